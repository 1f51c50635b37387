//! The recording and the field that a run is compared with.

use super::impactor::written::{self, Written};
use super::loading::Impact;
use super::{Face, Loading, ModelDiagnostics, Reference, Specimen, Window, field};
use crate::scenario::{self, Guide, Phase, Scenario};
use base::diagnostic::closest;
use base::units::Time;

const WINDOW: &str = "reference.window";

/// The recording, the field and the window of the errors.
pub fn check(
    scenario: &Scenario,
    loading: &Loading,
    specimen: Option<&Specimen>,
    faces: Option<&[Face]>,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Reference> {
    let written = scenario.reference.as_ref()?;
    if written.signals.is_none() && written.field.is_none() {
        mistakes.report_with("reference", "there is nothing to compare with", "name `signals`, a `field`, or both");
        return None;
    }
    let run_time = specimen.map(|specimen| loading.run_time(&specimen.shape));
    let field = written.field.as_ref().map(|field| field::check(field, faces, run_time, mistakes));
    let impactors = written::impactors(scenario, mistakes);
    let place = recorded(written.impactor.as_deref(), &impactors, mistakes);
    let recorded = impactors.get(place);
    let why = match recorded.map(|impactor| &impactor.guide) {
        Some(Guide::Fixed | Guide::Line(_) | Guide::Hinge(_)) => {
            Some("only a falling impactor is compared with a drop".to_owned())
        }
        _ => recorded.filter(|impactor| impactor.position.len() > 2).map(|impactor| {
            let position = impactor.key("position");
            format!("a recording counts from first contact: leave out the height of `{position}`")
        }),
    };
    if let Some(why) = why.filter(|_| written.signals.is_some()) {
        mistakes.out_of_place("reference", why);
    }
    let window = match written.window {
        scenario::Window::Phase(Phase::Loading) => Window::Loading,
        scenario::Window::Phase(Phase::All) => Window::All,
        scenario::Window::Range(range) => Window::Range(self::range(range, loading, mistakes)),
    };
    if written.signals.is_none() {
        let of_signals = [
            "impactor",
            "acceleration",
            "displacement",
            "drop_height",
            "height_error",
            "speed",
            "speed_error",
            "contact_time",
            "contact_error",
            "time_constant",
            "guide_friction",
        ];
        for key in of_signals.map(|key| format!("reference.{key}")) {
            if mistakes.is_written(&key) {
                mistakes.out_of_place(&key, "there are no `signals`");
            }
        }
    }
    let signals = match written.signals {
        Some(_) => Some(mistakes.file("reference.signals")?),
        None => None,
    };
    let field = match field {
        Some(field) => Some(field?),
        None => None,
    };
    let (acceleration, displacement) = (written.acceleration.clone(), written.displacement.clone());
    Some(Reference {
        impactor: place,
        signals,
        acceleration,
        displacement,
        drop_height: written.drop_height.map(|height| height.0),
        height_error: written.height_error.map(|error| error.0),
        speed: written.speed.map(|speed| speed.0),
        speed_error: written.speed_error.map(|error| error.0),
        contact_time: written.contact_time.map(|time| time.0),
        contact_error: written.contact_error.map(|error| error.0),
        time_constant: written.time_constant.map(|time| time.0),
        guide_friction: written.guide_friction.map(|friction| friction.map(|force| force.0)),
        window,
        field,
    })
}

/// Index of the impactor called `name`, the first where none is named.
fn recorded(name: Option<&str>, impactors: &[Written<'_>], mistakes: &mut ModelDiagnostics<'_>) -> usize {
    const KEY: &str = "reference.impactor";
    let Some(name) = name else { return 0 };
    let names = || impactors.iter().filter_map(|impactor| impactor.name.as_deref());
    let place = impactors.iter().position(|impactor| impactor.name.as_deref() == Some(name));
    if place.is_none() {
        let message = format!("there is no impactor \"{name}\"");
        match closest(name, names()) {
            Some(meant) => mistakes.report_with(KEY, message, format!("did you mean \"{meant}\"?")),
            None => mistakes.report(KEY, message),
        }
    }
    place.unwrap_or(0)
}

fn range([from, to]: [Time; 2], loading: &Loading, mistakes: &mut ModelDiagnostics<'_>) -> [f64; 2] {
    if from.0 < 0.0 {
        mistakes.report(&format!("{WINDOW}.0"), "the window starts before first contact");
    }
    if to.0 <= from.0 {
        mistakes.report(&format!("{WINDOW}.1"), "the window ends before it starts");
    }
    if let Some(Impact { duration, .. }) = loading.impact()
        && to.0 > *duration
    {
        let message = format!("the window ends after the run, which takes {}", Time(*duration));
        mistakes.report(&format!("{WINDOW}.1"), message);
        mistakes.label("loading.impact.duration", "the run ends here");
    }
    [from.0, to.0]
}
