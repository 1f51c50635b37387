//! Heat of film that warms up by what it absorbs: its variables, beside the blocks, and the pass that warms elements up
//! (theory.md, section 31).

use super::block::Block;
use super::elements::Elements;
use super::kernel::block_energies;
use crate::lane::{LANES, Lane, Width, at_width, lanes};
use crate::material::{Densities, HEAT_VARIABLES, Heat, MembraneLaw, Thermal};

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
    pub(crate) fn of_block(&mut self, block: usize) -> [&mut Lane<L>; HEAT_VARIABLES] {
        self.blocks[block].variables()
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
        *absorbed + *mounted
    }

    /// Takes over the energies (J/m³) that the law of the element at a block and lane stores and has absorbed, whose fibres
    /// broke.
    fn break_fibres(&mut self, [block, lane]: [usize; 2], Densities { stored, absorbed }: Densities) {
        let heat = &mut self.blocks[block];
        (heat.law_stored[lane], heat.law_absorbed[lane]) = (stored, absorbed);
    }
}

at_width! {
    up to AVX2
    /// Warms the elements up, which moved to `position` in `dt` (s), after their forces (theory.md, equation 358).
    pub(super) fn warm_up[M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize](
        elements: &mut Elements<M, B, NODES>, position: &[&[f64]; 3], dt: f64,
    ) {
        // Taken out, since heat is written while blocks and their viscous points are read.
        let Some(mut heating) = elements.common.heating.take() else { return };
        for (b, block) in elements.blocks.iter().enumerate() {
            let x = elements.gather(b, position);
            let energies = block_energies(Width::best(), block, &*elements.law, elements.viscous_block(b), &x);
            let volume = block.volume();
            let stored = lanes(|l| energies.densities(&volume, l).stored);
            let absorbed = lanes(|l| energies.densities(&volume, l).absorbed);
            heating.blocks[b].advance(stored, absorbed, dt, &heating.thermal);
        }
        elements.common.heating = Some(heating);
    }
}

impl<M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize> Elements<M, B, NODES> {
    /// Restarts the heat of the element at a block and lane in which fibres broke: what the law has absorbed less since then
    /// left with them.
    #[cfg_attr(not(test), inline)]
    pub(super) fn restart_heat(&mut self, [block, lane]: [usize; 2], position: &[&[f64]; 3]) {
        let Some(mut heating) = self.common.heating.take() else { return };
        let (of, x) = (&self.blocks[block], self.gather(block, position));
        let energies = block_energies(Width::best(), of, &*self.law, self.viscous_block(block), &x);
        heating.break_fibres([block, lane], energies.densities(&of.volume(), lane));
        self.common.heating = Some(heating);
    }
}
