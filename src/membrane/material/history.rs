//! History variables: what a law stores at an integration point between steps.

use crate::lane::{LANES, Lane, splat};

/// History variables of integration points, one point a lane.
pub trait History<const L: usize>: Clone + std::fmt::Debug + Send + Sync + 'static {
    /// History variables of virgin film.
    fn virgin() -> Self;
    /// Largest engineering strain so far of the MD (0) or TD (1) fibres.
    fn peak(&self, fibre: usize) -> &Lane<L>;
    /// Share of the layers whose MD (0) or TD (1) fibres are not broken.
    fn left(&self, fibre: usize) -> &Lane<L>;
    /// Share of the layers whose MD (0) or TD (1) fibres are not broken, mutable.
    fn left_mut(&mut self, fibre: usize) -> &mut Lane<L>;
    /// All variables, always in the same order.
    fn variables(&mut self) -> impl Iterator<Item = &mut Lane<L>>;
}

/// History variables of one fibre set.
pub trait FibreHistory<const L: usize>: Clone + std::fmt::Debug + Send + Sync + 'static {
    /// History variables of virgin fibres.
    fn virgin() -> Self;
    /// Largest engineering strain so far.
    fn peak(&self) -> &Lane<L>;
    /// All variables, always in the same order.
    fn variables(&mut self) -> impl Iterator<Item = &mut Lane<L>>;
}

/// History variables of two fibre sets, of their coupling and of shear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointHistory<F, const L: usize> {
    /// Of the MD and the TD fibres.
    pub fibres: [F; 2],
    /// Of the coupling of both directions.
    pub biaxial: F,
    /// Largest shear angle so far, rad.
    pub shear: Lane<L>,
    /// Share of the layers whose MD and TD fibres are not broken.
    pub left: [Lane<L>; 2],
}

/// Largest strains so far of the MD fibres, the TD fibres, of their coupling and in shear.
pub type PeakStrains<const L: usize = LANES> = PointHistory<Lane<L>, L>;

impl<F: FibreHistory<L>, const L: usize> History<L> for PointHistory<F, L> {
    fn virgin() -> Self {
        let fibres = [F::virgin(), F::virgin()];
        PointHistory { fibres, biaxial: F::virgin(), shear: splat(0.0), left: [splat(1.0); 2] }
    }

    #[inline(always)]
    fn peak(&self, fibre: usize) -> &Lane<L> {
        self.fibres[fibre].peak()
    }

    #[inline(always)]
    fn left(&self, fibre: usize) -> &Lane<L> {
        &self.left[fibre]
    }

    fn left_mut(&mut self, fibre: usize) -> &mut Lane<L> {
        &mut self.left[fibre]
    }

    fn variables(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        let fibres = self.fibres.iter_mut().chain([&mut self.biaxial]);
        fibres.flat_map(F::variables).chain([&mut self.shear]).chain(&mut self.left)
    }
}

/// Fibres whose largest strain is their only history variable.
impl<const L: usize> FibreHistory<L> for Lane<L> {
    fn virgin() -> Self {
        splat(0.0)
    }

    #[inline(always)]
    fn peak(&self) -> &Lane<L> {
        self
    }

    fn variables(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        [self].into_iter()
    }
}
