//! `[solver]`: time stepping.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::Time;

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
