//! Impact: bodies fall onto the film.

use serde::{Deserialize, Serialize};

use super::{Impactors, Inertia, Kind, MassScaling, Test};
use crate::mesh::Outline;
use crate::model::impactor::written::{self, Written};
use crate::model::{Guide, Impactor, Model, ModelDiagnostics};
use crate::scenario::{self, Scenario};
use base::number::significant;

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

impl Kind for Impact {
    fn name(&self) -> &'static str {
        "impact"
    }

    fn test(&self) -> Test {
        Test::Impact
    }

    fn inertia(&self) -> Inertia {
        Inertia::Dynamic
    }

    fn mass_scaling(&self) -> MassScaling {
        MassScaling::Unscaled
    }

    fn run_time(&self, _: &Outline) -> f64 {
        self.duration
    }

    fn pace(&self) -> &'static str {
        "duration"
    }

    fn impactors(&self) -> Impactors {
        Impactors::Free
    }

    fn subject(&self, model: &Model, layers: &str) -> String {
        match model.impactors.as_slice() {
            [] => format!("{} m/s on {layers}", significant(self.velocity, 3)),
            [impactor] if impactor.guide == Guide::Fixed => format!("{layers} on a {}", impactor.in_words()),
            [impactor] => format!("{} on {layers}", impactor.in_words()),
            several => {
                let named = |one: &Impactor| format!("{} ({})", one.words(), one.in_words());
                let all: Vec<String> = several.iter().map(named).collect();
                format!("{} on {layers}", all.join(", "))
            }
        }
    }

    fn facts(&self) -> Vec<(&'static str, f64)> {
        vec![("velocity", self.velocity), ("gravity", self.gravity), ("duration", self.duration)]
    }
}

impl Impact {
    pub(super) fn check(
        written: &scenario::Impact,
        scenario: &Scenario,
        mistakes: &mut ModelDiagnostics<'_>,
    ) -> Impact {
        const KEY: &str = "loading.impact";
        let impactors = &written::impactors(scenario, mistakes);
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
        Impact { velocity, gravity, duration: written.duration.0 }
    }
}

/// Whether an impactor starts with a velocity.
fn moves(impactor: &Written<'_>) -> bool {
    !matches!(impactor.guide, scenario::Guide::Fixed | scenario::Guide::Hinge(_))
}
