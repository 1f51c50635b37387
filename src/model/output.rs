//! What is kept of a run.

use super::{Findings, Output};
use crate::scenario::{Filter, Loading, Scenario};

/// Samples per second and hertz of the class below which a recording cannot be filtered. ISO 6487 asks for
/// 8, SAE J211-1 for 10; what is refused here satisfies neither.
const SAMPLES_PER_CLASS_HERTZ: f64 = 8.0;

/// Samples of one channel that a run may keep: 80 MB.
const MOST_SAMPLES: f64 = 1e7;

/// What is kept, with the class as a number.
pub fn check(scenario: &Scenario, findings: &mut Findings<'_>) -> Output {
    let written = &scenario.output;
    let impact = match &scenario.loading {
        Loading::Impact(impact) => Some(impact),
        Loading::Stretch(_) => None,
    };
    let filter = impact.and_then(|_| class(written.filter.unwrap_or(Filter::Cfc1000)));
    let sample_rate = written.sample_rate.0;
    if let Some(class) = filter
        && sample_rate < SAMPLES_PER_CLASS_HERTZ * class
    {
        let least = SAMPLES_PER_CLASS_HERTZ * class / 1e3;
        let message = format!("too few samples for the class CFC{class}");
        let hint = format!("at least {least} kHz (ISO 6487), better {} kHz (SAE J211-1)", class / 100.0);
        findings.report_with("output.sample_rate", message, hint);
    }
    if let Some(impact) = impact
        && impact.duration.0 * sample_rate > MOST_SAMPLES
    {
        let samples = impact.duration.0 * sample_rate;
        let message = format!("{samples:.2e} samples are more than can be kept");
        findings.report("output.sample_rate", message);
    }
    Output { sample_rate, frames: usize::try_from(written.frames).unwrap_or(usize::MAX), filter }
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
