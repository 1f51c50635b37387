//! The phase rating E_P of ISO/TS 18571, equation 64: the shift at which the curves correlate best.

use base::cancellation::stop_if_cancelled;
use membrane::lane::{LANES, Lane, Width, at_width, splat};

/// Difference of correlations beyond rounding.
const ROUNDING: f64 = 1e-12;

/// Shift of the comparison before values and slopes are compared, samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shift {
    /// The comparison is late: its first samples are dropped, and the last of the reference.
    Left(usize),
    /// The comparison is early.
    Right(usize),
}

impl Shift {
    /// Samples by which the comparison is late.
    pub(super) fn samples(self) -> i64 {
        match self {
            Shift::Left(count) => count as i64,
            Shift::Right(count) => -(count as i64),
        }
    }

    /// The common part of the curves after the shift.
    pub(super) fn cut<'a>(self, reference: &'a [f64], comparison: &'a [f64]) -> [&'a [f64]; 2] {
        match self {
            Shift::Left(count) => [&reference[..reference.len() - count], &comparison[count..]],
            Shift::Right(count) => [&reference[count..], &comparison[..comparison.len() - count]],
        }
    }

    /// 1 without a shift, 0 at a fifth of `length`, linear between.
    pub(super) fn rating(self, length: usize) -> f64 {
        let most = length as f64 / 5.0;
        ((most - self.samples().unsigned_abs() as f64) / most).max(0.0)
    }
}

/// The shift of at most a fifth of the length with the largest Pearson correlation; the smallest of several, left
/// before right.
pub(super) fn best_shift(reference: &[f64], comparison: &[f64]) -> Shift {
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
pub(super) fn is_flat(curve: &[f64]) -> bool {
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
    fn dot[](a: &[f64], b: &[f64]) -> f64 = dot_lanewise
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
