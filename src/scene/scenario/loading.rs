//! `[loading.…]`: the loading of the specimen; exactly one.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{Acceleration, Angle, Length, Pressure, Time, Velocity, Volume};

/// The loading of the specimen.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Loading {
    /// An impactor falls, flies or swings onto the film, or film falls onto it.
    Impact(Impact),
    /// Two jaws, the edges x- and x+, part along x.
    Stretch(Stretch),
    /// The impactor moves slowly down into the film at a prescribed speed.
    Indent(Indent),
    /// Pressure on the lower side of the film, held all around, inflates it; of several faces it acts on the lowest, which
    /// presses on those above it.
    Pressure(Inflation),
    /// Gas let in under one face of film, held all around, inflates it, also beyond the largest pressure that it carries.
    Volume(Filling),
}

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
