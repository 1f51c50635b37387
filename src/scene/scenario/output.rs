//! `[output]`, `[post]` and `[solver]`: what a run records, what is made of it, and its time step.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{Frequency, Time};

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
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
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
