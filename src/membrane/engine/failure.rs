//! Failure of elements.

use super::element::{Block, Blocks, ElementEnergy, energy_at};
use crate::lane::LANES;
use crate::material::MembraneLaw;

/// Deletes every element in which a fibre set is past its break strain: its volume and its forces become zero, its
/// mass stays at the nodes. Returns the number of elements and their energies.
pub(super) fn delete_failed<B, M, const NODES: usize>(
    elements: &mut Blocks<B, NODES>,
    law: &M,
    position: &[&[f64]; 3],
) -> (usize, ElementEnergy)
where
    B: Block<NODES, LANES>,
    M: MembraneLaw<History<LANES> = B::History>,
{
    let mut total = (0, ElementEnergy::default());
    for (block, lane) in elements.indices() {
        if elements.is_deleted(block, lane) || !elements.blocks[block].has_failed(law, lane) {
            continue;
        }
        total.0 += 1;
        total.1.add(&energy_at(elements, [block, lane], law, position));
        elements.blocks[block].delete(lane);
    }
    total
}
