//! A surrogate of one test: what its signals differ by from the recordings, and what it demands of its film, as polynomials
//! of the unknowns within a box.
//!
//! The differences of all runs are reduced to their principal components (as Higdon et al. 2008), each of which is a sparse
//! polynomial chaos. Its likelihood contains what cross-validation leaves of each component, which is an error of all
//! coordinates together, and what components that are left out leave of every coordinate (docs/theory.md, equation 334).

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

/// The differences and demands of a test as functions of the unknowns that act on it.
pub(super) struct TestSurrogate {
    region: Region,
    differences: Differences,
    demands: Vec<Amplitude>,
    /// Variances of the errors of the demands.
    demand_errors: Vec<f64>,
}

/// A polynomial of the unknowns; a constant where no unknown acts on the test.
enum Amplitude {
    Constant(f64),
    Varying {
        surrogate: Surrogate,
        /// Variance of its error, by cross-validation.
        error: f64,
    },
}

/// The differences of all signals.
struct Differences {
    mean: DVector<f64>,
    /// Components as columns.
    modes: DMatrix<f64>,
    amplitudes: Vec<Amplitude>,
    /// Variance of the error of every component's amplitude, by cross-validation.
    amplitude_errors: Vec<f64>,
    /// Variance of every coordinate that components which are left out have.
    errors: Vec<f64>,
}

impl TestSurrogate {
    /// Fits runs at points of a region, of whose numbers the first `compared` are differences and the others demands; runs
    /// outside of it are left out.
    pub(super) fn fit(
        region: Region,
        runs: &[(Vec<f64>, Vec<f64>)],
        compared: usize,
    ) -> Result<TestSurrogate, SurrogateError> {
        let inside: Vec<(Vec<f64>, &[f64])> =
            runs.iter().filter_map(|(point, found)| Some((region.unit(point)?, found.as_slice()))).collect();
        let count = inside.len();
        let points: Vec<Vec<f64>> = inside.iter().map(|(point, _)| point.clone()).collect();
        let Some(numbers) = inside.first().map(|(_, found)| found.len()) else {
            let (terms, needed) = (region.low.len() + 1, 2 * region.low.len() + 3);
            return Err(SurrogateError::TooFewSamples { samples: 0, terms, needed });
        };
        let demands = (compared..numbers).map(|place| {
            let outputs: Vec<f64> = inside.iter().map(|(_, found)| found[place]).collect();
            Amplitude::fit(&points, &outputs)
        });
        let demands = demands.collect::<Result<Vec<_>, _>>()?;
        let all = DMatrix::from_fn(compared, count, |row, column| inside[column].1[row]);
        let differences = Differences::fit(&points, &all)?;
        let demand_errors = demands.iter().map(Amplitude::error).collect();
        Ok(TestSurrogate { region, differences, demands, demand_errors })
    }

    /// The differences and demands at a point; none outside of the region.
    pub(super) fn at(&self, point: &[f64]) -> Option<(DVector<f64>, Vec<f64>)> {
        let unit = self.region.unit(point)?;
        Some((self.differences.at(&unit), self.demands.iter().map(|own| own.at(&unit)).collect()))
    }

    /// Logarithm of the likelihood of these differences, up to a constant, where coordinates have these variances of noise and
    /// model error beside the surrogate's own.
    pub(super) fn log_likelihood(&self, differences: &DVector<f64>, variances: &[f64]) -> f64 {
        self.differences.log_likelihood(differences, variances)
    }

    /// Variances of the errors of the demands.
    pub(super) fn demand_errors(&self) -> &[f64] {
        &self.demand_errors
    }
}

impl Amplitude {
    fn fit(points: &[Vec<f64>], outputs: &[f64]) -> Result<Amplitude, SurrogateError> {
        let inputs = points.first().map_or(0, Vec::len);
        if inputs == 0 || outputs.iter().all(|output| *output == outputs[0]) {
            return Ok(Amplitude::Constant(outputs[0]));
        }
        let options = Options { highest_degree: HIGHEST_DEGREE, ..Options::default() };
        let given: Vec<Option<f64>> = outputs.iter().copied().map(Some).collect();
        let surrogate = Surrogate::fit(&vec![Family::Legendre; inputs], points, &given, &options)?;
        let variance = uncertainty::statistics::variance(outputs).unwrap_or(0.0);
        let error = variance * (1.0 - surrogate.q2()).max(0.0);
        Ok(Amplitude::Varying { surrogate, error })
    }

    fn at(&self, unit: &[f64]) -> f64 {
        match self {
            Amplitude::Constant(value) => *value,
            Amplitude::Varying { surrogate, .. } => surrogate.predict(unit),
        }
    }

    fn error(&self) -> f64 {
        match self {
            Amplitude::Constant(_) => 0.0,
            Amplitude::Varying { error, .. } => *error,
        }
    }
}

impl Differences {
    /// Fits the differences of runs, a column each, at points in unit coordinates.
    fn fit(points: &[Vec<f64>], all: &DMatrix<f64>) -> Result<Differences, SurrogateError> {
        let (length, count) = all.shape();
        if length == 0 || points.iter().all(Vec::is_empty) {
            let mean = if length == 0 { DVector::zeros(0) } else { all.column_mean() };
            return Ok(Differences {
                mean,
                modes: DMatrix::zeros(length, 0),
                amplitudes: Vec::new(),
                amplitude_errors: Vec::new(),
                errors: vec![0.0; length],
            });
        }
        let mean = all.column_mean();
        let centred = DMatrix::from_fn(length, count, |row, column| all[(row, column)] - mean[row]);
        let decomposed = centred.svd(true, true);
        let (Some(left), Some(right)) = (decomposed.u, decomposed.v_t) else { return Err(SurrogateError::Constant) };
        let mut order: Vec<usize> = (0..decomposed.singular_values.len()).collect();
        order.sort_by(|a, b| decomposed.singular_values[*b].total_cmp(&decomposed.singular_values[*a]));
        let limit = (LEFT_OUT * count as f64).sqrt();
        let taken: Vec<usize> =
            order.iter().copied().filter(|mode| decomposed.singular_values[*mode] > limit).take(MOST_MODES).collect();
        let errors: Vec<f64> = (0..length)
            .map(|row| {
                let others = order.iter().filter(|mode| !taken.contains(mode));
                others.map(|mode| (left[(row, *mode)] * decomposed.singular_values[*mode]).powi(2)).sum::<f64>()
                    / count as f64
            })
            .collect();
        let (mut amplitudes, mut amplitude_errors) = (Vec::new(), Vec::new());
        for mode in &taken {
            let size = decomposed.singular_values[*mode];
            let outputs: Vec<f64> = (0..count).map(|run| size * right[(*mode, run)]).collect();
            let amplitude = Amplitude::fit(points, &outputs)?;
            amplitude_errors.push(amplitude.error());
            amplitudes.push(amplitude);
        }
        let modes = DMatrix::from_fn(length, taken.len(), |row, column| left[(row, taken[column])]);
        Ok(Differences { mean, modes, amplitudes, amplitude_errors, errors })
    }

    /// The differences at a point in unit coordinates.
    fn at(&self, unit: &[f64]) -> DVector<f64> {
        let amplitudes = DVector::from_iterator(self.amplitudes.len(), self.amplitudes.iter().map(|own| own.at(unit)));
        &self.modes * amplitudes + &self.mean
    }

    /// See [`TestSurrogate::log_likelihood`]: the covariance is a diagonal and one direction a component (Woodbury).
    fn log_likelihood(&self, differences: &DVector<f64>, variances: &[f64]) -> f64 {
        let diagonal = DVector::from_iterator(
            variances.len(),
            variances.iter().zip(&self.errors).map(|(variance, error)| variance + error),
        );
        let weighted = differences.component_div(&diagonal);
        let mut square = differences.dot(&weighted);
        let mut log_determinant = diagonal.iter().map(|variance| variance.ln()).sum::<f64>();
        // Directions scaled by the deviations of their errors, so that one without an error drops out.
        let deviations = DVector::from_iterator(
            self.amplitude_errors.len(),
            self.amplitude_errors.iter().map(|variance| variance.sqrt()),
        );
        let mut scaled = self.modes.clone();
        for (mut column, deviation) in scaled.column_iter_mut().zip(deviations.iter()) {
            column.zip_apply(&diagonal, |entry, variance| *entry *= deviation / variance.sqrt());
        }
        let inner = DMatrix::identity(deviations.len(), deviations.len()) + scaled.tr_mul(&scaled);
        let projected = self.modes.tr_mul(&weighted).component_mul(&deviations);
        // The identity keeps it positive definite.
        if let Some(factor) = inner.cholesky() {
            square -= projected.dot(&factor.solve(&projected));
            log_determinant += 2.0 * factor.l_dirty().diagonal().iter().map(|entry| entry.ln()).sum::<f64>();
        }
        -0.5 * (square + log_determinant)
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
            let fitted = TestSurrogate::fit(region.clone(), &runs, 40).unwrap();
            let mut square = 0.0;
            for _ in 0..50 {
                let point = region.at(&[stream.uniform(), stream.uniform()]);
                let found = fitted.at(&point).unwrap().0;
                square += (0..40).map(|row| (found[row] - truth(&point, row)).powi(2)).sum::<f64>() / 2000.0;
            }
            let own = &fitted.differences;
            let stated = (own.errors.iter().sum::<f64>() + own.amplitude_errors.iter().sum::<f64>()) / 40.0;
            assert!(square.sqrt() < 0.05 + 1.5 * stated.sqrt() && stated.sqrt() >= least, "{square} {stated}");
        }
        // The likelihood is that of the covariance written out.
        let fitted = Differences {
            mean: DVector::zeros(3),
            modes: DMatrix::from_column_slice(3, 2, &[0.6, 0.8, 0.0, 0.0, 0.0, 1.0]),
            amplitudes: Vec::new(),
            amplitude_errors: vec![2.0, 0.0],
            errors: vec![0.1, 0.2, 0.3],
        };
        let variances = [1.0, 2.0, 0.5];
        let mut covariance = DMatrix::from_diagonal(&DVector::from_column_slice(&[1.1, 2.2, 0.8]));
        covariance += 2.0 * fitted.modes.column(0) * fitted.modes.column(0).transpose();
        let differences = DVector::from_column_slice(&[1.0, -2.0, 0.7]);
        let square = differences.dot(&(covariance.clone().try_inverse().unwrap() * &differences));
        let expected = -0.5 * (square + covariance.determinant().ln());
        assert!((fitted.log_likelihood(&differences, &variances) - expected).abs() < 1e-12);
        assert!(matches!(
            TestSurrogate::fit(region, &[], 0).err(),
            Some(SurrogateError::TooFewSamples { samples: 0, .. })
        ));
    }
}
