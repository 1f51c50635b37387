//! Measures of a slow indentation.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Audit, RunFindings};
use lab::signal::{Recording, Series, column};
use scene::simulate::Outcome;

/// Figures of an indentation; fields of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Indent {
    /// Largest force on the impactor, N.
    #[serde(rename = "peak_force_N")]
    pub peak_force: Option<f64>,
    /// Depth at the largest force.
    #[serde(rename = "depth_at_peak_force_m")]
    pub depth_at_peak_force: Option<f64>,
    /// Work of the impactor: the force over the depth, to the break where the test ends with it, J.
    #[serde(rename = "work_J")]
    pub work: f64,
    /// Depth at rupture; none without one.
    #[serde(rename = "depth_at_break_m")]
    pub depth_at_break: Option<f64>,
    /// Depth at the end of the test.
    #[serde(rename = "final_depth_m")]
    pub final_depth: Option<f64>,
    /// Force at the end of the test.
    #[serde(rename = "final_force_N")]
    pub final_force: Option<f64>,
    /// Size, cost and errors of the run.
    #[serde(flatten)]
    pub audit: Audit,
    /// The findings of the run.
    #[serde(flatten)]
    #[schemars(skip)]
    pub findings: RunFindings,
}

impl Indent {
    /// Measures of `signals` under an impactor at `velocity`, m/s.
    pub fn measure(velocity: f64, outcome: &Outcome, signals: &Recording, findings: RunFindings) -> Indent {
        let channel = |name| signals.series(name).unwrap_or_else(|| Series::new([], []));
        let (depth, force) = (channel(column::DEPTH.name), channel(column::FORCE.name));
        let peak = force.largest();
        let pairs = || depth.values().iter().zip(force.values());
        let slices = pairs().zip(pairs().skip(1));
        let depth_at_break = outcome.rupture_time.map(|time| velocity * time);
        // Between the last sample and the break the force goes on as between the last two.
        let last = slices.clone().next_back().zip(depth_at_break).map(|(((a, f), (b, g)), end)| {
            let rest = (end - b).max(0.0);
            if b > a { rest * (g + 0.5 * rest * (g - f) / (b - a)) } else { 0.0 }
        });
        Indent {
            peak_force: peak.map(|[_, force]| force),
            depth_at_peak_force: peak.and_then(|[time, _]| depth.value_at(time)),
            work: slices.map(|((a, f), (b, g))| 0.5 * (f + g) * (b - a)).sum::<f64>() + last.unwrap_or(0.0),
            depth_at_break,
            final_depth: depth.values().last().copied(),
            final_force: force.values().last().copied(),
            audit: Audit::from_outcome(outcome),
            findings,
        }
    }
}
