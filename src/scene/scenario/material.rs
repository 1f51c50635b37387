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
use lab::experiment::coupon::LIKELY_THICKNESS;

keys! {
    /// Material of one layer of film.
    #[schemars(extend("oneOf" = [
        { "required": ["fabric"] }, { "required": ["elastic"] }, { "required": ["hyperelastic"] }, { "required": ["plastic"] },
    ]))]
    pub struct Material {
        /// One line that describes it.
        title: Option<String>;
        /// A word for reports, e.g. "LLDPE".
        name: Option<String>;
        /// A material file whose keys this one extends and replaces; relative to this file.
        extends: Option<PathBuf>, path;
        /// Key paths of the file named by `extends` that are left out, e.g. `["fabric.scale"]`.
        unset: Vec<String>, or empty;
        /// Mass per volume of the stress-free film.
        density: Density, above 0, to 1e5, likely [20.0, 25e3], title "Density of the film";
        /// Thickness of one layer.
        thickness: Length, above 0, to 0.1, likely LIKELY_THICKNESS;
        /// Two fibre sets at 90° and a shear curve; a slack fibre carries no stress.
        fabric: Option<Fabric>;
        /// St. Venant–Kirchhoff, plane stress.
        elastic: Option<Elastic>;
        /// Rubber-like film of any stretch, plane stress with the thickness that follows.
        hyperelastic: Option<Hyperelastic>;
        /// Film that yields and keeps a set, plane stress with the thickness that follows.
        plastic: Option<Plastic>;
        /// Terms of a Prony series on the law, by which its stress relaxes; not on a fabric with `rates`, nor on plastic film.
        prony: Vec<PronyTerm>, or empty, least 1, most 64;
        /// Which film the law as written describes, where it has `prony`.
        prony_of: Option<PronyOf>;
        /// Temperature of the film, to which `shift` moves the times of `prony`.
        temperature: Option<Temperature>, above 0, likely [150.0, 600.0];
        /// How the times of `prony` change with temperature.
        shift: Option<Shift>;
        /// Heat that the film keeps of the energy that it absorbs, in tests too short for it to leave; left out, film keeps its
        /// temperature.
        thermal: Option<Thermal>;
        /// When the film tears, and the energy that a tear takes; left out, fibres of a fabric break at the last strain of their
        /// curves, and other film does not break.
        rupture: Option<Rupture>;
    }

    /// Two fibre sets at 90° and a shear curve, per layer.
    pub struct Fabric {
        /// Stress over engineering strain along the machine direction.
        md: Fibre;
        /// Stress over engineering strain along the transverse direction.
        td: Fibre;
        /// Shear stress over shear angle.
        shear: Shear;
        /// Multipliers that make a dynamic curve of a quasi-static one (paper, equations 12 and 13), of both fibre sets.
        scale: Scale, default;
        /// Whether the multipliers also move the break strain, with the second yield point, as they move the rest of the
        /// curve behind it; otherwise fibres break at the strain as written, up to which the last slope continues.
        scale_break: bool, default;
        /// Which curve gives the stress of film as it is mounted with a pre-strain: the one with the multipliers, or the
        /// one without, to which film relaxes on the frame.
        mounting: MountingCurve, default;
        /// Standard deviation of the break strains of single layers over their mean, that of the curve: layers of an
        /// element break one after another, each at its quantile of a normal distribution. All at once where it is zero.
        break_scatter: f64, default, from 0, to 0.2;
        /// Share of the stored energy that is lost on unloading.
        absorption: f64, default, from 0, below 1, likely [0.0, 1.0], title "Energy absorption of the film";
        /// Stress that both directions carry besides their own curves where their strains are equal, over the mean of both
        /// curves with their multipliers: biaxial coupling of MD and TD. Isotropic film with Poisson's ratio ν has ν/(1 − ν),
        /// 0.79 for 0.44; film of two independent fibre sets has none. It pulls at slack fibres too, until film has contracted
        /// across by as much as it is stretched. Not together with `mounting = "quasi-static"`.
        biaxial: f64, default, from 0, to 5, likely [0.0, 1.0];
        /// Where `biaxial` comes from, in a sentence: a bulge, a wide coupon, a fit. A coupling below 0.5, that of isotropic film
        /// with ν = 1/3, is reported (`uncoupled-biaxial`) where film is stretched in both directions, unless this tells its source.
        biaxial_source: Option<String>;
        /// Lowest and highest strain rate at which the curves were measured; where a fibre set has `rates`, from the lowest
        /// to the highest of these, of both sets where both have them, where it is left out.
        measured_rates: Option<[Rate; 2]>, positive;
        /// Growth of the largest strain over which the strain rate of fibres with `rates` is averaged; 0.01 where it is
        /// left out. It is assumed, as is that film was mounted (pre-strain) at the lowest of the rates, whose influence
        /// decays over several times this growth: results depend on both.
        rate_memory: Option<f64>, above 0;
    }

    /// The curve at which film is mounted.
    #[derive(Default)]
    pub enum MountingCurve of words {
        /// With the multipliers.
        #[default]
        Dynamic,
        /// Without the multipliers.
        QuasiStatic,
    }

    /// The curve of one fibre set: two yield points and a break point, any curve, or curves by strain rate.
    #[schemars(extend("oneOf" = [{ "required": ["yield", "break"] }, { "required": ["curve"] }, { "required": ["rates"] }]))]
    pub struct Fibre {
        /// The curve.
        points: FibreCurve, flat;
        /// Multipliers of these fibres alone, in place of all three of the fabric; one that is left out is 1.
        scale: Option<Scale>;
        /// Break strain over that of the curve with its multipliers, of all curves by rate alike: up to it a curve goes on along
        /// its last line, or it is cut there.
        break_factor: f64, default "schema::one::<f64>", above 0, likely [0.1, 10.0];
        /// Curves by strain rate, at least two, the slowest first: interpolated in the logarithm of the rate, constant
        /// below the lowest and above the highest.
        rates: Option<Vec<RateCurve>>, least 2;
    }

    /// A curve of a fibre set: two yield points and a break point, or any curve.
    pub struct FibreCurve {
        /// The two yield points: strain and stress of each.
        yield_points: Option<[Point; 2]>, written "yield";
        /// Strain and stress at which the fibres break.
        break_point: Option<Point>, written "break";
        /// A CSV file with the columns `strain` and `stress` (Pa, or `stress_MPa`), or the points themselves;
        /// the last one is the break.
        curve: Option<Vec<Point>>, default, schemars(schema_with = "schema::path_or_list::<Point>");
        /// Strains of the two yield points of `curve`, required with `scale`.
        yield_strains: Option<[f64; 2]>, positive;
    }

    /// The curve of one fibre set at one strain rate.
    #[schemars(extend("oneOf" = [{ "required": ["yield", "break"] }, { "required": ["curve"] }]))]
    pub struct RateCurve {
        /// Strain rate at which the curve was measured.
        rate: Rate, above 0;
        /// The curve.
        points: FibreCurve, flat;
        /// Multipliers of this curve alone, in place of those of the fibre set or of the fabric.
        scale: Option<Scale>;
    }

    /// The shear curve.
    pub struct Shear {
        /// A CSV file with the columns `strain` (shear angle, rad) and `stress` (Pa, or `stress_MPa`), or the
        /// points themselves.
        curve: Vec<Point>, schemars(schema_with = "schema::path_or_list::<Point>");
    }

    /// The multipliers of a dynamic curve.
    #[derive(Copy, PartialEq)]
    pub struct Scale with defaults {
        /// Stiffness of the first part, up to the first yield point: strains there are divided by it, besides `ke`.
        k1: f64, else 1.0, above 0, title "Stiffness k1 to the first yield point";
        /// Stiffness up to the second yield point: strains there are divided by it, so that both yield points move.
        ke: f64, else 1.0, above 0, title "Stiffness ke to the second yield point";
        /// Stress up to the second yield point is multiplied by it, and what follows moves along.
        ky: f64, else 1.0, above 0, title "Stress ky to the second yield point";
    }

    /// St. Venant–Kirchhoff, plane stress.
    #[derive(Copy)]
    pub struct Elastic {
        /// Young's modulus.
        young: Pressure, above 0, likely [1e5, 1e12];
        /// Poisson's ratio.
        poisson: f64, above -1, below 0.5, likely [-1.0, 0.5];
        /// Whether the film wrinkles under compression, so that it carries tension only (tension field).
        wrinkling: bool, default;
        /// Lowest and highest strain rate at which the modulus was measured.
        measured_rates: Option<[Rate; 2]>, positive;
    }

    /// Adiabatic heating: all energy that the film absorbs stays in it as heat, and stress and stiffness of the law fall with its
    /// temperature. The law as written is that of film at the temperature of the room, as slow coupons measure it; curves measured
    /// at the rates of the test have the heat in them already. Film is mounted at that temperature, and warms up from then on.
    #[derive(Copy)]
    pub struct Thermal {
        /// Specific heat capacity of the film; 2.3 kJ/(kg K) for polyethylene.
        heat: HeatCapacity, above 0, likely [300.0, 6000.0];
        /// Share of its stress that film loses with each kelvin, of what it has left: −d ln σ/dT. Some 0.6 to 0.9 %/K for
        /// polyethylene near room temperature.
        softening: SharePerTemperature, from 0, to 0.2, likely [0.0, 0.05];
    }

    /// Film that yields and keeps a set: elastoplastic in plane stress, on logarithmic strain.
    pub struct Plastic {
        /// Young's modulus.
        young: Pressure, above 0, likely [1e5, 1e12];
        /// Poisson's ratio of elastic strain.
        poisson: f64, above -1, below 0.5, likely [-1.0, 0.5];
        /// Flow stress over the equivalent plastic strain, in uniaxial tension along MD.
        hardening: FlowStress;
        /// Hill's orthotropic yield function of 1948, with MD and TD as its axes; left out: that of von Mises.
        hill: Option<HillRatios>;
        /// Lowest and highest strain rate at which the material was measured; left out: those of `hardening.rates`.
        measured_rates: Option<[Rate; 2]>, positive;
    }

    /// Flow stress (true stress) over the equivalent plastic strain (logarithmic): a table, Voce's law or tables by rate.
    #[schemars(extend("oneOf" = [{ "required": ["curve"] }, { "required": ["voce"] }, { "required": ["rates"] }]))]
    pub struct FlowStress {
        /// A CSV file with the columns `strain` (equivalent plastic strain) and `stress` (Pa, or `stress_MPa`), or the points
        /// themselves, from zero plastic strain on; constant beyond the last.
        curve: Option<Vec<Point>>, default, schemars(schema_with = "schema::path_or_list::<Point>");
        /// Voce's law.
        voce: Option<Voce>;
        /// Curves by the rate of plastic strain, at least two, the slowest first: interpolated in the logarithm of the rate,
        /// constant below the lowest and above the highest.
        rates: Option<Vec<FlowCurve>>, least 2;
    }

    /// Voce's law: saturation − (saturation − yield) exp(−rate p).
    #[derive(Copy)]
    pub struct Voce {
        /// Flow stress without plastic strain.
        initial: Pressure, written "yield", above 0, likely [1e4, 1e10];
        /// Flow stress that is approached, at least `yield`.
        saturation: Pressure, above 0, likely [1e4, 1e10];
        /// How fast it is approached, per equivalent plastic strain.
        rate: f64, above 0, likely [0.01, 1e4];
    }

    /// The flow stress at one rate.
    pub struct FlowCurve {
        /// Rate of plastic strain.
        rate: Rate, above 0;
        /// A CSV file with the columns `strain` (equivalent plastic strain) and `stress` (Pa, or `stress_MPa`), or the points
        /// themselves, from zero plastic strain on; constant beyond the last.
        curve: Vec<Point>, schemars(schema_with = "schema::path_or_list::<Point>");
    }

    /// Hill's yield function, by plastic strain ratios or by ratios of yield stress.
    #[derive(Copy)]
    #[schemars(extend("oneOf" = [{ "required": ["r0", "r45", "r90"] }, { "required": ["r11", "r22", "r33", "r12"] }]))]
    pub struct HillRatios {
        /// Plastic strain ratio, width over thickness, in tension along MD.
        r0: Option<f64>, above 0, likely [0.05, 20.0];
        /// The same at 45° between MD and TD.
        r45: Option<f64>, above 0, likely [0.05, 20.0];
        /// The same along TD.
        r90: Option<f64>, above 0, likely [0.05, 20.0];
        /// Yield stress along MD over that of `hardening`.
        r11: Option<f64>, above 0, likely [0.1, 10.0];
        /// Yield stress along TD over that of `hardening`.
        r22: Option<f64>, above 0, likely [0.1, 10.0];
        /// Yield stress across the film, of its normal direction, over that of `hardening`.
        r33: Option<f64>, above 0, likely [0.1, 10.0];
        /// Yield stress in shear along MD and TD over that of `hardening` divided by √3.
        r12: Option<f64>, above 0, likely [0.1, 10.0];
    }

    /// An energy of rubber-like film and its coefficients. Each law has its own keys.
    pub struct Hyperelastic {
        /// The energy.
        law: Energy;
        /// Shear modulus of `neo-hookean` and `gent`; the moduli of the terms of `ogden`.
        mu: Option<Moduli>, default, schemars(schema_with = "moduli_schema");
        /// Exponents of the terms of `ogden`, as many as `mu`, none of them zero.
        alpha: Option<Vec<f64>>, least 1, most 6, likely [-30.0, 30.0];
        /// Limit of I₁ − 3, at which the chains of `gent` are straight.
        jm: Option<f64>, above 0, likely [0.1, 1e4];
        /// Coefficient of I₁ − 3 of `mooney-rivlin` and `yeoh`.
        c10: Option<Pressure>, likely [1e2, 1e9];
        /// Coefficient of I₂ − 3 of `mooney-rivlin`.
        c01: Option<Pressure>, likely [-1e9, 1e9];
        /// Coefficient of (I₁ − 3)² of `yeoh`.
        c20: Option<Pressure>, likely [-1e9, 1e9];
        /// Coefficient of (I₁ − 3)³ of `yeoh`.
        c30: Option<Pressure>, likely [-1e9, 1e9];
        /// Young's modulus at small strain of `compressible-neo-hookean`.
        young: Option<Pressure>, above 0, likely [1e3, 1e12];
        /// Poisson's ratio at small strain of `compressible-neo-hookean`.
        poisson: Option<f64>, from 0, below 0.5;
        /// Whether the film wrinkles under compression, so that it carries tension only (tension field).
        wrinkling: bool, default;
        /// Lowest and highest strain rate at which the coefficients were measured.
        measured_rates: Option<[Rate; 2]>, positive;
    }

    /// Energies of rubber-like film.
    pub enum Energy of words {
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

    /// One term of a Prony series on the material's law.
    #[derive(Copy)]
    pub struct PronyTerm {
        /// Share of the instantaneous stiffness that relaxes with `time`; the shares of all terms sum to less than 1.
        share: f64, above 0, below 1;
        /// Relaxation time, at the reference temperature where there is a `shift`.
        time: Time, above 0;
    }

    /// Which film the law as written describes.
    #[derive(Default)]
    pub enum PronyOf of words {
        /// Film strained at once: the long-term stiffness is (1 − Σ share) of it.
        #[default]
        Instantaneous,
        /// Film that has relaxed, e.g. in a slow tensile test: the instantaneous stiffness is 1/(1 − Σ share) of it.
        LongTerm,
    }

    /// Shift of the relaxation times from a reference temperature to that of the film.
    #[derive(Copy)]
    pub enum Shift {
        /// Williams, Landel and Ferry: log₁₀ a = −c1 (T − reference)/(c2 + T − reference), above the glass transition.
        Wlf(Wlf),
        /// Arrhenius: ln a = energy/R (1/T − 1/reference).
        Arrhenius(Arrhenius),
    }

    /// Constants of Williams, Landel and Ferry.
    #[derive(Copy)]
    pub struct Wlf {
        /// Constant c₁.
        c1: f64, above 0, likely [1.0, 100.0];
        /// Constant c₂.
        c2: TemperatureDifference, above 0, likely [5.0, 500.0];
        /// Temperature of the relaxation times as written.
        reference: Temperature, above 0, likely [150.0, 600.0];
    }

    /// Constants of Arrhenius.
    #[derive(Copy)]
    pub struct Arrhenius {
        /// Activation energy.
        energy: MolarEnergy, above 0, likely [1e3, 1e6];
        /// Temperature of the relaxation times as written.
        reference: Temperature, above 0, likely [150.0, 600.0];
    }

    /// When an element of film starts to tear, and the energy that its tear takes. In a fabric it takes the place of the break
    /// at the last strain of the curves, whose last slope then continues.
    pub struct Rupture {
        /// What of an element is compared with the limit.
        criterion: RuptureCriterion;
        /// The value at which an element starts to tear: of `strain` a number, of `stress` a stress, of `energy` an energy per
        /// volume. A fabric with the criterion `strain` may leave it out: each fibre set then has the last strain of its curve.
        limit: Option<Level>;
        /// Fracture energy: energy that a tear takes for its length and the thickness of the stress-free film. Left out, an
        /// element fails at once.
        energy: Option<EnergyPerArea>, above 0, likely [1.0, 1e6];
    }

    /// What of an element is compared with the limit.
    pub enum RuptureCriterion of words {
        /// Largest principal engineering strain; of a fabric the larger strain of its fibre sets.
        Strain,
        /// Largest principal engineering stress, of force over stress-free cross-section.
        Stress,
        /// Energy stored and absorbed for the volume of stress-free film.
        Energy,
    }
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
