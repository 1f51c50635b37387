//! The distance of two signals: the relative error of the paper's equations 14 and 15.

use super::Series;
use crate::error::{Error, refusal};
use base::number::significant;

/// Relative error ‖s − e‖/‖e‖ over the samples of the reference `e` with `from <= time <= to`.
///
/// The signal `s` is read between its samples at the times of the reference. Samples at which the
/// reference was not measured do not count. The norm is Euclidean over samples (Polymers 2021, 13,
/// 1537, equations 14 and 15; equation 16 prints the same sum without the norm).
pub fn relative_error(signal: &Series, reference: &Series, window: [f64; 2]) -> Result<f64, Error> {
    let Compared { difference, size, .. } = compare(signal, reference, window)?;
    Ok((difference.iter().map(|d| d * d).sum::<f64>() / size).sqrt())
}

/// The differences (s − e)/‖e‖ at the samples that [`relative_error`] counts; their norm is that error.
pub fn relative_residuals(signal: &Series, reference: &Series, window: [f64; 2]) -> Result<Series, Error> {
    let Compared { time, difference, size } = compare(signal, reference, window)?;
    let norm = size.sqrt();
    Ok(Series::new(time, difference.iter().map(|d| d / norm).collect::<Vec<f64>>()))
}

struct Compared {
    time: Vec<f64>,
    /// s − e
    difference: Vec<f64>,
    /// ‖e‖²
    size: f64,
}

fn compare(signal: &Series, reference: &Series, [from, to]: [f64; 2]) -> Result<Compared, Error> {
    let mut compared = Compared { time: vec![], difference: vec![], size: 0.0 };
    let window = reference.window([from, to]);
    for [time, expected] in window.samples().filter(|[_, value]| value.is_finite()) {
        let found = signal.value_at(time).ok_or_else(|| {
            refusal!("the signal has no value at {} s, where the reference has one", significant(time, 9))
        })?;
        compared.time.push(time);
        compared.difference.push(found - expected);
        compared.size += expected.powi(2);
    }
    let between = || format!("between {} s and {} s", significant(from, 9), significant(to, 9));
    if compared.time.is_empty() {
        return Err(refusal!("the reference has no sample {}", between()));
    }
    if compared.size == 0.0 {
        return Err(refusal!("the reference is zero everywhere {}", between()));
    }
    Ok(compared)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [f64; 2] = [0.0, 1.0];

    fn sampled(count: usize, f: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64).collect();
        let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
        Series::new(time, values)
    }

    #[test]
    fn a_signal_ten_per_cent_high_is_off_by_a_tenth() {
        let reference = sampled(100, |t| (9.0 * t).sin());
        let high = sampled(100, |t| 1.1 * (9.0 * t).sin());
        assert!((relative_error(&high, &reference, ALL).unwrap() - 0.1).abs() < 1e-12);
    }

    #[test]
    fn different_time_axes_meet_on_the_samples_of_the_reference() {
        let reference = sampled(10, |t| 1.0 + t);
        let fine = sampled(777, |t| 1.0 + t);
        assert!(relative_error(&fine, &reference, ALL).unwrap() < 1e-12);
    }

    #[test]
    fn errors_of_both_signs_do_not_cancel() {
        let reference = sampled(100, |_| 1.0);
        let wavy = sampled(100, |t| 1.0 + (100.0 * std::f64::consts::PI * t).cos());
        assert!((relative_error(&wavy, &reference, ALL).unwrap() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn only_the_window_counts_and_only_what_was_measured() {
        let reference = sampled(100, |t| if t > 0.5 { f64::NAN } else { 2.0 });
        let late = sampled(100, |t| if t < 0.25 { 7.0 } else { 2.0 });
        assert_eq!(relative_error(&late, &reference, [0.25, 1.0]).unwrap(), 0.0);
    }

    #[test]
    fn curves_that_cannot_be_compared_are_refused() {
        let line = sampled(10, |t| t);
        let half = line.window([0.0, 0.5]);
        let zero = sampled(10, |_| 0.0);
        for (signal, reference, window, expected) in [
            (&line, &line, [2.0, 3.0], "the reference has no sample between 2 s and 3 s"),
            (&half, &line, ALL, "the signal has no value at 0.6 s, where the reference has one"),
            (&line, &zero, ALL, "the reference is zero everywhere between 0 s and 1 s"),
        ] {
            assert_eq!(relative_error(signal, reference, window).unwrap_err().to_string(), expected);
        }
    }
}
