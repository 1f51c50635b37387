//! Constitutive laws of films: stress and energy of one layer as functions of its deformation.
//!
//! A law is independent of mesh and time integration. It computes, in lanes ([`crate::lane`]), the stress at a
//! deformation gradient and the energy of which the stress is the derivative.

mod absorption;
mod curve;
mod elastic;
mod fabric;
mod fibre;
mod fibre_strains;
mod history;
mod hyperelastic;
mod layer_breaks;
mod log_interval;
mod measure;
mod multipliers;
mod plastic;
mod rate_curves;
mod rupture;
mod tension_field;
mod thermal;
#[cfg(test)]
mod tests;
mod viscous;

pub use absorption::{Absorption, Strained};
pub use curve::{Curve, CurveError, Reading};
pub use elastic::Elastic;
pub use fabric::Fabric;
pub use fibre::FibreLaw;
pub use history::{FibreHistory, History, PeakStrains, PointHistory};
pub use hyperelastic::{
    CompressibleNeoHookean, Gent, Hyperelastic, HyperelasticLaw, Ogden, OgdenTerm, Polynomial, StrainEnergy, Tangent,
    Tension,
};
pub use layer_breaks::LayerBreaks;
pub use measure::{Measure, ViscousBase, WithoutCompression};
pub use multipliers::Multipliers;
pub use plastic::{
    FlowCurve, FlowCurveError, FlowRate, Hardening, Hill, Plastic, PlasticHistory, RateTable, RateTableError, Voce,
};
pub use rate_curves::{RateCurves, RateCurvesError, RateHistory};
pub use rupture::{Criterion, Rupture};
pub(crate) use rupture::{Densities, Tear};
pub use tension_field::TensionField;
pub use thermal::Thermal;
pub(crate) use thermal::{HEAT_VARIABLES, Heat};
pub use viscous::{
    Arrhenius, GAS_CONSTANT, PronyTerm, ShiftFactor, Viscosity, ViscosityError, ViscousLaw, ViscousStep, Wlf, Written,
};

use serde::{Deserialize, Serialize};

use crate::lane::{LANES, Lane, Lane3, dot, splat};

/// Deformation gradient of a membrane: the images f₁ = F a₁ and f₂ = F a₂ of the unit vectors along MD and TD
/// of the stress-free film.
pub type Gradient<const L: usize = LANES> = [Lane3<L>; 2];

/// Deformation of a membrane element at one integration point.
#[derive(Clone, Copy, Debug)]
pub struct Deformation<const L: usize = LANES> {
    /// The gradient at the point.
    pub f: Gradient<L>,
    /// Mean square by which f₁ and f₂ vary over the part of the element that the point represents; the stretch in a law
    /// is the root mean square √(|f_I|² + s_I) (theory.md, equation 13).
    pub stretch_variance: [Lane<L>; 2],
}

impl<const L: usize> From<Gradient<L>> for Deformation<L> {
    /// A uniform gradient.
    #[inline(always)]
    fn from(f: Gradient<L>) -> Deformation<L> {
        Deformation { f, stretch_variance: [splat(0.0); 2] }
    }
}

impl From<[[f64; 3]; 2]> for Deformation<1> {
    /// A uniform gradient at one point.
    fn from(f: [[f64; 3]; 2]) -> Deformation<1> {
        Deformation::from(f.map(Lane3::splat))
    }
}

impl<const L: usize> Deformation<L> {
    /// C₁₁, C₂₂ and C₁₂ of the right Cauchy–Green tensor; the stretch variance counts as stretch (theory.md, equation 13).
    #[inline(always)]
    pub fn metric(&self) -> [Lane<L>; 3] {
        let [f1, f2] = &self.f;
        let mut c = [dot(f1, f1), dot(f2, f2), dot(f1, f2)];
        c[0] += self.stretch_variance[0];
        c[1] += self.stretch_variance[1];
        c
    }
}

/// Stress of a law at a deformation.
pub struct Stress<const L: usize> {
    /// First Piola–Kirchhoff stress ∂W/∂f₁, ∂W/∂f₂, Pa of one layer.
    pub p: Gradient<L>,
    /// 2 ∂W/∂|f_I|², Pa of one layer: tension over stretch, the geometric stiffness of a fibre.
    pub tension: [Lane<L>; 2],
    /// ∂W/∂(f₁·f₂), Pa of one layer.
    pub cross: Lane<L>,
}

impl<const L: usize> Stress<L> {
    /// Stress at `d` of a law with these derivatives of its energy by the metric, Pa: 2 ∂W/∂|f_I|² and ∂W/∂(f₁·f₂).
    #[inline(always)]
    pub fn of_metric(d: &Deformation<L>, tension: [Lane<L>; 2], cross: Lane<L>) -> Stress<L> {
        let [f1, f2] = d.f;
        Stress { p: [tension[0] * f1 + cross * f2, tension[1] * f2 + cross * f1], tension, cross }
    }
}

/// Energy density of a film, J/m³.
#[derive(Clone, Copy, Debug)]
pub struct Energy<const L: usize> {
    /// Returned on unloading.
    pub stored: Lane<L>,
    /// Dissipated.
    pub absorbed: Lane<L>,
}

/// Strains of a film in the measures of its law.
#[derive(Clone, Copy, Debug)]
pub struct Strains<const L: usize> {
    /// Engineering strain |f₁| − 1 along MD.
    pub md: Lane<L>,
    /// Engineering strain |f₂| − 1 along TD.
    pub td: Lane<L>,
    /// Angle by which MD and TD deviate from their right angle, rad.
    pub shear: Lane<L>,
}

/// Nominal stresses of a film: what does work on its [`Strains`], ∂W/∂ε_md, ∂W/∂ε_td and ∂W/∂γ, Pa of one layer on
/// its stress-free cross-section. Those of a fabric are the values of its curves, plus σ_b with biaxial coupling; of
/// wrinkled fabric they follow from the values at its relaxed metric.
#[derive(Clone, Copy, Debug)]
pub struct Stresses<const L: usize> {
    /// Along MD.
    pub md: Lane<L>,
    /// Along TD.
    pub td: Lane<L>,
    /// In shear, with the sign of the shear angle's growth.
    pub shear: Lane<L>,
}

/// Bounds on the tangent stiffness of a film, Pa, for the stable time step.
#[derive(Clone, Copy, Debug)]
pub struct Stiffness<const L: usize> {
    /// Against motion along the fibres, over that across them: MD, TD.
    pub along: [Lane<L>; 2],
    /// Against motion in any direction (tension): MD, TD.
    pub across: [Lane<L>; 2],
    /// In shear, on top of both directions.
    pub shear: Lane<L>,
    /// Cosine of the angle between the fibres: how much of both acts in one direction.
    pub alignment: Lane<L>,
    /// Against any motion, on top of the others: the largest eigenvalue of ∂²W/∂F∂F; zero for film of fibres.
    pub any: Lane<L>,
}

impl<const L: usize> Stiffness<L> {
    /// Stiffness of film whose stiffness against any motion is at most `any`, Pa.
    #[inline(always)]
    pub fn in_any_direction(any: Lane<L>) -> Stiffness<L> {
        let nothing = splat(0.0);
        Stiffness { along: [nothing; 2], across: [nothing; 2], shear: nothing, alignment: nothing, any }
    }

    /// Bound on the largest eigenvalue of the stiffness of an integration point over its volume, Pa/m², with
    /// G_IJ = Σ_a ∂N_a/∂X_I ∂N_a/∂X_J (theory.md, equation 17).
    #[inline(always)]
    pub fn eigenvalue_bound(&self, g: &[[Lane<L>; 2]; 2]) -> Lane<L> {
        let [[g11, g12], [_, g22]] = *g;
        let (first, second) = (self.along[0] * g11, self.along[1] * g22);
        let apart = 0.5 * (first - second);
        // Two rank-one stiffnesses at an angle: the larger eigenvalue of their Gram matrix instead of one of a 12 × 12
        // matrix.
        let both = first * second * self.alignment * self.alignment;
        let fibres = 0.5 * (first + second) + (apart * apart + both).sqrt();
        let tension = self.across[0] * g11 + self.across[1] * g22;
        let sheared = self.shear * (g11 + g22 + 2.0 * g12.abs());
        let (mean, half) = (0.5 * (g11 + g22), 0.5 * (g11 - g22));
        let isotropic = self.any * (mean + (half * half + g12 * g12).sqrt());
        // Eigenvalues of a sum are at most the sum of the eigenvalues.
        fibres + tension + sheared + isotropic
    }
}

/// A constitutive law of a membrane.
pub trait MembraneLaw {
    /// Its history variables at an integration point.
    type History<const L: usize>: History<L>;
    /// The stress that relaxes in a Prony series on it, that of [`MembraneLaw::viscous`]; none where it cannot have
    /// one. A constant, so that kernels have no code for the others.
    const MEASURE: Option<Measure> = None;
    /// Stress at deformation `d`, reached `dt` (s) after the previous one; updates the history variables. `dt` is zero
    /// while film is mounted.
    fn stress<const L: usize>(&self, d: &Deformation<L>, history: &mut Self::History<L>, dt: f64) -> Stress<L>;
    /// Stress at deformation `d` that the history includes: no time passes and no variable changes.
    fn stress_of<const L: usize>(&self, d: &Deformation<L>, history: &Self::History<L>) -> Stress<L> {
        self.stress(d, &mut history.clone(), 0.0)
    }
    /// Energy at deformation `d`.
    fn energy<const L: usize>(&self, d: &Deformation<L>, history: &Self::History<L>) -> Energy<L>;
    /// Bound on the tangent stiffness at and near deformation `d`, on loading and unloading.
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, history: &Self::History<L>) -> Stiffness<L>;
    /// Thickness over that of stress-free film at deformation `d`, where the law has `stress`; NaN where the law does
    /// not define it.
    fn thickness_ratio<const L: usize>(&self, d: &Deformation<L>, stress: &Stress<L>) -> Lane<L>;
    /// Slopes of the law at rest along MD and TD, of a fabric those of its own curves, Pa.
    fn moduli(&self) -> [f64; 2];
    /// Largest slope of the law at small strains, Pa, also of film that is soft at rest.
    fn early_modulus(&self) -> f64 {
        let [md, td] = self.moduli();
        md.max(td)
    }
    /// Strains at which the MD and TD fibres of the first layer break.
    #[inline(always)]
    fn break_strains<const L: usize>(&self, _history: &Self::History<L>) -> [Lane<L>; 2] {
        [splat(f64::INFINITY); 2]
    }
    /// Share of the layers in which fibres strained to `ratio` times the strain at which the first layer breaks are not
    /// broken.
    fn share_left(&self, ratio: f64) -> f64 {
        if ratio > 1.0 { 0.0 } else { 1.0 }
    }
    /// Strains at which the MD and TD fibres break when they are strained slowly, and those at which they are broken at
    /// any rate.
    fn break_range(&self) -> [[f64; 2]; 2] {
        [[f64::INFINITY; 2]; 2]
    }
    /// Measure that a Prony series on it needs; none where it cannot have one.
    fn viscous(&self) -> Option<ViscousBase> {
        None
    }
    /// Equivalent plastic strain, where the law has one.
    fn plastic_strain<'a, const L: usize>(&self, _history: &'a Self::History<L>) -> Option<&'a Lane<L>> {
        None
    }
    /// Whether it defines [`MembraneLaw::thickness_ratio`].
    fn has_thickness(&self) -> bool {
        true
    }
    /// Whether it admits stretches up to a limit only, where stress and stiffness become infinite; beyond it both are
    /// NaN.
    fn has_limit(&self) -> bool {
        false
    }
}

/// Properties of a law, whatever its deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawProperties {
    /// As of [`MembraneLaw::break_range`].
    pub break_range: [[f64; 2]; 2],
    /// Measure that a Prony series on it needs; none where it cannot have one.
    pub viscous: Option<ViscousBase>,
    /// Whether it admits stretches up to a limit only.
    pub has_limit: bool,
    /// Whether it defines the thickness.
    pub has_thickness: bool,
    /// Whether it has a plastic strain.
    pub is_plastic: bool,
}

/// The law of a film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Law {
    /// Two fibre sets and shear.
    Fabric(Fabric),
    /// Fabric with curves by strain rate.
    RateFabric(Fabric<RateCurves>),
    /// St. Venant–Kirchhoff plane stress.
    Elastic(Elastic),
    /// Elastic film without compression.
    TensionField(TensionField),
    /// An energy of rubber-like film.
    Hyperelastic(HyperelasticLaw),
    /// Elastoplastic, on logarithmic strain.
    Plastic(Plastic),
}

impl Law {
    /// Strains at which the MD and TD fibres break when they are strained slowly.
    pub fn break_strains(&self) -> [f64; 2] {
        self.properties().break_range[0]
    }

    /// Strains at which the MD and TD fibres are broken however fast they were strained.
    pub fn largest_break_strains(&self) -> [f64; 2] {
        self.properties().break_range[1]
    }

    /// This law of layers that break one after another; a law without fibres is as it was.
    pub fn with_layer_breaks(self, breaks: LayerBreaks) -> Law {
        match self {
            Law::Fabric(fabric) => Law::Fabric(fabric.with_layer_breaks(breaks)),
            Law::RateFabric(fabric) => Law::RateFabric(fabric.with_layer_breaks(breaks)),
            Law::Elastic(_) | Law::TensionField(_) | Law::Hyperelastic(_) | Law::Plastic(_) => self,
        }
    }

    /// Lowest and highest strain rate (1/s) of all curves by strain rate; those of a fibre set with one curve have
    /// none.
    pub fn rates(&self) -> Option<[f64; 2]> {
        let fabric = match self {
            Law::RateFabric(fabric) => fabric,
            Law::Plastic(law) => return law.rates(),
            Law::Fabric(_) | Law::Elastic(_) | Law::TensionField(_) | Law::Hyperelastic(_) => return None,
        };
        let ranges = [fabric.md().range(), fabric.td().range()];
        ranges.into_iter().flatten().reduce(|[low, high], [from, to]| [low.min(from), high.max(to)])
    }

    /// Its properties.
    pub fn properties(&self) -> LawProperties {
        struct Properties;
        impl LawVisitor for Properties {
            type Output = LawProperties;

            fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> LawProperties {
                LawProperties {
                    break_range: law.break_range(),
                    viscous: law.viscous(),
                    has_limit: law.has_limit(),
                    has_thickness: law.has_thickness(),
                    is_plastic: law.plastic_strain(&M::History::<1>::virgin()).is_some(),
                }
            }
        }
        self.visit(Properties)
    }

    /// Measure that a Prony series on the law needs; none where it cannot have one.
    pub fn viscous(&self) -> Option<ViscousBase> {
        self.properties().viscous
    }

    /// First Piola–Kirchhoff stress ∂W/∂f₁, ∂W/∂f₂ of virgin film at the gradient f₁, f₂, reached slowly, Pa of one layer.
    pub fn virgin_stress(&self, f: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
        struct VirginStress(Deformation<1>);
        impl LawVisitor for VirginStress {
            type Output = [[f64; 3]; 2];

            fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> [[f64; 3]; 2] {
                let stress = law.stress(&self.0, &mut History::virgin(), 0.0);
                stress.p.map(|p| p.map(|component| component[0]))
            }
        }
        self.visit(VirginStress(f.into()))
    }

    /// Energy stored and absorbed in virgin film at the gradient `f`, reached slowly, J/m³.
    pub fn virgin_energy(&self, f: [[f64; 3]; 2]) -> f64 {
        struct VirginEnergy(Deformation<1>);
        impl LawVisitor for VirginEnergy {
            type Output = f64;

            fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> f64 {
                let mut history = M::History::virgin();
                law.stress(&self.0, &mut history, 0.0);
                let Energy { stored, absorbed, .. } = law.energy(&self.0, &history);
                stored[0] + absorbed[0]
            }
        }
        self.visit(VirginEnergy(f.into()))
    }

    /// Calls `visitor` with the law itself: the only dispatch over laws.
    pub fn visit<V: LawVisitor>(&self, visitor: V) -> V::Output {
        match self {
            Law::Fabric(law) => visitor.visit(law),
            Law::RateFabric(law) => visitor.visit(law),
            Law::Elastic(law) => visitor.visit(law),
            Law::TensionField(law) => visitor.visit(law),
            Law::Hyperelastic(law) => law.visit(visitor),
            Law::Plastic(law) => visitor.visit(law),
        }
    }
}

/// An operation on a law of any type, called by [`Law::visit`].
pub trait LawVisitor {
    /// Its result.
    type Output;

    /// Called with the law.
    fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> Self::Output;
}

/// Material and thickness of one layer of film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// kg/m³.
    pub density: f64,
    /// Thickness of one layer, m.
    pub thickness: f64,
    /// Its constitutive law.
    pub law: Law,
    /// Prony series on the law, where film is viscous.
    pub viscosity: Option<Viscosity>,
    /// Rupture by a criterion of its own.
    pub rupture: Option<Rupture>,
    /// How the film warms up by what it absorbs, where it does.
    pub thermal: Option<Thermal>,
    /// Lowest and highest strain rate (1/s) at which the curves were measured, as written, else the lowest and highest
    /// rate of the curves.
    pub measured_rates: Option<[f64; 2]>,
}

impl Material {
    /// Film of a law that does nothing besides it: neither viscous nor warming up, without a rupture criterion of its own.
    pub fn new(law: Law, density: f64, thickness: f64) -> Material {
        let measured_rates = law.rates();
        Material { density, thickness, law, viscosity: None, rupture: None, thermal: None, measured_rates }
    }

    /// Strains along MD and TD at which film that is strained slowly breaks or starts to tear; infinite where these do
    /// not follow from strains.
    pub fn break_strains(&self) -> [f64; 2] {
        self.limits().unwrap_or_else(|| self.law.break_strains())
    }

    /// Largest of these strains, however fast film is strained.
    pub fn largest_break_strains(&self) -> [f64; 2] {
        self.limits().unwrap_or_else(|| self.law.largest_break_strains())
    }

    /// The strains of a rupture criterion of its own that does not take them from the law.
    fn limits(&self) -> Option<[f64; 2]> {
        let Rupture { criterion, limit, .. } = self.rupture.as_ref()?;
        match criterion {
            Criterion::Break => None,
            Criterion::Strain | Criterion::FibreStrain => Some([*limit; 2]),
            Criterion::Stress | Criterion::Energy => Some([f64::INFINITY; 2]),
        }
    }
}

/// Strains of a deformation, the same measures for every law.
#[inline(always)]
pub fn strains<const L: usize>(d: &Deformation<L>) -> Strains<L> {
    let fibres = fibre_strains::Fibres::from_deformation(d);
    Strains { md: fibres.strain(0), td: fibres.strain(1), shear: fibres.angle }
}

/// Nominal stresses at a deformation where a law has `stress`.
pub fn stresses<const L: usize>(d: &Deformation<L>, stress: &Stress<L>) -> Stresses<L> {
    fibre_strains::Fibres::from_deformation(d).stresses(stress)
}
