//! Figures of stretches, indentations and inflations.

use schemars::JsonSchema;
use serde::Serialize;

use crate::post::impact::channel;
use lab::signal::{Recording, column};
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
}

impl Stretch {
    /// Measures of `signals`.
    pub fn measure(outcome: &Outcome, signals: &Recording) -> Stretch {
        let channel = |column| channel(signals, "", column);
        let (strain, stress) = (channel(column::STRAIN), channel(column::STRESS));
        let peak = stress.largest();
        let at_break = outcome.rupture_time.and_then(|rupture| {
            let before = strain.window([f64::NEG_INFINITY, rupture]);
            let time = *before.time().last()?;
            Some((strain.value_at(rupture).or(strain.value_at(time))?, stress.value_at(time)?))
        });
        Stretch {
            peak_force: channel(column::FORCE).largest().map(|[_, force]| force),
            peak_stress: peak.map(|[_, value]| value),
            strain_at_peak_stress: peak.and_then(|[time, _]| strain.value_at(time)),
            strain_at_break: at_break.map(|(strain, _)| strain),
            stress_at_break: at_break.map(|(_, stress)| stress),
            final_strain: strain.values().last().copied(),
        }
    }
}

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
}

impl Indent {
    /// Measures of `signals` under an impactor at `velocity`, m/s.
    pub fn measure(velocity: f64, outcome: &Outcome, signals: &Recording) -> Indent {
        let channel = |column| channel(signals, "", column);
        let (depth, force) = (channel(column::DEPTH), channel(column::FORCE));
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
        }
    }
}

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
}

impl Inflation {
    /// Measures of `signals`.
    pub fn measure(outcome: &Outcome, signals: &Recording) -> Inflation {
        let channel = |column| channel(signals, "", column);
        let (pressure, deflection) = (channel(column::PRESSURE), channel(column::DEFLECTION));
        let last_pressure = pressure.values().last().copied();
        Inflation {
            peak_pressure: pressure.largest().map(|[_, pressure]| pressure),
            peak_deflection: deflection.largest().map(|[_, rise]| rise),
            final_deflection: deflection.values().last().copied(),
            final_volume: channel(column::VOLUME).values().last().copied(),
            settling: outcome.settling,
            burst_pressure: outcome.rupture_time.and(last_pressure),
        }
    }
}
