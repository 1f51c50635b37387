//! Breaking of elements.

use super::element::{Blocks, ElementEnergy, energies};
use crate::material::MembraneLaw;

/// Breaks every element in which a fibre set is past its break strain: its volume becomes zero, so that it has no
/// force any more; its mass stays in the nodes. Returns how many broke and the energies they held.
pub(super) fn break_elements<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &mut Blocks<NODES, POINTS>,
    law: &L,
    position: &[[f64; 3]],
) -> (usize, ElementEnergy) {
    let limits = law.break_strains();
    let mut total = (0, ElementEnergy::default());
    for (block, lane) in blocks.places() {
        let past = |p: &super::element::Point<NODES>| p.peaks[0][lane] > limits[0] || p.peaks[1][lane] > limits[1];
        if blocks.is_broken(block, lane) || !blocks.points[block].iter().any(past) {
            continue;
        }
        let held = energies(blocks, block, law, position)[lane];
        total = sum([total, (1, held)]);
        blocks.points[block].iter_mut().for_each(|p| p.volume[lane] = 0.0);
    }
    total
}

/// Total of several counts and energies.
pub(super) fn sum<const N: usize>(parts: [(usize, ElementEnergy); N]) -> (usize, ElementEnergy) {
    parts.into_iter().fold((0, ElementEnergy::default()), |(n, total), (count, held)| {
        let total = ElementEnergy {
            stored: total.stored + held.stored,
            absorbed: total.absorbed + held.absorbed,
            hourglass: total.hourglass + held.hourglass,
        };
        (n + count, total)
    })
}
