//! Breaking of elements.

use super::element::{Block, Blocks, ElementEnergy, energy_at};
use crate::lane::LANES;
use crate::material::MembraneLaw;

/// Breaks every element in which a fibre set is past its break strain: its volume becomes zero, so that it has no
/// force any more; its mass stays in the nodes. Returns how many broke and the energies they held.
pub(super) fn break_elements<B, M, const NODES: usize>(
    elements: &mut Blocks<B, NODES>,
    law: &M,
    position: &[&[f64]; 3],
) -> (usize, ElementEnergy)
where
    B: Block<NODES, LANES>,
    M: MembraneLaw<Past<LANES> = B::Past>,
{
    let mut total = (0, ElementEnergy::default());
    for (block, lane) in elements.places() {
        if elements.is_broken(block, lane) || !elements.blocks[block].is_past(law, lane) {
            continue;
        }
        total.0 += 1;
        total.1.add(&energy_at(elements, [block, lane], law, position));
        elements.blocks[block].take_out(lane);
    }
    total
}
