//! Heat of film that warms up by what it absorbs: its variables, beside the blocks (theory.md, equation 358).

use super::block::{Block, BlockEnergies, Blocks};
use super::kernel::{block_energies, gather};
use crate::lane::{Lane, Width, splat};
use crate::material::{Densities, Heat, MembraneLaw, Thermal};

/// Adiabatic heating of elements and its variables, block by block.
#[derive(Clone, Debug)]
pub(crate) struct Heating<const L: usize> {
    thermal: Thermal,
    /// The variables of [`Heat`].
    variables: Vec<[Lane<L>; Heat::VARIABLES]>,
}

impl<const L: usize> Heating<L> {
    /// Virgin film of as many blocks.
    pub(crate) fn new(thermal: Thermal, blocks: usize) -> Heating<L> {
        Heating { thermal, variables: vec![Heat::NONE.variables().map(splat); blocks] }
    }

    /// Resets the variables to those of virgin film.
    pub(crate) fn reset(&mut self) {
        self.variables.fill(Heat::NONE.variables().map(splat));
    }

    /// Variables of one block.
    pub(crate) fn of_block(&self, block: usize) -> &[Lane<L>] {
        &self.variables[block]
    }

    /// Variables of one block, mutable.
    pub(crate) fn of_block_mut(&mut self, block: usize) -> &mut [Lane<L>] {
        &mut self.variables[block]
    }

    /// Bytes of its arrays.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.variables[..])
    }

    /// Share of the law's forces that the elements of a block had at the last position.
    #[inline(always)]
    pub(super) fn share(&self, block: usize) -> &Lane<L> {
        let [share, ..] = &self.variables[block];
        share
    }

    /// Share of the law's forces that the elements of a block have at their next position.
    #[inline(always)]
    pub(super) fn next(&self, block: usize) -> &Lane<L> {
        let [_, next, ..] = &self.variables[block];
        next
    }

    /// Growth of the temperature of the element at a block and lane since it was mounted, K.
    pub(super) fn warming(&self, block: usize, lane: usize) -> f64 {
        self.thermal.warming(self.of_element([block, lane]).absorbed)
    }

    /// Energies (J) of a block with elements of these volumes (m³), where those of the law are `energies`.
    pub(super) fn softened(&self, block: usize, volume: Lane<L>, mut energies: BlockEnergies<L>) -> BlockEnergies<L> {
        let [share, _, absorbed, mounted, ..] = &self.variables[block];
        for l in 0..L {
            energies.stored[l] *= share[l];
            energies.hourglass[l] *= share[l];
            energies.absorbed[l] = volume[l] * (absorbed[l] + mounted[l]);
        }
        energies
    }

    /// Takes over the energies (J/m³) of the law of the element at a block and lane, whose fibres broke.
    pub(crate) fn break_fibres(&mut self, at: [usize; 2], law: Densities) {
        self.set(at, &Heat { law, ..self.of_element(at) });
    }

    fn of_element(&self, [block, lane]: [usize; 2]) -> Heat {
        Heat::of_variables(self.variables[block].each_ref().map(|variable| variable[lane]))
    }

    fn set(&mut self, [block, lane]: [usize; 2], heat: &Heat) {
        for (variable, value) in self.variables[block].iter_mut().zip(heat.variables()) {
            variable[lane] = value;
        }
    }
}

/// Warms the elements up, which moved to `position` in `dt` (s), after their forces.
#[cfg_attr(not(test), inline)]
pub(crate) fn heat<B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize>(
    width: Width,
    elements: &mut Blocks<B, NODES, L>,
    law: &M,
    position: &[&[f64]; 3],
    dt: f64,
) {
    // Taken out, since heat is written while blocks and their viscous points are read.
    let Some(mut heating) = elements.heating.take() else { return };
    let mut x = [[splat(0.0); 3]; NODES];
    for (b, block) in elements.blocks.iter().enumerate() {
        gather(&elements.corners[b], position, &mut x);
        let energies = block_energies(width, block, law, elements.viscous_block(b), &x);
        let volume = block.volume();
        for l in (0..L).filter(|l| volume[*l] > 0.0) {
            let mut heat = heating.of_element([b, l]);
            heat.advance(energies.densities(volume, l), dt, &heating.thermal);
            heating.set([b, l], &heat);
        }
    }
    elements.heating = Some(heating);
}

/// Lets an element, at its block and lane, in which fibres broke go on with what the law has left: it broke, and absorbed
/// nothing.
#[cfg_attr(not(test), inline)]
pub(crate) fn note_break<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    elements: &mut Blocks<B, NODES, L>,
    [block, lane]: [usize; 2],
    law: &M,
    position: &[&[f64]; 3],
) {
    let Some(mut heating) = elements.heating.take() else { return };
    let mut x = [[splat(0.0); 3]; NODES];
    gather(&elements.corners[block], position, &mut x);
    let of = &elements.blocks[block];
    let energies = block_energies(Width::best(), of, law, elements.viscous_block(block), &x);
    heating.break_fibres([block, lane], energies.densities(of.volume(), lane));
    elements.heating = Some(heating);
}
