//! What a simplex will ask for next, guessed from what is known, for cores that work ahead.
//!
//! Residuals that are known at all corners give those of any other point by the affine function through them, which is as
//! good as the objective is smooth over the simplex. With guessed values the search is carried on in thought, and what it asks
//! for there is worth trying. A wrong guess costs a trial in vain and nothing else.

use nalgebra::{DMatrix, DVector};

use super::nelder_mead::{Simplex, Values};
use super::objective::{Answer, Evaluation};
use super::search::Trials;

/// Iterations in thought for every point that is wanted, at most. Those among points that are known want none, and a simplex
/// that was pressed onto such points goes on among them for ever.
const MOST_ITERATIONS: usize = 4;

/// Points that `simplex` asks for next, in their order, where the guess is right; at most `most`, none without residuals.
pub(super) fn points(simplex: &Simplex, trials: &Trials<'_, '_>, most: usize) -> Vec<Vec<f64>> {
    let Some(model) = Affine::through(simplex, trials) else { return vec![] };
    let mut foresight = Foresight { trials, model, most, wanted: vec![] };
    let mut thought = simplex.clone();
    for _ in 0..MOST_ITERATIONS * most {
        if thought.advance(&mut foresight).is_err() {
            break;
        }
    }
    foresight.wanted
}

/// Values as they are, where they are known, or else as they are guessed.
struct Foresight<'t, 'c, 'a> {
    trials: &'t Trials<'c, 'a>,
    model: Affine,
    most: usize,
    wanted: Vec<Vec<f64>>,
}

/// As many points are wanted as there may be, or there is no guess.
struct Enough;

impl Values for Foresight<'_, '_, '_> {
    type Error = Enough;

    fn value(&mut self, x: &[f64]) -> Result<f64, Enough> {
        match self.trials.known(x) {
            Some(Evaluation::Answer(answer)) => Ok(answer.value()),
            Some(_) => Ok(f64::INFINITY),
            None => self.guess(x),
        }
    }

    fn confine(&self, x: &mut [f64]) {
        self.trials.search.bounds.project(x);
    }
}

impl Foresight<'_, '_, '_> {
    fn guess(&mut self, x: &[f64]) -> Result<f64, Enough> {
        if self.wanted.iter().any(|wanted| wanted == x) {
            return Ok(self.model.value(x));
        }
        if self.wanted.len() >= self.most {
            return Err(Enough);
        }
        self.wanted.push(x.to_vec());
        Ok(self.model.value(x))
    }
}

/// r(x) = r₀ + R X⁻¹ (x − x₀), with the differences of the other corners from the best as columns of X, those of their
/// residuals as columns of R.
struct Affine {
    origin: DVector<f64>,
    residuals: DVector<f64>,
    slope: DMatrix<f64>,
}

impl Affine {
    /// None where a corner has no residuals, or the simplex is flat.
    fn through(simplex: &Simplex, trials: &Trials<'_, '_>) -> Option<Affine> {
        let residuals = |x: &[f64]| match trials.known(x)? {
            Evaluation::Answer(Answer::Residuals(residuals)) => Some(DVector::from_vec(residuals)),
            _ => None,
        };
        let (best, others) = simplex.corners.split_first()?;
        let (origin, here) = (DVector::from_column_slice(&best.x), residuals(&best.x)?);
        let there = others.iter().map(|corner| residuals(&corner.x)).collect::<Option<Vec<_>>>()?;
        if there.iter().any(|there| there.len() != here.len()) {
            return None;
        }
        let edges: Vec<_> = others.iter().map(|corner| DVector::from_column_slice(&corner.x) - &origin).collect();
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
    use crate::identify::{Crew, Method, OnFailure, Search, SearchError, Task};
    use crate::simulate::Cancellation;

    /// Residuals that are affine, of which a guess is right.
    struct Plane;

    impl crate::identify::Objective for Plane {
        fn evaluate(&self, x: &[f64], _: &Cancellation) -> Evaluation {
            Answer::Residuals(vec![3.0 * x[0] - x[1], x[1] + 2.0, 0.5 * x[0] + x[1] - 1.0, 0.3]).checked()
        }
    }

    /// Notes what is asked for.
    struct Asked<'t, 'c, 'a>(&'t Trials<'c, 'a>, Vec<Vec<f64>>);

    impl Values for Asked<'_, '_, '_> {
        type Error = SearchError;

        fn value(&mut self, x: &[f64]) -> Result<f64, SearchError> {
            self.1.push(x.to_vec());
            Ok(self.0.answer(x)?.map_or(f64::INFINITY, |answer| answer.value()))
        }
    }

    #[test]
    fn what_follows_from_affine_residuals_is_foreseen() {
        let task = Task { objective: &Plane, on_failure: OnFailure::Worst, history: None };
        let search = Search::new(Method::NelderMead, vec![4.0, 3.0]);
        let found = Crew::new(vec![task], 1).at_work(1 << 20, |desk, _| {
            let trials = Trials::new(&search, desk);
            let mut asked = Asked(&trials, vec![]);
            let mut simplex = Simplex::around(&search.start, &mut asked)?;
            let mut right = vec![];
            for _ in 0..10 {
                let foreseen = points(&simplex, &trials, 5);
                asked.1.clear();
                let mut on = simplex.clone();
                while asked.1.len() < 5 {
                    on.advance(&mut asked)?;
                }
                right.push(foreseen.len() == 5 && foreseen == asked.1[..5]);
                simplex = on;
            }
            Ok::<_, SearchError>(right)
        });
        assert_eq!(found.unwrap_or_default(), [vec![true; 10]]);
    }

    #[test]
    fn values_alone_tell_nothing() {
        let value = |x: &[f64]| x[0] * x[0];
        let task = Task { objective: &value, on_failure: OnFailure::Worst, history: None };
        let search = Search::new(Method::NelderMead, vec![4.0]);
        let found = Crew::new(vec![task], 1).at_work(1 << 20, |desk, _| {
            let trials = Trials::new(&search, desk);
            let simplex = Simplex::around(&search.start, &mut Asked(&trials, vec![]))?;
            Ok::<_, SearchError>(points(&simplex, &trials, 5))
        });
        assert_eq!(found.unwrap_or_default(), [Vec::<Vec<f64>>::new()]);
    }
}
