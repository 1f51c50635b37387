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

use crate::signal::Series;

/// The reading (m/s²) behind a high pass of `time_constant` (s) that has settled at the first value of `input`.
///
/// Exact for an input that is straight between its samples:
/// r_{k+1} = φ r_k + τ(1 − φ)(x_{k+1} − x_k)/h with φ = exp(−h/τ).
pub fn high_pass(input: &Series, time_constant: f64) -> Series {
    let (time, x) = (input.time(), input.values());
    let mut reading = 0.0;
    let rest = (1..input.len()).map(|k| {
        let (decay, gain) = shares(time[k] - time[k - 1], 1.0 / time_constant);
        reading = decay * reading + gain * (x[k] - x[k - 1]);
        reading
    });
    let first = (!input.is_empty()).then_some(0.0);
    input.with_values(first.into_iter().chain(rest).collect())
}

/// The change of the input (m/s²) since the first sample, where the high pass had settled, from its `reading` and the
/// `inverse` of its time constant (1/s), which is zero for a sensor that holds a constant.
///
/// Undoes [`high_pass`] step by step, so it is exact for the same inputs.
pub fn restored(reading: &Series, inverse: f64) -> Series {
    let (time, r) = (reading.time(), reading.values());
    let mut change = r.first().copied().unwrap_or(0.0);
    let rest = (1..reading.len()).map(|k| {
        let (decay, gain) = shares(time[k] - time[k - 1], inverse);
        change += (r[k] - decay * r[k - 1]) / gain;
        change
    });
    let first = reading.values().first().copied();
    reading.with_values(first.into_iter().chain(rest).collect())
}

/// Factors of a step of length `h` in equation 42: of the reading, φ, and of the change of the input, τ(1 − φ)/h.
pub(super) fn shares(h: f64, inverse: f64) -> (f64, f64) {
    let x = h * inverse;
    let lost = -(-x).exp_m1();
    (1.0 - lost, if x > 0.0 { lost / x } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::integrate;

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
        let back = restored(&high_pass(&input, TAU), 1.0 / TAU);
        let gap = back.values().iter().zip(input.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gap < 1e-12, "{gap}");
    }

    /// The step-by-step inverse against the integral that defines it.
    #[test]
    fn restoring_is_adding_the_integral_over_the_time_constant() {
        let gap = |count| {
            let reading = sampled(count, 0.3, |t| 100.0 * (20.0 * t).sin().powi(2));
            let integral = integrate::once(&reading, 0.0);
            let restored = restored(&reading, 1.0 / TAU);
            let pairs = reading.values().iter().zip(integral.values()).zip(restored.values());
            pairs.map(|((r, i), a)| (r + i / TAU - a).abs()).fold(0.0, f64::max)
        };
        let order = (gap(300) / gap(600)).log2();
        assert!((order - 2.0).abs() < 0.1, "order {order}");
    }
}
