//! Derivatives of an energy of `I = c₁ + c₂` and `D = c₁c₂`, the trace and the determinant of C.

use super::{Squares, Tangent};
use crate::lane::{Lane, splat};
use crate::material::elastic::Plane;

/// ∂W/∂I and ∂W/∂D, Pa.
pub(super) type Slopes<const L: usize> = [Lane<L>; 2];

/// I and D of C₁₁, C₂₂ and C₁₂.
#[inline(always)]
pub(super) fn of_metric<const L: usize>(c: &Plane<L>) -> [Lane<L>; 2] {
    let mut out = [splat(0.0); 2];
    for l in 0..L {
        out[0][l] = c[0][l] + c[1][l];
        out[1][l] = c[0][l] * c[1][l] - c[2][l] * c[2][l];
    }
    out
}

/// I and D of the principal squares.
#[inline(always)]
pub(super) fn of_squares<const L: usize>(c: &Squares<L>) -> [Lane<L>; 2] {
    let mut out = [splat(0.0); 2];
    for l in 0..L {
        out[0][l] = c[0][l] + c[1][l];
        out[1][l] = c[0][l] * c[1][l];
    }
    out
}

/// S = 2 ∂W/∂I + 2 ∂W/∂D cof C.
#[inline(always)]
pub(super) fn plane_stress<const L: usize>(c: &Plane<L>, slopes: &Slopes<L>) -> Plane<L> {
    let mut s = [splat(0.0); 3];
    for l in 0..L {
        s[0][l] = 2.0 * (slopes[0][l] + slopes[1][l] * c[1][l]);
        s[1][l] = 2.0 * (slopes[0][l] + slopes[1][l] * c[0][l]);
        s[2][l] = -2.0 * slopes[1][l] * c[2][l];
    }
    s
}

/// S₁ and S₂.
#[inline(always)]
pub(super) fn stress<const L: usize>(c: &Squares<L>, slopes: &Slopes<L>) -> [Lane<L>; 2] {
    let mut s = [splat(0.0); 2];
    for l in 0..L {
        s[0][l] = 2.0 * (slopes[0][l] + slopes[1][l] * c[1][l]);
        s[1][l] = 2.0 * (slopes[0][l] + slopes[1][l] * c[0][l]);
    }
    s
}

/// The derivatives by the stretches, where `curvatures` are ∂²W/∂I², ∂²W/∂I∂D and ∂²W/∂D².
#[inline(always)]
pub(super) fn tangent<const L: usize>(c: &Squares<L>, slopes: &Slopes<L>, curvatures: &[Lane<L>; 3]) -> Tangent<L> {
    let nothing = splat(0.0);
    let stress = stress(c, slopes);
    let mut out = Tangent { stress, along: [nothing; 2], between: nothing, shear: nothing };
    let [trace, mixed, det] = curvatures;
    for l in 0..L {
        for (i, j) in [(0, 1), (1, 0)] {
            let other = c[j][l];
            let second = trace[l] + other * (2.0 * mixed[l] + other * det[l]);
            out.along[i][l] = stress[i][l] + 4.0 * c[i][l] * second;
        }
        let product = c[0][l] * c[1][l];
        let cross = trace[l] + mixed[l] * (c[0][l] + c[1][l]) + det[l] * product + slopes[1][l];
        out.between[l] = 4.0 * product.sqrt() * cross;
        out.shear[l] = -2.0 * slopes[1][l];
    }
    out
}
