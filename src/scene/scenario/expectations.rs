//! `expect.toml`: what a run must give, and how far it may be from what was recorded.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use base::units::Time;

/// What a run must give.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Expectations {
    /// A file of the same kind whose keys hold where this one has none.
    #[schemars(extend("x-path" = true))]
    pub extends: Option<PathBuf>,
    /// How far signals may be from the recorded ones (`expected.csv`), each under its name in `signals.csv`; under "*"
    /// all others.
    #[serde(default)]
    pub signals: BTreeMap<String, SignalBounds>,
    /// What figures of `summary.json` must be, each under its name.
    #[serde(default)]
    pub figures: BTreeMap<String, FigureBounds>,
    /// Findings that must or must not come, by their codes.
    #[serde(default)]
    pub warnings: FindingBounds,
}

/// How far a signal may be from the recorded one.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct SignalBounds {
    /// Largest distance, in the unit of the signal ("0.5 m/s2").
    pub absolute: Option<Amount>,
    /// Largest distance over the largest recorded magnitude within the window; where `absolute` is given too, the
    /// larger of both holds.
    #[schemars(range(min = 0, max = 1e3))]
    pub relative: Option<f64>,
    /// A sample may be as far as that in time from the recorded one.
    #[schemars(extend("minimum" = 0))]
    pub time: Option<Time>,
    /// Least overall rating by ISO/TS 18571 against the recorded signal.
    #[schemars(range(min = 0, max = 1))]
    pub rating: Option<f64>,
    /// A CSV file with the columns time_s, lower and upper: the signal must stay between both.
    #[schemars(extend("x-path" = true))]
    pub corridor: Option<PathBuf>,
    /// From when to when the bounds hold; left out, always.
    pub window: Option<[Time; 2]>,
    /// Why the bounds are as they are.
    pub reason: Option<String>,
}

/// What a figure must be: a value, or bounds.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FigureBounds {
    /// True or false.
    Flag(bool),
    /// Exactly this number.
    Number(f64),
    /// Exactly this text.
    Text(String),
    /// Bounds.
    Bounds(NumberBounds),
}

/// Bounds of a number.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct NumberBounds {
    /// Least and largest value, in the unit of the figure.
    pub between: Option<[Amount; 2]>,
    /// Largest distance from the recorded figure (`expected.json`), in the unit of the figure.
    pub absolute: Option<Amount>,
    /// Largest distance from the recorded figure over its magnitude; where `absolute` is given too, the larger of both
    /// holds.
    #[schemars(range(min = 0, max = 1e3))]
    pub relative: Option<f64>,
    /// Why the bounds are as they are.
    pub reason: Option<String>,
}

/// Findings by their codes.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct FindingBounds {
    /// Those that must come.
    #[serde(default)]
    pub must: Vec<String>,
    /// Those that must not come; "*" stands for every warning that is not in `must`.
    #[serde(default)]
    pub must_not: Vec<String>,
}

/// A number, or a number with the unit of what it bounds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Amount {
    /// In the SI unit.
    Number(f64),
    /// With its unit.
    Text(String),
}

impl JsonSchema for Amount {
    fn schema_name() -> Cow<'static, str> {
        "Amount".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "type": "number" }, { "type": "string" }] })
    }
}
