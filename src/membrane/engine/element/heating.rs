//! Heat of film that warms up by what it absorbs: its variables, beside the blocks (theory.md, section 31).

use crate::lane::{Lane, lanes};
use crate::material::{HEAT_VARIABLES, Heat, Thermal};

/// Adiabatic heating of elements and its variables, block by block.
#[derive(Clone, Debug)]
pub(crate) struct Heating<const L: usize> {
    thermal: Thermal,
    blocks: Vec<Heat<L>>,
}

impl<const L: usize> Heating<L> {
    /// Virgin film of as many blocks.
    pub(crate) fn new(thermal: Thermal, blocks: usize) -> Heating<L> {
        Heating { thermal, blocks: vec![Heat::NONE; blocks] }
    }

    /// Resets the variables to those of virgin film.
    pub(crate) fn reset(&mut self) {
        self.blocks.fill(Heat::NONE);
    }

    /// Variables of one block.
    pub(crate) fn of_block(&self, block: usize) -> [&Lane<L>; HEAT_VARIABLES] {
        self.blocks[block].variables()
    }

    /// Variables of one block, mutable.
    pub(crate) fn of_block_mut(&mut self, block: usize) -> [&mut Lane<L>; HEAT_VARIABLES] {
        self.blocks[block].variables_mut()
    }

    /// Bytes of its arrays.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..])
    }

    /// Share of the law's forces that the elements of a block had at the last position.
    #[inline(always)]
    pub(super) fn share(&self, block: usize) -> &Lane<L> {
        &self.blocks[block].share
    }

    /// Share of the law's forces that the elements of a block have at their next position.
    #[inline(always)]
    pub(super) fn next(&self, block: usize) -> &Lane<L> {
        &self.blocks[block].next
    }

    /// Growth of the temperature of the element at a block and lane since it was mounted, K.
    pub(super) fn warming(&self, block: usize, lane: usize) -> f64 {
        self.thermal.warming(self.blocks[block].absorbed[lane])
    }

    /// Energy that the elements of a block have absorbed, J/m³.
    pub(super) fn absorbed(&self, block: usize) -> Lane<L> {
        let Heat { absorbed, mounted, .. } = &self.blocks[block];
        lanes(|l| absorbed[l] + mounted[l])
    }

    /// Moves a block on to the next position after `dt` (s), at which the law has `stored` and `absorbed` these energies (J/m³).
    #[inline(always)]
    pub(super) fn advance(&mut self, block: usize, stored: &Lane<L>, absorbed: &Lane<L>, dt: f64) {
        self.blocks[block].advance(stored, absorbed, dt, &self.thermal);
    }

    /// Takes over the energies (J/m³) that the law of the element at a block and lane stores and has absorbed, whose fibres
    /// broke.
    pub(super) fn break_fibres(&mut self, [block, lane]: [usize; 2], [stored, absorbed]: [f64; 2]) {
        let heat = &mut self.blocks[block];
        (heat.law_stored[lane], heat.law_absorbed[lane]) = (stored, absorbed);
    }
}
