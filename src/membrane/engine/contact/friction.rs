//! Coulomb coefficients of the faces.

use crate::lane::{LANES, Lane};

/// Coefficient of the first face against the impactor, and of each further face, which is pressed against the one
/// before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    pub(super) impactor: f64,
    pub(super) film: f64,
    /// Number of nodes of the first face, which come first.
    pub(super) first_face: usize,
}

impl Friction {
    /// Coefficient at a node.
    pub(super) fn coefficient_at(&self, node: usize) -> f64 {
        if node < self.first_face { self.impactor } else { self.film }
    }

    /// Coefficient at each of some nodes.
    #[inline(always)]
    pub(super) fn lanes(&self, nodes: &[u32; LANES]) -> Lane {
        nodes.map(|node| self.coefficient_at(node as usize))
    }
}
