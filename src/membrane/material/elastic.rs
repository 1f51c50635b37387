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
use crate::lane::{Lane, dot, splat};

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
    /// for which the law is valid. `s` holds S₁₁ and S₂₂.
    pub(super) fn thickness_stretch<const L: usize>(&self, s: &[Lane<L>; 2]) -> Lane<L> {
        (1.0 - 2.0 * self.poisson / self.young * (s[0] + s[1])).sqrt()
    }

    fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// Green–Lagrange strain.
    #[inline(always)]
    pub(super) fn strain<const L: usize>(d: &Deformation<L>) -> Plane<L> {
        let [f1, f2] = &d.f;
        let [s1, s2] = d.stretch_variance;
        [0.5 * (dot(f1, f1) + s1 - 1.0), 0.5 * (dot(f2, f2) + s2 - 1.0), 0.5 * dot(f1, f2)]
    }

    /// Second Piola–Kirchhoff stress at strain `e`.
    #[inline(always)]
    fn response<const L: usize>(&self, e: &Plane<L>) -> Plane<L> {
        let (plane, nu) = (self.plane(), self.poisson);
        [plane * (e[0] + nu * e[1]), plane * (e[1] + nu * e[0]), 2.0 * self.shear() * e[2]]
    }

    /// First Piola–Kirchhoff stress and tension of the second, `s`.
    #[inline(always)]
    pub(super) fn first_piola<const L: usize>(d: &Deformation<L>, s: Plane<L>) -> Stress<L> {
        Stress::of_metric(d, [s[0], s[1]], s[2])
    }

    /// Bound on the tangent stiffness at deformation `d` under the second Piola–Kirchhoff stress `s`.
    #[inline(always)]
    pub(super) fn bound<const L: usize>(&self, d: &Deformation<L>, s: Plane<L>) -> Stiffness<L> {
        let [c11, c22, _] = d.metric();
        // (E₁ + νE₂)² mixes both directions; by 2ab ≤ a² + b² each takes the part of the other.
        let along = self.plane() * (1.0 + self.poisson.abs());
        Stiffness {
            along: [along * c11, along * c22],
            // Sizes: compression softens, but the bound has to hold for strains nearby, too.
            across: [s[0].abs() + s[2].abs(), s[1].abs() + s[2].abs()],
            shear: self.shear() * c11.max(c22),
            alignment: splat(1.0),
            any: splat(0.0),
        }
    }
}

impl MembraneLaw for Elastic {
    type History<const L: usize> = PeakStrains<L>;
    const MEASURE: Option<Measure> = Some(Measure::SecondPiola);

    #[inline(always)]
    fn stress<const L: usize>(&self, d: &Deformation<L>, _history: &mut PeakStrains<L>, _dt: f64) -> Stress<L> {
        Elastic::first_piola(d, self.response(&Elastic::strain(d)))
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Energy<L> {
        let e = Elastic::strain(d);
        let s = self.response(&e);
        Energy { stored: 0.5 * (s[0] * e[0] + s[1] * e[1]) + s[2] * e[2], absorbed: splat(0.0) }
    }

    #[inline(always)]
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Stiffness<L> {
        self.bound(d, self.response(&Elastic::strain(d)))
    }

    fn thickness_ratio<const L: usize>(&self, _d: &Deformation<L>, stress: &Stress<L>) -> Lane<L> {
        self.thickness_stretch(&stress.tension)
    }

    fn viscous(&self) -> Option<ViscousBase> {
        Some(ViscousBase::isotropic(self.young, self.poisson, false))
    }

    fn moduli(&self) -> [f64; 2] {
        [self.plane(); 2]
    }
}
