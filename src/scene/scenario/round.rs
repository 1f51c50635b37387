//! The size of what is round: its radius or its diameter.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use base::units::Length;

/// Radius or diameter; the validator has refused both and neither. A radius above `LIKELY` cm is implausible.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Round<const LIKELY: u32> {
    /// The radius.
    pub radius: Option<Length>,
    /// The diameter, in place of the radius.
    pub diameter: Option<Length>,
}

/// Least radius that is plausible, m.
const LEAST: f64 = 1e-4;

/// Largest radius, m.
const LARGEST: f64 = 1e3;

impl<const LIKELY: u32> Round<LIKELY> {
    /// The radius, m.
    pub fn radius(self) -> f64 {
        match (self.radius, self.diameter) {
            (Some(radius), _) => radius.0,
            (None, Some(diameter)) => 0.5 * diameter.0,
            (None, None) => f64::NAN,
        }
    }
}

impl<const LIKELY: u32> JsonSchema for Round<LIKELY> {
    fn schema_name() -> Cow<'static, str> {
        format!("Round{LIKELY}").into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut length = |sentence: &str, factor: f64| {
            let mut schema = Length::json_schema(generator);
            let likely = [LEAST, 1e-2 * f64::from(LIKELY)].map(|radius| factor * radius);
            schema.insert("description".into(), sentence.into());
            schema.insert("exclusiveMinimum".into(), 0.into());
            schema.insert("maximum".into(), (factor * LARGEST).into());
            schema.insert("x-likely".into(), likely.to_vec().into());
            schema
        };
        let (radius, diameter) = (length("Radius.", 1.0), length("Diameter, in place of the radius.", 2.0));
        json_schema!({
            "type": "object",
            "properties": { "radius": radius, "diameter": diameter },
            "oneOf": [{ "required": ["radius"] }, { "required": ["diameter"] }],
        })
    }
}
