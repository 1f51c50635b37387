//! The channel filter of impact testing: a Butterworth low pass of second order run forward and backward.
//!
//! ISO 6487 (Annex A) and SAE J211-1 (Appendix C) give the same recursion and differ in one constant.

use std::f64::consts::{PI, SQRT_2};

use thiserror::Error;

use super::{Series, resample};

/// Which standard's constant ties the corner frequency to the class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Standard {
    /// ISO 6487: ω = 2π · 2.08333 · class.
    #[default]
    Iso6487,
    /// SAE J211-1: ω = 2π · 2.0775 · class.
    SaeJ211,
}

impl Standard {
    fn corner_over_class(self) -> f64 {
        match self {
            Standard::Iso6487 => 2.08333,
            Standard::SaeJ211 => 2.0775,
        }
    }
}

/// Why a series cannot be filtered.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FilterError {
    #[error("a channel frequency class of {class} is not positive")]
    Class { class: f64 },
    #[error("CFC {class} needs at least {} samples a second, found {rate:.1}", 10.0 * class)]
    RateTooLow { class: f64, rate: f64 },
    #[error("the samples are not equally spaced, as the channel filter needs")]
    NotUniform,
    #[error("nothing was measured at {time} s")]
    NotMeasured { time: f64 },
}

/// The recursion yᵢ = b·(xᵢ, xᵢ₋₁, xᵢ₋₂) + a·(yᵢ₋₁, yᵢ₋₂).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelFilter {
    b: [f64; 3],
    a: [f64; 2],
    /// Samples added before and after a long record.
    padding: usize,
}

impl ChannelFilter {
    /// The filter of a channel frequency class (1000, 600, 180, 60 or any other number) at a sample interval in s.
    ///
    /// Errors where the rate lies below ten times the class, as both standards ask.
    pub fn new(class: f64, interval: f64, standard: Standard) -> Result<ChannelFilter, FilterError> {
        if class.is_nan() || class <= 0.0 {
            return Err(FilterError::Class { class });
        }
        let rate = 1.0 / interval;
        if rate.is_nan() || rate < 10.0 * class * (1.0 - 1e-6) {
            return Err(FilterError::RateTooLow { class, rate });
        }
        let wd = 2.0 * PI * class * standard.corner_over_class();
        let wa = (wd * interval / 2.0).tan();
        let denominator = 1.0 + SQRT_2 * wa + wa * wa;
        let b0 = wa * wa / denominator;
        Ok(ChannelFilter {
            b: [b0, 2.0 * b0, b0],
            a: [-2.0 * (wa * wa - 1.0) / denominator, (-1.0 + SQRT_2 * wa - wa * wa) / denominator],
            padding: (0.01 / interval).round().max(100.0) as usize,
        })
    }

    /// The filtered values: no phase shift, same length.
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        if values.len() < 2 {
            return values.to_vec();
        }
        let padding = self.padding.min(values.len() - 1);
        let mut padded = reflected(values, padding);
        self.pass(&mut padded);
        padded.reverse();
        self.pass(&mut padded);
        padded.reverse();
        padded[padding..padding + values.len()].to_vec()
    }

    /// One pass in place, started from the mean of the first ten samples.
    fn pass(&self, values: &mut [f64]) {
        let [b0, b1, b2] = self.b;
        let [a1, a2] = self.a;
        let head = &values[..values.len().min(10)];
        let mean = head.iter().sum::<f64>() / head.len() as f64;
        let (mut x2, mut x1) = (values[0], values[1]);
        let (mut y2, mut y1) = (mean, mean);
        values[..2].fill(mean);
        for value in &mut values[2..] {
            let x0 = *value;
            *value = b0 * x0 + b1 * x1 + b2 * x2 + a1 * y1 + a2 * y2;
            (x2, x1) = (x1, x0);
            (y2, y1) = (y1, *value);
        }
    }
}

/// `values` with `padding` samples before and after, reflected through the end points.
fn reflected(values: &[f64], padding: usize) -> Vec<f64> {
    let last = values.len() - 1;
    let before = (1..=padding).rev().map(|i| 2.0 * values[0] - values[i]);
    let after = (1..=padding).map(|i| 2.0 * values[last] - values[last - i]);
    before.chain(values.iter().copied()).chain(after).collect()
}

/// The series through the channel filter of `class`; it must be complete and equally spaced.
pub fn channel(series: &Series, class: f64, standard: Standard) -> Result<Series, FilterError> {
    if let Some([time, _]) = series.samples().find(|[_, value]| !value.is_finite()) {
        return Err(FilterError::NotMeasured { time });
    }
    let interval = resample::common_step(series.time()).ok_or(FilterError::NotUniform)?;
    let filter = ChannelFilter::new(class, interval, standard)?;
    Ok(series.with_values(filter.apply(series.values())))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLASSES: [f64; 4] = [1000.0, 600.0, 180.0, 60.0];
    const INTERVAL: f64 = 1e-5;

    fn filter(class: f64) -> ChannelFilter {
        ChannelFilter::new(class, INTERVAL, Standard::Iso6487).unwrap()
    }

    /// Amplitude of a filtered sine in the middle of a long record over the amplitude that went in.
    fn measured_gain(class: f64, frequency: f64) -> f64 {
        let per_cycle = 1.0 / (frequency * INTERVAL);
        let count = (per_cycle * 40.0) as usize + 4000;
        let sine = |i: usize| (2.0 * PI * frequency * i as f64 * INTERVAL).sin();
        let out = filter(class).apply(&(0..count).map(sine).collect::<Vec<_>>());
        let middle = count / 4..3 * count / 4;
        let power = |f: &dyn Fn(usize) -> f64| middle.clone().map(|i| f(i).powi(2)).sum::<f64>();
        (power(&|i| out[i]) / power(&sine)).sqrt()
    }

    /// Gain of both passes of the bilinear Butterworth filter.
    fn analytic_gain(class: f64, frequency: f64) -> f64 {
        let wa = (PI * class * 2.08333 * INTERVAL).tan();
        let ratio = (PI * frequency * INTERVAL).tan() / wa;
        1.0 / (1.0 + ratio.powi(4))
    }

    #[test]
    fn a_constant_passes_unchanged() {
        for class in CLASSES {
            let out = filter(class).apply(&[9.81; 3000]);
            assert!(out.iter().all(|v| (v - 9.81).abs() < 1e-8), "CFC {class}");
        }
    }

    #[test]
    fn a_ramp_passes_unchanged() {
        let ramp: Vec<f64> = (0..6000).map(|i| 1e-2 * i as f64).collect();
        for class in CLASSES {
            let out = filter(class).apply(&ramp);
            let worst = ramp.iter().zip(&out).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // What the start of each pass leaves behind after the padding, against the ramp's 60.
            assert!(worst < 1e-4 * 60.0, "CFC {class}: off by {worst}");
        }
    }

    #[test]
    fn a_pulse_keeps_its_time() {
        let pulse: Vec<f64> = (0..4001).map(|i| (-((i as f64 - 2000.0) / 300.0).powi(2)).exp()).collect();
        for class in CLASSES {
            let out = filter(class).apply(&pulse);
            let peak = (0..out.len()).max_by(|a, b| out[*a].total_cmp(&out[*b])).unwrap();
            assert_eq!(peak, 2000, "CFC {class}");
            let skew = (0..2000).map(|i| (out[i] - out[4000 - i]).abs()).fold(0.0, f64::max);
            assert!(skew < 1e-6, "CFC {class}: skewed by {skew}");
        }
    }

    #[test]
    fn sines_come_out_with_the_analytic_gain() {
        for class in CLASSES {
            for share in [0.5, 1.0, 5.0 / 3.0, 3.0] {
                let (found, expected) = (measured_gain(class, share * class), analytic_gain(class, share * class));
                assert!((found - expected).abs() < 3e-3, "CFC {class} at {share}: {found} for {expected}");
            }
        }
    }

    #[test]
    fn three_decibels_are_lost_near_five_thirds_of_the_class() {
        for class in CLASSES {
            let decibels = 20.0 * measured_gain(class, 5.0 / 3.0 * class).log10();
            assert!((decibels + 3.0).abs() < 0.1, "CFC {class}: {decibels} dB");
        }
    }

    /// Corridor of SAE J211-1, figure 1, from memory: +0.5/−1 dB at the class, +0.5/−4 dB at 1.65 of it, then
    /// between −9 and −24 dB an octave.
    #[test]
    fn the_gain_lies_in_the_corridor_of_the_standard() {
        for class in CLASSES {
            for (share, lowest, highest) in [(0.1, -0.5, 0.5), (1.0, -1.0, 0.5), (1.65, -4.0, 0.5), (3.3, -28.0, -8.5)]
            {
                let decibels = 20.0 * measured_gain(class, share * class).log10();
                assert!((lowest..=highest).contains(&decibels), "CFC {class} at {share}: {decibels} dB");
            }
        }
    }

    #[test]
    fn the_standards_differ_in_one_constant() {
        let iso = ChannelFilter::new(1000.0 * 2.0775 / 2.08333, INTERVAL, Standard::Iso6487).unwrap();
        let sae = ChannelFilter::new(1000.0, INTERVAL, Standard::SaeJ211).unwrap();
        assert!((iso.b[0] - sae.b[0]).abs() < 1e-12);
    }

    #[test]
    fn a_rate_too_low_is_refused_and_named() {
        let error = ChannelFilter::new(1000.0, 1e-3, Standard::Iso6487).unwrap_err();
        assert_eq!(error.to_string(), "CFC 1000 needs at least 10000 samples a second, found 1000.0");
        assert!(ChannelFilter::new(1000.0, 1e-4, Standard::Iso6487).is_ok());
    }

    #[test]
    fn gaps_and_uneven_steps_are_refused() {
        let uneven = Series::new(vec![0.0, 1e-5, 5e-5], vec![0.0; 3]);
        let gap = Series::new(vec![0.0, 1e-5, 2e-5], vec![0.0, f64::NAN, 0.0]);
        assert_eq!(channel(&uneven, 60.0, Standard::Iso6487), Err(FilterError::NotUniform));
        assert_eq!(channel(&gap, 60.0, Standard::Iso6487), Err(FilterError::NotMeasured { time: 1e-5 }));
    }

    #[test]
    fn short_records_are_filtered_too() {
        for count in 0..30 {
            let out = filter(60.0).apply(&vec![2.0; count]);
            assert_eq!(out.len(), count);
            assert!(out.iter().all(|v| (v - 2.0).abs() < 1e-8));
        }
    }
}
