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
use crate::lane::{Lane, dot, larger, splat};

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
        crate::lane::lanes(|l| (1.0 - 2.0 * self.poisson / self.young * (s[0][l] + s[1][l])).sqrt())
    }

    fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// Green–Lagrange strain.
    #[inline(always)]
    pub(super) fn strain<const L: usize>(d: &Deformation<L>) -> Plane<L> {
        let [f1, f2] = &d.f;
        let (c11, c22, c12) = (dot(f1, f1), dot(f2, f2), dot(f1, f2));
        let mut strain = [splat(0.0); 3];
        for l in 0..L {
            strain[0][l] = 0.5 * (c11[l] + d.stretch_variance[0][l] - 1.0);
            strain[1][l] = 0.5 * (c22[l] + d.stretch_variance[1][l] - 1.0);
            strain[2][l] = 0.5 * c12[l];
        }
        strain
    }

    /// Second Piola–Kirchhoff stress at strain `e`.
    #[inline(always)]
    fn response<const L: usize>(&self, e: &Plane<L>) -> Plane<L> {
        let (plane, twice_shear) = (self.plane(), 2.0 * self.shear());
        let mut stress = [splat(0.0); 3];
        for l in 0..L {
            stress[0][l] = plane * (e[0][l] + self.poisson * e[1][l]);
            stress[1][l] = plane * (e[1][l] + self.poisson * e[0][l]);
            stress[2][l] = twice_shear * e[2][l];
        }
        stress
    }

    /// First Piola–Kirchhoff stress and tension of the second, `s`.
    #[inline(always)]
    pub(super) fn first_piola<const L: usize>(d: &Deformation<L>, s: Plane<L>) -> Stress<L> {
        let mut p = [[splat(0.0); 3]; 2];
        let [f1, f2] = &d.f;
        for axis in 0..3 {
            for l in 0..L {
                p[0][axis][l] = s[0][l] * f1[axis][l] + s[2][l] * f2[axis][l];
                p[1][axis][l] = s[1][l] * f2[axis][l] + s[2][l] * f1[axis][l];
            }
        }
        Stress { p, tension: [s[0], s[1]], cross: s[2] }
    }

    /// Bound on the tangent stiffness at deformation `d` under the second Piola–Kirchhoff stress `s`.
    #[inline(always)]
    pub(super) fn bound<const L: usize>(&self, d: &Deformation<L>, s: Plane<L>) -> Stiffness<L> {
        let (c11, c22) = (dot(&d.f[0], &d.f[0]), dot(&d.f[1], &d.f[1]));
        let nothing = splat(0.0);
        let mut bound = Stiffness { alignment: splat(1.0), ..Stiffness::in_any_direction(nothing) };
        for l in 0..L {
            let square = [c11[l] + d.stretch_variance[0][l], c22[l] + d.stretch_variance[1][l]];
            for fibre in 0..2 {
                // (E₁ + νE₂)² mixes both directions; by 2ab ≤ a² + b² each takes the part of the other.
                bound.along[fibre][l] = self.plane() * (1.0 + self.poisson.abs()) * square[fibre];
                // Sizes: compression softens, but the bound has to hold for strains nearby, too.
                bound.across[fibre][l] = s[fibre][l].abs() + s[2][l].abs();
            }
            bound.shear[l] = self.shear() * larger(square[0], square[1]);
        }
        bound
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
        let mut stored = splat(0.0);
        for l in 0..L {
            stored[l] = 0.5 * (s[0][l] * e[0][l] + s[1][l] * e[1][l]) + s[2][l] * e[2][l];
        }
        Energy { stored, absorbed: splat(0.0) }
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

    #[inline(always)]
    fn break_strains<const L: usize>(&self, _history: &PeakStrains<L>) -> [Lane<L>; 2] {
        [splat(f64::INFINITY); 2]
    }
}
