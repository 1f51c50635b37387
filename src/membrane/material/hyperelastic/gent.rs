//! Gent's energy, incompressible: chains of a largest length (Gent, Rubber Chem. Technol. 69, 1996).
//!
//! With `x = I₁ − 3 = c₁ + c₂ + 1/(c₁c₂) − 3` (theory.md, equation 222):
//!
//! ```text
//! W = −½ μ J_m ln(1 − x/J_m) ,   A = ∂W/∂I₁ = ½ μ J_m/(J_m − x)
//! ```
//!
//! At `x = J_m` and beyond there is no energy and no stress: both are NaN.

use serde::{Deserialize, Serialize};

use super::invariants::{self, Slopes};
use super::{NEAR, Squares, StrainEnergy, Tangent};
use crate::lane::{Lane, ln, splat};
use crate::material::elastic::Plane;

/// Coefficients of the energy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gent {
    /// Shear modulus μ, Pa.
    pub mu: f64,
    /// J_m, the limit of I₁ − 3.
    pub jm: f64,
}

impl Gent {
    /// A; NaN at the limit and beyond.
    #[inline(always)]
    fn slope(&self, x: f64) -> f64 {
        let left = self.jm - x;
        0.5 * self.mu * self.jm / if left > 0.0 { left } else { f64::NAN }
    }

    #[inline(always)]
    fn slopes<const L: usize>(&self, [trace, det]: &[Lane<L>; 2]) -> Slopes<L> {
        let mut out = [splat(0.0); 2];
        for l in 0..L {
            let inverse = 1.0 / det[l];
            let a = self.slope(trace[l] + inverse - 3.0);
            out[0][l] = a;
            out[1][l] = -a * inverse * inverse;
        }
        out
    }
}

impl StrainEnergy for Gent {
    #[inline(always)]
    fn energy<const L: usize>(&self, c: &Squares<L>) -> Lane<L> {
        let [trace, det] = invariants::of_squares(c);
        let mut out = splat(0.0);
        for l in 0..L {
            let left = 1.0 - (trace[l] + 1.0 / det[l] - 3.0) / self.jm;
            let energy = -0.5 * self.mu * self.jm * ln(left);
            out[l] = if left > 0.0 { energy } else { f64::NAN };
        }
        out
    }

    #[inline(always)]
    fn stress<const L: usize>(&self, c: &Squares<L>) -> [Lane<L>; 2] {
        invariants::stress(c, &self.slopes(&invariants::of_squares(c)))
    }

    #[inline(always)]
    fn plane_stress<const L: usize>(&self, c: &Plane<L>) -> Plane<L> {
        invariants::plane_stress(c, &self.slopes(&invariants::of_metric(c)))
    }

    /// At the largest I₁ that strains within 0.5 % reach; NaN where that is the limit.
    #[inline(always)]
    fn tangent<const L: usize>(&self, c: &Squares<L>) -> Tangent<L> {
        let [trace, det] = invariants::of_squares(c);
        let (mut slopes, mut curvatures) = ([splat(0.0); 2], [splat(0.0); 3]);
        for l in 0..L {
            let inverse = 1.0 / det[l];
            let square = inverse * inverse;
            let growth = 2.0 * NEAR * ((c[0][l] - inverse).abs() + (c[1][l] - inverse).abs());
            let a = self.slope(trace[l] + inverse - 3.0 + growth);
            let bent = 2.0 * a * a / (self.mu * self.jm);
            slopes[0][l] = a;
            slopes[1][l] = -a * square;
            curvatures[0][l] = bent;
            curvatures[1][l] = -bent * square;
            curvatures[2][l] = square * (bent * square + 2.0 * inverse * a);
        }
        invariants::tangent(c, &slopes, &curvatures)
    }

    fn plane_modulus(&self) -> f64 {
        4.0 * self.mu
    }

    fn has_limit(&self) -> bool {
        true
    }
}
