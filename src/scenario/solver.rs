//! `[solver]`: how time is stepped.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How time is stepped.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Solver {
    /// Factor on the stable time step: 0.5 takes steps half as long, which shows what the step does to a result.
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
