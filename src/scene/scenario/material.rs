//! `[specimen.material]`: the laws of one layer of film, its relaxation and its rupture.

use std::path::PathBuf;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::curve_file::Point;
use super::schema;
use base::units::{
    Density, EnergyPerArea, HeatCapacity, Length, MolarEnergy, Pressure, Rate, SharePerTemperature, Temperature,
    TemperatureDifference, Time,
};

/// Material of one layer of film.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend(
    "oneOf" = [{ "required": ["fabric"] }, { "required": ["elastic"] }, { "required": ["hyperelastic"] }, { "required": ["plastic"] }]
))]
pub struct Material {
    /// One line that describes it.
    pub title: Option<String>,
    /// A word for reports, e.g. "LLDPE".
    pub name: Option<String>,
    /// A material file whose keys this one extends and replaces; relative to this file.
    #[schemars(extend("x-path" = true))]
    pub extends: Option<PathBuf>,
    /// Key paths of the file named by `extends` that are left out, e.g. `["fabric.scale"]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unset: Vec<String>,
    /// Mass per volume of the stress-free film.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e5, "x-likely" = [20.0, 25e3]))]
    #[schemars(title = "Density of the film")]
    pub density: Density,
    /// Thickness of one layer.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 0.1, "x-likely" = [1e-6, 2e-3]))]
    pub thickness: Length,
    /// Two fibre sets at 90° and a shear curve; a slack fibre carries no stress.
    pub fabric: Option<Fabric>,
    /// St. Venant–Kirchhoff, plane stress.
    pub elastic: Option<Elastic>,
    /// Rubber-like film of any stretch, plane stress with the thickness that follows.
    pub hyperelastic: Option<Hyperelastic>,
    /// Film that yields and keeps a set, plane stress with the thickness that follows.
    pub plastic: Option<Plastic>,
    /// Terms of a Prony series on the law, by which its stress relaxes; not on a fabric with `rates`, nor on plastic film.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(min = 1, max = 64))]
    pub prony: Vec<PronyTerm>,
    /// Which film the law as written describes, where it has `prony`.
    pub prony_of: Option<PronyOf>,
    /// Temperature of the film, to which `shift` moves the times of `prony`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [150.0, 600.0]))]
    pub temperature: Option<Temperature>,
    /// How the times of `prony` change with temperature.
    pub shift: Option<Shift>,
    /// Heat that the film keeps of the energy that it absorbs, in tests too short for it to leave; left out, film keeps its
    /// temperature.
    pub thermal: Option<Thermal>,
    /// When the film tears, and the energy that a tear takes; left out, fibres of a fabric break at the last strain of their
    /// curves, and other film does not break.
    pub rupture: Option<Rupture>,
}

impl Material {
    /// Whether it is a fabric with curves by strain rate.
    pub fn is_fabric_by_rate(&self) -> bool {
        self.fabric.as_ref().is_some_and(|fabric| fabric.md.rates.is_some() || fabric.td.rates.is_some())
    }

    /// Whether it absorbs energy.
    pub fn absorbs(&self) -> bool {
        let absorption = self.fabric.as_ref().map_or(0.0, |fabric| fabric.absorption);
        self.plastic.is_some() || !self.prony.is_empty() || absorption > 0.0
    }
}

/// Two fibre sets at 90° and a shear curve, per layer.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Fabric {
    /// Stress over engineering strain along the machine direction.
    pub md: Fibre,
    /// Stress over engineering strain along the transverse direction.
    pub td: Fibre,
    /// Shear stress over shear angle.
    pub shear: Shear,
    /// Multipliers that make a dynamic curve of a quasi-static one (paper, equations 12 and 13), of both fibre sets.
    #[serde(default)]
    pub scale: Scale,
    /// Whether the multipliers also move the break strain, with the second yield point, as they move the rest of the
    /// curve behind it; otherwise fibres break at the strain as written, up to which the last slope continues.
    #[serde(default)]
    pub scale_break: bool,
    /// Which curve gives the stress of film as it is mounted with a pre-strain: the one with the multipliers, or the
    /// one without, to which film relaxes on the frame.
    #[serde(default)]
    pub mounting: MountingCurve,
    /// Standard deviation of the break strains of single layers over their mean, that of the curve: layers of an
    /// element break one after another, each at its quantile of a normal distribution. All at once where it is zero.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 0.2))]
    pub break_scatter: f64,
    /// Share of the stored energy that is lost on unloading.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 1, "x-likely" = [0.0, 1.0]))]
    #[schemars(title = "Energy absorption of the film")]
    pub absorption: f64,
    /// Stress that both directions carry besides their own curves where their strains are equal, over the mean of both
    /// curves with their multipliers: biaxial coupling of MD and TD. Isotropic film with Poisson's ratio ν has ν/(1 − ν),
    /// 0.79 for 0.44; film of two independent fibre sets has none. It pulls at slack fibres too, until film has contracted
    /// across by as much as it is stretched. Not together with `mounting = "quasi-static"`.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 5, "x-likely" = [0.0, 1.0]))]
    pub biaxial: f64,
    /// Where `biaxial` comes from, in a sentence: a bulge, a wide coupon, a fit. A coupling below 0.5, that of isotropic film
    /// with ν = 1/3, is reported (`uncoupled-biaxial`) where film is stretched in both directions, unless this tells its source.
    pub biaxial_source: Option<String>,
    /// Lowest and highest strain rate at which the curves were measured; where a fibre set has `rates`, from the lowest
    /// to the highest of these, of both sets where both have them, where it is left out.
    #[schemars(transform = schema::positive_items)]
    pub measured_rates: Option<[Rate; 2]>,
    /// Growth of the largest strain over which the strain rate of fibres with `rates` is averaged; 0.01 where it is
    /// left out. It is assumed, as is that film was mounted (pre-strain) at the lowest of the rates, whose influence
    /// decays over several times this growth: results depend on both.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate_memory: Option<f64>,
}

/// The curve at which film is mounted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MountingCurve {
    /// With the multipliers.
    #[default]
    Dynamic,
    /// Without the multipliers.
    QuasiStatic,
}

/// The curve of one fibre set: two yield points and a break point, any curve, or curves by strain rate.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend(
    "oneOf" = [{ "required": ["yield", "break"] }, { "required": ["curve"] }, { "required": ["rates"] }]
))]
pub struct Fibre {
    /// The two yield points: strain and stress of each.
    #[serde(rename = "yield")]
    pub yield_points: Option<[Point; 2]>,
    /// Strain and stress at which the fibres break.
    #[serde(rename = "break")]
    pub break_point: Option<Point>,
    /// A CSV file with the columns `strain` and `stress` (Pa, or `stress_MPa`), or the points themselves;
    /// the last one is the break.
    #[serde(default)]
    #[schemars(schema_with = "schema::path_or_list::<Point>")]
    pub curve: Option<Vec<Point>>,
    /// Strains of the two yield points of `curve`, required with `scale`.
    #[schemars(transform = schema::positive_items)]
    pub yield_strains: Option<[f64; 2]>,
    /// Multipliers of these fibres alone, in place of all three of the fabric; one that is left out is 1.
    pub scale: Option<Scale>,
    /// Break strain over that of the curve with its multipliers, of all curves by rate alike: up to it a curve goes on along
    /// its last line, or it is cut there.
    #[serde(default = "unchanged")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.1, 10.0]))]
    pub break_factor: f64,
    /// Curves by strain rate, at least two, the slowest first: interpolated in the logarithm of the rate, constant
    /// below the lowest and above the highest.
    #[schemars(length(min = 2))]
    pub rates: Option<Vec<RateCurve>>,
}

/// The curve of one fibre set at one strain rate.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [{ "required": ["yield", "break"] }, { "required": ["curve"] }]))]
pub struct RateCurve {
    /// Strain rate at which the curve was measured.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate: Rate,
    /// The two yield points: strain and stress of each.
    #[serde(rename = "yield")]
    pub yield_points: Option<[Point; 2]>,
    /// Strain and stress at which the fibres break.
    #[serde(rename = "break")]
    pub break_point: Option<Point>,
    /// A CSV file with the columns `strain` and `stress` (Pa, or `stress_MPa`), or the points themselves;
    /// the last one is the break.
    #[serde(default)]
    #[schemars(schema_with = "schema::path_or_list::<Point>")]
    pub curve: Option<Vec<Point>>,
    /// Strains of the two yield points of `curve`, required with `scale`.
    #[schemars(transform = schema::positive_items)]
    pub yield_strains: Option<[f64; 2]>,
    /// Multipliers of this curve alone, in place of those of the fibre set or of the fabric.
    pub scale: Option<Scale>,
}

/// The shear curve.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Shear {
    /// A CSV file with the columns `strain` (shear angle, rad) and `stress` (Pa, or `stress_MPa`), or the
    /// points themselves.
    #[schemars(schema_with = "schema::path_or_list::<Point>")]
    pub curve: Vec<Point>,
}

/// The multipliers of a dynamic curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scale {
    /// Stiffness of the first part, up to the first yield point: strains there are divided by it, besides `ke`.
    #[serde(default = "unchanged")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[schemars(title = "Stiffness k1 to the first yield point")]
    pub k1: f64,
    /// Stiffness up to the second yield point: strains there are divided by it, so that both yield points move.
    #[serde(default = "unchanged")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[schemars(title = "Stiffness ke to the second yield point")]
    pub ke: f64,
    /// Stress up to the second yield point is multiplied by it, and what follows moves along.
    #[serde(default = "unchanged")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[schemars(title = "Stress ky to the second yield point")]
    pub ky: f64,
}

impl Default for Scale {
    fn default() -> Scale {
        Scale { k1: unchanged(), ke: unchanged(), ky: unchanged() }
    }
}

fn unchanged() -> f64 {
    1.0
}

/// St. Venant–Kirchhoff, plane stress.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Elastic {
    /// Young's modulus.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e5, 1e12]))]
    pub young: Pressure,
    /// Poisson's ratio.
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5, "x-likely" = [-1.0, 0.5]))]
    pub poisson: f64,
    /// Whether the film wrinkles under compression, so that it carries tension only (tension field).
    #[serde(default)]
    pub wrinkling: bool,
    /// Lowest and highest strain rate at which the modulus was measured.
    #[schemars(transform = schema::positive_items)]
    pub measured_rates: Option<[Rate; 2]>,
}

/// Adiabatic heating: all energy that the film absorbs stays in it as heat, and stress and stiffness of the law fall with its
/// temperature. The law as written is that of film at the temperature of the room, as slow coupons measure it; curves measured
/// at the rates of the test have the heat in them already. Film is mounted at that temperature, and warms up from then on.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Thermal {
    /// Specific heat capacity of the film; 2.3 kJ/(kg K) for polyethylene.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [300.0, 6000.0]))]
    pub heat: HeatCapacity,
    /// Share of its stress that film loses with each kelvin, of what it has left: −d ln σ/dT. Some 0.6 to 0.9 %/K for
    /// polyethylene near room temperature.
    #[schemars(extend("minimum" = 0, "maximum" = 0.2, "x-likely" = [0.0, 0.05]))]
    pub softening: SharePerTemperature,
}

/// Film that yields and keeps a set: elastoplastic in plane stress, on logarithmic strain.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-future" = { "wrinkling": "a plastic film carries compression; film of the other laws can wrinkle" }))]
pub struct Plastic {
    /// Young's modulus.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e5, 1e12]))]
    pub young: Pressure,
    /// Poisson's ratio of elastic strain.
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5, "x-likely" = [-1.0, 0.5]))]
    pub poisson: f64,
    /// Flow stress over the equivalent plastic strain, in uniaxial tension along MD.
    pub hardening: FlowStress,
    /// Hill's orthotropic yield function of 1948, with MD and TD as its axes; left out: that of von Mises.
    pub hill: Option<HillRatios>,
    /// Lowest and highest strain rate at which the material was measured; left out: those of `hardening.rates`.
    #[schemars(transform = schema::positive_items)]
    pub measured_rates: Option<[Rate; 2]>,
}

/// Flow stress (true stress) over the equivalent plastic strain (logarithmic): a table, Voce's law or tables by rate.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend(
    "oneOf" = [{ "required": ["curve"] }, { "required": ["voce"] }, { "required": ["rates"] }]
))]
pub struct FlowStress {
    /// A CSV file with the columns `strain` (equivalent plastic strain) and `stress` (Pa, or `stress_MPa`), or the points
    /// themselves, from zero plastic strain on; constant beyond the last.
    #[serde(default)]
    #[schemars(schema_with = "schema::path_or_list::<Point>")]
    pub curve: Option<Vec<Point>>,
    /// Voce's law.
    pub voce: Option<Voce>,
    /// Curves by the rate of plastic strain, at least two, the slowest first: interpolated in the logarithm of the rate,
    /// constant below the lowest and above the highest.
    #[schemars(length(min = 2))]
    pub rates: Option<Vec<FlowCurve>>,
}

/// Voce's law: saturation − (saturation − yield) exp(−rate p).
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Voce {
    /// Flow stress without plastic strain.
    #[serde(rename = "yield")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e4, 1e10]))]
    pub initial: Pressure,
    /// Flow stress that is approached, at least `yield`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e4, 1e10]))]
    pub saturation: Pressure,
    /// How fast it is approached, per equivalent plastic strain.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.01, 1e4]))]
    pub rate: f64,
}

/// The flow stress at one rate.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FlowCurve {
    /// Rate of plastic strain.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate: Rate,
    /// A CSV file with the columns `strain` (equivalent plastic strain) and `stress` (Pa, or `stress_MPa`), or the points
    /// themselves, from zero plastic strain on; constant beyond the last.
    #[schemars(schema_with = "schema::path_or_list::<Point>")]
    pub curve: Vec<Point>,
}

/// Hill's yield function, by plastic strain ratios or by ratios of yield stress.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend(
    "oneOf" = [{ "required": ["r0", "r45", "r90"] }, { "required": ["r11", "r22", "r33", "r12"] }]
))]
pub struct HillRatios {
    /// Plastic strain ratio, width over thickness, in tension along MD.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.05, 20.0]))]
    pub r0: Option<f64>,
    /// The same at 45° between MD and TD.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.05, 20.0]))]
    pub r45: Option<f64>,
    /// The same along TD.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.05, 20.0]))]
    pub r90: Option<f64>,
    /// Yield stress along MD over that of `hardening`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.1, 10.0]))]
    pub r11: Option<f64>,
    /// Yield stress along TD over that of `hardening`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.1, 10.0]))]
    pub r22: Option<f64>,
    /// Yield stress across the film, of its normal direction, over that of `hardening`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.1, 10.0]))]
    pub r33: Option<f64>,
    /// Yield stress in shear along MD and TD over that of `hardening` divided by √3.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.1, 10.0]))]
    pub r12: Option<f64>,
}

/// An energy of rubber-like film and its coefficients. Each law has its own keys.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Hyperelastic {
    /// The energy.
    pub law: Energy,
    /// Shear modulus of `neo-hookean` and `gent`; the moduli of the terms of `ogden`.
    #[serde(default)]
    #[schemars(schema_with = "moduli_schema")]
    pub mu: Option<Moduli>,
    /// Exponents of the terms of `ogden`, as many as `mu`, none of them zero.
    #[schemars(length(min = 1, max = 6), extend("x-likely" = [-30.0, 30.0]))]
    pub alpha: Option<Vec<f64>>,
    /// Limit of I₁ − 3, at which the chains of `gent` are straight.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.1, 1e4]))]
    pub jm: Option<f64>,
    /// Coefficient of I₁ − 3 of `mooney-rivlin` and `yeoh`.
    #[schemars(extend("x-likely" = [1e2, 1e9]))]
    pub c10: Option<Pressure>,
    /// Coefficient of I₂ − 3 of `mooney-rivlin`.
    #[schemars(extend("x-likely" = [-1e9, 1e9]))]
    pub c01: Option<Pressure>,
    /// Coefficient of (I₁ − 3)² of `yeoh`.
    #[schemars(extend("x-likely" = [-1e9, 1e9]))]
    pub c20: Option<Pressure>,
    /// Coefficient of (I₁ − 3)³ of `yeoh`.
    #[schemars(extend("x-likely" = [-1e9, 1e9]))]
    pub c30: Option<Pressure>,
    /// Young's modulus at small strain of `compressible-neo-hookean`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e3, 1e12]))]
    pub young: Option<Pressure>,
    /// Poisson's ratio at small strain of `compressible-neo-hookean`.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 0.5))]
    pub poisson: Option<f64>,
    /// Whether the film wrinkles under compression, so that it carries tension only (tension field).
    #[serde(default)]
    pub wrinkling: bool,
    /// Lowest and highest strain rate at which the coefficients were measured.
    #[schemars(transform = schema::positive_items)]
    pub measured_rates: Option<[Rate; 2]>,
}

/// Energies of rubber-like film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Energy {
    /// μ/2 (I₁ − 3), incompressible: `mu`.
    NeoHookean,
    /// μ/2 (I₁ − 3) − μ ln J + λ/2 ln² J: `young`, `poisson`.
    CompressibleNeoHookean,
    /// c₁₀ (I₁ − 3) + c₀₁ (I₂ − 3), incompressible: `c10`, `c01`.
    MooneyRivlin,
    /// Σ c_i0 (I₁ − 3)^i, incompressible: `c10`, `c20`, `c30`.
    Yeoh,
    /// −μ J_m/2 ln(1 − (I₁ − 3)/J_m), incompressible: `mu`, `jm`.
    Gent,
    /// Σ μ_k/α_k (λ₁^α_k + λ₂^α_k + λ₃^α_k − 3), incompressible: `mu`, `alpha`.
    Ogden,
}

/// One modulus, or one a term. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Moduli {
    /// A shear modulus.
    One(Pressure),
    /// One a term.
    Terms(Vec<Pressure>),
}

fn moduli_schema(generator: &mut SchemaGenerator) -> Schema {
    let mut likely = |range: [f64; 2]| {
        let mut modulus = generator.subschema_for::<Pressure>();
        modulus.insert("x-likely".into(), serde_json::json!(range));
        modulus
    };
    // Moduli of terms may be small beside others, or negative.
    let (one, term) = (likely([1e3, 1e9]), likely([-1e9, 1e9]));
    json_schema!({ "anyOf": [one, { "type": "array", "items": term, "minItems": 1, "maxItems": 6 }] })
}

/// One term of a Prony series on the material's law.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct PronyTerm {
    /// Share of the instantaneous stiffness that relaxes with `time`; the shares of all terms sum to less than 1.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub share: f64,
    /// Relaxation time, at the reference temperature where there is a `shift`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time: Time,
}

/// Which film the law as written describes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PronyOf {
    /// Film strained at once: the long-term stiffness is (1 − Σ share) of it.
    #[default]
    Instantaneous,
    /// Film that has relaxed, e.g. in a slow tensile test: the instantaneous stiffness is 1/(1 − Σ share) of it.
    LongTerm,
}

/// Shift of the relaxation times from a reference temperature to that of the film.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Shift {
    /// Williams, Landel and Ferry: log₁₀ a = −c1 (T − reference)/(c2 + T − reference), above the glass transition.
    Wlf(Wlf),
    /// Arrhenius: ln a = energy/R (1/T − 1/reference).
    Arrhenius(Arrhenius),
}

/// Constants of Williams, Landel and Ferry.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Wlf {
    /// Constant c₁.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1.0, 100.0]))]
    pub c1: f64,
    /// Constant c₂.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [5.0, 500.0]))]
    pub c2: TemperatureDifference,
    /// Temperature of the relaxation times as written.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [150.0, 600.0]))]
    pub reference: Temperature,
}

/// Constants of Arrhenius.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Arrhenius {
    /// Activation energy.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e3, 1e6]))]
    pub energy: MolarEnergy,
    /// Temperature of the relaxation times as written.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [150.0, 600.0]))]
    pub reference: Temperature,
}

/// When an element of film starts to tear, and the energy that its tear takes. In a fabric it takes the place of the break
/// at the last strain of the curves, whose last slope then continues.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Rupture {
    /// What of an element is compared with the limit.
    pub criterion: RuptureCriterion,
    /// The value at which an element starts to tear: of `strain` a number, of `stress` a stress, of `energy` an energy per
    /// volume. A fabric with the criterion `strain` may leave it out: each fibre set then has the last strain of its curve.
    pub limit: Option<Level>,
    /// Fracture energy: energy that a tear takes for its length and the thickness of the stress-free film. Left out, an
    /// element fails at once.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1.0, 1e6]))]
    pub energy: Option<EnergyPerArea>,
}

/// What of an element is compared with the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RuptureCriterion {
    /// Largest principal engineering strain; of a fabric the larger strain of its fibre sets.
    Strain,
    /// Largest principal engineering stress, of force over stress-free cross-section.
    Stress,
    /// Energy stored and absorbed for the volume of stress-free film.
    Energy,
}

/// A strain, or a stress or an energy per volume with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Level {
    /// A bare number.
    Number(f64),
    /// Pa, or J/m³, which is the same.
    Quantity(Pressure),
}

impl Level {
    /// In SI.
    pub fn value(self) -> f64 {
        match self {
            Level::Number(value) | Level::Quantity(Pressure(value)) => value,
        }
    }
}

impl JsonSchema for Level {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Level".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut quantity = Pressure::json_schema(generator);
        quantity.insert("exclusiveMinimum".into(), 0.into());
        json_schema!({
            "anyOf": [quantity, { "type": "number", "exclusiveMinimum": 0 }],
            "examples": [1.2, "30 MPa", "15 MJ/m3"],
        })
    }
}
