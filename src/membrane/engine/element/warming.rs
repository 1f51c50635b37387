//! The pass over elements that warms them up by what they absorbed (theory.md, equation 358).

use super::block::{Block, Blocks};
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
        let energies = block_energies(Width::best(), block, law, elements.viscous_block(b), &x);
        let volume = block.volume();
        let (mut stored, mut absorbed): (Lane<L>, Lane<L>) = (splat(0.0), splat(0.0));
        for l in 0..L {
            Densities { stored: stored[l], absorbed: absorbed[l] } = energies.densities(&volume, l);
        }
        heating.advance(b, &stored, &absorbed, dt);
    }
    elements.heating = Some(heating);
}

/// Restarts the heat of the element at a block and lane in which fibres broke: what the law has absorbed less since then left
/// with them.
#[cfg_attr(not(test), inline)]
pub(crate) fn restart_after_break<
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
    let Densities { stored, absorbed } = energies.densities(&of.volume(), lane);
    heating.break_fibres([block, lane], [stored, absorbed]);
    elements.heating = Some(heating);
}
