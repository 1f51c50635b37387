//! Ogden's energy, incompressible (Ogden, Proc. R. Soc. A 326, 1972).
//!
//! With the principal stretches `λ_i`, `λ₃ = 1/(λ₁λ₂)` (theory.md, equation 223):
//!
//! ```text
//! W = Σ_k μ_k/α_k (λ₁^α_k + λ₂^α_k + λ₃^α_k − 3)
//! S_i = Σ_k μ_k (λ_i^α_k − λ₃^α_k)/c_i
//! ```

use serde::{Deserialize, Serialize};

use super::{NEAR, Squares, StrainEnergy, Tangent};
use crate::lane::{Lane, splat};

/// Most terms of the energy.
pub const TERMS: usize = 6;

/// A term of the energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OgdenTerm {
    /// μ_k, Pa.
    pub mu: f64,
    /// α_k, not zero.
    pub alpha: f64,
}

/// Terms of the energy, at most [`Ogden::TERMS`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ogden {
    terms: [OgdenTerm; TERMS],
    count: usize,
}

/// λ₁^α, λ₂^α and λ₃^α of a term.
type Powers<const L: usize> = [Lane<L>; 3];

/// ln λ₁ and ln λ₂.
#[inline(always)]
fn logarithms<const L: usize>(c: &Squares<L>) -> [Lane<L>; 2] {
    [0.5 * c[0].ln(), 0.5 * c[1].ln()]
}

#[inline(always)]
fn powers<const L: usize>(alpha: f64, log: &[Lane<L>; 2]) -> Powers<L> {
    let (first, second) = ((alpha * log[0]).exp(), (alpha * log[1]).exp());
    [first, second, 1.0 / (first * second)]
}

impl Ogden {
    /// Most terms of the energy.
    pub const TERMS: usize = TERMS;

    /// The terms for Treloar's rubber (Ogden, Proc. R. Soc. A 326, 1972).
    pub const TRELOAR: [OgdenTerm; 3] =
        [OgdenTerm { mu: 6.3e5, alpha: 1.3 }, OgdenTerm { mu: 1.2e3, alpha: 5.0 }, OgdenTerm { mu: -1e4, alpha: -2.0 }];

    /// The energy of these terms.
    ///
    /// # Panics
    /// Where there are more than [`Ogden::TERMS`].
    pub fn new(written: &[OgdenTerm]) -> Ogden {
        let mut terms = [OgdenTerm::default(); TERMS];
        terms[..written.len()].copy_from_slice(written);
        Ogden { terms, count: written.len() }
    }

    /// Its terms.
    pub fn terms(&self) -> &[OgdenTerm] {
        &self.terms[..self.count]
    }

    /// Shear modulus of small strain, ½ Σ μ_k α_k, Pa.
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.terms().iter().map(|term| term.mu * term.alpha).sum::<f64>()
    }
}

impl StrainEnergy for Ogden {
    #[inline(always)]
    fn energy<const L: usize>(&self, c: &Squares<L>) -> Lane<L> {
        let log = logarithms(c);
        let mut out = splat(0.0);
        for term in self.terms() {
            let [first, second, third] = powers(term.alpha, &log);
            out += term.mu / term.alpha * (first + second + third - 3.0);
        }
        out
    }

    #[inline(always)]
    fn stress<const L: usize>(&self, c: &Squares<L>) -> [Lane<L>; 2] {
        let log = logarithms(c);
        let mut sum = [splat(0.0); 2];
        for term in self.terms() {
            let [first, second, third] = powers(term.alpha, &log);
            sum[0] += term.mu * (first - third);
            sum[1] += term.mu * (second - third);
        }
        [sum[0] / c[0], sum[1] / c[1]]
    }

    /// `shear` by the mean value theorem: with λ₃ fixed, S is a function of c_i alone, whose derivative
    /// `Σ μ ((½α − 1) λ_i^α + λ₃^α)/c_i²` is largest at one of both, term by term.
    #[inline(always)]
    fn tangent<const L: usize>(&self, c: &Squares<L>) -> Tangent<L> {
        let log = logarithms(c);
        let nothing = splat(0.0);
        let mut out = Tangent { stress: [nothing; 2], along: [nothing; 2], between: nothing, shear: nothing };
        for OgdenTerm { mu, alpha } in self.terms() {
            let powers = powers(*alpha, &log);
            // Change of the powers by strains within `NEAR`.
            let mu = mu * (1.0 + 2.0 * NEAR * alpha.abs());
            let third = powers[2];
            for i in 0..2 {
                let inverse = 1.0 / c[i];
                out.stress[i] += mu * (powers[i] - third) * inverse;
                out.along[i] += mu * ((alpha - 1.0) * powers[i] + (alpha + 1.0) * third) * inverse;
            }
            out.between += mu * alpha * third / (c[0] * c[1]).sqrt();
            let fourth = [c[0] * c[0], c[1] * c[1]];
            let bent = (0.5 * alpha - 1.0) * mu;
            let steepest = (bent * powers[0] / fourth[0]).max(bent * powers[1] / fourth[1]);
            out.shear += steepest + mu * third / if mu > 0.0 { fourth[1] } else { fourth[0] };
        }
        out
    }

    fn plane_modulus(&self) -> f64 {
        4.0 * self.shear_modulus()
    }
}
