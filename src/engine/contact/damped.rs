//! What contact changes in the work of damping.

use nalgebra::Vector3;

use super::Contact;
use crate::engine::nodes::Nodes;

impl Contact {
    /// Remembers how the nodes in reach would move if they were not met.
    pub(in crate::engine) fn let_be(&mut self, nodes: &Nodes) {
        self.unmet.resize(self.offset.len(), Vector3::zeros());
        for n in self.within_reach() {
            self.unmet[n] = nodes.velocity_of(n);
        }
    }

    /// Σ m v̄·½Δv with the mean `v̄` of the velocities before and after a step without contact and the change `Δv` by contact,
    /// kg m²/s²: damping acts as if there were no contact, over the way that the nodes go with it.
    pub(in crate::engine) fn damped_on_the_way(&mut self, nodes: &Nodes) -> f64 {
        let mut sum = 0.0;
        for n in self.within_reach() {
            // A node may come up twice; then there is no change left.
            let after = nodes.velocity_of(n);
            let unmet = std::mem::replace(&mut self.unmet[n], after);
            sum += 0.5 * nodes.mass[n] * (after - unmet).dot(&(0.5 * (self.earlier[n] + unmet)));
        }
        sum
    }

    /// Nodes that may be met in this step, some of them twice.
    fn within_reach(&self) -> Vec<usize> {
        let corners = self.near.watched.iter().flat_map(|element| &element.corners);
        self.near.nodes.iter().chain(corners).map(|n| *n as usize).collect()
    }
}
