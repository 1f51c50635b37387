//! `[output]`, `[solver]`, `[post]`, `[reference]` with the field that a run is compared with, and `expect.toml`: what a run
//! must give, and how far it may be from what was recorded.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::impactor::MeshUnit;
use super::schema;
use base::units::{Force, Frequency, Length, Time, Velocity};

keys! {
    /// What a run records.
    pub struct Output with defaults {
        /// Samples per second in `signals.csv`.
        sample_rate: Frequency, else Frequency(10e3), above 0, to 1e7, likely [0.01, 1e7];
        /// Number of snapshots for pages and recordings. Of a film so fine that they would take more than 0.4 GB, fewer are
        /// taken, and a warning gives their number.
        frames: u32, else 240, from 1, to 100_000;
        /// Channel frequency class of the filtered acceleration (SAE J211-1, ISO 6487); CFC1000 for an
        /// impact where it is left out.
        filter: Option<Filter>, usually "CFC1000";
    }

    /// Processing of the results.
    pub struct Post {
        /// Rhai script that adds to the summary.
        script: PathBuf, path;
    }

    /// Time stepping.
    #[derive(Copy, PartialEq)]
    pub struct Solver with defaults {
        /// Factor on the stable time step: with 0.5 steps are half as long, which shows the influence of the step on a
        /// result.
        step_factor: f64, else 1.0, from 0.001, to 1;
        /// Elements whose own stable time step is shorter, before the test, get the mass for this one; left out, no mass is
        /// added. It lets a few small elements not determine the step of all; `added_mass_share` in the summary says what it
        /// is.
        smallest_step: Option<Time>, above 0, likely [1e-9, 1e-4];
    }

    /// The recording that a run is compared with: signals, a displacement field, or both.
    #[derive(PartialEq)]
    pub struct Reference {
        /// Recording (table, ISO-MME, TDMS, …): signals from first contact on where it has the columns `acceleration_m_s2` and/or
        /// `displacement_m` (with `time_s`) and neither `acceleration` nor `displacement` is given; anything else is the
        /// raw recording of a drop, from the rest before the release on, by an accelerometer and possibly a laser, and is
        /// reduced first.
        signals: Option<PathBuf>, path;
        /// Displacement field of a face of film, measured by digital image correlation.
        field: Option<FieldReference>;
        /// Name of the impactor that it was recorded of, of several; the first where it is left out.
        impactor: Option<String>;
        /// Accelerometer of a raw recording; the only channel that is an acceleration where it is left out.
        acceleration: Option<String>;
        /// Whether the accelerometer reads a deceleration as negative.
        invert: bool, default;
        /// Laser of a raw recording, upward from the film's upper face; the only channel that is a length where it is
        /// left out.
        displacement: Option<String>;
        /// Drop height of a raw recording. Where neither height, speed nor time of contact is given, the impactor is taken to
        /// have reached the impact velocity of the run.
        drop_height: Option<Length>, above 0;
        /// Standard deviation of the drop height; half a per cent of it where it is left out.
        height_error: Option<Length>, above 0;
        /// Impact speed of a raw recording where it is known.
        speed: Option<Velocity>, above 0;
        /// Standard deviation of the impact speed: of that of a raw recording where it is given (half a per cent where it is left out),
        /// else of signals that count from first contact (none). A calibration takes it up.
        speed_error: Option<Velocity>, above 0;
        /// Time of first contact on the clock of a raw recording where it is known.
        contact_time: Option<Time>;
        /// Standard deviation of the time of first contact: of that of a raw recording where it is given (half a sample where it is
        /// left out), else of signals that count from first contact (none). A calibration takes it up.
        contact_error: Option<Time>, above 0;
        /// Time constant of the coupling of the accelerometer of a raw recording where it is known.
        time_constant: Option<Time>, above 0;
        /// Friction of the guide of a raw recording and its standard deviation where they are known.
        guide_friction: Option<[Force; 2]>;
        /// Window of the errors: the loading phase, the whole recording, or from–to. Without signals, the loading phase is the
        /// whole run.
        window: Window, default;
    }

    /// Window of the errors. The validator has reported mistakes before serde tries the two forms.
    #[derive(Copy, PartialEq)]
    pub enum Window of forms {
        /// A named part.
        Phase(Phase),
        /// From, to.
        Range([Time; 2]),
    }

    /// A named part of a run.
    pub enum Phase of words {
        /// From first contact to the largest displacement of the reference.
        Loading,
        /// The whole recording.
        All,
    }

    /// A displacement field over time, measured by digital image correlation.
    #[derive(PartialEq)]
    pub struct FieldReference {
        /// Its files, one per image, in the order of the numbers in their names: a folder, a pattern such as `"dic/*.csv"`, or a
        /// list. Exports of VIC-3D, MatchID, ARAMIS and DICe with undeformed places and displacements in space.
        files: FieldFiles;
        /// When they were recorded, on the time axis of the run: a table with a column of time, a list, or a rate.
        times: FieldTimes;
        /// Unit of places and displacements where a file states none.
        unit: Option<MeshUnit>;
        /// Number of the face that was measured, counted from the first that comes into contact.
        face: u32, default "schema::one::<u32>", from 1, to 64;
        /// Rigid motion from the axes of the field to those of the run.
        align: Align, default;
    }

    /// The files of a field. The validator has reported mistakes before serde tries the two forms.
    #[derive(PartialEq)]
    pub enum FieldFiles of forms {
        /// A folder, a pattern or a single file.
        Pattern(#[schemars(extend("x-path" = true))] PathBuf),
        /// Every file.
        List(#[schemars(schema_with = "paths")] Vec<PathBuf>),
    }

    /// The times of the files of a field.
    #[derive(PartialEq)]
    pub enum FieldTimes of forms {
        /// A table with a column of time.
        Table(#[schemars(extend("x-path" = true))] PathBuf),
        /// A time for every file.
        List(#[schemars(length(min = 1))] Vec<Time>),
        /// A constant rate.
        Rate(FieldRate),
    }

    /// Images at a constant rate.
    #[derive(Copy, PartialEq)]
    pub struct FieldRate {
        /// Images per second.
        rate: Frequency, above 0;
        /// Time of the first file.
        start: Time, default;
    }

    /// How a field is brought into the axes of the run.
    #[derive(Default, PartialEq)]
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
    #[derive(Copy, PartialEq)]
    pub struct Marker {
        /// x, y, z in the axes of the field.
        field: [Length; 3];
        /// x, y, z in those of the run.
        film: [Length; 3];
    }

    /// What a run must give.
    pub struct Expectations with defaults {
        /// A file of the same kind whose keys hold where this one has none.
        extends: Option<PathBuf>, path;
        /// How far signals may be from the recorded ones (`expected.csv`), each under its name in `signals.csv`; under "*"
        /// all others.
        signals: BTreeMap<String, SignalBounds>;
        /// What figures of `summary.json` must be, each under its name.
        figures: BTreeMap<String, FigureBounds>;
        /// Findings that must or must not come, by their codes.
        warnings: FindingBounds;
    }

    /// How far a signal may be from the recorded one.
    #[derive(Default)]
    pub struct SignalBounds {
        /// Largest distance, in the unit of the signal ("0.5 m/s2").
        absolute: Option<Amount>;
        /// Largest distance over the largest recorded magnitude within the window; where `absolute` is given too, the
        /// larger of both holds.
        relative: Option<f64>, from 0, to 1e3;
        /// A sample may be as far as that in time from the recorded one.
        time: Option<Time>, from 0;
        /// Least overall rating by ISO/TS 18571 against the recorded signal.
        rating: Option<f64>, from 0, to 1;
        /// A CSV file with the columns time_s, lower and upper: the signal must stay between both.
        corridor: Option<PathBuf>, path;
        /// From when to when the bounds hold; left out, always.
        window: Option<[Time; 2]>;
        /// Why the bounds are as they are.
        reason: Option<String>;
    }

    /// What a figure must be: a value, or bounds.
    pub enum FigureBounds of forms {
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
    #[derive(Default)]
    pub struct NumberBounds {
        /// Least and largest value, in the unit of the figure.
        between: Option<[Amount; 2]>;
        /// Largest distance from the recorded figure (`expected.json`), in the unit of the figure.
        absolute: Option<Amount>;
        /// Largest distance from the recorded figure over its magnitude; where `absolute` is given too, the larger of both
        /// holds.
        relative: Option<f64>, from 0, to 1e3;
        /// Why the bounds are as they are.
        reason: Option<String>;
    }

    /// Findings by their codes.
    pub struct FindingBounds with defaults {
        /// Those that must come.
        must: Vec<String>;
        /// Those that must not come; "*" stands for every warning that is not in `must`.
        must_not: Vec<String>;
    }
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

impl Marker {
    /// Its place in the axes of the field and in those of the run, m.
    pub fn pair(&self) -> [[f64; 3]; 2] {
        [self.field, self.film].map(|place| place.map(|length| length.0))
    }
}

impl Default for Window {
    fn default() -> Window {
        Window::Phase(Phase::Loading)
    }
}

/// A list of paths.
fn paths(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({ "type": "array", "items": { "type": "string", "x-path": true }, "minItems": 1 })
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
