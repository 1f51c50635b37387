//! `[loading.volume]`: gas that is let in inflates the film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{Time, Volume};

/// A slow inflation by a volume of gas: the film is in equilibrium throughout.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Filling {
    /// Volume of the gas under the film at the end, at the pressure that it has there; of the whole film, also where its
    /// symmetry is used.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-9, 100.0]))]
    pub volume: Volume,
    /// Time in which the gas is let in, smoothly at both ends; its volume is then constant for half as long.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub ramp: Time,
    /// Factor on the film's mass that lengthens the time step; where it is left out, chosen so that the
    /// loading lasts 100 periods of the film.
    #[schemars(range(min = 1))]
    pub mass_scaling: Option<f64>,
}
