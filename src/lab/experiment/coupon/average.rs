//! Means: of figures, of groups of figures, and of curves.

use serde::Serialize;

use super::Curve;
use crate::error::{Error, refusal};

/// Samples of a mean curve; strain grows with the square of the index, so that the elastic part is resolved.
pub const AXIS: usize = 600;

/// Mean, scatter and number of repeated figures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SampleStatistics {
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation of the sample (n − 1); zero for a single figure.
    pub deviation: f64,
    /// How many figures.
    pub count: usize,
}

impl SampleStatistics {
    /// The spread of `figures`.
    ///
    /// # Errors
    /// There is no figure.
    pub fn from_figures(figures: &[f64]) -> Result<SampleStatistics, Error> {
        if figures.is_empty() {
            return Err(nothing());
        }
        let count = figures.len();
        let mean = figures.iter().sum::<f64>() / count as f64;
        let squares: f64 = figures.iter().map(|figure| (figure - mean).powi(2)).sum();
        let deviation = if count > 1 { (squares / (count - 1) as f64).sqrt() } else { 0.0 };
        Ok(SampleStatistics { mean, deviation, count })
    }

    /// The mean of the groups' means, with scatter and number of all figures together.
    ///
    /// # Errors
    /// There is no group, or a group without figures.
    pub fn from_groups(groups: &[Vec<f64>]) -> Result<SampleStatistics, Error> {
        let all = SampleStatistics::from_figures(&groups.concat())?;
        Ok(SampleStatistics { mean: mean_of_means(groups)?, ..all })
    }
}

/// The mean of the means of `groups`: every group counts the same, however many figures it has.
///
/// The paper averages in this way: moduli per direction and speed, then per direction (Table 6), energy absorptions per
/// drop height, then over both (Table 7). Means are never rounded in between.
///
/// # Errors
/// There is no group, or a group without figures.
pub fn mean_of_means(groups: &[Vec<f64>]) -> Result<f64, Error> {
    let means = groups
        .iter()
        .map(|group| Ok(SampleStatistics::from_figures(group)?.mean))
        .collect::<Result<Vec<_>, Error>>()?;
    Ok(SampleStatistics::from_figures(&means)?.mean)
}

/// How far `measured` is from a `reference`, as a share of the reference (the errors of Table 4).
pub fn relative_difference(measured: f64, reference: f64) -> f64 {
    (measured - reference) / reference
}

/// The mean of `curves` on a common axis of strain: [`AXIS`] samples from the latest beginning to the earliest end.
///
/// # Errors
/// There is no curve, or no strain that all have.
pub fn mean_curve(curves: &[Curve]) -> Result<Curve, Error> {
    let [start, end] = common_strain(curves)?;
    let last = AXIS - 1;
    let place = |i: usize| if i == last { end } else { start + (end - start) * (i as f64 / last as f64).powi(2) };
    let mean = mean_at((0..AXIS).map(place).collect(), curves, Curve::stress_at);
    mean.ok_or_else(|| apart(start, end))
}

/// The mean of piecewise straight `laws` from their latest beginning to the mean of their ends, exact: it has the
/// corners of all. A law that has ended is extended along its last piece.
///
/// # Errors
/// There is no law, or no strain that all have.
pub fn mean_law(laws: &[Curve]) -> Result<Curve, Error> {
    let [start, end] = common_strain(laws)?;
    let mean_end = laws.iter().map(|law| law.range()[1]).sum::<f64>() / laws.len() as f64;
    let corners = laws.iter().flat_map(Curve::strain).copied().filter(|strain| (start..mean_end).contains(strain));
    let mut strain: Vec<f64> = corners.chain([start, mean_end]).collect();
    strain.sort_by(f64::total_cmp);
    strain.dedup();
    mean_at(strain, laws, Curve::continued).ok_or_else(|| apart(start, end))
}

fn nothing() -> Error {
    refusal!("there is nothing to average")
}

fn apart(start: f64, end: f64) -> Error {
    refusal!("the curves have no strain in common: one begins at {start}, another ends at {end}")
}

/// Strains from the latest beginning to the earliest end.
fn common_strain(curves: &[Curve]) -> Result<[f64; 2], Error> {
    if curves.is_empty() {
        return Err(nothing());
    }
    let start = curves.iter().map(|curve| curve.range()[0]).fold(f64::NEG_INFINITY, f64::max);
    let end = curves.iter().map(|curve| curve.range()[1]).fold(f64::INFINITY, f64::min);
    if start < end { Ok([start, end]) } else { Err(apart(start, end)) }
}

/// The curve of the mean stresses at `strain`, where all `curves` have one.
fn mean_at(strain: Vec<f64>, curves: &[Curve], stress: fn(&Curve, f64) -> Option<f64>) -> Option<Curve> {
    let mean = |strain: &f64| {
        let total: Option<f64> = curves.iter().map(|curve| stress(curve, *strain)).sum();
        total.map(|total| total / curves.len() as f64)
    };
    let means = strain.iter().map(mean).collect::<Option<_>>()?;
    Curve::new(strain, means).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(slope: f64, [from, to]: [f64; 2], samples: u32) -> Curve {
        let strain: Vec<f64> = (0..=samples).map(|i| from + (to - from) * f64::from(i) / f64::from(samples)).collect();
        let stress = strain.iter().map(|strain| slope * strain).collect();
        Curve::new(strain, stress).unwrap()
    }

    #[test]
    fn spread_is_mean_and_deviation_of_a_sample() {
        let spread = SampleStatistics::from_figures(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]).unwrap();
        assert!((spread.mean - 5.0).abs() < 1e-15 && (spread.deviation - (32.0_f64 / 7.0).sqrt()).abs() < 1e-14);
        assert_eq!(SampleStatistics::from_figures(&[3.0]).unwrap().deviation, 0.0);
        assert_eq!(SampleStatistics::from_figures(&[]), Err(nothing()));
    }

    #[test]
    fn groups_of_unequal_size_count_the_same() {
        assert_eq!(mean_of_means(&[vec![1.0, 2.0, 3.0], vec![4.0]]), Ok(3.0));
        assert_eq!(mean_of_means(&[vec![1.0], vec![]]), Err(nothing()));
    }

    #[test]
    fn curves_meet_on_the_strains_that_they_have_in_common() {
        let mean = mean_curve(&[line(2.0, [0.0, 1.0], 7), line(4.0, [0.1, 0.8], 300)]).unwrap();
        assert_eq!(mean.range(), [0.1, 0.8]);
        assert!(mean.samples().all(|[strain, stress]| (stress - 3.0 * strain).abs() < 1e-12));
    }

    /// By hand: the first law is extended beyond its end at 0.4 with its slope of 5, the mean ends at (0.4 + 0.8)/2.
    #[test]
    fn laws_are_averaged_at_their_corners_and_beyond_an_end() {
        let first = Curve::new(vec![0.0, 0.1, 0.4], vec![0.0, 1.0, 2.5]).unwrap();
        let second = Curve::new(vec![0.0, 0.2, 0.8], vec![0.0, 4.0, 4.0]).unwrap();
        let mean = mean_law(&[first.clone(), second]).unwrap();
        let expected = [[0.0, 0.0], [0.1, 1.5], [0.2, 2.75], [0.4, 3.25], [0.6, 3.75]];
        assert_eq!(mean.strain().len(), expected.len());
        for (found, expected) in mean.samples().zip(expected) {
            assert!((found[0] - expected[0]).abs() < 1e-12 && (found[1] - expected[1]).abs() < 1e-12, "{found:?}");
        }
        assert_eq!(mean_law(std::slice::from_ref(&first)), Ok(first));
        assert_eq!(mean_law(&[]), Err(nothing()));
    }

    #[test]
    fn curves_apart_have_no_mean() {
        // The mean of the ends, 0.7, lies beyond the latest beginning in the first pair, not in the second.
        for (first, second) in [([0.0, 0.4], [0.5, 1.0]), ([0.0, 0.2], [0.8, 1.0])] {
            let apart = [line(1.0, second, 4), line(1.0, first, 4)];
            let none = Err(super::apart(second[0], first[1]));
            assert_eq!((mean_curve(&apart), mean_law(&apart)), (none.clone(), none));
        }
        assert_eq!(mean_curve(&[]), Err(nothing()));
    }
}
