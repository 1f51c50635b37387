//! `[specimen.material.plastic]`: film that yields and keeps a set.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::curve_file::Point;
use super::schema;
use base::units::{Pressure, Rate};

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
