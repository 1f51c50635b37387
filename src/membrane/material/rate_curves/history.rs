//! History variables of fibres with curves by strain rate.

use super::super::history::FibreHistory;
use crate::lane::{Lane, splat};

/// History variables of one fibre set, one integration point a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateHistory<const L: usize> {
    /// Largest engineering strain so far, ε_m.
    pub(super) peak: Lane<L>,
    /// Mean time per growth of ε_m, p = 1/r, s.
    pub(super) slowness: Lane<L>,
    /// Work done over the energy of the present curve, X, J/m³.
    pub(super) surplus: Lane<L>,
}

impl<const L: usize> FibreHistory<L> for RateHistory<L> {
    fn virgin() -> Self {
        RateHistory { peak: splat(0.0), slowness: splat(0.0), surplus: splat(0.0) }
    }

    #[inline(always)]
    fn peak(&self) -> &Lane<L> {
        &self.peak
    }

    fn variables(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        [&mut self.peak, &mut self.slowness, &mut self.surplus].into_iter()
    }
}
