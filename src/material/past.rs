//! What a point of film remembers.

use crate::lane::{LANES, Lane, splat};

/// Memory of integration points, one a lane.
pub trait Past<const L: usize>: Clone + std::fmt::Debug + Send + Sync {
    /// Of film that was never strained.
    fn fresh() -> Self;
    /// Largest engineering strain so far of the MD (0) or TD (1) fibres.
    fn peak(&self, fibre: usize) -> &Lane<L>;
    /// All numbers, always in the same order.
    fn numbers(&self) -> impl Iterator<Item = &Lane<L>>;
    /// The same, to be put back.
    fn numbers_mut(&mut self) -> impl Iterator<Item = &mut Lane<L>>;
}

/// Memory of one fibre set.
pub trait FibrePast<const L: usize>: Clone + std::fmt::Debug + Send + Sync {
    /// Of fibres that were never strained.
    fn fresh() -> Self;
    /// Largest engineering strain so far.
    fn peak(&self) -> &Lane<L>;
    /// All numbers, always in the same order.
    fn numbers(&self) -> impl Iterator<Item = &Lane<L>>;
    /// The same, to be put back.
    fn numbers_mut(&mut self) -> impl Iterator<Item = &mut Lane<L>>;
}

/// Memory of two fibre sets and of shear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmPast<F, const L: usize> {
    /// Of the MD and the TD fibres.
    pub fibres: [F; 2],
    /// Largest shear angle so far, rad.
    pub shear: Lane<L>,
}

/// Largest strains so far of the MD fibres, the TD fibres and in shear.
pub type Peaks<const L: usize = LANES> = FilmPast<Lane<L>, L>;

impl<F: FibrePast<L>, const L: usize> Past<L> for FilmPast<F, L> {
    fn fresh() -> Self {
        FilmPast { fibres: [F::fresh(), F::fresh()], shear: splat(0.0) }
    }

    #[inline(always)]
    fn peak(&self, fibre: usize) -> &Lane<L> {
        self.fibres[fibre].peak()
    }

    fn numbers(&self) -> impl Iterator<Item = &Lane<L>> {
        self.fibres.iter().flat_map(F::numbers).chain([&self.shear])
    }

    fn numbers_mut(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        self.fibres.iter_mut().flat_map(F::numbers_mut).chain([&mut self.shear])
    }
}

/// Fibres whose largest strain says all.
impl<const L: usize> FibrePast<L> for Lane<L> {
    fn fresh() -> Self {
        splat(0.0)
    }

    #[inline(always)]
    fn peak(&self) -> &Lane<L> {
        self
    }

    fn numbers(&self) -> impl Iterator<Item = &Lane<L>> {
        [self].into_iter()
    }

    fn numbers_mut(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        [self].into_iter()
    }
}
