//! AC coupling of an accelerometer, forward and back.
//!
//! A piezoelectric accelerometer cannot hold a constant: behind its first-order high pass of time constant τ the
//! reading `r` of an input `x` follows
//!
//! ```text
//! r = x − L ,   τ L' = x − L
//! ```
//!
//! The input is the proper acceleration p = a + g. At rest L = g and r = 0, so that
//!
//! ```text
//! a(t) = r(t) + (1/τ) ∫ r dt'   from the rest on
//! ```
//!
//! is the exact inverse: it needs neither g nor the reading before the rest.

use thiserror::Error;

use super::fit::least_squares;
use crate::signal::{Series, integrate};

/// Why the time constant of a recording cannot be determined.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CouplingError {
    /// The release ends after the contact.
    #[error(
        "no fall was found: contact, at {contact:.4} s at the latest, comes before the end of the release at {release:.4} s, as \
         where the film never slows the impactor or the recording begins during the fall"
    )]
    NoFall {
        /// End of the release, s.
        release: f64,
        /// Latest contact, s.
        contact: f64,
    },
    /// Fewer samples than a fit needs.
    #[error("the fall between {from:.4} s and {to:.4} s has too few samples for a time constant")]
    TooShort {
        /// Start of the fall, s.
        from: f64,
        /// End of the fall, s.
        to: f64,
    },
    /// The fitted time constant is not positive.
    #[error(
        "the reading does not recover between {from:.4} s and {to:.4} s, so its time constant cannot be determined"
    )]
    NoRecovery {
        /// Start of the fall, s.
        from: f64,
        /// End of the fall, s.
        to: f64,
    },
}

/// Fewest samples of a fall to fit a time constant to.
const FEWEST: usize = 20;

/// The reading (m/s²) behind a high pass of `time_constant` (s) that has settled at the first value of `input`.
///
/// Exact for an input that is straight between its samples:
/// r_{k+1} = φ r_k + τ(1 − φ)(x_{k+1} − x_k)/h with φ = exp(−h/τ).
pub fn high_pass(input: &Series, time_constant: f64) -> Series {
    let (time, x) = (input.time(), input.values());
    let mut reading = 0.0;
    let rest = (1..input.len()).map(|k| {
        let (decay, gain) = shares(time[k] - time[k - 1], time_constant);
        reading = decay * reading + gain * (x[k] - x[k - 1]);
        reading
    });
    let first = (!input.is_empty()).then_some(0.0);
    input.with_values(first.into_iter().chain(rest).collect())
}

/// The change of the input (m/s²) since the first sample, where the high pass had settled, from its `reading`.
///
/// Undoes [`high_pass`] step by step, so it is exact for the same inputs.
pub fn restored(reading: &Series, time_constant: f64) -> Series {
    let (time, r) = (reading.time(), reading.values());
    let mut change = r.first().copied().unwrap_or(0.0);
    let rest = (1..reading.len()).map(|k| {
        let (decay, gain) = shares(time[k] - time[k - 1], time_constant);
        change += (r[k] - decay * r[k - 1]) / gain;
        change
    });
    let first = reading.values().first().copied();
    reading.with_values(first.into_iter().chain(rest).collect())
}

/// Factors of a step of length `h`: of the reading, φ, and of the change of the input, τ(1 − φ)/h.
fn shares(h: f64, time_constant: f64) -> (f64, f64) {
    let lost = -(-h / time_constant).exp_m1();
    (1.0 - lost, lost * time_constant / h)
}

/// The time constant of a fall whose friction is taken as constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FallFit {
    /// s.
    pub time_constant: f64,
    /// Standard error of its inverse by the scatter of the reading, 1/s; that of the assumption is not in it.
    pub error: f64,
}

/// The time constant that makes the fall between `from` and `to` (s) one of constant acceleration.
///
/// `reading` starts at rest, its offset removed. With I = ∫ r dt' from its start, the fall obeys r = −I/τ + a; 1/τ
/// and a are found by linear least squares. It errs where the guide's friction changes during the fall.
pub fn time_constant(reading: &Series, [from, to]: [f64; 2]) -> Result<FallFit, CouplingError> {
    if from >= to {
        return Err(CouplingError::NoFall { release: from, contact: to });
    }
    let integral = integrate::once(reading, 0.0).window([from, to]);
    let reading = reading.window([from, to]);
    if reading.len() < FEWEST {
        return Err(CouplingError::TooShort { from, to });
    }
    let rows = integral.values().iter().zip(reading.values()).map(|(i, r)| ([*i, 1.0], *r));
    match least_squares(rows) {
        Some(([slope, _], left)) if slope < 0.0 => {
            let count = reading.len() as f64;
            let mean = integral.values().iter().sum::<f64>() / count;
            let spread = integral.values().iter().map(|i| (i - mean).powi(2)).sum::<f64>();
            Ok(FallFit { time_constant: -1.0 / slope, error: (left / (count - 2.0) / spread).sqrt() })
        }
        _ => Err(CouplingError::NoRecovery { from, to }),
    }
}

/// The inverse time constant (1/s) with which all of the guide's friction in the fall between `from` and `to` (s) is
/// proportional to the speed, under `gravity` (m/s²); none where the fall is not of this kind.
///
/// With J = ∫ I dt' and the friction k per mass and speed, r + g = −(1/τ + k) I − (k/τ) J: linear in the sum p and the
/// product q of 1/τ and k, the larger root of x² − px + q being the inverse time constant.
pub fn inverse_with_friction_of_speed(reading: &Series, [from, to]: [f64; 2], gravity: f64) -> Option<f64> {
    let integral = integrate::once(reading, 0.0);
    let double = integrate::once(&integral, 0.0).window([from, to]);
    let (integral, reading) = (integral.window([from, to]), reading.window([from, to]));
    let integrals = integral.values().iter().zip(double.values());
    let rows = integrals.zip(reading.values()).map(|((i, j), r)| ([-i, -j], r + gravity));
    let ([sum, product], _) = least_squares(rows)?;
    let inverse = 0.5 * (sum + (sum * sum - 4.0 * product).sqrt());
    (inverse > 0.0 && inverse.is_finite()).then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TAU: f64 = 0.15;

    fn sampled(count: usize, span: f64, f: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..=count).map(|i| span * i as f64 / count as f64).collect();
        let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
        Series::new(time, values)
    }

    fn worst(found: &Series, expected: impl Fn(f64) -> f64) -> f64 {
        found.samples().map(|[t, value]| (value - expected(t)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_ramp_reads_as_the_closed_form() {
        let reading = high_pass(&sampled(50, 0.5, |t| 9.81 - 20.0 * t), TAU);
        let exact = |t: f64| -20.0 * TAU * (1.0 - (-t / TAU).exp());
        assert!(worst(&reading, exact) < 1e-12);
    }

    #[test]
    fn a_sine_has_the_gain_and_phase_of_the_transfer_function() {
        let omega = 2.0 * std::f64::consts::PI * 2.0;
        let error = |count| {
            let reading = high_pass(&sampled(count, 4.0, |t| (omega * t).sin()), TAU).window([3.0, 4.0]);
            let (gain, lead) = (omega * TAU / (omega * TAU).hypot(1.0), (1.0 / (omega * TAU)).atan());
            worst(&reading, |t| gain * (omega * t + lead).sin())
        };
        let order = (error(400) / error(800)).log2();
        assert!((order - 2.0).abs() < 0.05, "order {order}");
    }

    #[test]
    fn the_input_is_restored_with_any_steps() {
        let time: Vec<f64> = (0..200).map(|i| 1e-3 * f64::from(i) + 1e-6 * f64::from(i * i % 37)).collect();
        let values: Vec<f64> = time.iter().map(|t| (40.0 * t).sin() - if *t > 0.1 { 3.0 } else { 0.0 }).collect();
        let input = Series::new(time, values);
        let back = restored(&high_pass(&input, TAU), TAU);
        let gap = back.values().iter().zip(input.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gap < 1e-12, "{gap}");
    }

    /// The step-by-step inverse against the integral that defines it.
    #[test]
    fn restoring_is_adding_the_integral_over_the_time_constant() {
        let gap = |count| {
            let reading = sampled(count, 0.3, |t| 100.0 * (20.0 * t).sin().powi(2));
            let integral = integrate::once(&reading, 0.0);
            let restored = restored(&reading, TAU);
            let pairs = reading.values().iter().zip(integral.values()).zip(restored.values());
            pairs.map(|((r, i), a)| (r + i / TAU - a).abs()).fold(0.0, f64::max)
        };
        let order = (gap(300) / gap(600)).log2();
        assert!((order - 2.0).abs() < 0.1, "order {order}");
    }

    #[test]
    fn a_fall_determines_the_time_constant() {
        let fall = |t: f64| if t < 0.03 { -300.0 * t } else { -9.0 };
        let reading = high_pass(&sampled(5000, 0.5, fall), TAU);
        let found = time_constant(&reading, [0.05, 0.45]).unwrap();
        assert!((found.time_constant / TAU - 1.0).abs() < 1e-4 && found.error < 1e-3, "{found:?}");
    }

    /// u' = g − k u from rest.
    #[test]
    fn a_fall_with_friction_of_the_speed_determines_it_too() {
        let k = 0.3;
        let reading =
            high_pass(&sampled(20_000, 0.5, |t| if t < 0.01 { 0.0 } else { -9.81 * (-k * (t - 0.01)).exp() }), TAU);
        let found = inverse_with_friction_of_speed(&reading, [0.05, 0.45], 9.81).unwrap();
        assert!((found * TAU - 1.0).abs() < 2e-3, "{found}");
        let constant = time_constant(&reading, [0.05, 0.45]).unwrap();
        assert!(constant.time_constant < 0.9 * TAU, "{constant:?}");
    }

    #[test]
    fn a_reading_that_does_not_recover_determines_none() {
        let falling = sampled(500, 0.5, |t| -9.0 - 20.0 * t);
        let (from, to) = (0.1, 0.4);
        assert_eq!(time_constant(&falling, [from, to]), Err(CouplingError::NoRecovery { from, to }));
        assert_eq!(time_constant(&falling, [0.9, 1.0]), Err(CouplingError::TooShort { from: 0.9, to: 1.0 }));
        // Contact before the end of the release: no interval backwards in the message.
        let reversed = time_constant(&falling, [1.0328, 0.5254]).unwrap_err();
        assert_eq!(reversed, CouplingError::NoFall { release: 1.0328, contact: 0.5254 });
        assert!(reversed.to_string().contains("contact, at 0.5254 s at the latest, comes before"), "{reversed}");
    }
}
