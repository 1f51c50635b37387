//! The part of contact in the work of mass-proportional damping.

use nalgebra::Vector3;

use super::Contact;
use crate::engine::nodes::Nodes;

impl Contact {
    /// Records the predicted velocities of the nodes that may get an impulse.
    pub(in crate::engine) fn record_prediction(&mut self, nodes: &Nodes) {
        self.predicted.clear();
        self.predicted.extend(self.neighbours.impulse_nodes.iter().map(|n| nodes.velocity_of(*n as usize)));
    }

    /// Σ m v̄·½Δv with the mean `v̄` of the velocities before the step and of the predictor and the change `Δv` by the
    /// corrector, kg m²/s²: the damping force is that of the predictor, but its work is done along the corrected
    /// motion. Nodes that are `counted` elsewhere are left out.
    pub(in crate::engine) fn damping_correction(&self, nodes: &Nodes, counted: impl Fn(u32) -> bool) -> f64 {
        let of = |(n, predicted): (&u32, &Vector3<f64>)| {
            let n = *n as usize;
            0.25 * nodes.mass[n]
                * (nodes.velocity_of(n) - predicted)
                    .dot(&(Vector3::from(self.previous_velocity.value_at(n)) + predicted))
        };
        let own = self.neighbours.impulse_nodes.iter().zip(&self.predicted).filter(|(n, _)| !counted(**n));
        own.map(of).sum()
    }
}
