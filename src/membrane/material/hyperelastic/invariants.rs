//! Derivatives of an energy of `I = c₁ + c₂` and `D = c₁c₂`, the trace and the determinant of C.

use super::{Squares, Tangent};
use crate::lane::Lane;
use crate::material::elastic::Plane;

/// ∂W/∂I and ∂W/∂D, Pa.
pub(super) type Slopes<const L: usize> = [Lane<L>; 2];

/// I and D of C₁₁, C₂₂ and C₁₂.
#[inline(always)]
pub(super) fn of_metric<const L: usize>(c: &Plane<L>) -> [Lane<L>; 2] {
    [c[0] + c[1], c[0] * c[1] - c[2] * c[2]]
}

/// I and D of the principal squares.
#[inline(always)]
pub(super) fn of_squares<const L: usize>(c: &Squares<L>) -> [Lane<L>; 2] {
    [c[0] + c[1], c[0] * c[1]]
}

/// S = 2 ∂W/∂I + 2 ∂W/∂D cof C.
#[inline(always)]
pub(super) fn plane_stress<const L: usize>(c: &Plane<L>, slopes: &Slopes<L>) -> Plane<L> {
    let [by_trace, by_det] = *slopes;
    [2.0 * (by_trace + by_det * c[1]), 2.0 * (by_trace + by_det * c[0]), -2.0 * by_det * c[2]]
}

/// S₁ and S₂.
#[inline(always)]
pub(super) fn stress<const L: usize>(c: &Squares<L>, slopes: &Slopes<L>) -> [Lane<L>; 2] {
    let [by_trace, by_det] = *slopes;
    [2.0 * (by_trace + by_det * c[1]), 2.0 * (by_trace + by_det * c[0])]
}

/// The derivatives by the stretches, where `curvatures` are ∂²W/∂I², ∂²W/∂I∂D and ∂²W/∂D².
#[inline(always)]
pub(super) fn tangent<const L: usize>(c: &Squares<L>, slopes: &Slopes<L>, curvatures: &[Lane<L>; 3]) -> Tangent<L> {
    let stress = stress(c, slopes);
    let [trace, mixed, det] = *curvatures;
    let mut along = stress;
    for (i, j) in [(0, 1), (1, 0)] {
        along[i] += 4.0 * c[i] * (trace + c[j] * (2.0 * mixed + c[j] * det));
    }
    let product = c[0] * c[1];
    let cross = trace + mixed * (c[0] + c[1]) + det * product + slopes[1];
    let between = 4.0 * product.sqrt() * cross;
    Tangent { stress, along, between, shear: -2.0 * slopes[1] }
}
