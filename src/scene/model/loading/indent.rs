//! Indentation: an impactor is pressed slowly into the film.

mod depth;

use serde::{Deserialize, Serialize};

use super::rules::{DAMPED, OF_IMPACTS, out_of_place};
use super::{Impactors, Inertia, Kind, MassScaling, Refusal, Test};
use crate::mesh::{Outline, Side};
use crate::model::{Hold, Impactor, Model, ModelDiagnostics};
use crate::scenario::{self, Scenario};
use base::number::significant;
pub(in crate::model) use depth::check as depth;

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

impl Kind for Indent {
    fn name(&self) -> &'static str {
        "indent"
    }

    fn test(&self) -> Test {
        Test::Indent { velocity: self.velocity }
    }

    fn inertia(&self) -> Inertia {
        Inertia::Negligible
    }

    fn mass_scaling(&self) -> MassScaling {
        self.mass_scaling.into()
    }

    fn run_time(&self, _: &Outline) -> f64 {
        self.depth / self.velocity
    }

    fn pace(&self) -> &'static str {
        "velocity"
    }

    fn impactors(&self) -> Impactors {
        Impactors::Prescribed
    }

    fn refuses_hold(&self, hold: &Hold) -> Option<Refusal> {
        let message = "the film is not held on both sides of the impactor";
        let hint = "hold \"all\", or at least two opposite sides";
        (!is_spanned(hold)).then_some(Refusal::Unsupported { message, hint })
    }

    fn subject(&self, model: &Model, layers: &str) -> String {
        let body = model.impactor().map_or("body", Impactor::body);
        let [depth, velocity] = [self.depth * 1e3, self.velocity].map(|value| significant(value, 3));
        format!("{body} {depth} mm into {layers} at {velocity} m/s")
    }

    fn facts(&self) -> Vec<(&'static str, f64)> {
        vec![("depth", self.depth), ("velocity", self.velocity)]
    }
}

impl Indent {
    pub(super) fn check(written: &scenario::Indent, _: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Indent {
        out_of_place(&OF_IMPACTS, mistakes);
        out_of_place(&[DAMPED], mistakes);
        Indent { depth: written.depth.0, velocity: written.velocity.0, mass_scaling: written.mass_scaling }
    }
}

/// Whether two opposite sides are held.
fn is_spanned(hold: &Hold) -> bool {
    let both = |a, b| hold.holds(a) && hold.holds(b);
    both(Side::XMinus, Side::XPlus) || both(Side::YMinus, Side::YPlus)
}
