//! `[loading.stretch]`: two jaws pull the film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{Angle, Velocity};

/// A tensile test of a coupon or of a single element.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Stretch {
    /// Direction of loading in the film: along MD, along TD, or an angle from MD.
    pub direction: Direction,
    /// Speed at which the jaws part, both together.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub velocity: Velocity,
    /// Engineering strain at which the test ends.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 100))]
    pub until: f64,
    /// Factor on the film's mass that lengthens the time step; chosen from the number of steps where it
    /// is left out.
    #[schemars(range(min = 1))]
    pub mass_scaling: Option<f64>,
}

/// Direction of loading. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Direction {
    /// Along MD or TD.
    Axis(Axis),
    /// An angle from MD.
    Angle(Angle),
}

/// A direction of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Axis {
    /// The machine direction.
    #[serde(rename = "MD")]
    Machine,
    /// The transverse direction.
    #[serde(rename = "TD")]
    Transverse,
}
