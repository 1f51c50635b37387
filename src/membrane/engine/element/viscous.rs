//! Viscous film: the history variables of its Prony series, beside the blocks of its elements.

use crate::lane::{Lane, splat};
use crate::material::{Deformation, Energy, Measure, Stiffness, Stress, ViscousLaw, ViscousStep};

/// The Prony series of elements and its history variables, block by block and point by point.
#[derive(Clone, Debug)]
pub(crate) struct ViscousPoints<const L: usize> {
    law: ViscousLaw,
    /// Coefficients of the present step, and its length, s; NaN before the first one that takes time.
    step: ViscousStep<L>,
    dt: f64,
    /// Whether the film was mounted or has moved.
    is_mounted: bool,
    /// Of one block.
    per_block: usize,
    variables: Vec<Lane<L>>,
}

impl<const L: usize> ViscousPoints<L> {
    /// Points of virgin film in `blocks` blocks of `points` integration points.
    pub(crate) fn new(law: ViscousLaw, blocks: usize, points: usize) -> ViscousPoints<L> {
        let per_block = points * law.viscosity.variables();
        let step = ViscousStep::mounting(&law.viscosity);
        let variables = vec![splat(0.0); blocks * per_block];
        let mut points = ViscousPoints { law, step, dt: f64::NAN, is_mounted: false, per_block, variables };
        points.reset();
        points
    }

    /// Resets the variables to those of virgin film.
    pub(crate) fn reset(&mut self) {
        let count = self.law.viscosity.variables();
        self.variables.chunks_exact_mut(count).for_each(|point| self.law.reset(point));
        self.step = ViscousStep::mounting(&self.law.viscosity);
        (self.dt, self.is_mounted) = (f64::NAN, false);
    }

    /// Whether a step of `dt` (s) mounts the film: the first one, if it takes no time.
    pub(crate) fn mounts(&self, dt: f64) -> bool {
        !self.is_mounted && dt == 0.0
    }

    /// Its blocks, in order, for a step of `dt` (s).
    #[inline(always)]
    pub(crate) fn pass(&mut self, dt: f64) -> ViscousPass<'_, L> {
        if !self.mounts(dt) && dt != self.dt {
            self.step = ViscousStep::over(&self.law.viscosity, dt);
            self.dt = dt;
        }
        self.is_mounted = true;
        let ViscousPoints { law, step, per_block, variables, .. } = self;
        ViscousPass { law, step, blocks: variables.chunks_exact_mut(*per_block) }
    }

    /// The law and the variables of one block.
    pub(crate) fn block(&self, block: usize) -> ViscousBlock<'_, L> {
        ViscousBlock { law: &self.law, variables: &self.variables[block * self.per_block..][..self.per_block] }
    }

    /// The law and the variables of one block, mutable; all points of the block follow each other.
    pub(crate) fn block_mut(&mut self, block: usize) -> (&ViscousLaw, &mut [Lane<L>]) {
        // Its variables may be restored ones.
        self.is_mounted = true;
        (&self.law, &mut self.variables[block * self.per_block..][..self.per_block])
    }

    /// Takes from all points of the element at a block and lane what fibres that broke carried, where the shares of the
    /// layers whose MD and TD fibres are not broken fell from `before` to `left`.
    pub(crate) fn break_fibres(&mut self, [block, lane]: [usize; 2], before: [f64; 2], left: [f64; 2]) {
        let count = self.law.viscosity.variables();
        let (law, variables) = self.block_mut(block);
        variables.chunks_exact_mut(count).for_each(|point| law.break_fibres(point, lane, before, left));
    }

    /// Counts `energy` (J/m³ of the law as written) as the work done at the points of a block.
    pub(super) fn count_mounting(&mut self, block: usize, energy: Lane<L>) {
        let (count, instant) = (self.law.viscosity.variables(), self.law.instant());
        let (law, variables) = self.block_mut(block);
        let work = instant * energy;
        variables.chunks_exact_mut(count).for_each(|point| law.set_work(point, work));
    }
}

/// The blocks of viscous film in a step.
pub(crate) struct ViscousPass<'a, const L: usize> {
    law: &'a ViscousLaw,
    step: &'a ViscousStep<L>,
    blocks: std::slice::ChunksExactMut<'a, Lane<L>>,
}

impl<const L: usize> ViscousPass<'_, L> {
    /// The next block.
    #[inline(always)]
    pub(crate) fn next_block(&mut self) -> Option<MovedBlock<'_, L>> {
        let (law, step) = (self.law, self.step);
        self.blocks.next().map(|variables| MovedBlock { law, step, variables })
    }
}

/// Viscous points of one block in a step.
pub(crate) struct MovedBlock<'a, const L: usize> {
    law: &'a ViscousLaw,
    step: &'a ViscousStep<L>,
    variables: &'a mut [Lane<L>],
}

impl<const L: usize> MovedBlock<'_, L> {
    /// Replaces the stress of the law of this measure at the point numbered `point`, which is deformed by `d`.
    #[inline(always)]
    pub(crate) fn advance(&mut self, measure: Measure, point: usize, d: &Deformation<L>, stress: &mut Stress<L>) {
        let count = self.law.viscosity.variables();
        self.law.advance(measure, self.step, d, stress, &mut self.variables[point * count..][..count]);
    }
}

/// Viscous points of one block between steps.
#[derive(Clone, Copy)]
pub(crate) struct ViscousBlock<'a, const L: usize> {
    law: &'a ViscousLaw,
    variables: &'a [Lane<L>],
}

impl<const L: usize> ViscousBlock<'_, L> {
    fn point(&self, point: usize) -> &[Lane<L>] {
        let count = self.law.viscosity.variables();
        &self.variables[point * count..][..count]
    }

    /// Stress of a point.
    pub(super) fn stress(&self, point: usize, d: &Deformation<L>) -> Stress<L> {
        self.law.stress(d, self.point(point))
    }

    /// Energy of a point, where the law has `stress` and `energy`.
    #[inline(always)]
    pub(super) fn energy(&self, point: usize, d: &Deformation<L>, stress: &Stress<L>, energy: &Energy<L>) -> Energy<L> {
        self.law.energy(d, stress, energy, self.point(point))
    }

    /// Bound on the stiffness of a point, where that of the law is `stiffness`.
    #[inline(always)]
    pub(super) fn stiffness(&self, point: usize, d: &Deformation<L>, stiffness: Stiffness<L>) -> Stiffness<L> {
        self.law.stiffness(d, stiffness, self.point(point))
    }
}
