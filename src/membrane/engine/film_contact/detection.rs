//! Which tracked nodes and crossings come too close in a step, a lane each.

use std::ops::Range;

use super::crossing::{Crossing, PARALLEL};
use super::surface::{NONE, Surface};
use super::tracking::{BESIDE, Tracking};
use crate::engine::nodes::Vectors;
use crate::lane::{LANES, Lane, Lane3, at_width, cross, dot, splat};

at_width! {
    /// Adds those of the nodes `range` that come closer to the plane of their triangle than allowed, or that are not over
    /// it any more, to `found`.
    pub(super) fn near_nodes[](
        tracking: &Tracking,
        position: &Vectors,
        range: Range<usize>,
        found: &mut Vec<u32>,
    ) = near_nodes_lanewise
}

#[inline(always)]
fn near_nodes_lanewise(tracking: &Tracking, position: &Vectors, range: Range<usize>, found: &mut Vec<u32>) {
    for first in range.clone().step_by(LANES) {
        let of = |l: usize| (first + l).min(range.end - 1);
        let all = tracking.triangle.get(first..first + LANES);
        if all.is_some_and(|all| all.iter().all(|triangle| *triangle == NONE)) {
            continue;
        }
        let nodes: [u32; LANES] = std::array::from_fn(|l| of(l) as u32);
        let corners = [0, 1, 2].map(|k| tracking.corners[k].as_slice());
        let [a, b, c] = corners.map(|corner| position.gather(&std::array::from_fn(|l| corner[of(l)])));
        let p = position.gather(&nodes);
        let (u, v, r) = (minus(&b, &a), minus(&c, &a), minus(&p, &a));
        let area = cross(&u, &v);
        let (height, squared) = (dot(&area, &r), dot(&area, &area));
        // Weights of the corners times the square.
        let (of_b, of_c) = (dot(&cross(&r, &v), &area), dot(&cross(&u, &r), &area));
        let mut is_near = [false; LANES];
        for l in 0..LANES {
            let n = of(l);
            let beside = -BESIDE * squared[l];
            let is_over = of_b[l] >= beside && of_c[l] >= beside && squared[l] - of_b[l] - of_c[l] >= beside;
            let is_close = tracking.sign[n] * height[l] < tracking.bound[n] * squared[l].sqrt();
            // Where the node follows nothing, its triangle has no area.
            is_near[l] = squared[l] > 0.0 && (is_close || !is_over);
        }
        for l in (0..LANES.min(range.end - first)).filter(|l| is_near[*l]) {
            found.push((first + l) as u32);
        }
    }
}

/// Two edges at the end of a step as predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossed {
    /// Place of the crossing in the list.
    pub(super) place: usize,
    /// Where they cross, over the length of each.
    pub(super) shares: [f64; 2],
    /// Unit vector from the other edge to the walker.
    pub(super) normal: [f64; 3],
    /// Along it, m.
    pub(super) distance: f64,
}

/// What is found among crossings.
#[derive(Clone, Debug, Default)]
pub(super) struct FoundCrossings {
    /// Those that are too close.
    pub(super) crossed: Vec<Crossed>,
    /// Places of those that have become parallel, or are so no more.
    pub(super) turned: Vec<usize>,
}

at_width! {
    /// Adds those of the crossings `range` that are closer than `factor` of what is allowed, and those that have turned, to
    /// `found`.
    pub(super) fn near_crossings[](
        crossings: &[Crossing],
        surface: &Surface,
        position: &Vectors,
        range: Range<usize>,
        factor: f64,
        found: &mut FoundCrossings,
    ) = near_crossings_lanewise
}

#[inline(always)]
fn near_crossings_lanewise(
    crossings: &[Crossing],
    surface: &Surface,
    position: &Vectors,
    range: Range<usize>,
    factor: f64,
    found: &mut FoundCrossings,
) {
    for first in range.clone().step_by(LANES) {
        let of = |l: usize| (first + l).min(range.end - 1);
        let nodes: [[u32; 4]; LANES] = std::array::from_fn(|l| crossings[of(l)].nodes(surface));
        let [a, b, c, d] =
            [0, 1, 2, 3].map(|k| position.gather(&std::array::from_fn::<u32, LANES, _>(|l| nodes[l][k])));
        let (e, f, w) = (minus(&b, &a), minus(&d, &c), minus(&a, &c));
        let across = cross(&e, &f);
        let squared = dot(&across, &across);
        let (of_e, of_f) = (dot(&e, &e), dot(&f, &f));
        let (height, s, t) = (dot(&across, &w), dot(&cross(&f, &w), &across), dot(&cross(&e, &w), &across));
        let mut out: [Lane; 4] = [splat(0.0); 4];
        let (mut is_near, mut has_turned) = ([false; LANES], [false; LANES]);
        for l in 0..LANES {
            let crossing = &crossings[of(l)];
            let length = squared[l].sqrt();
            out[0][l] = s[l] / squared[l];
            out[1][l] = t[l] / squared[l];
            out[2][l] = crossing.sign / length;
            out[3][l] = out[2][l] * height[l];
            let is_inside = (0.0..=1.0).contains(&out[0][l]) && (0.0..=1.0).contains(&out[1][l]);
            let is_across = squared[l] > PARALLEL * of_e[l] * of_f[l];
            has_turned[l] = is_across != (crossing.sign != 0.0);
            is_near[l] = is_across && is_inside && out[3][l] < factor * crossing.bound;
        }
        let count = LANES.min(range.end - first);
        found.turned.extend((0..count).filter(|l| has_turned[*l]).map(|l| first + l));
        for l in (0..count).filter(|l| is_near[*l] && !has_turned[*l]) {
            let normal = [0, 1, 2].map(|axis| across[axis][l] * out[2][l]);
            found.crossed.push(Crossed {
                place: first + l,
                shares: [out[0][l], out[1][l]],
                normal,
                distance: out[3][l],
            });
        }
    }
}

#[inline(always)]
fn minus(a: &Lane3, b: &Lane3) -> Lane3 {
    let mut out = [splat(0.0); 3];
    for axis in 0..3 {
        for l in 0..LANES {
            out[axis][l] = a[axis][l] - b[axis][l];
        }
    }
    out
}
