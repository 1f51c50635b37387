//! The pass over elements that warms them up by what they absorbed (theory.md, equation 358).

use super::block::{Block, BlockEnergies, Blocks};
use super::kernel::{block_energies, gather};
use crate::lane::{Lane, Width, at_width, splat};
use crate::material::{Densities, MembraneLaw};

at_width! {
    /// Warms the elements up, which moved to `position` in `dt` (s), after their forces.
    pub(crate) fn warm_up[B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize](
        elements: &mut Blocks<B, NODES, L>, law: &M, position: &[&[f64]; 3], dt: f64,
    ) = warm_up_lanewise, up to AVX2
}

#[inline(always)]
fn warm_up_lanewise<B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize>(
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
        let BlockEnergies { stored, absorbed, hourglass } =
            block_energies(Width::best(), block, law, elements.viscous_block(b), &x);
        let volume = block.volume();
        let (mut of_law, mut lost): (Lane<L>, Lane<L>) = (splat(0.0), splat(0.0));
        for l in 0..L {
            // Padding and deleted elements: 0/0 would be a NaN in history variables that are saved.
            let per_volume = if volume[l] > 0.0 { 1.0 / volume[l] } else { 0.0 };
            of_law[l] = (stored[l] + hourglass[l]) * per_volume;
            lost[l] = absorbed[l] * per_volume;
        }
        heating.advance(b, &of_law, &lost, dt);
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
    let Densities { stored, absorbed } = energies.densities(of.volume(), lane);
    heating.break_fibres([block, lane], [stored, absorbed]);
    elements.heating = Some(heating);
}
