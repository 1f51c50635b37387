//! Measures of a coupon or a single element pulled between two jaws.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Audit, RunFindings};
use lab::signal::{Recording, Series, column};
use scene::simulate::Outcome;

/// Figures of a tensile test; fields of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Stretch {
    /// Largest force between the jaws, N.
    #[serde(rename = "peak_force_N")]
    pub peak_force: Option<f64>,
    /// Largest nominal stress, Pa.
    #[serde(rename = "peak_stress_Pa")]
    pub peak_stress: Option<f64>,
    /// Engineering strain at the largest stress.
    pub strain_at_peak_stress: Option<f64>,
    /// Engineering strain at the first rupture, after which film that tears may still hold; none without one.
    pub strain_at_break: Option<f64>,
    /// Nominal stress at the last sample before the rupture, Pa; none without one.
    #[serde(rename = "stress_at_break_Pa")]
    pub stress_at_break: Option<f64>,
    /// Engineering strain at the end of the test.
    pub final_strain: Option<f64>,
    /// Size, cost and errors of the run.
    #[serde(flatten)]
    pub audit: Audit,
    /// The findings of the run.
    #[serde(flatten)]
    #[schemars(skip)]
    pub findings: RunFindings,
}

impl Stretch {
    /// Measures of `signals`.
    pub fn measure(outcome: &Outcome, signals: &Recording, findings: RunFindings) -> Stretch {
        let channel = |name| signals.series(name).unwrap_or_else(|| Series::new([], []));
        let (strain, stress) = (channel(column::STRAIN.name), channel(column::STRESS.name));
        let peak = stress.largest();
        let at_break = outcome.rupture_time.and_then(|rupture| {
            let before = strain.window([f64::NEG_INFINITY, rupture]);
            let time = *before.time().last()?;
            Some((strain.value_at(rupture).or(strain.value_at(time))?, stress.value_at(time)?))
        });
        Stretch {
            peak_force: channel(column::FORCE.name).largest().map(|[_, force]| force),
            peak_stress: peak.map(|[_, value]| value),
            strain_at_peak_stress: peak.and_then(|[time, _]| strain.value_at(time)),
            strain_at_break: at_break.map(|(strain, _)| strain),
            stress_at_break: at_break.map(|(_, stress)| stress),
            final_strain: strain.values().last().copied(),
            audit: Audit::from_outcome(outcome),
            findings,
        }
    }
}
