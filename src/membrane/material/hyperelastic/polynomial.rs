//! Neo-Hookean, Mooney–Rivlin and Yeoh, incompressible: a polynomial in the invariants.
//!
//! With `λ₃² = 1/D`, `I₁ = I + 1/D` and `I₂ = D + I/D` (theory.md, equation 221):
//!
//! ```text
//! W = c₁₀ (I₁ − 3) + c₂₀ (I₁ − 3)² + c₃₀ (I₁ − 3)³ + c₀₁ (I₂ − 3)
//! ∂W/∂I = A + c₀₁/D ,   ∂W/∂D = −A/D² + c₀₁ (1 − I/D²) ,   A = ∂W/∂I₁
//! ```

use serde::{Deserialize, Serialize};

use super::invariants::{self, Slopes};
use super::{Squares, StrainEnergy, Tangent};
use crate::lane::Lane;
use crate::material::elastic::Plane;

/// Coefficients of the polynomial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polynomial {
    /// c₁₀, c₂₀ and c₃₀, Pa.
    pub first: [f64; 3],
    /// c₀₁, Pa.
    pub second: f64,
}

impl Polynomial {
    /// The neo-Hookean energy with the shear modulus `mu` (Pa).
    pub fn neo_hookean(mu: f64) -> Polynomial {
        Polynomial { first: [0.5 * mu, 0.0, 0.0], second: 0.0 }
    }

    /// The energy of Mooney and Rivlin, coefficients in Pa.
    pub fn mooney_rivlin(c10: f64, c01: f64) -> Polynomial {
        Polynomial { first: [c10, 0.0, 0.0], second: c01 }
    }

    /// The energy of Yeoh, coefficients in Pa.
    pub fn yeoh(first: [f64; 3]) -> Polynomial {
        Polynomial { first, second: 0.0 }
    }

    #[inline(always)]
    fn slopes<const L: usize>(&self, [trace, det]: &[Lane<L>; 2]) -> Slopes<L> {
        let [c10, c20, c30] = self.first;
        let inverse = 1.0 / *det;
        let x = *trace + inverse - 3.0;
        let a = c10 + x * (2.0 * c20 + x * (3.0 * c30));
        let square = inverse * inverse;
        [a + self.second * inverse, self.second * (1.0 - *trace * square) - a * square]
    }
}

impl StrainEnergy for Polynomial {
    #[inline(always)]
    fn energy<const L: usize>(&self, c: &Squares<L>) -> Lane<L> {
        let [trace, det] = invariants::of_squares(c);
        let [c10, c20, c30] = self.first;
        let x = trace + 1.0 / det - 3.0;
        let y = det + trace / det - 3.0;
        x * (c10 + x * (c20 + x * c30)) + self.second * y
    }

    #[inline(always)]
    fn stress<const L: usize>(&self, c: &Squares<L>) -> [Lane<L>; 2] {
        invariants::stress(c, &self.slopes(&invariants::of_squares(c)))
    }

    #[inline(always)]
    fn plane_stress<const L: usize>(&self, c: &Plane<L>) -> Plane<L> {
        invariants::plane_stress(c, &self.slopes(&invariants::of_metric(c)))
    }

    #[inline(always)]
    fn tangent<const L: usize>(&self, c: &Squares<L>) -> Tangent<L> {
        let invariants = invariants::of_squares(c);
        let [_, c20, c30] = self.first;
        let slopes = self.slopes(&invariants);
        let [trace, det] = invariants;
        let inverse = 1.0 / det;
        let (square, x) = (inverse * inverse, trace + inverse - 3.0);
        let a = slopes[0] - self.second * inverse;
        let bent = 2.0 * c20 + 6.0 * c30 * x;
        let bent_det = square * (bent * square + 2.0 * inverse * (a + self.second * trace));
        invariants::tangent(c, &slopes, &[bent, -(bent + self.second) * square, bent_det])
    }

    fn plane_modulus(&self) -> f64 {
        8.0 * (self.first[0] + self.second)
    }
}
