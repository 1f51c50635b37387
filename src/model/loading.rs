//! The loading.

use std::f64::consts::FRAC_PI_2;

use super::{Impactor, Loading, Mistakes, Model};
use crate::mesh::Outline;
use crate::scenario::{self, Axis, Direction, Scenario};

/// Time at constant pressure over the time in which it rises.
const HOLD: f64 = 0.5;

impl Loading {
    /// Simulated time, s; NaN for a stretch of another outline than a rectangle, which is reported separately.
    pub fn run_time(&self, shape: &Outline) -> f64 {
        match (self, shape) {
            (Loading::Impact { duration, .. }, _) => *duration,
            (Loading::Stretch { velocity, until, .. }, Outline::Rectangle { x, .. }) => until * x / velocity,
            (Loading::Stretch { .. }, _) => f64::NAN,
            (Loading::Indent { depth, velocity, .. }, _) => depth / velocity,
            (Loading::Pressure { ramp, .. }, _) => (1.0 + HOLD) * ramp,
        }
    }
}

impl Loading {
    /// The same with the vertical speed that the guide of the impactor admits.
    pub(super) fn with_impactor(self, impactor: Option<&Impactor>) -> Loading {
        match (self, impactor) {
            (Loading::Impact { gravity, duration, .. }, Some(Impactor { velocity: [_, _, upward], .. })) => {
                Loading::Impact { velocity: -upward, gravity, duration }
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
}

const NOT_COMPARED: (&str, &str) = ("reference", "only an impact is compared with a recording");
const NOT_FILTERED: (&str, &str) = ("output.filter", "only an impact has a filtered channel");
const DAMPED: (&str, &str) = ("specimen.damping", "the damping of a quasi-static test follows from its duration");

/// Keys without a meaning under an indentation, and why.
const INDENT: [(&str, &str); 3] = [NOT_COMPARED, NOT_FILTERED, DAMPED];
/// Keys without a meaning under pressure, and why.
const PRESSURE: [(&str, &str); 4] =
    [("impactor", "`loading.pressure` has no impactor"), NOT_COMPARED, NOT_FILTERED, DAMPED];

/// The loading in SI values.
pub fn check(scenario: &Scenario, mistakes: &mut Mistakes<'_>) -> Loading {
    match &scenario.loading {
        scenario::Loading::Impact(impact) => self::impact(impact, scenario.impactor.as_ref(), mistakes),
        scenario::Loading::Stretch(written) => {
            stretched_specimen(scenario, mistakes);
            stretch(written)
        }
        scenario::Loading::Indent(written) => {
            out_of_place(&INDENT, mistakes);
            Loading::Indent { depth: written.depth.0, velocity: written.velocity.0, mass_scaling: written.mass_scaling }
        }
        scenario::Loading::Pressure(written) => {
            out_of_place(&PRESSURE, mistakes);
            Loading::Pressure { pressure: written.pressure.0, ramp: written.ramp.0, mass_scaling: written.mass_scaling }
        }
    }
}

fn impact(written: &scenario::Impact, impactor: Option<&scenario::Impactor>, mistakes: &mut Mistakes<'_>) -> Loading {
    const KEY: &str = "loading.impact";
    let gravity = written.gravity.0;
    let own = impactor.and_then(|impactor| impactor.velocity).map(|[_, _, along]| -along.0);
    let moves =
        impactor.is_none_or(|impactor| !matches!(impactor.guide, scenario::Guide::Fixed | scenario::Guide::Hinge(_)));
    let is_given = written.velocity.is_some() || written.drop_height.is_some();
    if is_given && (own.is_some() || !moves) {
        let key = if written.velocity.is_some() { "velocity" } else { "drop_height" };
        let why = match impactor.map(|impactor| &impactor.guide) {
            Some(scenario::Guide::Fixed) => "the impactor is fixed: film falls onto it by its weight",
            Some(scenario::Guide::Hinge(_)) => "an impactor on a hinge starts with `impactor.spin`",
            _ => "`impactor.velocity` gives the velocity",
        };
        mistakes.out_of_place(&format!("{KEY}.{key}"), why);
    } else if !is_given && own.is_none() && moves {
        let message = "`loading.impact` needs one of `velocity`, `drop_height`";
        mistakes.report_with(KEY, message, "or give `impactor.velocity`, a vector");
    }
    if written.drop_height.is_some() && gravity == 0.0 {
        mistakes.report("loading.impact.gravity", "`drop_height` needs gravity");
        mistakes.label("loading.impact.drop_height", "the drop height");
    }
    let starts_above = impactor.is_some_and(|impactor| impactor.position.len() > 2);
    if starts_above && written.drop_height.is_some() {
        let why = "the impactor falls from the height of `impactor.position`: give its velocity there";
        mistakes.out_of_place(&format!("{KEY}.drop_height"), why);
    }
    let fall = |height: f64| (2.0 * gravity * height).sqrt();
    let velocity = match (written.velocity, written.drop_height) {
        (Some(velocity), _) => velocity.0,
        (None, Some(height)) => fall(height.0),
        (None, None) => own.unwrap_or(0.0),
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

/// Jaws hold a rectangle of unstrained film, whose orientation the loading gives.
fn stretched_specimen(scenario: &Scenario, mistakes: &mut Mistakes<'_>) {
    if !matches!(scenario.specimen.shape, scenario::Shape::Rectangle(_)) {
        mistakes.report_with("specimen.shape", "`loading.stretch` needs a rectangle", "jaws hold straight edges");
        mistakes.label("loading.stretch", "the loading");
    }
    let turned = "`loading.stretch.direction` gives the orientation of the film between the jaws";
    let pulled = "a stretch test pulls an unstrained film between two jaws";
    let keys = [
        ("specimen.md_angle", turned),
        ("impactor", "`loading.stretch` has no impactor"),
        NOT_COMPARED,
        NOT_FILTERED,
        ("layers.prestrain", pulled),
    ];
    out_of_place(&keys, mistakes);
    for place in 0..scenario.layer.len() {
        for (key, why) in [("md_angle", turned), ("prestrain", pulled)] {
            out_of_place(&[(&format!("layer.{place}.{key}"), why)], mistakes);
        }
    }
}

fn out_of_place(keys: &[(&str, &str)], mistakes: &mut Mistakes<'_>) {
    for (path, why) in keys {
        if mistakes.is_written(path) {
            mistakes.out_of_place(path, *why);
        }
    }
}
