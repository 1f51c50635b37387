//! The loading.

mod indent;

use std::f64::consts::FRAC_PI_2;

use super::impactor::{self, Written};
use super::{Impactor, Loading, Model, ModelDiagnostics};
use crate::mesh::Outline;
use crate::scenario::{self, Axis, Direction, Scenario};
pub(super) use indent::depth;

/// Time at constant pressure over the time in which it rises.
const HOLD: f64 = 0.5;

impl Loading {
    /// Whether gas presses on the film.
    pub fn is_by_gas(&self) -> bool {
        matches!(self, Loading::Pressure { .. } | Loading::Volume { .. })
    }

    /// Simulated time, s; NaN for a stretch of another outline than a rectangle, which is reported separately.
    pub fn run_time(&self, shape: &Outline) -> f64 {
        match (self, shape) {
            (Loading::Impact { duration, .. }, _) => *duration,
            (Loading::Stretch { velocity, until, .. }, Outline::Rectangle { x, .. }) => until * x / velocity,
            (Loading::Stretch { .. }, _) => f64::NAN,
            (Loading::Indent { depth, velocity, .. }, _) => depth / velocity,
            (Loading::Pressure { ramp, .. } | Loading::Volume { ramp, .. }, _) => (1.0 + HOLD) * ramp,
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
/// Keys without a meaning where gas is let in, and why.
const VOLUME: [(&str, &str); 4] =
    [("impactor", "`loading.volume` has no impactor"), NOT_COMPARED, NOT_FILTERED, DAMPED];

/// The loading in SI values.
pub fn check(scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Loading {
    match &scenario.loading {
        scenario::Loading::Impact(impact) => self::impact(impact, &impactor::written(scenario, mistakes), mistakes),
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
        scenario::Loading::Volume(written) => {
            out_of_place(&VOLUME, mistakes);
            Loading::Volume { volume: written.volume.0, ramp: written.ramp.0, mass_scaling: written.mass_scaling }
        }
    }
}

fn impact(written: &scenario::Impact, impactors: &[Written<'_>], mistakes: &mut ModelDiagnostics<'_>) -> Loading {
    const KEY: &str = "loading.impact";
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
        mistakes.out_of_place(&format!("{KEY}.{key}"), why);
    } else if !is_given && is_missing {
        let message = "`loading.impact` needs one of `velocity`, `drop_height`";
        let own = taking.map_or_else(|| "impactor.velocity".to_owned(), |impactor| impactor.key("velocity"));
        mistakes.report_with(KEY, message, format!("or give `{own}`, a vector"));
    }
    if written.drop_height.is_some() && gravity == 0.0 {
        mistakes.report("loading.impact.gravity", "`drop_height` needs gravity");
        mistakes.label("loading.impact.drop_height", "the drop height");
    }
    let above = impactors.iter().find(|impactor| impactor.position.len() > 2 && takes(impactor));
    if let Some(above) = above.filter(|_| written.drop_height.is_some()) {
        let height = above.key("position");
        let why = format!("the impactor falls from the height of `{height}`: give its velocity there");
        mistakes.out_of_place(&format!("{KEY}.drop_height"), why);
    }
    let fall = |height: f64| (2.0 * gravity * height).sqrt();
    let own = impactors.first().and_then(|impactor| impactor.velocity).map(|[_, _, along]| -along.0);
    let velocity = match (written.velocity, written.drop_height) {
        (Some(velocity), _) => velocity.0,
        (None, Some(height)) => fall(height.0),
        (None, None) => own.unwrap_or(0.0),
    };
    Loading::Impact { velocity, gravity, duration: written.duration.0 }
}

/// Whether an impactor starts with a velocity.
fn moves(impactor: &Written<'_>) -> bool {
    !matches!(impactor.guide, scenario::Guide::Fixed | scenario::Guide::Hinge(_))
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
fn stretched_specimen(scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) {
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

fn out_of_place(keys: &[(&str, &str)], mistakes: &mut ModelDiagnostics<'_>) {
    for (path, why) in keys {
        if mistakes.is_written(path) {
            mistakes.out_of_place(path, *why);
        }
    }
}
