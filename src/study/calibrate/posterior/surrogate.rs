//! A surrogate of one test: what its signals differ by from the recordings, as polynomials of the unknowns within a box.
//!
//! The differences of all runs are reduced to their principal components (as Higdon et al. 2008), each of which is a sparse
//! polynomial chaos. What components that are left out and cross-validation leave is the error of every coordinate, which the
//! likelihood contains.

use nalgebra::{DMatrix, DVector};
use uncertainty::surrogate::{Family, Options, Surrogate, SurrogateError};

/// Most principal components.
const MOST_MODES: usize = 12;
/// Variance that components which are left out may have, over that of the noise of one coordinate.
const LEFT_OUT: f64 = 1e-3;
/// Highest degree of the polynomials.
const HIGHEST_DEGREE: usize = 6;
/// Distance of points from the faces of the box in its unit coordinates, which are open.
const INSIDE: f64 = 1e-6;

/// A box of the unknowns that act on a test.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Region {
    pub(super) low: Vec<f64>,
    pub(super) high: Vec<f64>,
}

impl Region {
    /// A point in unit coordinates; none outside.
    pub(super) fn unit(&self, point: &[f64]) -> Option<Vec<f64>> {
        let unit = |((x, low), high): ((&f64, &f64), &f64)| {
            (low..=high).contains(&x).then(|| ((x - low) / (high - low)).clamp(INSIDE, 1.0 - INSIDE))
        };
        point.iter().zip(&self.low).zip(&self.high).map(unit).collect()
    }

    /// The point at unit coordinates.
    pub(super) fn at(&self, unit: &[f64]) -> Vec<f64> {
        unit.iter().zip(&self.low).zip(&self.high).map(|((u, low), high)| low + u * (high - low)).collect()
    }
}

/// The differences of a test as functions of the unknowns that act on it.
pub(super) struct TestSurrogate {
    region: Region,
    mean: DVector<f64>,
    /// Components as columns.
    modes: DMatrix<f64>,
    amplitudes: Vec<Surrogate>,
    /// Variance of the error of every coordinate.
    errors: Vec<f64>,
}

impl TestSurrogate {
    /// Fits the differences of runs at points of a region; those outside of it are left out.
    pub(super) fn fit(region: Region, runs: &[(Vec<f64>, Vec<f64>)]) -> Result<TestSurrogate, SurrogateError> {
        let inside: Vec<(Vec<f64>, &[f64])> =
            runs.iter().filter_map(|(point, found)| Some((region.unit(point)?, found.as_slice()))).collect();
        let count = inside.len();
        let points: Vec<Vec<f64>> = inside.iter().map(|(point, _)| point.clone()).collect();
        let Some(length) = inside.first().map(|(_, found)| found.len()) else {
            let (terms, needed) = (region.low.len() + 1, 2 * region.low.len() + 3);
            return Err(SurrogateError::TooFewSamples { samples: 0, terms, needed });
        };
        let all = DMatrix::from_fn(length, count, |row, column| inside[column].1[row]);
        let mean = all.column_mean();
        let centred = DMatrix::from_fn(length, count, |row, column| all[(row, column)] - mean[row]);
        let decomposed = centred.svd(true, true);
        let (Some(left), Some(right)) = (decomposed.u, decomposed.v_t) else { return Err(SurrogateError::Constant) };
        let mut order: Vec<usize> = (0..decomposed.singular_values.len()).collect();
        order.sort_by(|a, b| decomposed.singular_values[*b].total_cmp(&decomposed.singular_values[*a]));
        let limit = (LEFT_OUT * count as f64).sqrt();
        let taken: Vec<usize> =
            order.iter().copied().filter(|mode| decomposed.singular_values[*mode] > limit).take(MOST_MODES).collect();
        let mut errors: Vec<f64> = (0..length)
            .map(|row| {
                let others = order.iter().filter(|mode| !taken.contains(mode));
                others.map(|mode| (left[(row, *mode)] * decomposed.singular_values[*mode]).powi(2)).sum::<f64>()
                    / count as f64
            })
            .collect();
        let families = vec![Family::Legendre; region.low.len()];
        let options = Options { highest_degree: HIGHEST_DEGREE, ..Options::default() };
        let mut amplitudes = Vec::new();
        for mode in &taken {
            let size = decomposed.singular_values[*mode];
            let outputs: Vec<Option<f64>> = (0..count).map(|run| Some(size * right[(*mode, run)])).collect();
            let surrogate = Surrogate::fit(&families, &points, &outputs, &options)?;
            let variance = size * size / count as f64 * (1.0 - surrogate.q2()).max(0.0);
            for (row, error) in errors.iter_mut().enumerate() {
                *error += left[(row, *mode)].powi(2) * variance;
            }
            amplitudes.push(surrogate);
        }
        let modes = DMatrix::from_fn(length, taken.len(), |row, column| left[(row, taken[column])]);
        Ok(TestSurrogate { region, mean, modes, amplitudes, errors })
    }

    /// The differences at a point; none outside of the region.
    pub(super) fn differences(&self, point: &[f64]) -> Option<DVector<f64>> {
        let unit = self.region.unit(point)?;
        let amplitudes =
            DVector::from_iterator(self.amplitudes.len(), self.amplitudes.iter().map(|own| own.predict(&unit)));
        Some(&self.modes * amplitudes + &self.mean)
    }

    /// Variance of the error of every coordinate.
    pub(super) fn errors(&self) -> &[f64] {
        &self.errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use uncertainty::random::Stream;

    /// A bent curve of 40 coordinates over two unknowns is met within its own error, which noise of the runs raises.
    #[test]
    fn differences_are_met_within_the_error_that_is_stated() {
        let region = Region { low: vec![-1.0, 2.0], high: vec![1.0, 3.0] };
        let truth =
            |x: &[f64], row: usize| 20.0 * (0.1 * row as f64 * x[1]).sin() * (1.0 + 0.3 * x[0] + 0.2 * x[0] * x[0]);
        for (noise, least) in [(0.0, 0.0), (0.5, 0.1)] {
            let mut stream = Stream::new(3);
            let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..60)
                .map(|_| {
                    let point = region.at(&[stream.uniform(), stream.uniform()]);
                    let found = (0..40).map(|row| truth(&point, row) + noise * stream.normal()).collect();
                    (point, found)
                })
                .collect();
            let fitted = TestSurrogate::fit(region.clone(), &runs).unwrap();
            let mut square = 0.0;
            for _ in 0..50 {
                let point = region.at(&[stream.uniform(), stream.uniform()]);
                let found = fitted.differences(&point).unwrap();
                square += (0..40).map(|row| (found[row] - truth(&point, row)).powi(2)).sum::<f64>() / 2000.0;
            }
            let stated = fitted.errors().iter().sum::<f64>() / 40.0;
            assert!(square.sqrt() < 0.05 + 1.5 * stated.sqrt() && stated.sqrt() >= least, "{square} {stated}");
        }
        assert!(matches!(
            TestSurrogate::fit(region, &[]).err(),
            Some(SurrogateError::TooFewSamples { samples: 0, .. })
        ));
    }
}
