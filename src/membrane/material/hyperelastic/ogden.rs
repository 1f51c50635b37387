//! Ogden's energy, incompressible (Ogden, Proc. R. Soc. A 326, 1972).
//!
//! With the principal stretches `λ_i`, `λ₃ = 1/(λ₁λ₂)` (theory.md, equation 223):
//!
//! ```text
//! W = Σ_k μ_k/α_k (λ₁^α_k + λ₂^α_k + λ₃^α_k − 3)
//! S_i = Σ_k μ_k (λ_i^α_k − λ₃^α_k)/c_i
//! ```

use serde::{Deserialize, Serialize};

use super::{NEAR, Principal, StrainEnergy, Tangent};
use crate::lane::{Lane, at, each, exp, lanes, ln};
use crate::material::{Deformation, Stress};

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

/// ln λ₁ and ln λ₂.
#[inline(always)]
fn logarithms([c1, c2]: [f64; 2]) -> [f64; 2] {
    [0.5 * ln(c1), 0.5 * ln(c2)]
}

impl OgdenTerm {
    /// λ₁^α, λ₂^α and λ₃^α.
    #[inline(always)]
    fn powers(&self, [first, second]: [f64; 2]) -> [f64; 3] {
        let [first, second] = [exp(self.alpha * first), exp(self.alpha * second)];
        [first, second, 1.0 / (first * second)]
    }

    /// Its part of W.
    #[inline(always)]
    fn energy(&self, logarithms: [f64; 2]) -> f64 {
        let [first, second, third] = self.powers(logarithms);
        self.mu / self.alpha * (first + second + third - 3.0)
    }

    /// Its part of c_i S_i.
    #[inline(always)]
    fn stress(&self, logarithms: [f64; 2]) -> [f64; 2] {
        let [first, second, third] = self.powers(logarithms);
        [self.mu * (first - third), self.mu * (second - third)]
    }

    /// Its part of [`StrainEnergy::tangent`]. `shear` by the mean value theorem: with λ₃ fixed, S is a function of c_i
    /// alone, whose derivative `Σ μ ((½α − 1) λ_i^α + λ₃^α)/c_i²` is largest at one of both, term by term.
    #[inline(always)]
    fn tangent(&self, [c1, c2]: [f64; 2], logarithms: [f64; 2]) -> [f64; 6] {
        let OgdenTerm { mu, alpha } = *self;
        let [p1, p2, p3] = self.powers(logarithms);
        // Change of the powers by strains within `NEAR`.
        let mu = mu * (1.0 + 2.0 * NEAR * alpha.abs());
        let stress = |c: f64, p: f64| mu * (p - p3) * (1.0 / c);
        let along = |c: f64, p: f64| mu * ((alpha - 1.0) * p + (alpha + 1.0) * p3) * (1.0 / c);
        let bent = |c: f64, p: f64| (0.5 * alpha - 1.0) * mu * p / (c * c);
        let (first, second) = (bent(c1, p1), bent(c2, p2));
        let steepest = if first > second { first } else { second };
        let across = mu * p3 / (if mu > 0.0 { c2 * c2 } else { c1 * c1 });
        let between = mu * alpha * p3 / (c1 * c2).sqrt();
        [stress(c1, p1), stress(c2, p2), along(c1, p1), along(c2, p2), between, steepest + across]
    }
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

    /// The sum of the parts of all terms in each lane, term by term, so that each is a loop over lanes.
    #[inline(always)]
    fn sum<const N: usize, const L: usize>(&self, part: impl Fn(&OgdenTerm, usize) -> [f64; N]) -> [Lane<L>; N] {
        let mut out = [[0.0; L]; N];
        for term in self.terms() {
            for l in 0..L {
                let part = part(term, l);
                for i in 0..N {
                    out[i][l] += part[i];
                }
            }
        }
        out
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
    fn energy(&self, c: [f64; 2]) -> f64 {
        let log = logarithms(c);
        let [[energy]] = self.sum(|term, _| [term.energy(log)]);
        energy
    }

    fn stress(&self, c: [f64; 2]) -> [f64; 2] {
        let log = logarithms(c);
        let [[first], [second]] = self.sum(|term, _| term.stress(log));
        [first / c[0], second / c[1]]
    }

    fn tangent(&self, c: [f64; 2]) -> Tangent {
        let log = logarithms(c);
        Tangent::from(self.sum(|term, _| term.tangent(c, log)).map(|[sum]| sum))
    }

    fn plane_modulus(&self) -> f64 {
        4.0 * self.shear_modulus()
    }

    #[inline(always)]
    fn energy_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Lane<L> {
        let log: [Lane<L>; 2] = each(|l| logarithms(self.principal::<WRINKLING>(d.metric_at(l)).squares));
        let [energy] = self.sum(|term, l| [term.energy(at(&log, l))]);
        energy
    }

    #[inline(always)]
    fn stress_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Stress<L> {
        let principal: [Lane<L>; 5] = each(|l| self.principal::<WRINKLING>(d.metric_at(l)).into());
        let log: [Lane<L>; 2] = each(|l| logarithms(Principal::from(at(&principal, l)).squares));
        let sums: [Lane<L>; 2] = self.sum(|term, l| term.stress(at(&log, l)));
        Stress::of_second_piola(d, |l| {
            let principal = Principal::from(at(&principal, l));
            principal.turned([sums[0][l] / principal.squares[0], sums[1][l] / principal.squares[1]])
        })
    }

    #[inline(always)]
    fn bound_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Lane<L> {
        let c: [Lane<L>; 2] = each(|l| self.principal::<WRINKLING>(d.metric_at(l)).squares);
        let log: [Lane<L>; 2] = each(|l| logarithms(at(&c, l)));
        let sums: [Lane<L>; 6] = self.sum(|term, l| term.tangent(at(&c, l), at(&log, l)));
        lanes(|l| Tangent::from(at(&sums, l)).largest(at(&c, l)))
    }
}
