//! `[output]`, `[solver]`, `[post]`, `[reference]` with the field that a run is compared with, and `expect.toml`: what a run
//! must give, and how far it may be from what was recorded.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::impactor::MeshUnit;
use base::units::{Force, Frequency, Length, Time, Velocity};

/// What a run records.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Output {
    /// Samples per second in `signals.csv`.
    #[serde(default = "ten_kilohertz")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e7, "x-likely" = [0.01, 1e7]))]
    pub sample_rate: Frequency,
    /// Number of snapshots for pages and recordings. Of a film so fine that they would take more than 0.4 GB, fewer are
    /// taken, and a warning gives their number.
    #[serde(default = "two_hundred_forty")]
    #[schemars(range(min = 1, max = 100_000))]
    pub frames: u32,
    /// Channel frequency class of the filtered acceleration (SAE J211-1, ISO 6487); CFC1000 for an
    /// impact where it is left out.
    #[schemars(extend("default" = "CFC1000"))]
    pub filter: Option<Filter>,
}

impl Default for Output {
    fn default() -> Output {
        Output { sample_rate: ten_kilohertz(), frames: two_hundred_forty(), filter: None }
    }
}

fn ten_kilohertz() -> Frequency {
    Frequency(10e3)
}

fn two_hundred_forty() -> u32 {
    240
}

/// Channel frequency class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "UPPERCASE")]
pub enum Filter {
    /// Class 1000.
    Cfc1000,
    /// Class 600.
    Cfc600,
    /// Class 180.
    Cfc180,
    /// Class 60.
    Cfc60,
    /// No filter.
    #[serde(rename = "none")]
    None,
}

/// Processing of the results.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Post {
    /// Rhai script that adds to the summary.
    #[schemars(extend("x-path" = true))]
    pub script: PathBuf,
}

/// Time stepping.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Solver {
    /// Factor on the stable time step: with 0.5 steps are half as long, which shows the influence of the step on a
    /// result.
    #[serde(default = "whole")]
    #[schemars(range(min = 0.001, max = 1))]
    pub step_factor: f64,
    /// Elements whose own stable time step is shorter, before the test, get the mass for this one; left out, no mass is
    /// added. It lets a few small elements not determine the step of all; `added_mass_share` in the summary says what it
    /// is.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-9, 1e-4]))]
    pub smallest_step: Option<Time>,
}

impl Default for Solver {
    fn default() -> Solver {
        Solver { step_factor: whole(), smallest_step: None }
    }
}

fn whole() -> f64 {
    1.0
}

/// The recording that a run is compared with: signals, a displacement field, or both.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// Recording (table, ISO-MME, TDMS, …): signals from first contact on where it has the columns `acceleration_m_s2` and/or
    /// `displacement_m` (with `time_s`) and neither `acceleration` nor `displacement` is given; anything else is the
    /// raw recording of a drop, from the rest before the release on, by an accelerometer and possibly a laser, and is
    /// reduced first.
    #[schemars(extend("x-path" = true))]
    pub signals: Option<PathBuf>,
    /// Displacement field of a face of film, measured by digital image correlation.
    pub field: Option<FieldReference>,
    /// Name of the impactor that it was recorded of, of several; the first where it is left out.
    pub impactor: Option<String>,
    /// Accelerometer of a raw recording; the only channel that is an acceleration where it is left out.
    pub acceleration: Option<String>,
    /// Whether the accelerometer reads a deceleration as negative.
    #[serde(default)]
    pub invert: bool,
    /// Laser of a raw recording, upward from the film's upper face; the only channel that is a length where it is
    /// left out.
    pub displacement: Option<String>,
    /// Drop height of a raw recording. Where neither height, speed nor time of contact is given, the impactor is taken to
    /// have reached the impact velocity of the run.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub drop_height: Option<Length>,
    /// Standard deviation of the drop height; half a per cent of it where it is left out.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub height_error: Option<Length>,
    /// Impact speed of a raw recording where it is known.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub speed: Option<Velocity>,
    /// Standard deviation of the impact speed: of that of a raw recording where it is given (half a per cent where it is left out),
    /// else of signals that count from first contact (none). A calibration takes it up.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub speed_error: Option<Velocity>,
    /// Time of first contact on the clock of a raw recording where it is known.
    pub contact_time: Option<Time>,
    /// Standard deviation of the time of first contact: of that of a raw recording where it is given (half a sample where it is
    /// left out), else of signals that count from first contact (none). A calibration takes it up.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub contact_error: Option<Time>,
    /// Time constant of the coupling of the accelerometer of a raw recording where it is known.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time_constant: Option<Time>,
    /// Friction of the guide of a raw recording and its standard deviation where they are known.
    pub guide_friction: Option<[Force; 2]>,
    /// Window of the errors: the loading phase, the whole recording, or from–to. Without signals, the loading phase is the
    /// whole run.
    #[serde(default)]
    pub window: Window,
}

/// Window of the errors. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Window {
    /// A named part.
    Phase(Phase),
    /// From, to.
    Range([Time; 2]),
}

impl Default for Window {
    fn default() -> Window {
        Window::Phase(Phase::Loading)
    }
}

/// A named part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// From first contact to the largest displacement of the reference.
    Loading,
    /// The whole recording.
    All,
}

/// A displacement field over time, measured by digital image correlation.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FieldReference {
    /// Its files, one per image, in the order of the numbers in their names: a folder, a pattern such as `"dic/*.csv"`, or a
    /// list. Exports of VIC-3D, MatchID, ARAMIS and DICe with undeformed places and displacements in space.
    pub files: FieldFiles,
    /// When they were recorded, on the time axis of the run: a table with a column of time, a list, or a rate.
    pub times: FieldTimes,
    /// Unit of places and displacements where a file states none.
    pub unit: Option<MeshUnit>,
    /// Number of the face that was measured, counted from the first that comes into contact.
    #[serde(default = "first")]
    #[schemars(range(min = 1, max = 64))]
    pub face: u32,
    /// Rigid motion from the axes of the field to those of the run.
    #[serde(default)]
    pub align: Align,
}

fn first() -> u32 {
    1
}

/// The files of a field. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FieldFiles {
    /// A folder, a pattern or a single file.
    Pattern(#[schemars(extend("x-path" = true))] PathBuf),
    /// Every file.
    List(#[schemars(schema_with = "paths")] Vec<PathBuf>),
}

/// A list of paths.
fn paths(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({ "type": "array", "items": { "type": "string", "x-path": true }, "minItems": 1 })
}

/// The times of the files of a field.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FieldTimes {
    /// A table with a column of time.
    Table(#[schemars(extend("x-path" = true))] PathBuf),
    /// A time for every file.
    List(#[schemars(length(min = 1))] Vec<Time>),
    /// A constant rate.
    Rate(FieldRate),
}

/// Images at a constant rate.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FieldRate {
    /// Images per second.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate: Frequency,
    /// Time of the first file.
    #[serde(default)]
    pub start: Time,
}

/// How a field is brought into the axes of the run.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Align {
    /// By the rigid motion for which its places lie on the undeformed film and its displacements are closest to those of
    /// the run.
    #[default]
    Rigid,
    /// Its axes are those of the run.
    None,
    /// By the rigid motion that brings at least three points of it onto points of the undeformed film.
    Markers(#[schemars(length(min = 3))] Vec<Marker>),
}

/// A point in the axes of the field and in those of the run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Marker {
    /// x, y, z in the axes of the field.
    pub field: [Length; 3],
    /// x, y, z in those of the run.
    pub film: [Length; 3],
}

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
