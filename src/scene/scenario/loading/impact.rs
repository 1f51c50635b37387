//! `[loading.impact]`: a body falls onto the film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{Acceleration, Length, Time, Velocity};

/// An impact.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend(
    "not" = { "required": ["velocity", "drop_height"] }
))]
pub struct Impact {
    /// Speed at the start, at first contact where the impactor starts there, downward positive; on a guide along a line,
    /// down the line. `impactor.velocity` is one in any direction.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-3, 500.0]))]
    #[schemars(title = "Impact speed")]
    pub velocity: Option<Velocity>,
    /// Drop height of an ideal free fall to first contact, in place of `velocity`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-3, 100.0]))]
    #[schemars(title = "Drop height")]
    pub drop_height: Option<Length>,
    /// Acceleration of free fall.
    #[serde(default = "standard_gravity")]
    #[schemars(range(min = 0), extend("x-likely" = [1e-3, 300.0]))]
    pub gravity: Acceleration,
    /// Simulated time from the start: from first contact, unless the impactor starts above the film.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-6, 5.0]))]
    pub duration: Time,
}

fn standard_gravity() -> Acceleration {
    Acceleration(9.81)
}
