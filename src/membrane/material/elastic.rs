//! Linear elastic film: St. Venant–Kirchhoff in plane stress.
//!
//! Energy per volume (theory.md, equation 9) with the Green–Lagrange strain E = ½(FᵀF − I) and G = Y/(2(1 + ν)):
//!
//! ```text
//! W = Y/(2(1 − ν²)) · (E₁₁² + E₂₂² + 2ν E₁₁E₂₂) + 2G E₁₂²
//! ∂W/∂f₁ = S₁₁ f₁ + S₁₂ f₂,   S₁₁ = Y/(1 − ν²)(E₁₁ + ν E₂₂),   S₁₂ = 2G E₁₂
//! ```

use serde::{Deserialize, Serialize};

use super::{Deformation, Energy, Measure, MembraneLaw, PeakStrains, Stiffness, Stress, ViscousBase};
use crate::lane::{Lane, each, lanes, larger, splat};

/// Isotropic linear elasticity for small strain and any rotation; it carries compression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Elastic {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio, −1 < ν < 0.5.
    pub poisson: f64,
}

/// Components 11, 22 and 12 of a symmetric tensor in the film.
pub(super) type Plane<const L: usize> = [Lane<L>; 3];

impl Elastic {
    /// Ȳ = Y/(1 − ν²), Pa.
    pub(super) fn plane(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }

    /// √(1 + 2E₃₃) with E₃₃ = −ν/Y (S₁₁ + S₂₂), in plane stress; NaN where the root is not real, beyond the strains
    /// for which the law is valid.
    pub(super) fn thickness_ratio_of<const L: usize>(&self, stress: &Stress<L>) -> Lane<L> {
        let [s11, s22] = &stress.tension;
        lanes(|l| (1.0 - 2.0 * self.poisson / self.young * (s11[l] + s22[l])).sqrt())
    }

    /// G = Y/(2(1 + ν)), Pa.
    fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// Green–Lagrange strain of C₁₁, C₂₂ and C₁₂.
    #[inline(always)]
    pub(super) fn strain([c11, c22, c12]: [f64; 3]) -> [f64; 3] {
        [0.5 * (c11 - 1.0), 0.5 * (c22 - 1.0), 0.5 * c12]
    }

    /// Second Piola–Kirchhoff stress at a strain.
    #[inline(always)]
    fn response(&self, [e11, e22, e12]: [f64; 3]) -> [f64; 3] {
        let plane = self.plane();
        [plane * (e11 + self.poisson * e22), plane * (e22 + self.poisson * e11), 2.0 * self.shear() * e12]
    }

    /// Bound on the tangent stiffness at deformation `d` under the second Piola–Kirchhoff stress `s` of C in each lane.
    #[inline(always)]
    pub(super) fn bound<const L: usize>(&self, d: &Deformation<L>, s: impl Fn([f64; 3]) -> [f64; 3]) -> Stiffness<L> {
        let [first, second, across_first, across_second, shear] = each(|l| {
            let c = d.metric_at(l);
            let ([c11, c22, _], [s11, s22, s12]) = (c, s(c));
            // (E₁ + νE₂)² mixes both directions; by 2ab ≤ a² + b² each takes the part of the other.
            let along = self.plane() * (1.0 + self.poisson.abs());
            // Sizes: compression softens, but the bound has to hold for strains nearby, too.
            let across = [s11.abs() + s12.abs(), s22.abs() + s12.abs()];
            [along * c11, along * c22, across[0], across[1], self.shear() * larger(c11, c22)]
        });
        let (along, across) = ([first, second], [across_first, across_second]);
        Stiffness { along, across, shear, alignment: splat(1.0), any: splat(0.0) }
    }
}

impl MembraneLaw for Elastic {
    type History<const L: usize> = PeakStrains<L>;
    const MEASURE: Option<Measure> = Some(Measure::SecondPiola);

    #[inline(always)]
    fn stress<const L: usize>(&self, d: &Deformation<L>, _history: &mut PeakStrains<L>, _dt: f64) -> Stress<L> {
        Stress::of_second_piola(d, |l| self.response(Elastic::strain(d.metric_at(l))))
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Energy<L> {
        let stored = lanes(|l| {
            let e = Elastic::strain(d.metric_at(l));
            let s = self.response(e);
            0.5 * (s[0] * e[0] + s[1] * e[1]) + s[2] * e[2]
        });
        Energy { stored, absorbed: splat(0.0) }
    }

    #[inline(always)]
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Stiffness<L> {
        self.bound(d, |c| self.response(Elastic::strain(c)))
    }

    fn thickness_ratio<const L: usize>(&self, _d: &Deformation<L>, stress: &Stress<L>) -> Lane<L> {
        self.thickness_ratio_of(stress)
    }

    fn viscous(&self) -> Option<ViscousBase> {
        Some(ViscousBase::isotropic(self.young, self.poisson, false))
    }

    fn moduli(&self) -> [f64; 2] {
        [self.plane(); 2]
    }

    #[inline(always)]
    fn break_strains<const L: usize>(&self, _history: &PeakStrains<L>) -> [Lane<L>; 2] {
        [splat(f64::INFINITY); 2]
    }
}
