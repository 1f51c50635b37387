//! `[solver]`: time stepping.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Time stepping.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Solver {
    /// Factor on the stable time step: with 0.5 steps are half as long, which shows the influence of the step on a
    /// result.
    #[serde(default = "whole")]
    #[schemars(range(min = 0.001, max = 1))]
    pub step_factor: f64,
}

impl Default for Solver {
    fn default() -> Solver {
        Solver { step_factor: whole() }
    }
}

fn whole() -> f64 {
    1.0
}
