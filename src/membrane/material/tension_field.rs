//! Tension field: an isotropic elastic film that wrinkles under compression.
//!
//! The relaxed energy (Pipkin 1986; Steigmann 1990) of St. Venant–Kirchhoff in plane stress is the least energy of film
//! with the same tangent vectors whose fine wrinkles may take up length. In the principal strains `E₁ ≥ E₂` of
//! `E = ½(FᵀF − I)`, with `Ȳ = Y/(1 − ν²)` and `⟨x⟩ = max(x, 0)` (theory.md, equation 9b):
//!
//! ```text
//! W  = ½ Y ⟨E₁⟩² + ½ Ȳ ⟨E₂ + νE₁⟩²
//! S₁ = Y ⟨E₁⟩ + ν Ȳ ⟨E₂ + νE₁⟩ ,   S₂ = Ȳ ⟨E₂ + νE₁⟩
//! ```
//!
//! Taut film (both brackets positive) follows St. Venant–Kirchhoff itself, wrinkled film (the second is zero) carries
//! tension along `E₁` alone, ½ Y E₁², and slack film nothing. Stress is continuous from one to the other.

use serde::{Deserialize, Serialize};

use super::elastic::{Elastic, Plane};
use super::{Deformation, Energy, Measure, MembraneLaw, PeakStrains, Stiffness, Stress, ViscousBase};
use crate::lane::{Lane, splat};

/// An elastic film without stiffness against compression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TensionField(pub Elastic);

/// Radius of Mohr's circle below which strain has no direction: far below round-off of a strain.
const POINT: f64 = 1e-100;

/// Principal strains and stresses of wrinkling film.
struct Principal<const L: usize> {
    /// E₁ ≥ E₂.
    strain: [Lane<L>; 2],
    /// S₁ ≥ S₂ ≥ 0, Pa.
    stress: [Lane<L>; 2],
    /// cos 2θ and sin 2θ of the first principal direction; zero where all directions are principal.
    direction: [Lane<L>; 2],
}

/// ⟨x⟩; zero for NaN, which the direction propagates.
#[inline(always)]
fn positive<const L: usize>(x: Lane<L>) -> Lane<L> {
    x.max(0.0)
}

impl TensionField {
    #[inline(always)]
    fn principal<const L: usize>(&self, e: &Plane<L>) -> Principal<L> {
        let Elastic { young, poisson } = self.0;
        let (mean, apart) = (0.5 * (e[0] + e[1]), 0.5 * (e[0] - e[1]));
        let radius = (apart * apart + e[2] * e[2]).sqrt();
        let (first, second) = (mean + radius, mean - radius);
        // theory.md, equation 9b: this bracket is zero from where the film has contracted as a free strip does, and with it
        // S₂.
        let across = self.0.plane() * positive(second + poisson * first);
        // Equal strains have no direction: both components become zero, and the mean alone is left.
        let inverse = 1.0 / radius.max(POINT);
        Principal {
            strain: [first, second],
            stress: [young * positive(first) + poisson * across, across],
            direction: [apart * inverse, e[2] * inverse],
        }
    }

    /// Second Piola–Kirchhoff stress S₁₁, S₂₂, S₁₂.
    #[inline(always)]
    fn response<const L: usize>(&self, d: &Deformation<L>) -> Plane<L> {
        let p = self.principal(&Elastic::strain(d));
        let (mean, apart) = (0.5 * (p.stress[0] + p.stress[1]), 0.5 * (p.stress[0] - p.stress[1]));
        [mean + apart * p.direction[0], mean - apart * p.direction[0], apart * p.direction[1]]
    }
}

impl MembraneLaw for TensionField {
    type History<const L: usize> = PeakStrains<L>;
    const MEASURE: Option<Measure> = Some(Measure::SecondPiola);

    #[inline(always)]
    fn stress<const L: usize>(&self, d: &Deformation<L>, _history: &mut PeakStrains<L>, _dt: f64) -> Stress<L> {
        Elastic::first_piola(d, self.response(d))
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Energy<L> {
        let Elastic { young, poisson } = self.0;
        let p = self.principal(&Elastic::strain(d));
        let along = positive(p.strain[0]);
        let across = positive(p.strain[1] + poisson * p.strain[0]);
        let stored = 0.5 * (young * along * along + self.0.plane() * across * across);
        Energy { stored, absorbed: splat(0.0) }
    }

    /// The bound of the elastic film with the tension of this one: relaxation reduces the stiffness, since the tension
    /// of wrinkled film rotates with `S₁/(E₁ − E₂) ≤ 2G`.
    #[inline(always)]
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Stiffness<L> {
        self.0.bound(d, self.response(d))
    }

    fn thickness_ratio<const L: usize>(&self, _d: &Deformation<L>, stress: &Stress<L>) -> Lane<L> {
        self.0.thickness_stretch(&stress.tension)
    }

    fn viscous(&self) -> Option<ViscousBase> {
        Some(ViscousBase::isotropic(self.0.young, self.0.poisson, true))
    }

    fn moduli(&self) -> [f64; 2] {
        [self.0.plane(); 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::Lane3;
    use crate::material::History;

    const LAW: TensionField = TensionField(Elastic { young: 5e7, poisson: 0.4 });

    /// Principal stretches in the plane, rotated by 0.3 in the film and out of its plane.
    fn rotated([first, second]: [f64; 2]) -> Deformation<1> {
        let (s, c) = 0.3_f64.sin_cos();
        let [u, v] = [[0.8, 0.0, 0.6], [0.0, 1.0, 0.0]];
        let f = |a: f64, b: f64| Lane3::splat([0, 1, 2].map(|i| first * a * u[i] + second * b * v[i]));
        Deformation::from([f(c, -s), f(s, c)])
    }

    fn energy(law: &impl MembraneLaw, stretches: [f64; 2]) -> f64 {
        law.energy(&rotated(stretches), &History::virgin()).stored[0]
    }

    #[test]
    fn energy_of_slack_wrinkled_and_taut_film() {
        let strain = |stretch: f64| 0.5 * (stretch * stretch - 1.0);
        assert_eq!(energy(&LAW, [0.99, 0.9]), 0.0);
        let wrinkled = 0.5 * LAW.0.young * strain(1.2) * strain(1.2);
        for across in [0.9, 0.5, 0.1] {
            assert!((energy(&LAW, [1.2, across]) / wrinkled - 1.0).abs() < 1e-12, "{across}");
        }
        for taut in [[1.2, 0.95], [1.2, 1.2], [1.0, 1.1]] {
            assert!((energy(&LAW, taut) / energy(&LAW.0, taut) - 1.0).abs() < 1e-12, "{taut:?}");
        }
    }

    /// The least energy over all lengths that wrinkles may take up.
    #[test]
    fn the_energy_is_relaxed() {
        for (stretches, wider) in [([1.2, 0.7], 1), ([0.8, 0.9], 2)] {
            let steps = || (0..2000).map(|k| 5e-4 * f64::from(k));
            let least = match wider {
                1 => steps().map(|h| energy(&LAW.0, [stretches[0], stretches[1] + h])).fold(f64::INFINITY, f64::min),
                _ => steps().map(|h| energy(&LAW.0, stretches.map(|s| (s + h).min(1.0)))).fold(f64::INFINITY, f64::min),
            };
            assert!((energy(&LAW, stretches) - least).abs() < 1e-6 * LAW.0.young, "{stretches:?}");
        }
    }

    #[test]
    fn wrinkled_film_is_in_uniaxial_tension() {
        let d = rotated([1.2, 0.7]);
        let stress = LAW.stress(&d, &mut PeakStrains::virgin(), 0.0);
        let (s, c) = 0.3_f64.sin_cos();
        let traction = |n: [f64; 2]| [0, 1, 2].map(|axis| n[0] * stress.p[0][axis][0] + n[1] * stress.p[1][axis][0]);
        let is = |traction: [f64; 3], expected: [f64; 3]| {
            (0..3).all(|axis| (traction[axis] - expected[axis]).abs() < 1e-7 * LAW.0.young)
        };
        assert!(is(traction([-s, c]), [0.0; 3]), "{:?}", traction([-s, c]));
        // Uniaxial tension of the stretch 1.2 along the first direction.
        let tension = 1.2 * LAW.0.young * 0.5 * (1.2 * 1.2 - 1.0);
        assert!(is(traction([c, s]), [0.8 * tension, 0.0, 0.6 * tension]), "{:?}", traction([c, s]));
    }
}
