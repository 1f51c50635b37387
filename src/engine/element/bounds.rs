//! How fast an element could swing.

use super::block::Blocks;
use super::hourglass;
use super::kernel::{deformations, gather};
use crate::lane::{LANES, splat};
use crate::material::MembraneLaw;

/// Bound on the squared angular frequency of the elements of one block, rad²/s² (theory.md, equation 17).
pub(crate) fn frequency_bound<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    block: usize,
    law: &L,
    density: f64,
    position: &[[f64; 3]],
) -> f64 {
    let mut bound = splat(0.0);
    let mut volume = splat(0.0);
    let hourglass = &blocks.hourglass[block];
    let q = hourglass.amplitude(&gather(&blocks.nodes[block], position));
    let stabilisation = hourglass::stabilisation(law);
    for (point, d) in blocks.points[block].iter().zip(deformations(blocks, block, position)) {
        let k = law.stiffness(&d, &point.peaks);
        for l in 0..LANES {
            let mut g = [0.0; 2];
            for a in 0..NODES {
                for fibre in 0..2 {
                    g[fibre] += point.gradient[a][fibre][l] * point.gradient[a][fibre][l];
                }
            }
            let (first, second) = (k.along[0][l] * g[0], k.along[1][l] * g[1]);
            let apart = 0.5 * (first - second);
            let both = first * second * k.alignment[l] * k.alignment[l];
            let fibres = 0.5 * (first + second) + (apart * apart + both).sqrt();
            let tension = k.across[0][l] * g[0] + k.across[1][l] * g[1];
            let stabilised = hourglass.stiffness(&q, &d, stabilisation, g, l);
            bound[l] += point.volume[l] * (fibres + tension + k.shear[l] * (g[0] + g[1]) + stabilised);
            volume[l] += point.volume[l];
        }
    }
    let mut largest = 0.0_f64;
    for l in 0..LANES {
        if volume[l] > 0.0 {
            largest = largest.max(bound[l] * NODES as f64 / (density * volume[l]));
        }
    }
    largest
}
