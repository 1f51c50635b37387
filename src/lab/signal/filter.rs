//! The channel filter of impact testing: a Butterworth low pass of second order run forward and backward.
//!
//! ISO 6487 (Annex A) and SAE J211-1 (Appendix C) give the same recursion and differ in one constant.

use std::f64::consts::{PI, SQRT_2};

use super::{Series, gap, resample};
use crate::error::{Error, refusal};

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

/// The channel frequency classes that both standards define.
pub const CLASSES: [f64; 4] = [1000.0, 600.0, 180.0, 60.0];

/// The recursion yᵢ = b·(xᵢ, xᵢ₋₁, xᵢ₋₂) + a·(yᵢ₋₁, yᵢ₋₂) of both standards.
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
    pub fn new(class: f64, interval: f64, standard: Standard) -> Result<ChannelFilter, Error> {
        if class.is_nan() || class <= 0.0 {
            return Err(refusal!("a channel frequency class of {class} is not positive"));
        }
        let rate = 1.0 / interval;
        if rate.is_nan() || rate < 10.0 * class * (1.0 - 1e-6) {
            return Err(refusal!("CFC {class} needs at least {} samples a second, found {rate:.1}", 10.0 * class));
        }
        let wd = 2.0 * PI * class * standard.corner_over_class();
        // The tangent undoes the warping of frequencies by the bilinear transform: the corner is the same at any rate.
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
    ///
    /// The difference from the chord between first and last value is filtered (equation 61). A zero-phase filter of
    /// unit gain passes lines, so this changes only the start of both passes, which then distorts neither a constant
    /// nor a ramp.
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        if values.len() < 2 {
            return values.to_vec();
        }
        let chord = Chord::through_ends(values);
        let padding = self.padding.min(values.len() - 1);
        let mut rest = chord.reflected_rest(values, padding);
        // Backward too, so that the phases cancel (ISO 6487, Annex A).
        self.pass(mean(rest.iter()), rest.iter_mut());
        self.pass(mean(rest.iter().rev()), rest.iter_mut().rev());
        rest.truncate(padding + values.len());
        rest.drain(..padding);
        rest.iter_mut().enumerate().for_each(|(index, value)| *value += chord.value_at(index));
        rest
    }

    /// One pass in place, whose first two results are `start`.
    fn pass<'a>(&self, start: f64, mut values: impl Iterator<Item = &'a mut f64>) {
        let [b0, b1, b2] = self.b;
        let [a1, a2] = self.a;
        let (mut x2, mut x1) = (0.0, 0.0);
        for value in values.by_ref().take(2) {
            (x2, x1) = (x1, *value);
            *value = start;
        }
        let (mut y2, mut y1) = (start, start);
        for value in values {
            let x0 = *value;
            // The term that depends on the last result comes last.
            let y0 = (b0 * x0 + b1 * x1 + b2 * x2 + a2 * y2) + a1 * y1;
            *value = y0;
            (x2, x1) = (x1, x0);
            (y2, y1) = (y1, y0);
        }
    }
}

/// The line from the first value of a record to the last.
struct Chord {
    first: f64,
    slope: f64,
}

impl Chord {
    fn through_ends(values: &[f64]) -> Chord {
        let last = values.len() - 1;
        Chord { first: values[0], slope: (values[last] - values[0]) / last as f64 }
    }

    fn value_at(&self, index: usize) -> f64 {
        self.first + self.slope * index as f64
    }

    /// The difference from the line, with `padding` samples before and after, reflected through the end points.
    fn reflected_rest(&self, values: &[f64], padding: usize) -> Vec<f64> {
        let last = values.len() - 1;
        let rest = |index: usize| values[index] - self.value_at(index);
        let mut padded = Vec::with_capacity(values.len() + 2 * padding);
        // Point reflection continues value and slope, a mirror only the value.
        padded.extend((1..=padding).rev().map(|i| 2.0 * rest(0) - rest(i)));
        padded.extend((0..=last).map(rest));
        padded.extend((1..=padding).map(|i| 2.0 * rest(last) - rest(last - i)));
        padded
    }
}

/// Mean of the first ten values, from which the standards start a pass.
fn mean<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let (sum, count) = values.take(10).fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// The series through the channel filter of `class`; it must be complete and equally spaced.
pub fn channel(series: &Series, class: f64, standard: Standard) -> Result<Series, Error> {
    gap::check(series)?;
    let interval = resample::common_step(series.time()).ok_or_else(|| {
        refusal!("the samples are not equally spaced, as the channel filter needs")
            .with_hint("bring it to equal steps: --resample \"10 kHz\"")
    })?;
    let filter = ChannelFilter::new(class, interval, standard)?;
    Ok(series.with_values(filter.apply(series.values())))
}

#[cfg(test)]
mod tests {
    use super::*;

    const INTERVAL: f64 = 1e-5;

    fn filter(class: f64) -> ChannelFilter {
        ChannelFilter::new(class, INTERVAL, Standard::Iso6487).unwrap()
    }

    /// Response to a sine in the middle of a long record: amplitude over the amplitude that went in, and phase in
    /// radians.
    fn response(filter: &ChannelFilter, frequency: f64, interval: f64) -> [f64; 2] {
        // A Hann window over many cycles suppresses the ends and other frequencies in the projection.
        let count = (60.0 / (frequency * interval)) as usize + 4000;
        let angle = |i: usize| 2.0 * PI * frequency * i as f64 * interval;
        let out = filter.apply(&(0..count).map(|i| angle(i).sin()).collect::<Vec<_>>());
        let weight = |i: usize| (PI * i as f64 / count as f64).sin().powi(4);
        let project = |wave: fn(f64) -> f64, values: &dyn Fn(usize) -> f64| {
            (0..count).map(|i| weight(i) * wave(angle(i)) * values(i)).sum::<f64>()
        };
        let (sine, cosine) = (project(f64::sin, &|i| out[i]), project(f64::cos, &|i| out[i]));
        [sine.hypot(cosine) / project(f64::sin, &|i| angle(i).sin()), (cosine / sine).atan()]
    }

    /// Gain of both passes of the bilinear Butterworth filter.
    fn analytic_gain(corner: f64, frequency: f64, interval: f64) -> f64 {
        let ratio = (PI * frequency * interval).tan() / (PI * corner * interval).tan();
        1.0 / (1.0 + ratio.powi(4))
    }

    /// The recursion as both standards print it, with their padding and start; `k` is the constant.
    fn as_printed(values: &[f64], class: f64, t: f64, k: f64) -> Vec<f64> {
        let wd = 2.0 * PI * class * k;
        let wa = (wd * t / 2.0).tan();
        let b0 = wa.powi(2) / (1.0 + 2.0f64.sqrt() * wa + wa.powi(2));
        let (b1, b2) = (2.0 * b0, b0);
        let a1 = -2.0 * (wa.powi(2) - 1.0) / (1.0 + 2.0f64.sqrt() * wa + wa.powi(2));
        let a2 = (-1.0 + 2.0f64.sqrt() * wa - wa.powi(2)) / (1.0 + 2.0f64.sqrt() * wa + wa.powi(2));
        let (last, add) = (values.len() - 1, ((0.01 / t) as usize).max(100).min(values.len() - 1));
        let mut x: Vec<f64> = (0..add).map(|i| 2.0 * values[0] - values[add - i]).collect();
        x.extend(values);
        x.extend((0..add).map(|i| 2.0 * values[last] - values[last - 1 - i]));
        for _ in 0..2 {
            let mut y = vec![x[..10].iter().sum::<f64>() / 10.0; x.len()];
            for i in 2..x.len() {
                y[i] = b0 * x[i] + b1 * x[i - 1] + b2 * x[i - 2] + a1 * y[i - 1] + a2 * y[i - 2];
            }
            y.reverse();
            x = y;
        }
        x[add..=add + last].to_vec()
    }

    fn furthest(a: &[f64], b: &[f64]) -> f64 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_ramp_passes_unchanged() {
        for (count, slope, start) in [(6000, 1e-2, 0.0), (57, -3.0, 40.0), (2, 1.0, 0.0)] {
            let ramp: Vec<f64> = (0..count).map(|i| start + slope * i as f64).collect();
            let size = ramp.iter().fold(0.0, |size, v| f64::max(size, v.abs()));
            for class in CLASSES {
                let off = furthest(&ramp, &filter(class).apply(&ramp));
                assert!(off <= 4.0 * f64::EPSILON * size, "CFC {class}: off by {off} of {size}");
            }
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
    fn it_is_the_printed_recursion_for_what_starts_and_ends_at_zero() {
        let half_sine = |i: usize| if (500..=700).contains(&i) { (PI * (i - 500) as f64 / 200.0).sin() } else { 0.0 };
        let pulse: Vec<f64> = (0..3000).map(half_sine).collect();
        for class in CLASSES {
            for (standard, k) in [(Standard::Iso6487, 2.08333), (Standard::SaeJ211, 2.0775)] {
                let ours = ChannelFilter::new(class, INTERVAL, standard).unwrap().apply(&pulse);
                let off = furthest(&ours, &as_printed(&pulse, class, INTERVAL, k));
                assert!(off < 1e-12, "CFC {class}, {standard:?}: off by {off}");
            }
        }
    }

    #[test]
    fn it_is_the_printed_recursion_but_for_the_starts_of_its_passes() {
        let curve: Vec<f64> = (0..600).map(|i| 0.3 - (0.01 * i as f64).sin() + 0.2 * (0.07 * i as f64).cos()).collect();
        for class in [1000.0, 600.0, 180.0] {
            let ours = ChannelFilter::new(class, 1e-4, Standard::Iso6487).unwrap().apply(&curve);
            let off = furthest(&ours, &as_printed(&curve, class, 1e-4, 2.08333));
            assert!(off < 1e-6, "CFC {class}: off by {off}");
        }
    }

    #[test]
    fn sines_come_out_with_the_analytic_gain_and_no_phase() {
        for (standard, k) in [(Standard::Iso6487, 2.08333), (Standard::SaeJ211, 2.0775)] {
            for class in CLASSES {
                for share in [0.5, 1.0, 5.0 / 3.0, 3.0] {
                    let filter = ChannelFilter::new(class, INTERVAL, standard).unwrap();
                    let [gain, phase] = response(&filter, share * class, INTERVAL);
                    let expected = analytic_gain(k * class, share * class, INTERVAL);
                    assert!((gain / expected - 1.0).abs() < 1e-5, "CFC {class} at {share}: {gain} for {expected}");
                    assert!(phase.abs() < 1e-6, "CFC {class} at {share}: {phase} rad");
                }
            }
        }
    }

    /// Lowest and highest gain (dB) that SAE J211-1 and ISO 6487 allow a data channel, their figures 1 from memory:
    /// ±0.5 dB at low frequencies, +0.5/−1 dB up to F_H, the class, +0.5/−4 dB at F_N, from where on the gain falls by
    /// at least 9 and at most 24 dB an octave, until it is below −30 dB.
    fn corridor(class: f64, frequency: f64) -> [f64; 2] {
        let edge = match class {
            1000.0 => 1650.0,
            600.0 => 1000.0,
            180.0 => 300.0,
            _ => 100.0,
        };
        let octaves = (frequency / edge).log2();
        match frequency {
            f if f <= 0.1 * class => [-0.5, 0.5],
            f if f <= class => [-1.0, 0.5],
            f if f <= edge => [-1.0 - 3.0 * (f / class).log2() / (edge / class).log2(), 0.5],
            _ => [-4.0 - 24.0 * octaves, f64::max(0.5 - 9.0 * octaves, -30.0)],
        }
    }

    #[test]
    fn the_gain_lies_in_the_corridor_of_the_standard() {
        for standard in [Standard::Iso6487, Standard::SaeJ211] {
            for class in CLASSES {
                for rate in [10.0 * class, 12.5 * class, 20.0 * class, 100.0 * class] {
                    let filter = ChannelFilter::new(class, 1.0 / rate, standard).unwrap();
                    // Near half the sampling rate the standards' own bilinear filter falls faster than they allow.
                    let frequencies = (-12..=20).map(|i| class * 2.0f64.powf(i as f64 / 6.0));
                    let frequencies = frequencies.filter(|frequency| *frequency < 0.29 * rate);
                    for frequency in frequencies {
                        let decibels = 20.0 * response(&filter, frequency, 1.0 / rate)[0].log10();
                        let [lowest, highest] = corridor(class, frequency);
                        let inside = (lowest..=highest).contains(&decibels);
                        assert!(
                            inside,
                            "CFC {class}, {rate} 1/s, {frequency} Hz: {decibels} not in {lowest}..{highest}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn gaps_and_uneven_steps_are_refused() {
        let uneven = Series::new(vec![0.0, 1e-5, 5e-5], vec![0.0; 3]);
        let gap = Series::new(vec![0.0, 1e-5, 2e-5], vec![0.0, f64::NAN, 0.0]);
        let hole = Series::new(vec![0.0, 1e-5, 2e-5, 9e-5], vec![0.0; 4]);
        let refused = |series: &Series| channel(series, 60.0, Standard::Iso6487).unwrap_err();
        let begins = |series: &Series, words: &str| refused(series).message().starts_with(words);
        assert!(refused(&hole).hint().is_none() && begins(&hole, "there are no samples between"));
        assert!(begins(&uneven, "the samples are not equally spaced"));
        assert_eq!(refused(&gap).to_string(), "nothing was measured at 0.00001 s");
    }

    #[test]
    fn constants_of_any_length_pass_unchanged() {
        for class in CLASSES {
            let is_same = |count: usize| filter(class).apply(&vec![9.81; count]) == vec![9.81; count];
            assert!((0..30).chain([3000]).all(is_same), "CFC {class}");
        }
    }
}
