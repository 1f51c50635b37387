//! The full step that observers are shown.

use super::impact::Impact;
use super::nodes::{Nodes, Vectors};
use super::rigid_body::RigidBody;

/// State of the full step, stored for an observer while the nodes move on.
#[derive(Default)]
pub(super) struct PreviousStep {
    pub(super) position: Vectors,
    pub(super) force: Vectors,
    /// Half a step before the full one.
    pub(super) velocity: Vectors,
    pub(super) bodies: Vec<RigidBody>,
}

impl PreviousStep {
    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        self.position.bytes() + self.force.bytes() + self.velocity.bytes()
    }

    /// Stores the present state.
    pub(super) fn store(&mut self, nodes: &Nodes, impacts: &[Impact]) {
        self.position.clone_from(&nodes.position);
        self.force.clone_from(&nodes.force);
        self.velocity.clone_from(&nodes.velocity);
        self.bodies.clear();
        self.bodies.extend(impacts.iter().map(|impact| impact.body.clone()));
    }
}
