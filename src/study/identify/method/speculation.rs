//! Speculative points of a simplex, from a surrogate model.
//!
//! The residuals at the vertices define an affine function, which approximates the residuals where they are smooth over
//! the simplex. A copy of the simplex iterates on the values of this surrogate; the points that it requests are
//! evaluated speculatively. A wrong prediction costs a trial and does not change the search.

use nalgebra::{DMatrix, DVector};

use super::simplex::{Simplex, SimplexValues};
use super::trials::Trials;
use crate::identify::objective::{Evaluation, ObjectiveValue};

/// Limit of iterations on the surrogate for each point. Iterations over cached points request none, and a simplex that
/// collapsed onto such points iterates over them without end.
const MAX_ITERATIONS: usize = 4;

/// Points that `simplex` requests next if the surrogate is right, in their order; at most `max`, none without
/// residuals.
pub(super) fn points(simplex: &Simplex, trials: &Trials<'_, '_>, max: usize) -> Vec<Vec<f64>> {
    let Some(model) = Affine::through(simplex, trials) else { return vec![] };
    let mut values = Predicted { trials, model, max, points: vec![] };
    let mut simplex = simplex.clone();
    for _ in 0..MAX_ITERATIONS * max {
        if simplex.advance(&mut values).is_err() {
            break;
        }
    }
    values.points
}

/// Cached values, and those of the surrogate at other points.
struct Predicted<'t, 'c, 'a> {
    trials: &'t Trials<'c, 'a>,
    model: Affine,
    max: usize,
    /// The other points.
    points: Vec<Vec<f64>>,
}

/// There are as many points as requested for.
struct Enough;

impl SimplexValues for Predicted<'_, '_, '_> {
    type Error = Enough;

    fn value(&mut self, x: &[f64]) -> Result<f64, Enough> {
        match self.trials.cached(x) {
            Some(Evaluation::Value(value)) => Ok(value.value()),
            // As the search itself counts a failed trial.
            Some(_) => Ok(f64::INFINITY),
            None => self.predict_value(x),
        }
    }

    fn project(&self, x: &mut [f64]) {
        self.trials.search.bounds.project(x);
    }
}

impl Predicted<'_, '_, '_> {
    fn predict_value(&mut self, x: &[f64]) -> Result<f64, Enough> {
        // The copy may come back to a point: it costs no further trial.
        if self.points.iter().any(|point| point == x) {
            return Ok(self.model.value(x));
        }
        if self.points.len() >= self.max {
            return Err(Enough);
        }
        self.points.push(x.to_vec());
        Ok(self.model.value(x))
    }
}

/// r(x) = r₀ + R X⁻¹ (x − x₀), with the differences of the other vertices from the best as columns of X, those of their
/// residuals as columns of R.
struct Affine {
    origin: DVector<f64>,
    residuals: DVector<f64>,
    slope: DMatrix<f64>,
}

impl Affine {
    /// None where a vertex has no residuals, or the simplex has collapsed.
    fn through(simplex: &Simplex, trials: &Trials<'_, '_>) -> Option<Affine> {
        let residuals = |x: &[f64]| match trials.cached(x)? {
            Evaluation::Value(ObjectiveValue::Residuals(residuals)) => Some(DVector::from_vec(residuals)),
            _ => None,
        };
        let (best, others) = simplex.vertices.split_first()?;
        let (origin, here) = (DVector::from_column_slice(&best.x), residuals(&best.x)?);
        let there = others.iter().map(|vertex| residuals(&vertex.x)).collect::<Option<Vec<_>>>()?;
        if there.iter().any(|there| there.len() != here.len()) {
            return None;
        }
        let edges: Vec<_> = others.iter().map(|vertex| DVector::from_column_slice(&vertex.x) - &origin).collect();
        let differences: Vec<_> = there.iter().map(|there| there - &here).collect();
        let slope = DMatrix::from_columns(&differences) * DMatrix::from_columns(&edges).try_inverse()?;
        Some(Affine { origin, residuals: here, slope })
    }

    fn value(&self, x: &[f64]) -> f64 {
        (&self.residuals + &self.slope * (DVector::from_column_slice(x) - &self.origin)).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::error::SearchError;
    use crate::identify::options::{Method, Search};
    use crate::identify::pool::trial_pool::with_evaluator;

    /// Affine residuals, which the surrogate reproduces.
    fn plane(x: &[f64]) -> Vec<f64> {
        vec![3.0 * x[0] - x[1], x[1] + 2.0, 0.5 * x[0] + x[1] - 1.0, 0.3]
    }

    /// Records the points that are requested.
    struct Requested<'t, 'c, 'a>(&'t Trials<'c, 'a>, Vec<Vec<f64>>);

    impl SimplexValues for Requested<'_, '_, '_> {
        type Error = SearchError;

        fn value(&mut self, x: &[f64]) -> Result<f64, SearchError> {
            self.1.push(x.to_vec());
            Ok(self.0.value(x)?.map_or(f64::INFINITY, |value| value.value()))
        }
    }

    #[test]
    fn points_of_affine_residuals_are_predicted() {
        let search = Search::new(Method::NelderMead, vec![4.0, 3.0]);
        let found = with_evaluator(&plane, 1, |evaluator| {
            let trials = Trials::new(&search, evaluator);
            let mut requested = Requested(&trials, vec![]);
            let mut simplex = Simplex::around(&search.start, &mut requested)?;
            let mut right = vec![];
            for _ in 0..10 {
                let predicted = points(&simplex, &trials, 5);
                requested.1.clear();
                let mut on = simplex.clone();
                while requested.1.len() < 5 {
                    on.advance(&mut requested)?;
                }
                right.push(predicted.len() == 5 && predicted == requested.1[..5]);
                simplex = on;
            }
            Ok::<_, SearchError>(right)
        });
        assert_eq!(found.unwrap(), vec![true; 10]);
    }

    #[test]
    fn scalars_have_no_surrogate() {
        let value = |x: &[f64]| x[0] * x[0];
        let search = Search::new(Method::NelderMead, vec![4.0]);
        let found = with_evaluator(&value, 1, |evaluator| {
            let trials = Trials::new(&search, evaluator);
            let simplex = Simplex::around(&search.start, &mut Requested(&trials, vec![]))?;
            Ok::<_, SearchError>(points(&simplex, &trials, 5))
        });
        assert_eq!(found.unwrap(), Vec::<Vec<f64>>::new());
    }
}
