//! How well one signal follows another: the objective rating of ISO/TS 18571 for signals without ambiguity.
//!
//! Four ratings between 0 and 1 and their weighted sum, equation 64. The curves are compared at 10 kHz and equal
//! length, as the specification requires; the warnings of the rating report how they were resampled.

mod magnitude;
mod phase;

use std::fmt;

use self::magnitude::relative;
use super::gap;
use super::warning::Warning;
use super::{Series, resample};
use crate::error::{Error, refusal};
use base::number::{clean_time, significant};

pub use super::curve::Curve;

/// Samples a second at which curves are rated.
pub const RATE: f64 = 10_000.0;

/// Fewest samples that leave the nine of the slope's moving average at the largest shift.
const FEWEST: usize = 11;

/// Most samples that are rated: the warping compares a fifth of their square.
const MOST: usize = 100_000;

/// The four ratings, the overall one, and how they came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Rating {
    /// Z: how much of the comparison lies close to the reference.
    pub corridor: f64,
    /// E_P: how little the comparison has to be shifted to correlate best.
    pub phase: f64,
    /// E_M: how little values differ after the shift and a warping of time.
    pub magnitude: f64,
    /// E_S: how little slopes differ after the shift.
    pub slope: f64,
    /// R = 0.4 Z + 0.2 E_P + 0.2 E_M + 0.2 E_S.
    pub overall: f64,
    /// The word for `overall`.
    pub grade: Grade,
    /// By how much the comparison is late, s; negative where it is early.
    pub shift: f64,
    /// Samples of each curve at [`RATE`].
    pub samples: usize,
    /// How the curves were resampled, and what puts the rating in doubt.
    pub warnings: Vec<Warning>,
}

/// Grades of ISO/TS 18571.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grade {
    /// Above 0.94.
    Excellent,
    /// Above 0.80.
    Good,
    /// Above 0.58.
    Fair,
    /// The rest.
    Poor,
}

impl Grade {
    /// The grade of an overall rating.
    pub fn from_rating(overall: f64) -> Grade {
        match overall {
            r if r > 0.94 => Grade::Excellent,
            r if r > 0.80 => Grade::Good,
            r if r > 0.58 => Grade::Fair,
            _ => Grade::Poor,
        }
    }
}

impl fmt::Display for Grade {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Grade::Excellent => "excellent",
            Grade::Good => "good",
            Grade::Fair => "fair",
            Grade::Poor => "poor",
        })
    }
}

/// Rates `comparison` against `reference` over the time that both cover.
pub fn rate(reference: &Series, comparison: &Series) -> Result<Rating, Error> {
    let span = common_span(reference, comparison)?;
    let curves = [(Curve::Reference, reference), (Curve::Comparison, comparison)];
    for (curve, series) in curves {
        gap::check(&series.window(span)).map_err(|gap| Error::from(gap).about(curve))?;
    }
    let samples = sample_count(span)?;
    let [r, c] = [reference, comparison].map(|series| sampled(series, span[0], samples));
    if r.iter().all(|value| *value == 0.0) {
        let [from, to] = span.map(|time| significant(time, 9));
        return Err(refusal!("the reference is zero everywhere between {from} s and {to} s"));
    }
    let mut rating = rate_curves(&r, &c);
    rating.warnings = curves.into_iter().filter_map(|(curve, series)| change(curve, series, span, samples)).collect();
    if phase::is_flat(&c) {
        rating.warnings.push(Warning::ConstantCurve);
    }
    Ok(rating)
}

/// The rating of curves of equal length at [`RATE`].
fn rate_curves(reference: &[f64], comparison: &[f64]) -> Rating {
    let shift = phase::best_shift(reference, comparison);
    let [r, c] = shift.cut(reference, comparison);
    // Corridor and phase are of the whole curves, magnitude and slope of what the shift leaves.
    let (corridor, phase) = (corridor_rating(reference, comparison), shift.rating(reference.len()));
    let (magnitude, slope) = (magnitude::rating(r, c), slope_rating(r, c));
    let overall = 0.4 * corridor + 0.2 * phase + 0.2 * magnitude + 0.2 * slope;
    Rating {
        corridor,
        phase,
        magnitude,
        slope,
        overall,
        grade: Grade::from_rating(overall),
        shift: shift.samples() as f64 / RATE,
        samples: reference.len(),
        warnings: Vec::new(),
    }
}

fn common_span(reference: &Series, comparison: &Series) -> Result<[f64; 2], Error> {
    let ends = |curve, series: &Series| match *series.time() {
        [] => Err(refusal!("the {curve} has no samples")),
        [only] => Ok([only, only]),
        [first, .., last] => Ok([first, last]),
    };
    let (r, c) = (ends(Curve::Reference, reference)?, ends(Curve::Comparison, comparison)?);
    let span = [r[0].max(c[0]), r[1].min(c[1])];
    if span[0] > span[1] {
        let [[r0, r1], [c0, c1]] = [r, c].map(|ends| ends.map(|time| significant(time, 9)));
        return Err(refusal!(
            "the curves have no time in common: the reference is from {r0} s to {r1} s, the comparison from {c0} s to {c1} s"
        ));
    }
    Ok(span)
}

fn sample_count([from, to]: [f64; 2]) -> Result<usize, Error> {
    // Rounding of recorded times must not drop the last sample.
    let samples = ((to - from) * RATE + 1e-3).floor() as usize + 1;
    if samples < FEWEST {
        return Err(refusal!(
            "the curves have {samples} samples at 10 kHz in common, a rating needs at least {FEWEST}"
        ));
    }
    if samples > MOST {
        let pairs = (samples as u64 / 5).saturating_mul(samples as u64);
        return Err(refusal!(
            "the curves have {samples} samples at 10 kHz in common, of which at most {MOST} are rated: \
             to warp them would compare {pairs} pairs"
        ));
    }
    Ok(samples)
}

/// The values at `count` instants from `start` on at [`RATE`]; those of the samples themselves where they lie there.
fn sampled(series: &Series, start: f64, count: usize) -> Vec<f64> {
    let (time, values) = (series.time(), series.values());
    if let Some(first) = first_of_rate(series, start) {
        return values[first..].iter().copied().take(count).collect();
    }
    let last = time[time.len() - 1];
    let at = |index| series.value_at((start + index as f64 / RATE).min(last));
    (0..count).map_while(at).collect()
}

/// Index of the sample at `start` in a series that is sampled at [`RATE`] already.
fn first_of_rate(series: &Series, start: f64) -> Option<usize> {
    let step = resample::common_step(series.time())?;
    let steps = (start - series.time()[0]) * RATE;
    let on_samples = (step * RATE - 1.0).abs() < 1e-6 && (steps - steps.round()).abs() < 1e-3;
    on_samples.then_some(steps.round() as usize)
}

/// How a curve was changed, if it was.
fn change(curve: Curve, series: &Series, [from, to]: [f64; 2], samples: usize) -> Option<Warning> {
    let on_samples = first_of_rate(series, from).is_some();
    let (from, to) = (clean_time(from), clean_time(to));
    if !on_samples {
        return Some(Warning::CurveResampled { curve, samples: series.len(), from, to });
    }
    (series.len() != samples).then_some(Warning::CurveCut { curve, from, to })
}

#[cfg(test)]
mod tests;

/// Samples on each side of a moving average.
const REACH: usize = 4;

/// Relative difference of the slopes as a rating: 1 for none, 0 for twice the reference.
fn slope_rating(reference: &[f64], comparison: &[f64]) -> f64 {
    let (r, c) = (smoothed(&slopes(reference)), smoothed(&slopes(comparison)));
    let off = r.iter().zip(&c).map(|(r, c)| (c - r).abs()).sum();
    let size = r.iter().map(|r| r.abs()).sum();
    ((2.0 - relative(off, size)) / 2.0).max(0.0)
}

/// Central differences per sample, one-sided at the ends.
fn slopes(curve: &[f64]) -> Vec<f64> {
    let last = curve.len() - 1;
    let slope = |i: usize| {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
        (curve[after] - curve[before]) / (after - before) as f64
    };
    (0..=last).map(slope).collect()
}

/// Means of nine, of seven, five, three and one towards the ends.
fn smoothed(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    let mean = |i: usize| {
        let reach = REACH.min(i).min(last - i);
        values[i - reach..=i + reach].iter().sum::<f64>() / (2 * reach + 1) as f64
    };
    (0..=last).map(mean).collect()
}

/// Half widths of the corridors over the largest magnitude of the reference.
const INNER: f64 = 0.05;
const OUTER: f64 = 0.5;

/// Mean over the samples of 1 in the inner corridor, 0 outside the outer one, and a parabola between.
fn corridor_rating(reference: &[f64], comparison: &[f64]) -> f64 {
    let size = reference.iter().fold(0.0, |size, value| f64::max(size, value.abs()));
    let score = |(r, c): (&f64, &f64)| match (c - r).abs() / size {
        d if d < INNER => 1.0,
        d if d > OUTER => 0.0,
        d => ((OUTER - d) / (OUTER - INNER)).powi(2),
    };
    reference.iter().zip(comparison).map(score).sum::<f64>() / reference.len() as f64
}
