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
use crate::lane::Lane;
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
    fn slope<const L: usize>(&self, x: Lane<L>) -> Lane<L> {
        let left = self.jm - x;
        0.5 * self.mu * self.jm / left.above(0.0).select(left, f64::NAN)
    }

    #[inline(always)]
    fn slopes<const L: usize>(&self, [trace, det]: &[Lane<L>; 2]) -> Slopes<L> {
        let inverse = 1.0 / *det;
        let a = self.slope(*trace + inverse - 3.0);
        [a, -a * inverse * inverse]
    }
}

impl StrainEnergy for Gent {
    #[inline(always)]
    fn energy<const L: usize>(&self, c: &Squares<L>) -> Lane<L> {
        let [trace, det] = invariants::of_squares(c);
        let left = 1.0 - (trace + 1.0 / det - 3.0) / self.jm;
        left.above(0.0).select(-0.5 * self.mu * self.jm * left.ln(), f64::NAN)
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
        let inverse = 1.0 / det;
        let square = inverse * inverse;
        let growth = 2.0 * NEAR * ((c[0] - inverse).abs() + (c[1] - inverse).abs());
        let a = self.slope(trace + inverse - 3.0 + growth);
        let bent = 2.0 * a * a / (self.mu * self.jm);
        let curvatures = [bent, -bent * square, square * (bent * square + 2.0 * inverse * a)];
        invariants::tangent(c, &[a, -a * square], &curvatures)
    }

    fn plane_modulus(&self) -> f64 {
        4.0 * self.mu
    }

    fn has_limit(&self) -> bool {
        true
    }
}
