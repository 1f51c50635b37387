//! Values between samples: linear interpolation, and a time axis of equal steps.

use super::Series;
use crate::error::{Error, refusal};
use base::number::significant;

/// Most samples a resampled series may have; a smaller step is taken for a mistake.
pub const MOST_SAMPLES: usize = 20_000_000;

/// The series at other `times`; `NaN` where it has no value.
pub fn onto(series: &Series, times: &[f64]) -> Vec<f64> {
    times.iter().map(|t| series.value_at(*t).unwrap_or(f64::NAN)).collect()
}

/// The series on equal steps (s) from its first sample to its last.
pub fn uniform(series: &Series, step: f64) -> Result<Series, Error> {
    let &[first, .., last] = series.time() else {
        return Err(too_short(series.len()));
    };
    if step.is_nan() || step <= 0.0 {
        return Err(refusal!("a time step of {} s is not positive", significant(step, 9)));
    }
    let span = last - first;
    let steps = (span / step * (1.0 + 1e-12)).floor();
    if steps >= MOST_SAMPLES as f64 {
        let [step, span] = [step, span].map(|time| significant(time, 9));
        return Err(refusal!("a time step of {step} s over {span} s gives more than {MOST_SAMPLES} samples"));
    }
    let times: Vec<f64> = (0..=steps as usize).map(|i| (first + i as f64 * step).min(last)).collect();
    let values = onto(series, &times);
    Ok(Series::new(times, values))
}

/// Refuses a series of so few samples.
pub(crate) fn too_short(count: usize) -> Error {
    refusal!("a series of {count} samples cannot be resampled")
}

/// The common step (s) where all samples lie within 1 % of a step from equal spacing.
pub fn common_step(time: &[f64]) -> Option<f64> {
    let &[first, .., last] = time else {
        return None;
    };
    let step = (last - first) / (time.len() - 1) as f64;
    let straight = |(i, t): (usize, &f64)| (t - (first + i as f64 * step)).abs() <= 0.01 * step;
    time.iter().enumerate().all(straight).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_keeps_its_values_on_other_times() {
        let line = Series::new(vec![0.0, 0.3, 0.4, 1.0], vec![1.0, 1.6, 1.8, 3.0]);
        let fine = uniform(&line, 0.01).unwrap();
        assert_eq!(fine.len(), 101);
        for [t, v] in fine.samples() {
            assert!((v - (1.0 + 2.0 * t)).abs() < 1e-12, "{v} at {t}");
        }
    }

    #[test]
    fn there_are_no_values_outside_the_samples_or_beside_gaps() {
        let gap = Series::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.0, f64::NAN, 2.0, 3.0]);
        assert_eq!(gap.value_at(-0.1), None);
        assert_eq!(gap.value_at(3.1), None);
        assert_eq!(gap.value_at(0.5), None);
        assert_eq!(gap.value_at(1.0), None);
        assert_eq!(gap.value_at(2.0), Some(2.0));
        assert_eq!(gap.value_at(3.0), Some(3.0));
    }

    #[test]
    fn equal_steps_are_recognised_and_unequal_ones_not() {
        let even: Vec<f64> = (0..1000).map(|i| i as f64 * 1e-4).collect();
        assert!((common_step(&even).unwrap() - 1e-4).abs() < 1e-15);
        assert_eq!(common_step(&[0.0, 1.0, 3.0]), None);
        assert_eq!(common_step(&[0.0]), None);
    }

    #[test]
    fn invalid_steps_are_refused() {
        let line = Series::new(vec![0.0, 1.0], vec![0.0, 1.0]);
        let refused = |step| uniform(&line, step).unwrap_err().to_string();
        assert_eq!(refused(0.0), "a time step of 0 s is not positive");
        assert!(refused(1e-12).contains("gives more than 20000000 samples"));
    }
}
