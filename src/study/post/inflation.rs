//! Measures of a slow inflation.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Audit, RunFindings};
use lab::signal::{Recording, Series, column};
use scene::simulate::Outcome;

/// Figures of an inflation; fields of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Inflation {
    /// Largest pressure on the film.
    #[serde(rename = "peak_pressure_Pa")]
    pub peak_pressure: Option<f64>,
    /// Largest deflection of the highest point.
    #[serde(rename = "peak_deflection_m")]
    pub peak_deflection: Option<f64>,
    /// Deflection at the end of the test, where the pressure is constant.
    #[serde(rename = "final_deflection_m")]
    pub final_deflection: Option<f64>,
    /// Volume under the film at the end of the test.
    #[serde(rename = "final_volume_m3")]
    pub final_volume: Option<f64>,
    /// Change of the deflection over the last tenth of the test, over the deflection; small at rest.
    pub settling: Option<f64>,
    /// Pressure at the last sample before the rupture; none without one.
    #[serde(rename = "burst_pressure_Pa")]
    pub burst_pressure: Option<f64>,
    /// Size, cost and errors of the run.
    #[serde(flatten)]
    pub audit: Audit,
    /// The findings of the run.
    #[serde(flatten)]
    #[schemars(skip)]
    pub findings: RunFindings,
}

impl Inflation {
    /// Measures of `signals`.
    pub fn measure(outcome: &Outcome, signals: &Recording, findings: RunFindings) -> Inflation {
        let channel = |name| signals.series(name).unwrap_or_else(|| Series::new([], []));
        let (pressure, deflection) = (channel(column::PRESSURE.name), channel(column::DEFLECTION.name));
        let last_pressure = pressure.values().last().copied();
        Inflation {
            peak_pressure: pressure.largest().map(|[_, pressure]| pressure),
            peak_deflection: deflection.largest().map(|[_, rise]| rise),
            final_deflection: deflection.values().last().copied(),
            final_volume: channel(column::VOLUME.name).values().last().copied(),
            settling: outcome.settling,
            burst_pressure: outcome.rupture_time.and(last_pressure),
            audit: Audit::from_outcome(outcome),
            findings,
        }
    }
}
