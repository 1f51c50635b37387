//! How well one signal follows another: the objective rating of ISO/TS 18571 for signals without ambiguity.
//!
//! Four ratings between 0 and 1 and their weighted sum, equation 64. The curves are compared at 10 kHz and equal
//! length, as the specification requires; the warnings of the rating report how they were resampled.

use super::warning::Warning;
use super::{Series, gap, resample};
use crate::error::{Error, refusal};
use base::cancellation::stop_if_cancelled;
use base::number::{clean_time, significant};
use base::words;
use membrane::lane::{LANES, Lane, Width, at_width, splat};

pub use super::warning::Curve;

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

words! {
    /// Grades of ISO/TS 18571.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Grade {
        /// Above 0.94.
        Excellent = "excellent",
        /// Above 0.80.
        Good = "good",
        /// Above 0.58.
        Fair = "fair",
        /// The rest.
        Poor = "poor",
    }
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

/// Rates `comparison` against `reference` over the time that both cover.
pub fn rate(reference: &Series, comparison: &Series) -> Result<Rating, Error> {
    let span = common_span(reference, comparison)?;
    let curves = [(Curve::Reference, reference), (Curve::Comparison, comparison)];
    for (curve, series) in curves {
        gap::check(&series.window(around(series, span))).map_err(|gap| Error::from(gap).about(curve))?;
    }
    let samples = sample_count(span)?;
    let sampled = |(curve, series): (Curve, &Series)| {
        sampled(series, span, samples).ok_or_else(|| refusal!("the {curve} has values too large to be rated"))
    };
    let (r, c) = (sampled(curves[0])?, sampled(curves[1])?);
    if r.iter().all(|value| *value == 0.0) {
        let [from, to] = span.map(|time| significant(time, 9));
        return Err(refusal!("the reference is zero everywhere between {from} s and {to} s"));
    }
    let mut rating = rate_curves(&r, &c);
    rating.warnings = curves.into_iter().filter_map(|(curve, series)| change(curve, series, span, samples)).collect();
    if is_flat(&c) {
        rating.warnings.push(Warning::ConstantCurve);
    }
    Ok(rating)
}

/// The rating of curves of equal length at [`RATE`].
fn rate_curves(reference: &[f64], comparison: &[f64]) -> Rating {
    let shift = best_shift(reference, comparison);
    let [r, c] = shift.cut(reference, comparison);
    // Corridor and phase are of the whole curves, magnitude and slope of what the shift leaves.
    let (corridor, phase) = (corridor_rating(reference, comparison), shift.rating(reference.len()));
    let (magnitude, slope) = (magnitude_rating(r, c), slope_rating(r, c));
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

/// Times of the samples between which `series` has its values from `from` to `to`, which it covers.
fn around(series: &Series, [from, to]: [f64; 2]) -> [f64; 2] {
    let time = series.time();
    [time[time.partition_point(|t| *t <= from) - 1], time[time.partition_point(|t| *t < to)]]
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

/// The values at `count` instants between `from` and `to` at [`RATE`]; those of the samples themselves where they lie there.
/// None where one between samples, which are finite, is too large for a number.
fn sampled(series: &Series, [from, to]: [f64; 2], count: usize) -> Option<Vec<f64>> {
    if let Some(first) = first_of_rate(series, from) {
        return series.values().get(first..first + count).map(<[f64]>::to_vec);
    }
    (0..count).map(|index| series.value_at((from + index as f64 / RATE).min(to))).collect()
}

/// Index of the sample at `start` in a series that is sampled at [`RATE`] already, to a thousandth of a step at its end.
fn first_of_rate(series: &Series, start: f64) -> Option<usize> {
    let step = resample::common_step(series.time())?;
    let steps = (start - series.time()[0]) * RATE;
    let drift = (step * RATE - 1.0) * (series.len() - 1) as f64;
    let on_samples = drift.abs() < 1e-3 && (steps - steps.round()).abs() < 1e-3;
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

/// E_M: the relative difference of the curves when their time is warped, as a rating: 1 for none, 0 for a half.
///
/// Sakoe and Chiba, IEEE Transactions on Acoustics, Speech, and Signal Processing 26 (1978): squared differences, steps
/// of (1, 0), (0, 1) and (1, 1) of equal weight, a band about the diagonal. The rating only needs two sums along the
/// path, so they are computed with the costs from one antidiagonal of the band to the next, and no path is stored:
/// memory is linear in the length.
fn magnitude_rating(reference: &[f64], comparison: &[f64]) -> f64 {
    let band = reference.len().div_ceil(10) - 1;
    let [off, size] = warped(reference, comparison, band);
    ((0.5 - relative(off, size)) / 0.5).max(0.0)
}

/// The cheapest path to a pair of samples: its cost, and its sums of the absolute difference and of the absolute reference.
type Path = [f64; 3];

/// Sums of the absolute difference and of the absolute reference along the cheapest path.
fn warped(reference: &[f64], comparison: &[f64], band: usize) -> [f64; 2] {
    let count = comparison.len();
    let step = |[cost, off, size]: Path, c: f64, r: f64| -> Path {
        [cost + (c - r) * (c - r), off + (c - r).abs(), size + r.abs()]
    };
    // Paths to the pairs of the last antidiagonal but one, of the last and of the next, by the index in the comparison plus one.
    let unreached: Path = [f64::INFINITY, 0.0, 0.0];
    let mut fronts = [0; 3].map(|_| vec![unreached; count + 2]);
    fronts[1][1] = step([0.0; 3], comparison[0], reference[0]);
    for diagonal in 1..2 * count - 1 {
        stop_if_cancelled();
        let first = diagonal.saturating_sub(count - 1).max(diagonal.saturating_sub(band).div_ceil(2));
        // In a band without width every other antidiagonal is empty.
        let end = count.min(diagonal + 1).min((diagonal + band) / 2 + 1).max(first);
        let [before_last, last, next] = &mut fronts;
        for i in first..end {
            // Steps (1, 0), (0, 1), (1, 1): of paths of equal cost the first counts.
            let before = cheaper(cheaper(last[i], last[i + 1]), before_last[i]);
            next[i + 1] = step(before, comparison[i], reference[diagonal - i]);
        }
        // Beyond the ends are paths of an earlier antidiagonal.
        next[first] = unreached;
        next[end + 1] = unreached;
        fronts.rotate_left(1);
    }
    let [_, off, size] = fronts[1][count];
    [off, size]
}

/// The cheaper of two paths, the first of equally cheap ones.
fn cheaper(first: Path, second: Path) -> Path {
    if second[0] < first[0] { second } else { first }
}

/// |off|₁/|size|₁; infinite where only `size` is zero.
fn relative(off: f64, size: f64) -> f64 {
    if off == 0.0 { 0.0 } else { off / size }
}

/// Difference of correlations beyond rounding.
const ROUNDING: f64 = 1e-12;

/// Shift of the comparison before values and slopes are compared, samples.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shift {
    /// The comparison is late: its first samples are dropped, and the last of the reference.
    Left(usize),
    /// The comparison is early.
    Right(usize),
}

impl Shift {
    /// Samples by which the comparison is late.
    fn samples(self) -> i64 {
        match self {
            Shift::Left(count) => count as i64,
            Shift::Right(count) => -(count as i64),
        }
    }

    /// The common part of the curves after the shift.
    fn cut<'a>(self, reference: &'a [f64], comparison: &'a [f64]) -> [&'a [f64]; 2] {
        match self {
            Shift::Left(count) => [&reference[..reference.len() - count], &comparison[count..]],
            Shift::Right(count) => [&reference[count..], &comparison[..comparison.len() - count]],
        }
    }

    /// 1 without a shift, 0 at a fifth of `length`, linear between.
    fn rating(self, length: usize) -> f64 {
        let most = length as f64 / 5.0;
        ((most - self.samples().unsigned_abs() as f64) / most).max(0.0)
    }
}

/// The shift of at most a fifth of the length with the largest Pearson correlation; the smallest of several, left
/// before right.
fn best_shift(reference: &[f64], comparison: &[f64]) -> Shift {
    let (r, c) = (Moments::from_curve(reference), Moments::from_curve(comparison));
    let correlation = |shift: Shift| {
        let [left, right] = shift.cut(&r.values, &c.values);
        match shift {
            Shift::Left(m) => correlation(left, right, r.of_range(0, left.len()), c.of_range(m, right.len())),
            Shift::Right(m) => correlation(left, right, r.of_range(m, left.len()), c.of_range(0, right.len())),
        }
    };
    let mut best = Shift::Left(0);
    let mut largest = correlation(best).unwrap_or(-1.0);
    // The order of ISO/TS 18571: small before large, left before right. Beyond rounding, so that shifts of equal
    // correlation are not decided by the order of a sum.
    let shifts = (1..=reference.len() / 5).flat_map(|m| [Shift::Left(m), Shift::Right(m)]);
    for shift in shifts {
        stop_if_cancelled();
        if let Some(found) = correlation(shift).filter(|found| *found > largest + ROUNDING) {
            (best, largest) = (shift, found);
        }
    }
    best
}

/// Whether a curve has one value everywhere.
fn is_flat(curve: &[f64]) -> bool {
    curve.iter().all(|value| *value == curve[0])
}

/// A curve less its mean, with running sums of its values and their squares.
struct Moments {
    values: Vec<f64>,
    sums: Vec<[f64; 2]>,
}

impl Moments {
    fn from_curve(curve: &[f64]) -> Moments {
        // Without the mean the differences of running sums lose no digits to a large offset.
        let mean = curve.iter().sum::<f64>() / curve.len() as f64;
        let values: Vec<f64> = curve.iter().map(|value| value - mean).collect();
        let running = values.iter().scan([0.0, 0.0], |[sum, squares], value| {
            (*sum, *squares) = (*sum + value, *squares + value * value);
            Some([*sum, *squares])
        });
        let sums = std::iter::once([0.0, 0.0]).chain(running).collect();
        Moments { values, sums }
    }

    /// Sum, and sum of the squares about the mean, of `count` samples; no squares where they are rounding.
    fn of_range(&self, first: usize, count: usize) -> [f64; 2] {
        let [before, after] = [self.sums[first], self.sums[first + count]];
        let (sum, squares) = (after[0] - before[0], after[1] - before[1]);
        let about_mean = squares - sum * sum / count as f64;
        let whole = self.sums[self.sums.len() - 1][1];
        [sum, if about_mean > 1e-13 * whole { about_mean } else { 0.0 }]
    }
}

/// Pearson's correlation; none where one of the curves is constant.
fn correlation(r: &[f64], c: &[f64], [r_sum, r_squares]: [f64; 2], [c_sum, c_squares]: [f64; 2]) -> Option<f64> {
    let size = (r_squares * c_squares).sqrt();
    (size > 0.0).then(|| (dot(Width::best(), r, c) - r_sum * c_sum / r.len() as f64) / size)
}

at_width! {
    /// Scalar product, summed in lanes.
    fn dot[](a: &[f64], b: &[f64]) -> f64 {
        dot_lanewise(a, b)
    }
}

#[inline(always)]
fn dot_lanewise(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums: Lane = splat(0.0);
    for (a, b) in a.iter().zip(b) {
        for l in 0..LANES {
            sums[l] += a[l] * b[l];
        }
    }
    let rest = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>();
    sums.into_iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn sampled_at(step: f64, [from, to]: [f64; 2], f: impl Fn(f64) -> f64) -> Series {
        let count = ((to - from) / step + 0.5) as usize;
        let time: Vec<f64> = (0..=count).map(|i| from + i as f64 * step).collect();
        let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
        Series::new(time, values)
    }

    fn at_10_khz(f: impl Fn(f64) -> f64) -> Series {
        sampled_at(1e-4, [0.0, 0.0999], f)
    }

    fn pulse(t: f64) -> f64 {
        100.0 * (-((t - 0.05) / 0.008).powi(2)).exp()
    }

    #[test]
    fn a_curve_follows_itself() {
        for curve in [at_10_khz(pulse), at_10_khz(|t| (2.0 * PI * 100.0 * t).sin()), at_10_khz(|t| 5.0 + t)] {
            let rating = rate(&curve, &curve).unwrap();
            assert_eq!([rating.corridor, rating.phase, rating.magnitude, rating.slope], [1.0; 4]);
            assert!((rating.overall - 1.0).abs() < 1e-15 && rating.grade == Grade::Excellent && rating.shift == 0.0);
            assert!(rating.warnings.is_empty() && rating.samples == 1000, "{rating:?}");
        }
    }

    #[test]
    fn a_shifted_curve_only_loses_phase_and_corridor() {
        for late in [37, -52] {
            let rating = rate(&at_10_khz(pulse), &at_10_khz(|t| pulse(t - 1e-4 * f64::from(late)))).unwrap();
            assert!((rating.shift - 1e-4 * f64::from(late)).abs() < 1e-12, "{rating:?}");
            assert!((rating.phase - (200.0 - f64::from(late).abs()) / 200.0).abs() < 1e-12);
            assert!(rating.magnitude > 1.0 - 1e-9 && rating.slope > 1.0 - 1e-9 && rating.corridor < 1.0);
        }
    }

    #[test]
    fn a_constant_offset_costs_corridor_and_magnitude_by_their_closed_forms() {
        let (size, offset) = (2.0, 0.5);
        let sine = |t: f64| size * (2.0 * PI * 10.0 * t).sin();
        let rating = rate(&at_10_khz(sine), &at_10_khz(|t| sine(t) + offset)).unwrap();
        let largest = at_10_khz(sine).largest().unwrap()[1];
        let exact = ((0.5 - offset / largest) / 0.45f64).powi(2);
        assert!((rating.corridor - exact).abs() < 1e-12, "{rating:?} for {exact}");
        assert!(rating.phase == 1.0 && rating.slope > 1.0 - 1e-9);
        let inside = rate(&at_10_khz(sine), &at_10_khz(|t| sine(t) + 0.049 * largest)).unwrap();
        assert_eq!(inside.corridor, 1.0);
        let outside = rate(&at_10_khz(sine), &at_10_khz(|t| sine(t) - 0.51 * largest)).unwrap();
        assert_eq!(outside.corridor, 0.0);
    }

    #[test]
    fn a_scaled_curve_costs_slope_and_corridor_by_their_closed_forms() {
        let rating = rate(&at_10_khz(pulse), &at_10_khz(|t| 1.2 * pulse(t))).unwrap();
        assert_eq!((rating.phase, rating.shift), (1.0, 0.0));
        assert!((rating.slope - (2.0 - 0.2) / 2.0).abs() < 1e-12, "{rating:?}");
        let peak = at_10_khz(pulse).largest().unwrap()[1];
        let score = |[_, value]: [f64; 2]| match 0.2 * value / peak {
            d if d < 0.05 => 1.0,
            d => ((0.5 - d) / 0.45f64).powi(2),
        };
        let corridor = at_10_khz(pulse).samples().map(score).sum::<f64>() / 1000.0;
        assert!((rating.corridor - corridor).abs() < 1e-12);
        // Warping does not reduce the difference of a peak that is too high, nor does it increase it.
        assert!(rating.magnitude >= 0.6 - 1e-12 && rating.magnitude < 1.0);
    }

    #[test]
    fn opposite_curves_are_rated_zero() {
        let rating = rate(&at_10_khz(pulse), &at_10_khz(|t| -3.0 * pulse(t))).unwrap();
        assert_eq!((rating.magnitude, rating.slope, rating.grade), (0.0, 0.0, Grade::Poor));
    }

    #[test]
    fn grades_are_those_of_the_specification() {
        use Grade::*;
        let found = [1.0, 0.941, 0.94, 0.81, 0.80, 0.59, 0.58, 0.0].map(Grade::from_rating);
        assert_eq!(found, [Excellent, Excellent, Good, Good, Fair, Fair, Poor, Poor]);
    }

    #[test]
    fn other_rates_and_spans_are_brought_together_and_reported() {
        let (fine, late) = (sampled_at(1e-6, [0.0, 0.1], pulse), sampled_at(1e-4, [0.005, 0.095], pulse));
        let rating = rate(&fine, &late).unwrap();
        assert_eq!(rating.samples, 901);
        assert!(rating.overall > 1.0 - 1e-6, "{rating:?}");
        let curve = Curve::Reference;
        assert_eq!(rating.warnings, [Warning::CurveResampled { curve, samples: 100_001, from: 0.005, to: 0.095 }]);
        let cut = rate(&at_10_khz(pulse), &late).unwrap();
        assert_eq!(cut.warnings, [Warning::CurveCut { curve, from: 0.005, to: 0.095 }]);
    }

    /// A sample just outside the common span decides on the values at its ends.
    #[test]
    fn gaps_beside_the_common_span_are_refused() {
        let short = sampled_at(1e-4, [0.010_05, 0.089_95], pulse);
        for (gap, at) in [(100, "0.01"), (900, "0.09")] {
            let mut values = at_10_khz(pulse).values().to_vec();
            values[gap] = f64::NAN;
            let long = at_10_khz(pulse).with_values(values);
            for (a, b) in [(&long, &short), (&short, &long)] {
                let error = rate(a, b).unwrap_err().to_string();
                assert!(error.ends_with(&format!("nothing was measured at {at} s")), "{error}");
            }
        }
    }

    #[test]
    fn a_clock_that_drifts_is_resampled() {
        let time: Vec<f64> = (0..=1_200_000).map(|i| f64::from(i) * 1e-4 * (1.0 + 9.5e-7)).collect();
        let values: Vec<f64> = time.iter().map(|t| pulse(t - 119.9)).collect();
        let other = sampled_at(1e-4, [119.9, 121.0], |t| pulse(t - 119.9));
        let rating = rate(&Series::new(time, values), &other).unwrap();
        assert!(rating.overall > 1.0 - 1e-3 && rating.shift == 0.0, "{rating:?}");
    }

    #[test]
    fn a_constant_comparison_is_noted() {
        let rating = rate(&at_10_khz(pulse), &at_10_khz(|_| 3.0)).unwrap();
        assert_eq!(rating.warnings, [Warning::ConstantCurve]);
    }

    /// The whole matrix, and the way back through it.
    fn by_matrix(reference: &[f64], comparison: &[f64], band: usize) -> [f64; 2] {
        let n = reference.len();
        let mut cost = vec![vec![f64::INFINITY; n]; n];
        let at = |cost: &Vec<Vec<f64>>, i: isize, j: isize| {
            if i < 0 || j < 0 { f64::INFINITY } else { cost[i as usize][j as usize] }
        };
        let from = |cost: &Vec<Vec<f64>>, i: usize, j: usize| {
            let (i, j) = (i as isize, j as isize);
            let steps = [(i - 1, j), (i, j - 1), (i - 1, j - 1)];
            steps.into_iter().reduce(|a, b| if at(cost, b.0, b.1) < at(cost, a.0, a.1) { b } else { a }).unwrap()
        };
        for i in 0..n {
            for j in i.saturating_sub(band)..(i + band + 1).min(n) {
                let (before_i, before_j) = from(&cost, i, j);
                let before = if i == 0 && j == 0 { 0.0 } else { at(&cost, before_i, before_j) };
                cost[i][j] = before + (comparison[i] - reference[j]).powi(2);
            }
        }
        let (mut i, mut j, mut sums) = (n - 1, n - 1, [0.0, 0.0]);
        loop {
            sums = [sums[0] + (comparison[i] - reference[j]).abs(), sums[1] + reference[j].abs()];
            if i == 0 && j == 0 {
                return sums;
            }
            let (before_i, before_j) = from(&cost, i, j);
            (i, j) = (before_i as usize, before_j as usize);
        }
    }

    #[test]
    fn running_sums_are_those_along_the_path() {
        for (n, band) in [(9, 0), (12, 1), (57, 5), (58, 5), (130, 12), (40, 39)] {
            let reference: Vec<f64> = (0..n).map(|i| (0.11 * i as f64).sin() + 0.1 * (i * i % 7) as f64).collect();
            let comparison: Vec<f64> =
                (0..n).map(|i| (0.12 * i as f64 - 0.2).sin() + 0.1 * (i * i % 5) as f64).collect();
            let expected = by_matrix(&reference, &comparison, band);
            let found = warped(&reference, &comparison, band);
            let is_close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 * b);
            assert!(is_close, "{n}, {band}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn ties_of_paths_are_broken_as_specified() {
        // Plateaus make ties everywhere.
        let reference: Vec<f64> = (0..60).map(|i| f64::from(i / 13)).collect();
        let comparison: Vec<f64> = (0..60).map(|i| f64::from((i + 4) / 11) - 0.5).collect();
        for band in [3, 5, 20] {
            assert_eq!(warped(&reference, &comparison, band), by_matrix(&reference, &comparison, band));
        }
    }
}
