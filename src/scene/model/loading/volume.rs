//! Inflation by gas that is let in under the film.

use serde::{Deserialize, Serialize};

use super::rules::{DAMPED, OF_IMPACTS, gas_time, out_of_place};
use super::{Inertia, Kind, MassScaling, Test};
use crate::mesh::Outline;
use crate::model::{Model, ModelDiagnostics};
use crate::scenario::{self, Scenario};
use base::number::significant;

/// An inflation by a volume of gas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Volume {
    /// Final volume under the whole film, m³.
    pub volume: f64,
    /// Time in which it is let in, s.
    pub ramp: f64,
    /// Factor on the film's mass; `None` chooses it from the periods of the film.
    pub mass_scaling: Option<f64>,
}

impl Kind for Volume {
    fn name(&self) -> &'static str {
        "volume"
    }

    fn test(&self) -> Test {
        Test::Inflation
    }

    fn inertia(&self) -> Inertia {
        Inertia::Negligible
    }

    fn mass_scaling(&self) -> MassScaling {
        self.mass_scaling.into()
    }

    fn run_time(&self, _: &Outline) -> f64 {
        gas_time(self.ramp)
    }

    fn pace(&self) -> &'static str {
        "ramp"
    }

    fn is_by_gas(&self) -> bool {
        true
    }

    fn refuses_faces(&self) -> Option<&'static str> {
        Some("gas is let in under one face; `loading.pressure` acts on several")
    }

    fn subject(&self, _: &Model, layers: &str) -> String {
        format!("{} l of gas under {layers}", significant(self.volume * 1e3, 3))
    }

    fn facts(&self) -> Vec<(&'static str, f64)> {
        vec![("volume", self.volume), ("ramp", self.ramp)]
    }
}

impl Volume {
    pub(super) fn check(written: &scenario::Filling, _: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Volume {
        out_of_place(&[("impactor", "`loading.volume` has no impactor"), DAMPED], mistakes);
        out_of_place(&OF_IMPACTS, mistakes);
        Volume { volume: written.volume.0, ramp: written.ramp.0, mass_scaling: written.mass_scaling }
    }
}
