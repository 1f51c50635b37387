//! Hyperelastic films: isotropic energies of rubber-like materials, in plane stress with the thickness that follows.
//!
//! An energy is a function of the squared principal stretches `c₁ ≥ c₂` in the plane, the eigenvalues of
//! `C = FᵀF`; the stretch across the film, `λ₃`, is that at which it has no stress (theory.md, equations 220 to 226):
//!
//! ```text
//! S_i = 2 ∂W/∂c_i ,   S = S₁ N₁N₁ᵀ + S₂ N₂N₂ᵀ ,   ∂W/∂f₁ = S₁₁ f₁ + S₁₂ f₂
//! ```
//!
//! Film that wrinkles has the relaxed energy `W(c₁*, c₂*)` with `c₁* = max(c₁, 1)` and `c₂* = max(c₂, n(c₁*))`, where
//! `n` is the squared width of film in uniaxial tension (Pipkin 1986).

mod compressible;
mod gent;
mod invariants;
mod ogden;
mod polynomial;
mod principal;
mod stability;
mod tension;
#[cfg(test)]
mod tests;

pub use compressible::CompressibleNeoHookean;
pub use gent::Gent;
pub use ogden::{Ogden, OgdenTerm};
pub use polynomial::Polynomial;
pub use tension::Tension;

use serde::{Deserialize, Serialize};

use super::elastic::{Elastic, Plane};
use super::{Deformation, Energy, LawVisitor, Measure, MembraneLaw, PeakStrains, Stiffness, Stress, ViscousBase};
use crate::lane::{Lane, splat};
use principal::Principal;

/// Squares of the principal stretches in the plane, the larger first.
type Squares<const L: usize> = [Lane<L>; 2];

/// Growth of a strain between two updates of the stable time step.
const NEAR: f64 = 0.005;

/// Energy of an isotropic hyperelastic film in plane stress.
pub trait StrainEnergy {
    /// W, J/m³.
    fn energy<const L: usize>(&self, c: &Squares<L>) -> Lane<L>;

    /// S_i = 2 ∂W/∂c_i, Pa.
    fn stress<const L: usize>(&self, c: &Squares<L>) -> [Lane<L>; 2];

    /// Second Piola–Kirchhoff stress, Pa, where `c` has C₁₁, C₂₂ and C₁₂.
    #[inline(always)]
    fn plane_stress<const L: usize>(&self, c: &Plane<L>) -> Plane<L> {
        let principal = Principal::from_cauchy_green(c);
        principal.turned(self.stress(&principal.squares))
    }

    /// Derivatives that bound the stiffness at the strain and, where it grows without limit or with a power, within
    /// 0.5 % of it. What is left of the growth between two updates of the time step its safety factor covers.
    fn tangent<const L: usize>(&self, c: &Squares<L>) -> Tangent<L>;

    /// Thickness over that of the undeformed film, λ₃; that of incompressible film unless the law has another.
    #[inline(always)]
    fn thickness<const L: usize>(&self, c: &Squares<L>) -> Lane<L> {
        1.0 / (c[0] * c[1]).sqrt()
    }

    /// n(c₁), the square of the width in uniaxial tension; that of incompressible film, 1/√c₁, unless the law has
    /// another.
    #[inline(always)]
    fn natural_width<const L: usize>(&self, first: Lane<L>) -> Lane<L> {
        1.0 / first.sqrt()
    }

    /// Modulus of undeformed film in plane strain, Pa.
    fn plane_modulus(&self) -> f64;

    /// Poisson's ratio of undeformed film; that of incompressible film unless the law has another.
    fn poisson(&self) -> f64 {
        0.5
    }

    /// Whether there are stretches at which the energy becomes infinite, besides those to nothing.
    fn has_limit(&self) -> bool {
        false
    }
}

/// Derivatives of the energy by the principal stretches λ₁ and λ₂, Pa.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<const L: usize> {
    /// S₁ and S₂, the stiffness against motion out of the plane.
    pub stress: [Lane<L>; 2],
    /// ∂²W/∂λ₁² and ∂²W/∂λ₂².
    pub along: [Lane<L>; 2],
    /// ∂²W/∂λ₁∂λ₂.
    pub between: Lane<L>,
    /// (S₁ − S₂)/(c₁ − c₂), or a bound on it.
    pub shear: Lane<L>,
}

impl<const L: usize> Tangent<L> {
    /// Largest eigenvalue of ∂²W/∂F∂F (theory.md, equation 226).
    #[inline(always)]
    fn largest(&self, c: &Squares<L>) -> Lane<L> {
        let [first, second] = self.along;
        let (mean, apart) = (0.5 * (first + second), 0.5 * (first - second));
        let stretched = mean + (apart * apart + self.between * self.between).sqrt();
        let sheared = self.stress[0] + ((c[0] * c[1]).sqrt() + c[1]) * self.shear;
        // A NaN must propagate.
        let most = stretched.at_most(sheared).select(sheared, stretched);
        let most = most.at_most(self.stress[0]).select(self.stress[0], most);
        most.at_most(self.stress[1]).select(self.stress[1], most)
    }
}

/// A hyperelastic film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hyperelastic<E> {
    /// Its energy.
    pub energy: E,
    /// Whether it wrinkles under compression, so that it carries tension only.
    pub wrinkling: bool,
}

/// Film of one of the energies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum HyperelasticLaw {
    /// Neo-Hookean, Mooney–Rivlin and Yeoh, incompressible.
    Polynomial(Hyperelastic<Polynomial>),
    /// Gent, incompressible.
    Gent(Hyperelastic<Gent>),
    /// Ogden, incompressible.
    Ogden(Hyperelastic<Ogden>),
    /// Neo-Hookean with a volume that changes.
    CompressibleNeoHookean(Hyperelastic<CompressibleNeoHookean>),
}

impl HyperelasticLaw {
    /// Calls `visitor` with the law itself.
    pub(super) fn visit<V: LawVisitor>(&self, visitor: V) -> V::Output {
        match self {
            HyperelasticLaw::Polynomial(law) => visitor.visit(law),
            HyperelasticLaw::Gent(law) => visitor.visit(law),
            HyperelasticLaw::Ogden(law) => visitor.visit(law),
            HyperelasticLaw::CompressibleNeoHookean(law) => visitor.visit(law),
        }
    }
}

/// Evaluates `$value` with the energy of a [`HyperelasticLaw`].
macro_rules! with_energy {
    ($law:expr, $energy:ident => $value:expr) => {
        match $law {
            HyperelasticLaw::Polynomial(Hyperelastic { energy: $energy, .. }) => $value,
            HyperelasticLaw::Gent(Hyperelastic { energy: $energy, .. }) => $value,
            HyperelasticLaw::Ogden(Hyperelastic { energy: $energy, .. }) => $value,
            HyperelasticLaw::CompressibleNeoHookean(Hyperelastic { energy: $energy, .. }) => $value,
        }
    };
}
use with_energy;

impl<E: StrainEnergy> Hyperelastic<E> {
    /// Squared principal stretches at which the energy is evaluated.
    #[inline(always)]
    fn squares<const L: usize>(&self, d: &Deformation<L>) -> Squares<L> {
        let principal = Principal::from_cauchy_green(&d.metric());
        if self.wrinkling { principal.relaxed(&self.energy).0.squares } else { principal.squares }
    }
}

impl<E: StrainEnergy> MembraneLaw for Hyperelastic<E> {
    type History<const L: usize> = PeakStrains<L>;
    const MEASURE: Option<Measure> = Some(Measure::SecondPiola);

    #[inline(always)]
    fn stress<const L: usize>(&self, d: &Deformation<L>, _history: &mut PeakStrains<L>, _dt: f64) -> Stress<L> {
        let c = d.metric();
        let s = if self.wrinkling {
            let (relaxed, is_taut) = Principal::from_cauchy_green(&c).relaxed(&self.energy);
            let mut stress = self.energy.stress(&relaxed.squares);
            stress[1] = is_taut.select(stress[1], 0.0);
            relaxed.turned(stress)
        } else {
            self.energy.plane_stress(&c)
        };
        Elastic::first_piola(d, s)
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Energy<L> {
        Energy { stored: self.energy.energy(&self.squares(d)), absorbed: splat(0.0) }
    }

    /// Bound at the relaxed stretches: relaxation reduces the stiffness, since the tension of wrinkled film rotates
    /// with ∂W/∂λ₁/(λ₁ − λ₂), which is less than at its natural width.
    #[inline(always)]
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Stiffness<L> {
        let squares = self.squares(d);
        Stiffness::in_any_direction(self.energy.tangent(&squares).largest(&squares))
    }

    fn thickness_ratio<const L: usize>(&self, d: &Deformation<L>, _stress: &Stress<L>) -> Lane<L> {
        self.energy.thickness(&self.squares(d))
    }

    fn viscous(&self) -> Option<ViscousBase> {
        let poisson = self.energy.poisson();
        let young = self.energy.plane_modulus() * (1.0 - poisson * poisson);
        Some(ViscousBase::isotropic(young, poisson, self.wrinkling))
    }

    fn moduli(&self) -> [f64; 2] {
        [self.energy.plane_modulus(); 2]
    }

    fn has_limit(&self) -> bool {
        self.energy.has_limit()
    }
}
