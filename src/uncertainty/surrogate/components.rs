//! Surrogate of many outputs that vary together, such as the samples of a signal: polynomials of the inputs for the
//! amplitudes of their principal components (Higdon et al. 2008), and the likelihood of what they should be.

use nalgebra::{DMatrix, DVector};

use super::{Family, Output, Surrogate, polynomials};
use crate::{Error, ensure};

/// Most principal components.
const MOST: usize = 12;
/// Variance that components which are left out may have.
const LEFT_OUT: f64 = 1e-3;

/// Many outputs as functions of the inputs: their mean and the principal components of their scatter, each of which has an
/// amplitude that is a polynomial chaos.
///
/// Outputs are in units of the deviation of their noise, so that components which are left out are less than that.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    mean: DVector<f64>,
    /// Components as columns.
    modes: DMatrix<f64>,
    amplitudes: Vec<Output>,
    /// Components that are left out as columns, of the size of their deviation.
    left_out: DMatrix<f64>,
}

impl Components {
    /// Fits outputs, a column for each of the points of the open unit cube.
    ///
    /// # Errors
    /// See [`Error`].
    pub fn fit(
        families: &[Family],
        points: &[Vec<f64>],
        outputs: &DMatrix<f64>,
        highest_degree: usize,
    ) -> Result<Components, Error> {
        let (length, count) = outputs.shape();
        ensure(points.len() == count, || format!("{} points have {count} outputs", points.len()))?;
        if length == 0 || families.is_empty() {
            let mean = if length == 0 { DVector::zeros(0) } else { outputs.column_mean() };
            let modes = DMatrix::zeros(length, 0);
            return Ok(Components { mean, modes: modes.clone(), amplitudes: Vec::new(), left_out: modes });
        }
        let mean = outputs.column_mean();
        let centred = DMatrix::from_fn(length, count, |row, column| outputs[(row, column)] - mean[row]);
        let decomposed = centred.svd(true, true);
        let (Some(left), Some(right)) = (decomposed.u, decomposed.v_t) else {
            return Err(Error::new("the output is the same everywhere: there is nothing to model"));
        };
        let sizes = decomposed.singular_values;
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
        let limit = (LEFT_OUT * count as f64).sqrt();
        let taken = order.iter().take(MOST).take_while(|mode| sizes[**mode] > limit).count();
        let (taken, others) = order.split_at(taken);
        let amplitudes = taken.iter().map(|mode| {
            let own: Vec<f64> = (0..count).map(|sample| sizes[*mode] * right[(*mode, sample)]).collect();
            Output::fit(families, points, &own, highest_degree)
        });
        let left_out = DMatrix::from_fn(length, others.len(), |row, column| {
            left[(row, others[column])] * sizes[others[column]] / (count as f64).sqrt()
        });
        Ok(Components {
            mean,
            modes: DMatrix::from_fn(length, taken.len(), |row, column| left[(row, taken[column])]),
            amplitudes: amplitudes.collect::<Result<_, _>>()?,
            left_out,
        })
    }

    /// Number of components.
    pub fn count(&self) -> usize {
        self.amplitudes.len()
    }

    /// Their amplitudes at a point of the open unit cube.
    ///
    /// # Panics
    /// The point has fewer coordinates than the fit.
    pub fn amplitudes(&self, point: &[f64]) -> Vec<f64> {
        let fitted = || self.amplitudes.iter().filter_map(Output::surrogate);
        let degree = fitted().map(Surrogate::degree).max().unwrap_or(0);
        let families = fitted().next().map_or(&[][..], |surrogate| &surrogate.families);
        let values = polynomials(families, point, degree);
        self.amplitudes.iter().map(|own| own.with(&values)).collect()
    }

    /// The outputs that have these amplitudes.
    ///
    /// # Panics
    /// Their number is not that of the components.
    pub fn outputs(&self, amplitudes: &[f64]) -> DVector<f64> {
        &self.modes * DVector::from_column_slice(amplitudes) + &self.mean
    }

    /// Variance of the error of all outputs together: of amplitudes by cross-validation, and of components that are left out.
    pub fn error(&self) -> f64 {
        self.amplitudes.iter().map(Output::error).sum::<f64>() + self.left_out.norm_squared()
    }

    /// The same in other coordinates of the outputs, the rows of an orthogonal matrix.
    ///
    /// # Panics
    /// The number of its columns is not that of the outputs.
    pub fn rotated(&self, basis: &DMatrix<f64>) -> Components {
        let amplitudes = self.amplitudes.clone();
        Components {
            mean: basis * &self.mean,
            modes: basis * &self.modes,
            amplitudes,
            left_out: basis * &self.left_out,
        }
    }

    /// The likelihood that outputs are zero but for normal noise of these variances, beside the surrogate's own, which along a
    /// component is an error of all outputs together. Its logarithm, up to a constant that does not depend on the variances, is the
    /// sum of these factors, of the products of each amplitude with itself and those before it, one for the mean as the
    /// first; and what is added.
    ///
    /// # Panics
    /// The number of variances is not that of the outputs.
    pub fn likelihood(&self, variances: &[f64]) -> Vec<f64> {
        assert_eq!(variances.len(), self.mean.len(), "one variance an output");
        let of_row = |row: usize| variances[row] + self.left_out.row(row).norm_squared();
        let diagonal = DVector::from_fn(variances.len(), |row, _| of_row(row));
        let deviation = diagonal.map(f64::sqrt);
        // The mean and the components, each output over its deviation.
        let scaled = DMatrix::from_fn(diagonal.len(), 1 + self.count(), |row, column| {
            let own = if column == 0 { self.mean[row] } else { self.modes[(row, column - 1)] };
            own / deviation[row]
        });
        let mut form = scaled.tr_mul(&scaled);
        let mut constant = diagonal.iter().map(|variance| variance.ln()).sum::<f64>();
        // The covariance is a diagonal and one direction a component (Woodbury), scaled by the deviation of its error, so that
        // one without an error drops out.
        let errors: Vec<f64> = self.amplitudes.iter().map(|own| own.error().sqrt()).collect();
        let inner = DMatrix::from_fn(self.count(), self.count(), |row, column| {
            let unit = if row == column { 1.0 } else { 0.0 };
            unit + errors[row] * form[(row + 1, column + 1)] * errors[column]
        });
        let projected =
            DMatrix::from_fn(self.count(), 1 + self.count(), |row, column| errors[row] * form[(row + 1, column)]);
        // The identity keeps it positive definite.
        if let Some(factor) = inner.cholesky() {
            form -= projected.tr_mul(&factor.solve(&projected));
            constant += 2.0 * factor.l_dirty().diagonal().iter().map(|entry| entry.ln()).sum::<f64>();
        }
        let factor = |column: usize, row: usize| if row == column { -0.5 } else { -1.0 } * form[(row, column)];
        let pairs = (0..=self.count()).flat_map(|column| (0..=column).map(move |row| (column, row)));
        pairs.map(|(column, row)| factor(column, row)).chain([-0.5 * constant]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// The sum of factors of products of amplitudes.
    fn log(factors: &[f64], amplitudes: &[f64]) -> f64 {
        let all: Vec<f64> = [&[1.0], amplitudes].concat();
        let pairs = (0..all.len()).flat_map(|column| (0..=column).map(move |row| (column, row)));
        let products = pairs.map(|(column, row)| all[column] * all[row]).chain([1.0]);
        products.zip(factors).map(|(product, factor)| product * factor).sum()
    }

    fn truth(x: &[f64], row: usize) -> f64 {
        20.0 * (0.1 * row as f64 * (2.0 + x[1])).sin() * (1.0 + 0.6 * (x[0] - 0.5) + 0.8 * (x[0] - 0.5).powi(2))
    }

    /// A bent curve of 40 outputs over two inputs is met within its own error, which noise of the samples raises.
    #[test]
    fn outputs_are_met_within_the_error_that_is_stated() {
        for (noise, least) in [(0.0, 0.0), (0.5, 0.1)] {
            let mut stream = Stream::new(3);
            let points: Vec<Vec<f64>> = (0..60).map(|_| vec![stream.uniform(), stream.uniform()]).collect();
            let outputs = DMatrix::from_fn(40, 60, |row, run| truth(&points[run], row) + noise * stream.normal());
            let fitted = Components::fit(&[Family::Legendre; 2], &points, &outputs, 6).unwrap();
            let mut square = 0.0;
            for _ in 0..50 {
                let point = [stream.uniform(), stream.uniform()];
                let found = fitted.outputs(&fitted.amplitudes(&point));
                square += (0..40).map(|row| (found[row] - truth(&point, row)).powi(2)).sum::<f64>() / 2000.0;
            }
            let stated = (fitted.error() / 40.0).sqrt();
            assert!(square.sqrt() < 0.05 + 1.5 * stated && stated >= least, "{square} {stated}");
        }
    }

    /// The likelihood is that of the covariance written out, also of a component without an error.
    #[test]
    fn the_likelihood_is_that_of_the_covariance_written_out() {
        let points: Vec<Vec<f64>> = (0..40).map(|place| vec![(f64::from(place) + 0.5) / 40.0]).collect();
        let rough = |place: usize| 0.4 * (13.0 * place as f64).sin();
        let outputs = DMatrix::from_fn(3, 40, |row, run| match row {
            0 => 3.0 + 10.0 * points[run][0] + rough(run),
            1 => -6.0 * points[run][0] + rough(run + 7),
            _ => 1e-3 * rough(run + 3),
        });
        let fitted = Components::fit(&[Family::Legendre], &points, &outputs, 12).unwrap();
        let variances = [1.0, 2.0, 0.5];
        let amplitudes = fitted.amplitudes(&[0.3]);
        let mut covariance = DMatrix::from_fn(3, 3, |row, column| {
            if row == column { variances[row] + fitted.left_out.row(row).norm_squared() } else { 0.0 }
        });
        for (own, mode) in fitted.amplitudes.iter().zip(fitted.modes.column_iter()) {
            covariance += own.error() * mode * mode.transpose();
        }
        assert!(fitted.count() == 2 && fitted.error() > 0.01, "{fitted:?}");
        let differences = fitted.outputs(&amplitudes);
        let square = differences.dot(&(covariance.clone().try_inverse().unwrap() * &differences));
        let expected = -0.5 * (square + covariance.determinant().ln());
        assert!((log(&fitted.likelihood(&variances), &amplitudes) - expected).abs() < 1e-12);
    }

    #[test]
    fn outputs_that_no_input_changes_have_no_component() {
        let outputs = DMatrix::from_element(2, 1, 3.0);
        let fitted = Components::fit(&[], &[Vec::new()], &outputs, 12).unwrap();
        assert!(fitted.count() == 0 && fitted.outputs(&fitted.amplitudes(&[])) == DVector::from_element(2, 3.0));
        let expected = -0.5 * (9.0 / 2.0 + 9.0 / 4.0 + 8.0_f64.ln());
        assert!((log(&fitted.likelihood(&[2.0, 4.0]), &[]) - expected).abs() < 1e-14);
        let none = Components::fit(&[Family::Legendre], &[], &outputs, 12);
        assert_eq!(none, Err(Error::new("0 points have 1 outputs")));
    }
}
