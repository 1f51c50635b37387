//! Linear least squares of few coefficients over many rows, and nonlinear ones of residuals.

use std::cell::RefCell;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, MinimizationReport};
use nalgebra::{SMatrix, SVector};
// The version of nalgebra that the crate of the method uses.
use nalgebra_of_lm::{DMatrix, DVector, Dyn, Owned};

use base::cancellation::stop_if_cancelled;

/// The coefficients c with the least Σ (Σ_j c_j x_j − y)² over all rows (x, y), and that sum of squares.
///
/// Columns should be of one order of magnitude. None where the rows do not determine the coefficients.
pub(super) fn least_squares<const N: usize>(
    rows: impl Iterator<Item = ([f64; N], f64)> + Clone,
) -> Option<([f64; N], f64)> {
    let (mut normal, mut right) = (SMatrix::<f64, N, N>::zeros(), SVector::<f64, N>::zeros());
    for (x, y) in rows.clone() {
        let x = SVector::from(x);
        normal += x * x.transpose();
        right += x * y;
    }
    let coefficients: [f64; N] = normal.cholesky()?.solve(&right).into();
    let gap = |(x, y): ([f64; N], f64)| y - (0..N).map(|j| coefficients[j] * x[j]).sum::<f64>();
    let left = rows.map(|row| gap(row).powi(2)).sum();
    coefficients.iter().all(|c| c.is_finite()).then_some((coefficients, left))
}

/// Residuals of unknowns u, for a search after Levenberg and Marquardt.
pub trait Residuals {
    /// Those at u; none ends the search.
    fn at(&mut self, u: &[f64]) -> Option<Vec<f64>>;

    /// Their derivatives at u, a column for each unknown; none ends the search.
    fn derivatives(&mut self, u: &[f64]) -> Option<Vec<Vec<f64>>>;
}

/// A local minimum of |r(u)|² below `start`, and why the search ended there.
pub fn minimize(
    method: LevenbergMarquardt<f64>,
    start: Vec<f64>,
    residuals: &mut dyn Residuals,
) -> (Vec<f64>, MinimizationReport<f64>) {
    let problem = Problem { u: DVector::from_vec(start), residuals: RefCell::new(residuals) };
    let (problem, report) = method.minimize(problem);
    (problem.u.as_slice().to_vec(), report)
}

struct Problem<'a> {
    u: DVector<f64>,
    /// The crate evaluates through shared references.
    residuals: RefCell<&'a mut dyn Residuals>,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, u: &DVector<f64>) {
        self.u.copy_from(u);
    }

    fn params(&self) -> DVector<f64> {
        self.u.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.residuals.borrow_mut().at(self.u.as_slice()).map(DVector::from_vec)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let columns = self.residuals.borrow_mut().derivatives(self.u.as_slice())?;
        Some(DMatrix::from_columns(&columns.into_iter().map(DVector::from_vec).collect::<Vec<_>>()))
    }
}

/// `u` with the unknown at `index` moved by `step`.
pub fn moved(u: &[f64], index: usize, step: f64) -> Vec<f64> {
    let mut u = u.to_vec();
    u[index] += step;
    u
}

/// Difference of an unknown over its size, at least one, by which residuals are differentiated.
const DIFFERENCE: f64 = 1e-5;

/// Evaluations for each unknown.
const PATIENCE: usize = 200;

/// Stands for a residual that is not finite.
const WORST: f64 = 1e6;

/// A local minimum of |r(u)|² below `start`, of unknowns of order one.
pub(super) fn descend(start: Vec<f64>, residuals: &dyn Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let method = LevenbergMarquardt::new().with_tol(1e-15).with_patience(PATIENCE);
    minimize(method, start, &mut Finite(residuals)).0
}

/// Residuals that are finite everywhere, and their central differences.
struct Finite<'a>(&'a dyn Fn(&[f64]) -> Vec<f64>);

impl Residuals for Finite<'_> {
    fn at(&mut self, u: &[f64]) -> Option<Vec<f64>> {
        stop_if_cancelled();
        let finite = |r: f64| if r.is_finite() { r } else { WORST };
        Some((self.0)(u).into_iter().map(finite).collect())
    }

    fn derivatives(&mut self, u: &[f64]) -> Option<Vec<Vec<f64>>> {
        let column = |index: usize| {
            let step = DIFFERENCE * u[index].abs().max(1.0);
            let [above, below] = [step, -step].map(|step| self.at(&moved(u, index, step)));
            Some(above?.iter().zip(below?).map(|(above, below)| (above - below) / (2.0 * step)).collect())
        };
        (0..u.len()).map(column).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_found_again() {
        let rows = (0..20).map(|i| f64::from(i) / 10.0).map(|t| ([1.0, t, t * t], 3.0 - 2.0 * t + 0.5 * t * t));
        let (found, left) = least_squares(rows).unwrap();
        for (found, expected) in found.into_iter().zip([3.0, -2.0, 0.5]) {
            assert!((found - expected).abs() < 1e-10, "{found} for {expected}");
        }
        assert!(left < 1e-18);
    }

    #[test]
    fn the_residual_is_the_scatter() {
        let rows = [1.0, -1.0, 1.0, -1.0].map(|y| ([1.0], y));
        assert_eq!(least_squares(rows.into_iter()), Some(([0.0], 4.0)));
    }

    #[test]
    fn too_few_rows_determine_nothing() {
        assert_eq!(least_squares([([1.0, 2.0], 3.0)].into_iter()), None);
    }

    #[test]
    fn rosenbrocks_valley_is_followed() {
        let found = descend(vec![-1.2, 1.0], &|u| vec![10.0 * (u[1] - u[0] * u[0]), 1.0 - u[0]]);
        assert!(found.iter().all(|u| (u - 1.0).abs() < 1e-9), "{found:?}");
    }

    #[test]
    fn a_region_without_values_is_left() {
        let found = descend(vec![4.0], &|u| vec![if u[0] < 5.0 { u[0].sqrt() - 2.2 } else { f64::NAN }]);
        assert!((found[0] - 4.84).abs() < 1e-9, "{found:?}");
    }
}
