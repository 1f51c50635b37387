//! The states of tests: kinds of tension, and the nominal stresses of a law at given stretches.

use std::fmt;

use super::{Hyperelastic, HyperelasticLaw, StrainEnergy, with_energy};
use crate::lane::one;

/// Kinds of tension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tension {
    /// Of a strip, which contracts across.
    Uniaxial,
    /// Equal stretches in both directions.
    Equibiaxial,
    /// Of a wide strip, which keeps its width: pure shear.
    Plane,
}

impl Tension {
    /// Squared principal stretches in the plane of film with this energy, that along the tension first.
    pub(super) fn squares(self, energy: &impl StrainEnergy, stretch: f64) -> [f64; 2] {
        let square = stretch * stretch;
        match self {
            Tension::Uniaxial => [square, energy.natural_width(one(square))[0]],
            Tension::Equibiaxial => [square; 2],
            Tension::Plane => [square, 1.0],
        }
    }
}

impl fmt::Display for Tension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Tension::Uniaxial => "uniaxial tension",
            Tension::Equibiaxial => "equibiaxial tension",
            Tension::Plane => "plane tension",
        })
    }
}

impl HyperelasticLaw {
    /// Principal stretches in the plane of film under tension, that along the tension first.
    pub fn stretches(&self, tension: Tension, stretch: f64) -> [f64; 2] {
        with_energy!(self, energy => tension.squares(energy, stretch).map(f64::sqrt))
    }

    /// Nominal principal stresses P_i = λ_i S_i (Pa) of taut film at these principal stretches in the plane, in their
    /// order; NaN beyond the limit of a law.
    pub fn nominal_stress(&self, stretches: [f64; 2]) -> [f64; 2] {
        let squares = stretches.map(|stretch| one(stretch * stretch));
        let stress = with_energy!(self, energy => energy.stress(&squares));
        [0, 1].map(|i| stretches[i] * stress[i][0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{CompressibleNeoHookean, Polynomial};

    /// Of neo-Hookean film: μ (λ − λ⁻²), μ (λ − λ⁻⁵) and μ (λ − λ⁻³), in compression too.
    #[test]
    fn stresses_of_tests_are_their_closed_forms() {
        let law = HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::neo_hookean(2.0), wrinkling: true });
        for stretch in [0.6, 1.0, 1.7, 4.0_f64] {
            for (tension, power) in [(Tension::Uniaxial, -2), (Tension::Equibiaxial, -5), (Tension::Plane, -3)] {
                let expected = 2.0 * (stretch - stretch.powi(power));
                let found = law.nominal_stress(law.stretches(tension, stretch))[0];
                assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{tension} at {stretch}: {found}");
            }
        }
    }

    #[test]
    fn a_strip_has_no_stress_across() {
        let energy = CompressibleNeoHookean { young: 1.0, poisson: 0.3 };
        let law = HyperelasticLaw::CompressibleNeoHookean(Hyperelastic { energy, wrinkling: false });
        for stretch in [0.7, 1.2, 3.0] {
            let [along, across] = law.nominal_stress(law.stretches(Tension::Uniaxial, stretch));
            assert!(across.abs() < 1e-12 && along.abs() > 0.1, "{along} {across}");
        }
    }
}
