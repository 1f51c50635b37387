//! Damped least squares of a function that costs nothing: Levenberg and Marquardt's method from one start.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
// The version of nalgebra that the crate uses.
use nalgebra_of_lm::{DMatrix, DVector, Dyn, Owned};

use base::cancellation::stop_if_cancelled;

/// Difference of an unknown over its size, at least one, by which residuals are differentiated.
const DIFFERENCE: f64 = 1e-5;

/// Evaluations for each unknown.
const PATIENCE: usize = 200;

/// Stands for a residual that is not finite.
const WORST: f64 = 1e6;

/// A local minimum of |r(u)|² below `start`, of unknowns of order one.
pub(super) fn descend(start: Vec<f64>, residuals: &dyn Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let problem = Problem { u: DVector::from_vec(start), residuals };
    let (problem, _) = LevenbergMarquardt::new().with_tol(1e-15).with_patience(PATIENCE).minimize(problem);
    problem.u.as_slice().to_vec()
}

struct Problem<'a> {
    u: DVector<f64>,
    residuals: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

impl Problem<'_> {
    fn residuals_at(&self, u: &[f64]) -> DVector<f64> {
        stop_if_cancelled();
        let finite = |r: f64| if r.is_finite() { r } else { WORST };
        DVector::from_vec((self.residuals)(u).into_iter().map(finite).collect())
    }
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
        Some(self.residuals_at(self.u.as_slice()))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let column = |index: usize| {
            let step = DIFFERENCE * self.u[index].abs().max(1.0);
            let beside = |step: f64| {
                let mut u = self.u.clone();
                u[index] += step;
                self.residuals_at(u.as_slice())
            };
            (beside(step) - beside(-step)) / (2.0 * step)
        };
        Some(DMatrix::from_columns(&(0..self.u.len()).map(column).collect::<Vec<_>>()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
