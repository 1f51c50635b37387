//! The loading: its kinds, and what differs between them.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use super::impactor::{Written, impactors};
use super::{Checker, Guide, Hold, Impactor, Model};
use crate::mesh::{Outline, Side};
use crate::scenario::{self, Axis, Direction, Scenario};
use base::number::significant;

/// The loading of the specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Loading {
    /// Impactors fall, fly or swing onto the film, or film falls onto them.
    Impact(Impact),
    /// The edges x- and x+ are jaws that part along x.
    Stretch(Stretch),
    /// The impactor starts in contact with the film and moves down.
    Indent(Indent),
    /// Gas below the film, of which pressure or volume rises and is then constant for half as long.
    Inflation(Inflation),
}

/// An impact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Impact {
    /// Vertical velocity of the first impactor at the start, m/s, downward positive.
    pub velocity: f64,
    /// Acceleration of free fall, m/s².
    pub gravity: f64,
    /// Simulated time, s.
    pub duration: f64,
}

/// A tensile test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stretch {
    /// Angle from MD to the direction of loading, rad: MD 0, TD π/2.
    pub angle: f64,
    /// Speed at which the jaws part, m/s.
    pub velocity: f64,
    /// Engineering strain at which the test ends.
    pub until: f64,
    /// Factor on the film's mass; `None` chooses it from the number of steps.
    pub mass_scaling: Option<f64>,
}

/// An indentation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Indent {
    /// Travel of the impactor, m.
    pub depth: f64,
    /// Speed of the impactor, m/s.
    pub velocity: f64,
    /// Factor on the film's mass; `None` chooses it from the periods of the film.
    pub mass_scaling: Option<f64>,
}

/// An inflation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inflation {
    /// Its gas.
    pub gas: Gas,
    /// Time in which pressure or volume rises, s.
    pub ramp: f64,
    /// Factor on the film's mass; `None` chooses it from the periods of the film.
    pub mass_scaling: Option<f64>,
}

/// The gas below inflated film.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Gas {
    /// Final pressure, Pa.
    Pressure(f64),
    /// Final volume under the whole film, m³.
    Volume(f64),
}

/// Time at constant pressure or volume over the time in which it rises.
const REST: f64 = 0.5;

/// What differs between kinds. Everything else asks here, so that the compiler names what another kind needs.
impl Loading {
    /// Name of its table in `[loading]`.
    pub fn name(&self) -> &'static str {
        match self {
            Loading::Impact(_) => "impact",
            Loading::Stretch(_) => "stretch",
            Loading::Indent(_) => "indent",
            Loading::Inflation(Inflation { gas: Gas::Pressure(_), .. }) => "pressure",
            Loading::Inflation(Inflation { gas: Gas::Volume(_), .. }) => "volume",
        }
    }

    /// Path of a `key` of its table.
    pub fn key(&self, key: &str) -> String {
        format!("loading.{}.{key}", self.name())
    }

    /// The kind of its test, which decides what is recorded, measured and shown.
    pub fn test(&self) -> Test {
        match self {
            Loading::Impact(_) => Test::Impact,
            Loading::Stretch(_) => Test::Stretch,
            Loading::Indent(indent) => Test::Indent { velocity: indent.velocity },
            Loading::Inflation(_) => Test::Inflation,
        }
    }

    /// The part that inertia plays in it.
    pub fn inertia(&self) -> Inertia {
        match self {
            Loading::Impact(_) => Inertia::Dynamic,
            Loading::Stretch(_) => Inertia::Reported,
            Loading::Indent(_) | Loading::Inflation(_) => Inertia::Negligible,
        }
    }

    /// Where the factor on the film's mass comes from.
    pub fn mass_scaling(&self) -> MassScaling {
        match self {
            Loading::Impact(_) => MassScaling::Unscaled,
            Loading::Stretch(Stretch { mass_scaling, .. })
            | Loading::Indent(Indent { mass_scaling, .. })
            | Loading::Inflation(Inflation { mass_scaling, .. }) => {
                mass_scaling.map_or(MassScaling::Chosen, MassScaling::Given)
            }
        }
    }

    /// Simulated time on film of this outline, s; NaN where it has none, which is reported separately.
    pub fn run_time(&self, shape: &Outline) -> f64 {
        match (self, shape) {
            (Loading::Impact(impact), _) => impact.duration,
            (Loading::Stretch(stretch), Outline::Rectangle { x, .. }) => stretch.until * x / stretch.velocity,
            (Loading::Stretch(_), _) => f64::NAN,
            (Loading::Indent(indent), _) => indent.depth / indent.velocity,
            (Loading::Inflation(inflation), _) => (1.0 + REST) * inflation.ramp,
        }
    }

    /// The key of its table from which the simulated time follows.
    pub fn pace(&self) -> &'static str {
        match self {
            Loading::Impact(_) => "duration",
            Loading::Stretch(_) | Loading::Indent(_) => "velocity",
            Loading::Inflation(_) => "ramp",
        }
    }

    /// The impactors that it needs.
    pub fn impactors(&self) -> Impactors {
        match self {
            Loading::Impact(_) => Impactors::Free,
            Loading::Indent(_) => Impactors::Prescribed,
            Loading::Stretch(_) | Loading::Inflation(_) => Impactors::None,
        }
    }

    /// Whether gas presses on the film.
    pub fn is_by_gas(&self) -> bool {
        matches!(self, Loading::Inflation(_))
    }

    /// Angle from the x axis to MD where the loading turns the film, rad.
    pub fn md_angle(&self) -> Option<f64> {
        match self {
            Loading::Stretch(stretch) => Some(-stretch.angle),
            Loading::Impact(_) | Loading::Indent(_) | Loading::Inflation(_) => None,
        }
    }

    /// The edges that are held where the scenario does not say.
    pub fn default_hold(&self) -> Hold {
        match self {
            Loading::Stretch(_) => Hold::Sides(vec![Side::XMinus, Side::XPlus]),
            Loading::Impact(_) | Loading::Indent(_) | Loading::Inflation(_) => Hold::All,
        }
    }

    /// Why there is one face of film.
    pub fn refuses_faces(&self) -> Option<&'static str> {
        match self {
            Loading::Stretch(_) => Some("a stretch test has one face"),
            Loading::Inflation(Inflation { gas: Gas::Volume(_), .. }) => {
                Some("gas is let in under one face; `loading.pressure` acts on several")
            }
            Loading::Impact(_) | Loading::Indent(_) | Loading::Inflation(_) => None,
        }
    }

    /// Its quantities for scripts, SI.
    pub fn facts(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Loading::Impact(Impact { velocity, gravity, duration }) => {
                vec![("velocity", velocity), ("gravity", gravity), ("duration", duration)]
            }
            Loading::Stretch(Stretch { angle, velocity, until, .. }) => {
                vec![("angle", angle), ("velocity", velocity), ("until", until)]
            }
            Loading::Indent(Indent { depth, velocity, .. }) => vec![("depth", depth), ("velocity", velocity)],
            Loading::Inflation(Inflation { gas: Gas::Pressure(value) | Gas::Volume(value), ramp, .. }) => {
                vec![(self.name(), value), ("ramp", ramp)]
            }
        }
    }

    /// The impact, where impactors move freely.
    pub fn impact(&self) -> Option<&Impact> {
        match self {
            Loading::Impact(impact) => Some(impact),
            _ => None,
        }
    }

    /// The loading with the vertical speed that the guide of the impactor admits.
    pub(super) fn with_impactor(&self, impactor: Option<&Impactor>) -> Loading {
        match (self.clone(), impactor) {
            (Loading::Impact(impact), Some(Impactor { velocity: [_, _, upward], .. })) => {
                Loading::Impact(Impact { velocity: -upward, ..impact })
            }
            (loading, _) => loading,
        }
    }
}

impl Model {
    /// Simulated time, s.
    pub fn run_time(&self) -> f64 {
        self.loading.run_time(&self.specimen.shape)
    }

    /// The action of the test on the film, in one phrase: `sphere 10.72 kg at 4.16 m/s on 2 x 8 layers of LLDPE`.
    pub fn subject(&self) -> String {
        let layers = self.layers_in_words();
        match &self.loading {
            Loading::Impact(impact) => match self.impactors.as_slice() {
                [] => format!("{} m/s on {layers}", significant(impact.velocity, 3)),
                [impactor] if impactor.guide == Guide::Fixed => format!("{layers} on a {}", impactor.in_words()),
                [impactor] => format!("{} on {layers}", impactor.in_words()),
                several => {
                    let named = |one: &Impactor| format!("{} ({})", one.words(), one.in_words());
                    let all: Vec<String> = several.iter().map(named).collect();
                    format!("{} on {layers}", all.join(", "))
                }
            },
            Loading::Stretch(stretch) => {
                let (velocity, until) = (significant(stretch.velocity, 3), significant(stretch.until * 100.0, 3));
                let angle = degrees(stretch.angle);
                format!("{layers} stretched at {velocity} m/s to {until} %, {angle:.0}° from MD")
            }
            Loading::Indent(indent) => {
                let body = self.impactor().map_or("body", Impactor::body);
                let [depth, velocity] = [indent.depth * 1e3, indent.velocity].map(|value| significant(value, 3));
                format!("{body} {depth} mm into {layers} at {velocity} m/s")
            }
            Loading::Inflation(Inflation { gas: Gas::Pressure(pressure), .. }) => {
                format!("{} kPa under {layers}", significant(pressure * 1e-3, 3))
            }
            Loading::Inflation(Inflation { gas: Gas::Volume(volume), .. }) => {
                format!("{} l of gas under {layers}", significant(volume * 1e3, 3))
            }
        }
    }
}

/// The kind of a test; those of one kind record, measure and show the same signals, figures and plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Test {
    /// The motion of impactors.
    Impact,
    /// The force of jaws over their travel.
    Stretch,
    /// The force on an impactor over its depth.
    Indent {
        /// Speed of the impactor, m/s.
        velocity: f64,
    },
    /// Pressure, rise and volume of film on gas.
    Inflation,
}

/// The part that inertia plays in a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inertia {
    /// It is what the test is about.
    Dynamic,
    /// It should not matter; how much it does is reported.
    Reported,
    /// It must not matter: the film is in equilibrium throughout, and its failure ends the test.
    Negligible,
}

/// Where the factor on the film's mass comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MassScaling {
    /// The film has its own mass.
    Unscaled,
    /// From the scenario.
    Given(f64),
    /// From the duration of the test.
    Chosen,
}

/// The impactors that a loading needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Impactors {
    /// None.
    None,
    /// One, whose motion it prescribes.
    Prescribed,
    /// At least one, which moves by its mass.
    Free,
}

/// The loading in SI values.
pub(super) fn check(scenario: &Scenario, checker: &mut Checker<'_>) -> Loading {
    match &scenario.loading {
        scenario::Loading::Impact(impact) => Loading::Impact(check_impact(impact, scenario, checker)),
        scenario::Loading::Stretch(stretch) => Loading::Stretch(check_stretch(stretch, scenario, checker)),
        scenario::Loading::Indent(scenario::Indent { depth, velocity, mass_scaling }) => {
            Loading::Indent(Indent { depth: depth.0, velocity: velocity.0, mass_scaling: *mass_scaling })
        }
        scenario::Loading::Pressure(scenario::Inflation { pressure, ramp, mass_scaling }) => {
            let gas = Gas::Pressure(pressure.0);
            Loading::Inflation(Inflation { gas, ramp: ramp.0, mass_scaling: *mass_scaling })
        }
        scenario::Loading::Volume(scenario::Filling { volume, ramp, mass_scaling }) => {
            let gas = Gas::Volume(volume.0);
            Loading::Inflation(Inflation { gas, ramp: ramp.0, mass_scaling: *mass_scaling })
        }
    }
}

/// The impact in SI values.
fn check_impact(written: &scenario::Impact, scenario: &Scenario, checker: &mut Checker<'_>) -> Impact {
    const KEY: &str = "loading.impact";
    let impactors = &impactors(scenario, checker);
    let gravity = written.gravity.0;
    let is_given = written.velocity.is_some() || written.drop_height.is_some();
    let takes = |impactor: &&Written<'_>| moves(impactor) && impactor.velocity.is_none();
    let taking = impactors.iter().find(takes);
    let is_missing = taking.is_some() || impactors.is_empty();
    if is_given && !is_missing {
        let key = if written.velocity.is_some() { "velocity" } else { "drop_height" };
        let why = match impactors.first().filter(|impactor| !moves(impactor)).map(|impactor| &impactor.guide) {
            Some(scenario::Guide::Fixed) => "the impactor is fixed: film falls onto it by its weight".to_owned(),
            Some(scenario::Guide::Hinge(_)) => {
                format!("an impactor on a hinge starts with `{}`", impactors[0].key("spin"))
            }
            _ => format!("`{}` gives the velocity", impactors[0].key("velocity")),
        };
        checker.out_of_place(&format!("{KEY}.{key}"), why);
    } else if !is_given && is_missing {
        let message = "`loading.impact` needs one of `velocity`, `drop_height`";
        let own = taking.map_or_else(|| "impactor.velocity".to_owned(), |impactor| impactor.key("velocity"));
        checker.report_with(KEY, message, format!("or give `{own}`, a vector"));
    }
    if written.drop_height.is_some() && gravity == 0.0 {
        checker.report("loading.impact.gravity", "`drop_height` needs gravity");
        checker.label("loading.impact.drop_height", "the drop height");
    }
    let above = impactors.iter().find(|impactor| impactor.position.len() > 2 && takes(impactor));
    if let Some(above) = above.filter(|_| written.drop_height.is_some()) {
        let height = above.key("position");
        let why = format!("the impactor falls from the height of `{height}`: give its velocity there");
        checker.out_of_place(&format!("{KEY}.drop_height"), why);
    }
    let fall = |height: f64| (2.0 * gravity * height).sqrt();
    let own = impactors.first().and_then(|impactor| impactor.velocity).map(|[_, _, along]| -along.0);
    let velocity = match (written.velocity, written.drop_height) {
        (Some(velocity), _) => velocity.0,
        (None, Some(height)) => fall(height.0),
        (None, None) => own.unwrap_or(0.0),
    };
    Impact { velocity, gravity, duration: written.duration.0 }
}

/// Whether an impactor starts with a velocity.
fn moves(impactor: &Written<'_>) -> bool {
    !matches!(impactor.guide, scenario::Guide::Fixed | scenario::Guide::Hinge(_))
}

/// Jaws hold a rectangle of unstrained film, whose orientation the loading gives.
fn check_stretch(written: &scenario::Stretch, scenario: &Scenario, checker: &mut Checker<'_>) -> Stretch {
    if !matches!(scenario.specimen.shape, scenario::Shape::Rectangle(_)) {
        checker.report_with("specimen.shape", "`loading.stretch` needs a rectangle", "jaws hold straight edges");
        checker.label("loading.stretch", "the loading");
    }
    let angle = match written.direction {
        Direction::Axis(Axis::Machine) => 0.0,
        Direction::Axis(Axis::Transverse) => FRAC_PI_2,
        Direction::Angle(angle) => angle.0,
    };
    Stretch { angle, velocity: written.velocity.0, until: written.until, mass_scaling: written.mass_scaling }
}

/// A direction has no sense: within 0 to 180 degrees.
fn degrees(angle: f64) -> f64 {
    // The sum has no negative zero.
    angle.to_degrees().rem_euclid(180.0) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_lie_within_half_a_turn() {
        for (angle, expected) in [("0", 0.0), ("-45", 135.0), ("225", 45.0), ("-0", 0.0)] {
            let degrees = degrees(angle.parse::<f64>().unwrap().to_radians());
            assert!((degrees - expected).abs() < 1e-9 && degrees.is_sign_positive(), "{angle}");
        }
    }
}
