//! Stretch: two jaws pull the film.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use super::rules::{OF_IMPACTS, out_of_place};
use super::{Inertia, Kind, MassScaling, Refusal, Test};
use crate::mesh::{Outline, Side};
use crate::model::{Hold, Model, ModelDiagnostics};
use crate::scenario::{self, Axis, Direction, Scenario};
use base::number::significant;

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

impl Kind for Stretch {
    fn name(&self) -> &'static str {
        "stretch"
    }

    fn test(&self) -> Test {
        Test::Stretch
    }

    fn inertia(&self) -> Inertia {
        Inertia::Reported
    }

    fn mass_scaling(&self) -> MassScaling {
        self.mass_scaling.into()
    }

    fn run_time(&self, shape: &Outline) -> f64 {
        match shape {
            Outline::Rectangle { x, .. } => self.until * x / self.velocity,
            _ => f64::NAN,
        }
    }

    fn pace(&self) -> &'static str {
        "velocity"
    }

    fn md_angle(&self) -> Option<f64> {
        Some(-self.angle)
    }

    fn default_hold(&self) -> Hold {
        Hold::Sides(vec![Side::XMinus, Side::XPlus])
    }

    fn refuses_hold(&self, hold: &Hold) -> Option<Refusal> {
        let message = "the jaws of a stretch test hold the sides x- and x+";
        (!is_jaws(hold)).then_some(Refusal::Unsupported { message, hint: "leave the key out" })
    }

    fn refuses_bars(&self) -> Option<Refusal> {
        Some(Refusal::NotAllowed("jaws hold the film of a stretch test, which stays plane"))
    }

    fn refuses_clamp(&self) -> Option<Refusal> {
        let hint = "leave it out; the jaws of a stretch test hold without slip";
        Some(Refusal::Unsupported { message: "film that slips in jaws is not supported", hint })
    }

    fn refuses_springs(&self) -> Option<Refusal> {
        let hint = "leave them out; the jaws of a stretch test hold the film itself";
        Some(Refusal::Unsupported { message: "springs between film and jaws are not supported", hint })
    }

    fn refuses_faces(&self) -> Option<&'static str> {
        Some("a stretch test has one face")
    }

    fn subject(&self, _: &Model, layers: &str) -> String {
        let (velocity, until) = (significant(self.velocity, 3), significant(self.until * 100.0, 3));
        format!("{layers} stretched at {velocity} m/s to {until} %, {:.0}° from MD", degrees(self.angle))
    }

    fn facts(&self) -> Vec<(&'static str, f64)> {
        vec![("angle", self.angle), ("velocity", self.velocity), ("until", self.until)]
    }
}

impl Stretch {
    /// Jaws hold a rectangle of unstrained film, whose orientation the loading gives.
    pub(super) fn check(
        written: &scenario::Stretch,
        scenario: &Scenario,
        mistakes: &mut ModelDiagnostics<'_>,
    ) -> Stretch {
        if !matches!(scenario.specimen.shape, scenario::Shape::Rectangle(_)) {
            mistakes.report_with("specimen.shape", "`loading.stretch` needs a rectangle", "jaws hold straight edges");
            mistakes.label("loading.stretch", "the loading");
        }
        let turned = "`loading.stretch.direction` gives the orientation of the film between the jaws";
        let pulled = "a stretch test pulls an unstrained film between two jaws";
        let keys = [
            ("specimen.md_angle", turned),
            ("impactor", "`loading.stretch` has no impactor"),
            ("layers.prestrain", pulled),
        ];
        out_of_place(&keys, mistakes);
        out_of_place(&OF_IMPACTS, mistakes);
        for place in 0..scenario.layer.len() {
            for (key, why) in [("md_angle", turned), ("prestrain", pulled)] {
                out_of_place(&[(&format!("layer.{place}.{key}"), why)], mistakes);
            }
        }
        Stretch {
            angle: direction(written.direction),
            velocity: written.velocity.0,
            until: written.until,
            mass_scaling: written.mass_scaling,
        }
    }
}

/// Angle from MD to the direction of pull, rad.
fn direction(written: Direction) -> f64 {
    match written {
        Direction::Axis(Axis::Machine) => 0.0,
        Direction::Axis(Axis::Transverse) => FRAC_PI_2,
        Direction::Angle(angle) => angle.0,
    }
}

fn is_jaws(hold: &Hold) -> bool {
    let Hold::Sides(sides) = hold else { return false };
    sides.len() == 2 && sides.contains(&Side::XMinus) && sides.contains(&Side::XPlus)
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
