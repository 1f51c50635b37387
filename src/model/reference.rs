//! The recording that a run is compared with.

use super::{Mistakes, Reference, Window};
use crate::scenario::{self, Guide, Loading, Phase, Scenario};
use crate::units::Time;

const WINDOW: &str = "reference.window";

/// The recording and the window of the errors.
pub fn check(scenario: &Scenario, mistakes: &mut Mistakes<'_>) -> Option<Reference> {
    let written = scenario.reference.as_ref()?;
    let impactor = scenario.impactor.as_ref();
    let why = match impactor.map(|impactor| &impactor.guide) {
        Some(Guide::Fixed | Guide::Line(_) | Guide::Hinge(_)) => {
            Some("only a falling impactor is compared with a drop")
        }
        _ if impactor.is_some_and(|impactor| impactor.position.len() > 2) => {
            Some("a recording counts from first contact: leave out the height of `impactor.position`")
        }
        _ => None,
    };
    if let Some(why) = why {
        mistakes.out_of_place("reference", why);
    }
    let window = match written.window {
        scenario::Window::Phase(Phase::Loading) => Window::Loading,
        scenario::Window::Phase(Phase::All) => Window::All,
        scenario::Window::Range(range) => Window::Range(self::range(range, scenario, mistakes)),
    };
    let signals = mistakes.file("reference.signals")?;
    let (acceleration, displacement) = (written.acceleration.clone(), written.displacement.clone());
    let drop_height = written.drop_height.map(|height| height.0);
    Some(Reference { signals, acceleration, displacement, drop_height, window })
}

fn range([from, to]: [Time; 2], scenario: &Scenario, mistakes: &mut Mistakes<'_>) -> [f64; 2] {
    if from.0 < 0.0 {
        mistakes.report(&format!("{WINDOW}.0"), "the window starts before first contact");
    }
    if to.0 <= from.0 {
        mistakes.report(&format!("{WINDOW}.1"), "the window ends before it starts");
    }
    if let Loading::Impact(impact) = &scenario.loading
        && to.0 > impact.duration.0
    {
        let message = format!("the window ends after the run, which takes {}", impact.duration);
        mistakes.report(&format!("{WINDOW}.1"), message);
        mistakes.label("loading.impact.duration", "the run ends here");
    }
    [from.0, to.0]
}
