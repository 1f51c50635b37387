//! What is done to the specimen.

use std::f64::consts::FRAC_PI_2;

use super::{Findings, Loading, Model, Shape};
use crate::scenario::{self, Axis, Direction, Scenario};

impl Model {
    /// Simulated time, s; zero for a stretch of a shape that jaws cannot hold, which is a mistake of its own.
    pub fn run_time(&self) -> f64 {
        match (&self.loading, &self.specimen.shape) {
            (Loading::Impact { duration, .. }, _) => *duration,
            (Loading::Stretch { velocity, until, .. }, Shape::Rectangle { x, .. }) => until * x / velocity,
            (Loading::Stretch { .. }, _) => 0.0,
        }
    }
}

/// The loading in SI values.
pub fn check(scenario: &Scenario, findings: &mut Findings<'_>) -> Loading {
    match &scenario.loading {
        scenario::Loading::Impact(impact) => self::impact(impact, findings),
        scenario::Loading::Stretch(written) => {
            stretched_specimen(scenario, findings);
            stretch(written)
        }
    }
}

fn impact(written: &scenario::Impact, findings: &mut Findings<'_>) -> Loading {
    let gravity = written.gravity.0;
    if written.drop_height.is_some() && gravity == 0.0 {
        findings.report("loading.impact.gravity", "nothing falls from `drop_height` without gravity");
    }
    let fall = |height: f64| (2.0 * gravity * height).sqrt();
    let velocity = match (written.velocity, written.drop_height) {
        (Some(velocity), _) => velocity.0,
        (None, height) => height.map_or(0.0, |h| fall(h.0)),
    };
    Loading::Impact { velocity, gravity, duration: written.duration.0 }
}

fn stretch(written: &scenario::Stretch) -> Loading {
    Loading::Stretch {
        angle: direction(written.direction),
        velocity: written.velocity.0,
        until: written.until,
        mass_scaling: written.mass_scaling,
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

/// Jaws pull one flat, unstrained, straight-edged film in a direction that the loading alone names.
fn stretched_specimen(scenario: &Scenario, findings: &mut Findings<'_>) {
    if !matches!(scenario.specimen.shape, scenario::Shape::Rectangle(_)) {
        findings.report_with("specimen.shape", "`loading.stretch` needs a rectangle", "jaws hold straight edges");
    }
    let turned = "`loading.stretch.direction` says how the film lies between the jaws";
    let pulled = "a stretch test pulls an unstrained film between two jaws";
    for (path, why) in [
        ("specimen.md_angle", turned),
        ("impactor", "`loading.stretch` has no impactor"),
        ("reference", "only an impact is compared with a recording"),
        ("output.filter", "only an impact has a filtered channel"),
        ("layers.prestrain", pulled),
    ] {
        if findings.is_written(path) {
            findings.out_of_place(path, why);
        }
    }
    for place in 0..scenario.layer.len() {
        for (key, why) in [("md_angle", turned), ("prestrain", pulled)] {
            let path = format!("layer.{place}.{key}");
            if findings.is_written(&path) {
                findings.out_of_place(&path, why);
            }
        }
    }
}
