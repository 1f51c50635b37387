//! Inflation: a pressure on the lower side of the film.

use serde::{Deserialize, Serialize};

use super::rules::{DAMPED, OF_IMPACTS, gas_time, out_of_place};
use super::{Inertia, Kind, MassScaling, Test};
use crate::mesh::Outline;
use crate::model::{Model, ModelDiagnostics};
use crate::scenario::{self, Scenario};
use base::number::significant;

/// An inflation by a pressure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pressure {
    /// Final pressure, Pa.
    pub pressure: f64,
    /// Time in which it rises, s.
    pub ramp: f64,
    /// Factor on the film's mass; `None` chooses it from the periods of the film.
    pub mass_scaling: Option<f64>,
}

impl Kind for Pressure {
    fn name(&self) -> &'static str {
        "pressure"
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

    fn subject(&self, _: &Model, layers: &str) -> String {
        format!("{} kPa under {layers}", significant(self.pressure * 1e-3, 3))
    }

    fn facts(&self) -> Vec<(&'static str, f64)> {
        vec![("pressure", self.pressure), ("ramp", self.ramp)]
    }
}

impl Pressure {
    pub(super) fn check(written: &scenario::Inflation, _: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Pressure {
        out_of_place(&[("impactor", "`loading.pressure` has no impactor"), DAMPED], mistakes);
        out_of_place(&OF_IMPACTS, mistakes);
        Pressure { pressure: written.pressure.0, ramp: written.ramp.0, mass_scaling: written.mass_scaling }
    }
}
