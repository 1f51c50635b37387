//! `[specimen.material.rupture]`: when film starts to tear, and what a tear takes.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use base::units::{EnergyPerArea, Pressure};

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
