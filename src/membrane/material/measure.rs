//! Measure of a law, as a Prony series on it needs it: the stress that relaxes, compression, compliance.

use super::Deformation;
use crate::lane::{Lane, splat};

/// The stress that relaxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The second Piola–Kirchhoff stress S.
    SecondPiola,
    /// The forces along the fibres over their stress-free cross-section, m₁ S₁₁, m₂ S₂₂ and m₁ m₂ S₁₂ with the
    /// stretches m_I ≥ 1 of the fibres: S itself decreases where a fibre is stretched under constant force.
    Fibres,
}

/// How film that is shortened faster than it relaxes avoids compression: it is longer than its span then, and wrinkles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WithoutCompression {
    /// Not at all: the law carries compression.
    Carried,
    /// Fibres carry no more compression than their law gives them.
    Fibres,
    /// No direction carries compression.
    AnyDirection,
}

/// Measure of a law, as a Prony series on it needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousBase {
    /// The stress that relaxes.
    pub measure: Measure,
    /// Behaviour under compression.
    pub compression: WithoutCompression,
    /// Compliance of film at rest by the stresses of the measure, 1/Pa: C₁₁, C₂₂, C₁₂ = C₂₁, and that of shear, by
    /// which the energy is ½ C₃₃ S₁₂².
    pub compliance: [f64; 4],
}

impl ViscousBase {
    /// Isotropic film, with Young's modulus (Pa) and Poisson's ratio at rest.
    pub(super) fn isotropic(young: f64, poisson: f64, is_wrinkling: bool) -> ViscousBase {
        use WithoutCompression::{AnyDirection, Carried};
        let compression = if is_wrinkling { AnyDirection } else { Carried };
        let compliance = [1.0 / young, 1.0 / young, -poisson / young, 2.0 * (1.0 + poisson) / young];
        ViscousBase { measure: Measure::SecondPiola, compression, compliance }
    }

    /// ½ s·C·s at rest, J/m³.
    #[inline(always)]
    pub(super) fn complementary<const L: usize>(&self, s: &[Lane<L>; 3]) -> Lane<L> {
        let [first, second, between, shear] = self.compliance;
        let normal = 0.5 * (first * s[0] * s[0] + second * s[1] * s[1]);
        normal + between * s[0] * s[1] + 0.5 * shear * s[2] * s[2]
    }
}

/// A deformation in the measure of a law.
pub(super) struct Measured<const L: usize> {
    /// Strains that the stresses do work on.
    pub(super) strain: [Lane<L>; 3],
    /// Stress of the measure over S.
    pub(super) scale: [Lane<L>; 3],
    /// S over the stress of the measure.
    pub(super) inverse: [Lane<L>; 3],
}

impl Measure {
    #[inline(always)]
    pub(super) fn evaluate<const L: usize>(self, d: &Deformation<L>) -> Measured<L> {
        let [c11, c22, c12] = d.metric();
        match self {
            Measure::SecondPiola => {
                let unscaled = [splat(1.0); 3];
                Measured { strain: [0.5 * c11, 0.5 * c22, c12], scale: unscaled, inverse: unscaled }
            }
            Measure::Fibres => {
                let (first, second) = (c11.sqrt(), c22.sqrt());
                let (m1, m2) = (first.max(1.0), second.max(1.0));
                let strain = [
                    first.above(1.0).select(first, 0.5 * (c11 + 1.0)),
                    second.above(1.0).select(second, 0.5 * (c22 + 1.0)),
                    c12,
                ];
                let product = m1 * m2;
                let both = 1.0 / product;
                Measured { strain, scale: [m1, m2, product], inverse: [m2 * both, m1 * both, both] }
            }
        }
    }

    /// Strains of undeformed film.
    pub(super) fn undeformed(self) -> [f64; 3] {
        match self {
            Measure::SecondPiola => [0.5, 0.5, 0.0],
            Measure::Fibres => [1.0, 1.0, 0.0],
        }
    }
}

impl<const L: usize> Measured<L> {
    /// S of a stress of the measure.
    #[inline(always)]
    pub(super) fn unmeasured(&self, stress: &[Lane<L>; 3]) -> [Lane<L>; 3] {
        [stress[0] * self.inverse[0], stress[1] * self.inverse[1], stress[2] * self.inverse[2]]
    }
}
