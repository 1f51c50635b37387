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

mod invariants;
mod ogden;
mod tension;
#[cfg(test)]
mod tests;

pub use invariants::{CompressibleNeoHookean, Gent, Polynomial};
pub use ogden::{Ogden, OgdenTerm};
pub use tension::Tension;

use serde::{Deserialize, Serialize};

use super::{Deformation, Energy, LawVisitor, Measure, MembraneLaw, PeakStrains, Stiffness, Stress, ViscousBase};
use crate::lane::{Lane, lanes, larger, splat};

/// Growth of a strain between two updates of the stable time step.
const NEAR: f64 = 0.005;

/// Radius of Mohr's circle below which the stretch has no direction: far below round-off.
const POINT: f64 = 1e-100;

/// Energy of an isotropic hyperelastic film in plane stress, of the squares `c` of the principal stretches in the plane,
/// the larger first.
pub trait StrainEnergy {
    /// W, J/m³.
    fn energy(&self, c: [f64; 2]) -> f64;

    /// S_i = 2 ∂W/∂c_i, Pa.
    fn stress(&self, c: [f64; 2]) -> [f64; 2];

    /// Derivatives that bound the stiffness at the strain and, where it grows without limit or with a power, within
    /// 0.5 % of it. What is left of the growth between two updates of the time step its safety factor covers.
    fn tangent(&self, c: [f64; 2]) -> Tangent;

    /// Second Piola–Kirchhoff stress, Pa, of C₁₁, C₂₂ and C₁₂.
    #[inline(always)]
    fn plane_stress(&self, c: [f64; 3]) -> [f64; 3] {
        let principal = Principal::from_cauchy_green(c);
        principal.turned(self.stress(principal.squares))
    }

    /// Thickness over that of the undeformed film, λ₃; that of incompressible film unless the law has another.
    fn thickness(&self, [c1, c2]: [f64; 2]) -> f64 {
        1.0 / (c1 * c2).sqrt()
    }

    /// n(c₁), the square of the width in uniaxial tension; that of incompressible film, 1/√c₁, unless the law has
    /// another.
    #[inline(always)]
    fn natural_width(&self, c1: f64) -> f64 {
        1.0 / c1.sqrt()
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

    /// Principal stretches of C₁₁, C₂₂ and C₁₂ at which the energy is evaluated, of film that wrinkles the relaxed ones.
    #[inline(always)]
    fn principal<const WRINKLING: bool>(&self, c: [f64; 3]) -> Principal {
        let principal = Principal::from_cauchy_green(c);
        if WRINKLING { principal.relaxed(self.natural_width(principal.stretched())) } else { principal }
    }

    /// W in each lane.
    #[inline(always)]
    fn energy_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Lane<L> {
        lanes(|l| self.energy(self.principal::<WRINKLING>(d.metric_at(l)).squares))
    }

    /// Stress in each lane.
    #[inline(always)]
    fn stress_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Stress<L> {
        Stress::of_second_piola(d, |l| {
            let c = d.metric_at(l);
            if !WRINKLING {
                return self.plane_stress(c);
            }
            let relaxed = self.principal::<WRINKLING>(c);
            relaxed.turned(self.stress(relaxed.squares))
        })
    }

    /// λ₃ in each lane.
    fn thickness_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Lane<L> {
        lanes(|l| self.thickness(self.principal::<WRINKLING>(d.metric_at(l)).squares))
    }

    /// Largest eigenvalue of ∂²W/∂F∂F in each lane, by [`StrainEnergy::tangent`].
    #[inline(always)]
    fn bound_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Lane<L> {
        lanes(|l| {
            let c = self.principal::<WRINKLING>(d.metric_at(l)).squares;
            self.tangent(c).largest(c)
        })
    }
}

/// Derivatives of the energy by the principal stretches λ₁ and λ₂, Pa.
#[derive(Clone, Copy, Debug)]
pub struct Tangent {
    /// S₁ and S₂, the stiffness against motion out of the plane.
    pub stress: [f64; 2],
    /// ∂²W/∂λ₁² and ∂²W/∂λ₂².
    pub along: [f64; 2],
    /// ∂²W/∂λ₁∂λ₂.
    pub between: f64,
    /// (S₁ − S₂)/(c₁ − c₂), or a bound on it.
    pub shear: f64,
}

impl From<[f64; 6]> for Tangent {
    #[inline(always)]
    fn from([s1, s2, first, second, between, shear]: [f64; 6]) -> Tangent {
        Tangent { stress: [s1, s2], along: [first, second], between, shear }
    }
}

impl Tangent {
    /// Largest eigenvalue of ∂²W/∂F∂F (theory.md, equation 226).
    #[inline(always)]
    fn largest(&self, [c1, c2]: [f64; 2]) -> f64 {
        let Tangent { stress, along: [first, second], between, shear } = *self;
        let (mean, apart) = (0.5 * (first + second), 0.5 * (first - second));
        let stretched = mean + (apart * apart + between * between).sqrt();
        let sheared = stress[0] + ((c1 * c2).sqrt() + c2) * shear;
        // A NaN must propagate.
        let larger = |a: f64, b: f64| if a <= b { b } else { a };
        larger(larger(larger(stretched, sheared), stress[0]), stress[1])
    }
}

/// Eigenvalues of C and their directions.
#[derive(Clone, Copy, Debug)]
pub struct Principal {
    /// c₁ ≥ c₂.
    squares: [f64; 2],
    /// cos 2θ and sin 2θ of the first direction; zero where all directions are principal.
    direction: [f64; 2],
    /// Whether film at these stretches has no wrinkles.
    is_taut: bool,
}

impl From<Principal> for [f64; 5] {
    #[inline(always)]
    fn from(Principal { squares: [first, second], direction: [cosine, sine], is_taut }: Principal) -> [f64; 5] {
        [first, second, cosine, sine, if is_taut { 1.0 } else { 0.0 }]
    }
}

impl From<[f64; 5]> for Principal {
    #[inline(always)]
    fn from([first, second, cosine, sine, taut]: [f64; 5]) -> Principal {
        Principal { squares: [first, second], direction: [cosine, sine], is_taut: taut > 0.0 }
    }
}

impl Principal {
    /// Principal stretches of C₁₁, C₂₂ and C₁₂.
    #[inline(always)]
    fn from_cauchy_green([c11, c22, c12]: [f64; 3]) -> Principal {
        let (mean, apart) = (0.5 * (c11 + c22), 0.5 * (c11 - c22));
        let radius = (apart * apart + c12 * c12).sqrt();
        let first = mean + radius;
        let inverse = 1.0 / larger(radius, POINT);
        // The difference would lose what is small against c₁.
        let squares = [first, (c11 * c22 - c12 * c12) / first];
        Principal { squares, direction: [apart * inverse, c12 * inverse], is_taut: true }
    }

    /// c₁* of wrinkling film.
    #[inline(always)]
    fn stretched(&self) -> f64 {
        // A NaN must propagate.
        if self.squares[0] < 1.0 { 1.0 } else { self.squares[0] }
    }

    /// The stretches of taut film with the same energy as film that wrinkles at these, c₁* and c₂*, where c₁* has the
    /// `natural` width.
    #[inline(always)]
    fn relaxed(&self, natural: f64) -> Principal {
        let second = larger(self.squares[1], natural);
        // Not by the comparison that `larger` makes: the compiler would compute the law for both of its outcomes.
        Principal { squares: [self.stretched(), second], is_taut: second > natural, ..*self }
    }

    /// D.
    #[inline(always)]
    fn det(&self) -> f64 {
        self.squares[0] * self.squares[1]
    }

    /// Components 11, 22 and 12 of a stress with the principal values `s` in these directions; film with wrinkles has
    /// none across them.
    #[inline(always)]
    fn turned(&self, [first, second]: [f64; 2]) -> [f64; 3] {
        let [cosine, sine] = self.direction;
        let second = if self.is_taut { second } else { 0.0 };
        let (mean, apart) = (0.5 * (first + second), 0.5 * (first - second));
        [mean + apart * cosine, mean - apart * cosine, apart * sine]
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

/// Calls `$function` of the energy of film that wrinkles or does not. Loops over lanes have no branch on it.
macro_rules! by_wrinkling {
    ($law:ident, $function:ident, $d:ident) => {
        if $law.wrinkling { $law.energy.$function::<true, L>($d) } else { $law.energy.$function::<false, L>($d) }
    };
}

impl<E: StrainEnergy> MembraneLaw for Hyperelastic<E> {
    type History<const L: usize> = PeakStrains<L>;
    const MEASURE: Option<Measure> = Some(Measure::SecondPiola);

    #[inline(always)]
    fn stress<const L: usize>(&self, d: &Deformation<L>, _history: &mut PeakStrains<L>, _dt: f64) -> Stress<L> {
        by_wrinkling!(self, stress_lanes, d)
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Energy<L> {
        Energy { stored: by_wrinkling!(self, energy_lanes, d), absorbed: splat(0.0) }
    }

    /// Bound at the relaxed stretches: relaxation reduces the stiffness, since the tension of wrinkled film rotates
    /// with ∂W/∂λ₁/(λ₁ − λ₂), which is less than at its natural width.
    #[inline(always)]
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, _history: &PeakStrains<L>) -> Stiffness<L> {
        Stiffness::in_any_direction(by_wrinkling!(self, bound_lanes, d))
    }

    fn thickness_ratio<const L: usize>(&self, d: &Deformation<L>, _stress: &Stress<L>) -> Lane<L> {
        by_wrinkling!(self, thickness_lanes, d)
    }

    fn viscous(&self) -> Option<ViscousBase> {
        let poisson = self.energy.poisson();
        let young = self.energy.plane_modulus() * (1.0 - poisson * poisson);
        Some(ViscousBase::isotropic(young, poisson, self.wrinkling))
    }

    fn moduli(&self) -> [f64; 2] {
        [self.energy.plane_modulus(); 2]
    }

    #[inline(always)]
    fn break_strains<const L: usize>(&self, _history: &PeakStrains<L>) -> [Lane<L>; 2] {
        [splat(f64::INFINITY); 2]
    }

    fn has_limit(&self) -> bool {
        self.energy.has_limit()
    }
}
