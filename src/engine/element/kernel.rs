//! From positions to forces and energies, a block at a time.

use super::block::{Blocks, Point};
use super::hourglass;
use crate::lane::{LANES, Lane, Lane3, splat};
use crate::material::{Deformation, MembraneLaw};

/// Positions of a block's nodes.
#[inline(always)]
pub(super) fn gather<const NODES: usize>(nodes: &[[u32; LANES]; NODES], position: &[[f64; 3]]) -> [Lane3; NODES] {
    let mut x = [[splat(0.0); 3]; NODES];
    for a in 0..NODES {
        for l in 0..LANES {
            let p = position[nodes[a][l] as usize];
            for axis in 0..3 {
                x[a][axis][l] = p[axis];
            }
        }
    }
    x
}

#[inline(always)]
fn scatter<const NODES: usize>(nodes: &[[u32; LANES]; NODES], f: &[Lane3; NODES], force: &mut [[f64; 3]]) {
    for a in 0..NODES {
        for l in 0..LANES {
            let to = &mut force[nodes[a][l] as usize];
            for axis in 0..3 {
                to[axis] += f[a][axis][l];
            }
        }
    }
}

/// f_I = Σ_a ∂N_a/∂X_I x_a (theory.md, equation 1), and how far f_I varies around it.
#[inline(always)]
fn deformation<const NODES: usize>(x: &[Lane3; NODES], point: &Point<NODES>, spread: [Lane; 2]) -> Deformation {
    let mut f = [[splat(0.0); 3]; 2];
    for fibre in 0..2 {
        for axis in 0..3 {
            for a in 0..NODES {
                for l in 0..LANES {
                    f[fibre][axis][l] += point.gradient[a][fibre][l] * x[a][axis][l];
                }
            }
        }
    }
    Deformation { f, spread }
}

/// Adds the forces of all elements to `force` and raises the largest strains.
/// True if a fibre somewhere is past its break strain.
pub(crate) fn add_forces<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &mut Blocks<NODES, POINTS>,
    law: &L,
    position: &[[f64; 3]],
    force: &mut [[f64; 3]],
) -> bool {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        #[target_feature(enable = "avx2")]
        fn avx2<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
            blocks: &mut Blocks<NODES, POINTS>,
            law: &L,
            position: &[[f64; 3]],
            force: &mut [[f64; 3]],
        ) -> bool {
            add_forces_lanewise(blocks, law, position, force)
        }
        // SAFETY: the machine was just seen to have AVX2.
        return unsafe { avx2(blocks, law, position, force) };
    }
    add_forces_lanewise(blocks, law, position, force)
}

/// [`add_forces`], to be compiled for vectors of each width: the operations are the same, so the bits are.
#[inline(always)]
fn add_forces_lanewise<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &mut Blocks<NODES, POINTS>,
    law: &L,
    position: &[[f64; 3]],
    force: &mut [[f64; 3]],
) -> bool {
    let limits = law.break_strains();
    let stabilisation = hourglass::stabilisation(law);
    let mut past = false;
    for ((nodes, points), hourglass) in blocks.nodes.iter().zip(&mut blocks.points).zip(&blocks.hourglass) {
        let x = gather(nodes, position);
        let mut out = [[splat(0.0); 3]; NODES];
        if NODES == 4 && POINTS == 1 {
            let q = hourglass.amplitude(&x);
            let d = deformation(&x, &points[0], hourglass.spread(&q));
            let mut stress = law.stress(&d, &mut points[0].peaks);
            hourglass.subtract_force(&mut out, &q, &d, &points[0].volume, &mut stress, stabilisation);
            subtract_stress(&mut out, &points[0], &stress.p);
            past |= beyond(&points[0], limits);
        } else {
            for point in points.iter_mut() {
                let d = deformation(&x, point, [splat(0.0); 2]);
                let stress = law.stress(&d, &mut point.peaks);
                subtract_stress(&mut out, point, &stress.p);
                past |= beyond(point, limits);
            }
        }
        scatter(nodes, &out, force);
    }
    past
}

/// −V Σ_I ∂N_a/∂X_I p_I (theory.md, equation 2).
#[inline(always)]
fn subtract_stress<const NODES: usize>(out: &mut [Lane3; NODES], point: &Point<NODES>, p: &[Lane3; 2]) {
    for fibre in 0..2 {
        for axis in 0..3 {
            let mut vp = splat(0.0);
            for l in 0..LANES {
                vp[l] = point.volume[l] * p[fibre][axis][l];
            }
            for a in 0..NODES {
                for l in 0..LANES {
                    out[a][axis][l] -= point.gradient[a][fibre][l] * vp[l];
                }
            }
        }
    }
}

#[inline(always)]
fn beyond<const NODES: usize>(point: &Point<NODES>, limits: [f64; 2]) -> bool {
    let mut any = false;
    for l in 0..LANES {
        any |= (point.volume[l] > 0.0) & ((point.peaks[0][l] > limits[0]) | (point.peaks[1][l] > limits[1]));
    }
    any
}

/// Energies of one element, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct ElementEnergy {
    /// Comes back on unloading.
    pub stored: f64,
    /// Lost in the law.
    pub absorbed: f64,
    /// In the stabilisation.
    pub hourglass: f64,
}

/// Energies of the elements of one block, lane by lane.
pub(crate) fn energies<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    block: usize,
    law: &L,
    position: &[[f64; 3]],
) -> [ElementEnergy; LANES] {
    let x = gather(&blocks.nodes[block], position);
    let stabilisation = hourglass::stabilisation(law);
    let hourglass = &blocks.hourglass[block];
    let q = hourglass.amplitude(&x);
    let mut out = [ElementEnergy::default(); LANES];
    for point in &blocks.points[block] {
        let d = deformation(&x, point, hourglass.spread(&q));
        let energy = law.energy(&d, &point.peaks);
        let stabilised = hourglass.energy(&q, &d, stabilisation);
        for l in 0..LANES {
            out[l].stored += point.volume[l] * energy.stored[l];
            out[l].absorbed += point.volume[l] * energy.absorbed[l];
            out[l].hourglass += point.volume[l] * stabilised[l];
        }
    }
    out
}

/// Deformation at every integration point of a block.
pub(crate) fn deformations<const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    block: usize,
    position: &[[f64; 3]],
) -> [Deformation; POINTS] {
    let x = gather(&blocks.nodes[block], position);
    let hourglass = &blocks.hourglass[block];
    let spread = hourglass.spread(&hourglass.amplitude(&x));
    std::array::from_fn(|p| deformation(&x, &blocks.points[block][p], spread))
}
