//! The corridor rating Z of ISO/TS 18571, equation 64.

/// Half widths of the corridors over the largest magnitude of the reference.
const INNER: f64 = 0.05;
const OUTER: f64 = 0.5;

/// Mean over the samples of 1 in the inner corridor, 0 outside the outer one, and a parabola between.
pub(super) fn rating(reference: &[f64], comparison: &[f64]) -> f64 {
    let size = reference.iter().fold(0.0, |size, value| f64::max(size, value.abs()));
    let score = |(r, c): (&f64, &f64)| match (c - r).abs() / size {
        d if d < INNER => 1.0,
        d if d > OUTER => 0.0,
        d => ((OUTER - d) / (OUTER - INNER)).powi(2),
    };
    reference.iter().zip(comparison).map(score).sum::<f64>() / reference.len() as f64
}
