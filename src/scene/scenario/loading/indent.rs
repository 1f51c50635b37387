//! `[loading.indent]`: an impactor is pressed slowly into the film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{Length, Velocity};

/// A slow indentation: the film is in equilibrium throughout.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Indent {
    /// Travel of the impactor from first contact, downward, at which the test ends.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-5, 2.0]))]
    pub depth: Length,
    /// Speed of the impactor.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub velocity: Velocity,
    /// Factor on the film's mass that lengthens the time step; where it is left out, chosen so that the
    /// loading lasts 50 periods of the film.
    #[schemars(range(min = 1))]
    pub mass_scaling: Option<f64>,
}
