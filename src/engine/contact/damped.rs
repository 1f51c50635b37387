//! What contact changes in the work of damping.

use nalgebra::Vector3;

use super::Contact;
use crate::engine::nodes::Nodes;

impl Contact {
    /// Remembers how the nodes in reach would move if they were not met.
    pub(in crate::engine) fn let_be(&mut self, nodes: &Nodes) {
        self.unmet.clear();
        self.unmet.extend(self.near.remembered.iter().map(|n| nodes.velocity_of(*n as usize)));
    }

    /// Σ m v̄·½Δv with the mean `v̄` of the velocities before and after a step without contact and the change `Δv` by contact,
    /// kg m²/s²: damping acts as if there were no contact, over the way that the nodes go with it.
    pub(in crate::engine) fn damped_on_the_way(&self, nodes: &Nodes) -> f64 {
        let of = |(n, unmet): (&u32, &Vector3<f64>)| {
            let n = *n as usize;
            0.25 * nodes.mass[n] * (nodes.velocity_of(n) - unmet).dot(&(Vector3::from(self.earlier.at(n)) + unmet))
        };
        self.near.remembered.iter().zip(&self.unmet).map(of).sum()
    }
}
