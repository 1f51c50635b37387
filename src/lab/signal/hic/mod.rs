//! The head injury criterion, HIC: the worst interval of a deceleration, by its length and its mean.
//!
//! Versace, *A Review of the Severity Index* (1971), SAE 710881; windows of 15 and 36 ms after 49 CFR 571.208.

mod pulse;
mod search;

use super::Series;
use super::gap;
use crate::error::{Error, refusal};
use base::number::significant;
use base::units::STANDARD_GRAVITY;
use pulse::Pulse;
use search::Search;

/// The interval with the largest (t₂ − t₁)·(mean of a in g)^2.5, equation 62.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hic {
    /// The criterion; its unit is s by convention, and never written.
    pub value: f64,
    /// When the interval starts, s.
    pub start: f64,
    /// When it ends, s.
    pub end: f64,
    /// Mean acceleration in it, m/s².
    pub mean: f64,
}

/// The longest interval of HIC36, s.
pub const LONG_WINDOW: f64 = 0.036;

/// HIC(d): what a dummy's head would have shown where a free-motion head form showed the criterion `hic36` over at most
/// 36 ms. 49 CFR 571.201, S7.
pub fn dummy_equivalent(hic36: f64) -> f64 {
    0.75446 * hic36 + 166.4
}

/// The head injury criterion of an acceleration (m/s², deceleration positive, or the resultant) over intervals of at
/// most `window` s.
///
/// The acceleration is taken as linear between samples. All pairs of samples are compared, and the ends of the best
/// pair are then moved between samples, so a window need not be a multiple of the step, which need not be even.
pub fn head_injury_criterion(series: &Series, window: f64) -> Result<Hic, Error> {
    if window.is_nan() || window <= 0.0 {
        return Err(refusal!("a window of {} s is not positive", significant(window, 9)));
    }
    if series.len() < 2 {
        return Err(refusal!("the head injury criterion needs two samples, found {}", series.len()));
    }
    gap::check(series)?;
    let never_positive = || {
        refusal!(
            "the mean acceleration is positive between no two samples (deceleration must be, or give the resultant)"
        )
    };
    let peak = series.values().iter().copied().fold(0.0, f64::max);
    if peak == 0.0 {
        return Err(never_positive());
    }
    let pulse = Pulse::new(series, peak);
    let pair = Search::new(&pulse, window).best_pair();
    let pair = pair.ok_or_else(|| refusal!("no two samples lie within a window of {} s", significant(window, 9)))?;
    let [start, end] = pulse.refined(pair, window);
    let length = end - start;
    let mean = peak * (pulse.speed_at(end) - pulse.speed_at(start)) / length;
    // A single positive sample between negative ones gives no pair a positive mean.
    if mean <= 0.0 {
        return Err(never_positive());
    }
    Ok(Hic { value: length * (mean / STANDARD_GRAVITY).powf(2.5), start, end, mean })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    const G: f64 = STANDARD_GRAVITY;

    /// A pulse of `peak` g and `length` s in the middle of 100 ms, `shape` running from −1 to 1 over it.
    fn pulse(peak: f64, length: f64, step: f64, shape: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..=(0.1 / step).round() as usize).map(|i| i as f64 * step).collect();
        let share = |t: f64| (t - 0.05) / (0.5 * length);
        let value = |t: &f64| if share(*t).abs() <= 1.0 + 1e-9 { peak * G * shape(share(*t)) } else { 0.0 };
        let values: Vec<f64> = time.iter().map(value).collect();
        Series::new(time, values)
    }

    fn hic(series: &Series, milliseconds: f64) -> Hic {
        head_injury_criterion(series, 1e-3 * milliseconds).unwrap()
    }

    /// Every pair of samples.
    fn by_force(series: &Series, window: f64) -> f64 {
        let (time, values) = (series.time(), series.values());
        let mut best: f64 = 0.0;
        for from in 0..time.len() {
            let mut rise = 0.0;
            for to in from + 1..time.len() {
                rise += 0.5 * (values[to] + values[to - 1]) * (time[to] - time[to - 1]);
                let length = time[to] - time[from];
                if length <= window * (1.0 + 1e-9) && rise > 0.0 {
                    best = best.max(length * (rise / length / G).powf(2.5));
                }
            }
        }
        best
    }

    /// Values that look like noise, the same in every run.
    fn noise(count: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn a_square_pulse_counts_for_its_length_or_the_windows() {
        let square = pulse(50.0, 0.02, 1e-4, |_| 1.0);
        let hic15 = hic(&square, 15.0);
        assert!((hic15.value - 265.165).abs() < 5e-4, "{hic15:?}");
        assert!((hic15.end - hic15.start - 0.015).abs() < 1e-12 && (hic15.mean - 50.0 * G).abs() < 1e-9);
        // Its flanks, a sample long each, contribute a little.
        let (hic36, exact) = (hic(&square, 36.0).value, 50f64.powf(2.5) * 0.02);
        assert!(hic36 >= exact && hic36 < 1.01 * exact, "{hic36} for {exact}");
    }

    #[test]
    fn a_half_sine_has_the_value_of_its_closed_form() {
        let length = 0.02;
        let sine = pulse(80.0, length, 1e-5, |x| (FRAC_PI_2 * x).cos());
        let of_angle = |angle: f64| length * 2.0 * angle / PI * (80.0 * angle.sin() / angle).powf(2.5);
        // The best interval ends where the pulse is 0.6 of its mean: tan φ = 5/3 φ.
        let mut angle: f64 = 1.0;
        for _ in 0..200 {
            angle = (5.0 / 3.0 * angle).atan();
        }
        let free = hic(&sine, 36.0);
        assert!((free.value / of_angle(angle) - 1.0).abs() < 1e-6, "{free:?} for {}", of_angle(angle));
        assert!((free.end - free.start - length * 2.0 * angle / PI).abs() < 1e-6);
        let short = hic(&sine, 8.0);
        assert!((short.value / of_angle(PI * 0.008 / (2.0 * length)) - 1.0).abs() < 1e-6);
        assert!((0.5 * (short.start + short.end) - 0.05).abs() < 1e-6);
    }

    #[test]
    fn a_triangle_has_the_value_of_its_closed_form() {
        let (length, peak) = (0.03, 60f64);
        let triangle = pulse(peak, length, 1e-4, |x| 1.0 - x.abs());
        let of_share = |share: f64| share * length * (peak * (1.0 - 0.5 * share)).powf(2.5);
        // It ends at 0.6 of its mean where 1 − x = 0.6 (1 − x/2).
        let free = hic(&triangle, 36.0);
        assert!((free.value / of_share(4.0 / 7.0) - 1.0).abs() < 1e-9, "{free:?}");
        let short = hic(&triangle, 15.0);
        assert!((short.value / of_share(0.5) - 1.0).abs() < 1e-9, "{short:?}");
    }

    #[test]
    fn ends_lie_between_samples_where_the_step_does_not_divide_the_window() {
        let triangle = pulse(60.0, 0.08, 7e-4, |x| 1.0 - x.abs());
        let top = triangle.largest().unwrap();
        let found = hic(&triangle, 15.0);
        assert!((found.end - found.start - 0.015).abs() < 1e-9, "{found:?}");
        let fine = Series::new(
            (0..=100_000).map(|i| i as f64 * 1e-6).filter(|t| *t < 0.0994).collect::<Vec<_>>(),
            (0..=100_000).map(|i| triangle.value_at(i as f64 * 1e-6).unwrap_or(0.0)).collect::<Vec<_>>(),
        );
        assert!((hic(&fine, 15.0).value / found.value - 1.0).abs() < 1e-6, "around {top:?}");
    }

    #[test]
    fn the_search_finds_the_best_of_all_pairs() {
        for seed in 0..12 {
            let count = 150 + 97 * seed as usize;
            let steps = noise(count, seed + 100);
            let even = seed % 2 == 0;
            let time: Vec<f64> = steps
                .iter()
                .scan(0.0, |t, s| {
                    *t += if even { 1e-4 } else { 1e-4 * (0.2 + s) };
                    Some(*t)
                })
                .collect();
            let offset = [0.0, 0.5, 0.3][seed as usize % 3];
            let wave = |t: f64| 0.4 * (400.0 * t).sin();
            let noisy = noise(count, seed).into_iter().zip(&time).map(|(v, t)| 900.0 * (v - offset + wave(*t)));
            let series = Series::new(time.clone(), noisy.collect::<Vec<_>>());
            for window in [5e-4, 0.004, 0.015, 1.0] {
                let (found, least) = (head_injury_criterion(&series, window).unwrap().value, by_force(&series, window));
                assert!(found >= least * (1.0 - 1e-12), "seed {seed}, {window} s: {found} below {least}");
                assert!(found <= least * 1.5, "seed {seed}, {window} s: {found} far above {least}");
            }
        }
    }

    #[test]
    fn series_without_a_criterion_are_refused() {
        let line = |values: Vec<f64>| Series::new((0..values.len()).map(|i| i as f64).collect::<Vec<_>>(), values);
        for (values, window, expected) in [
            (vec![1.0], 0.015, "the head injury criterion needs two samples, found 1"),
            (vec![1.0, f64::NAN], 0.015, "nothing was measured at 1 s"),
            (vec![-1.0, -2.0], 2.0, "the mean acceleration is positive between no two samples"),
            (vec![-10.0, 1.0, -10.0], 2.0, "the mean acceleration is positive between no two samples"),
            (vec![1.0, 2.0], 0.015, "no two samples lie within a window of 0.015 s"),
            (vec![1.0, 2.0], 0.0, "a window of 0 s is not positive"),
        ] {
            let error = head_injury_criterion(&line(values), window).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    /// A cost quadratic in the samples would take hours.
    #[test]
    fn a_million_samples_are_searched() {
        let time: Vec<f64> = (0..1_000_000).map(|i| i as f64 * 1e-6).collect();
        let values: Vec<f64> = noise(time.len(), 7).into_iter().map(|v| 50.0 * G + v).collect();
        let found = hic(&Series::new(time, values), 15.0);
        assert!((found.value / 265.165 - 1.0).abs() < 0.01, "{found:?}");
    }
}
