//! How fast an element could swing.

use super::block::Blocks;
use super::hourglass;
use super::kernel::{deformation, gather};
use crate::lane::{LANES, splat};
use crate::material::MembraneLaw;

/// Bound on the squared angular frequency of all elements, rad²/s² (theory.md, equation 17).
pub(crate) fn frequency_bound<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    law: &L,
    density: f64,
    position: &[[f64; 3]],
) -> f64 {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[target_feature(enable = "avx2")]
        fn avx2<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
            blocks: &Blocks<NODES, POINTS>,
            law: &L,
            density: f64,
            position: &[[f64; 3]],
        ) -> f64 {
            frequency_bound_lanewise(blocks, law, density, position)
        }
        // SAFETY: the machine was just seen to have AVX2.
        return unsafe { avx2(blocks, law, density, position) };
    }
    frequency_bound_lanewise(blocks, law, density, position)
}

#[inline(always)]
fn frequency_bound_lanewise<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    law: &L,
    density: f64,
    position: &[[f64; 3]],
) -> f64 {
    let stabilisation = hourglass::stabilisation(law);
    let mut x = [[splat(0.0); 3]; NODES];
    let mut largest = 0.0;
    for ((nodes, points), hourglass) in blocks.nodes.iter().zip(&blocks.points).zip(&blocks.hourglass) {
        gather(nodes, position, &mut x);
        let q = hourglass.amplitude(&x);
        let mut bound = splat(0.0);
        let mut volume = splat(0.0);
        for point in points {
            let d = deformation(&x, point, hourglass.spread(&q));
            let k = law.stiffness(&d, &point.peaks);
            let mut g = [splat(0.0); 2];
            let mut mixed = splat(0.0);
            for a in 0..NODES {
                for l in 0..LANES {
                    let [b1, b2] = [point.gradient[a][0][l], point.gradient[a][1][l]];
                    g[0][l] += b1 * b1;
                    g[1][l] += b2 * b2;
                    mixed[l] += b1 * b2;
                }
            }
            let stabilised = hourglass.stiffness(&q, &d, stabilisation, &g);
            for l in 0..LANES {
                let (first, second) = (k.along[0][l] * g[0][l], k.along[1][l] * g[1][l]);
                let apart = 0.5 * (first - second);
                let both = first * second * k.alignment[l] * k.alignment[l];
                let fibres = 0.5 * (first + second) + (apart * apart + both).sqrt();
                let tension = k.across[0][l] * g[0][l] + k.across[1][l] * g[1][l];
                let sheared = k.shear[l] * (g[0][l] + g[1][l] + 2.0 * mixed[l].abs());
                bound[l] += point.volume[l] * (fibres + tension + sheared + stabilised[l]);
                volume[l] += point.volume[l];
            }
        }
        for l in 0..LANES {
            let squared = bound[l] * NODES as f64 / (density * volume[l]);
            // Broken elements and the fill of the last block have no volume; a NaN has to get through.
            let settled = volume[l] == 0.0 || squared <= largest || largest.is_nan();
            largest = if settled { largest } else { squared };
        }
    }
    largest
}
