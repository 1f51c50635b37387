//! The slope rating E_S of ISO/TS 18571, equation 68.

use super::relative::relative;

/// Samples on each side of a moving average.
const REACH: usize = 4;

/// Relative difference of the slopes as a rating: 1 for none, 0 for twice the reference.
pub(super) fn rating(reference: &[f64], comparison: &[f64]) -> f64 {
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
