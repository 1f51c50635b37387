//! `[loading.pressure]`: a pressure inflates the film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{Pressure, Time};

/// A slow inflation: the film is in equilibrium throughout.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Inflation {
    /// Final difference of the pressures below and above the film.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1.0, 1e8]))]
    pub pressure: Pressure,
    /// Time in which the pressure rises, smoothly at both ends; it is then constant for half as long.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub ramp: Time,
    /// Factor on the film's mass that lengthens the time step; where it is left out, chosen so that the
    /// loading lasts 50 periods of the film.
    #[schemars(range(min = 1))]
    pub mass_scaling: Option<f64>,
}
