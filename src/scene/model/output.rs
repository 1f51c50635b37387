//! The signals and snapshots that a run records, the script behind it, and its time step.

use std::path::PathBuf;

use super::loading::Test;
use super::{Loading, ModelDiagnostics, Output, Solver, Specimen};
use crate::scenario::{Filter, Scenario};
use base::units::Time;

/// Least samples per second and hertz of the class. ISO 6487 requires 8, SAE J211-1 requires 10; what is refused
/// satisfies neither.
const SAMPLES_PER_CLASS_HERTZ: f64 = 8.0;

/// Most samples of one channel: 80 MB.
const MOST_SAMPLES: f64 = 1e7;

/// Fewest samples of one channel.
const FEWEST_SAMPLES: f64 = 10.0;

const PATH: &str = "output.sample_rate";

/// Sampling, snapshots, and the class as a number.
pub fn check(
    scenario: &Scenario,
    loading: &Loading,
    specimen: Option<&Specimen>,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Output {
    let written = &scenario.output;
    let is_filtered = loading.test() == Test::Impact;
    let filter = is_filtered.then(|| written.filter.unwrap_or(Filter::Cfc1000)).and_then(class);
    let sample_rate = written.sample_rate.0;
    if let Some(class) = filter
        && sample_rate < SAMPLES_PER_CLASS_HERTZ * class
    {
        let least = SAMPLES_PER_CLASS_HERTZ * class / 1e3;
        let message = format!("too few samples for the class CFC{class}");
        let hint = format!("at least {least} kHz (ISO 6487), better {} kHz (SAE J211-1)", class / 100.0);
        mistakes.report_with(PATH, message, hint);
    }
    if let Some(specimen) = specimen {
        samples(loading, loading.run_time(&specimen.shape), sample_rate, mistakes);
    }
    Output { sample_rate, frames: usize::try_from(written.frames).unwrap_or(usize::MAX), filter, motion: None }
}

/// Refuses too few and too many samples.
fn samples(loading: &Loading, time: f64, sample_rate: f64, mistakes: &mut ModelDiagnostics<'_>) {
    let samples = time * sample_rate;
    let path = if mistakes.is_written(PATH) { PATH.to_owned() } else { loading.key(loading.pace()) };
    let hint = format!("the run takes {}", Time(time));
    if samples > MOST_SAMPLES {
        let message = format!("{samples:.1e} samples exceed the limit of {MOST_SAMPLES:e}");
        mistakes.report_with(&path, message, hint);
    } else if (0.0..FEWEST_SAMPLES).contains(&samples) {
        let message = format!("the run ends before {FEWEST_SAMPLES} samples are taken");
        mistakes.report_with(&path, message, hint);
    }
}

fn class(filter: Filter) -> Option<f64> {
    match filter {
        Filter::Cfc1000 => Some(1000.0),
        Filter::Cfc600 => Some(600.0),
        Filter::Cfc180 => Some(180.0),
        Filter::Cfc60 => Some(60.0),
        Filter::None => None,
    }
}

/// The solver's settings; their range is the language's own.
pub fn check_solver(scenario: &Scenario) -> Solver {
    let solver = &scenario.solver;
    Solver { step_factor: solver.step_factor, smallest_step: solver.smallest_step.map(|step| step.0) }
}

/// The script that adds to the summary.
pub fn check_post(scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Option<PathBuf> {
    scenario.post.as_ref()?;
    mistakes.file("post.script")
}
