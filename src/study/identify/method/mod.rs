//! The methods of search, the trials that they request, and their ends at bounds.

pub(super) mod cma_es;
pub(super) mod levenberg_marquardt;
pub(super) mod nelder_mead;

use std::cmp::Ordering;
use std::sync::Mutex;

use crate::identify::evaluator::Evaluator;
use crate::identify::objective::{Evaluation, ObjectiveValue, SearchError};
use crate::identify::options::{Point, Search, Side};
use crate::identify::search::{Iteration, StartResult};
use crate::identify::warning::Warning;

/// The means of a method: its search, its evaluator and its observer.
pub(in crate::identify) struct SearchContext<'s> {
    pub(in crate::identify) search: &'s Search,
    pub(in crate::identify) trials: &'s Trials<'s>,
    /// Number of the start, from zero.
    pub(in crate::identify) start: usize,
    /// Called after each iteration.
    pub(in crate::identify) observer: &'s mut (dyn FnMut(&Iteration) + Send),
}

/// The trials of one start.
pub(in crate::identify) struct Trials<'c> {
    search: &'c Search,
    evaluator: &'c Evaluator<'c>,
    tally: Mutex<Tally>,
}

/// What becomes of trials.
#[derive(Clone, Debug, Default)]
pub(in crate::identify) struct Tally {
    evaluations: usize,
    /// Trials without a value.
    failed: usize,
    first: Option<Failure>,
}

#[derive(Clone, Debug)]
struct Failure {
    /// Number of trials requested before it.
    before: usize,
    x: Vec<f64>,
    cause: String,
}

impl Tally {
    /// Adds the failures of a later start.
    pub(in crate::identify) fn add(&mut self, other: Tally) {
        self.failed += other.failed;
        self.first = self.first.take().or(other.first);
    }

    /// Adds one; of trials requested at once, the first in the order of their points counts as first.
    fn push(&mut self, failure: Failure) {
        self.failed += 1;
        // Outcomes come in any order: the first by its place in the search is the same with any number of threads.
        let is_before =
            |first: &Failure| failure.before.cmp(&first.before).then_with(|| order(&failure.x, &first.x)).is_lt();
        if self.first.as_ref().is_none_or(is_before) {
            self.first = Some(failure);
        }
    }

    /// A warning if there are any.
    pub(in crate::identify) fn warning(self, search: &Search) -> Option<Warning> {
        let Failure { x, cause, .. } = self.first?;
        Some(Warning::FailedTrials { count: self.failed, first: Point::new(&search.names, &x), cause })
    }
}

impl<'c> Trials<'c> {
    pub(in crate::identify) fn new(search: &'c Search, evaluator: &'c Evaluator<'c>) -> Trials<'c> {
        Trials { search, evaluator, tally: Mutex::default() }
    }

    /// The value at a start, without which a search has nothing to improve. Not counted: the method requests it again.
    pub(in crate::identify) fn at_start(&self, x: &[f64]) -> Result<ObjectiveValue, SearchError> {
        self.evaluator.evaluate(x)?.value_at(|| format!("the objective has no value at the start {x:?}"))
    }

    /// The value at `x`; none where the trial failed and counts as worst.
    fn value(&self, x: &[f64]) -> Result<Option<ObjectiveValue>, SearchError> {
        self.value_of_several(x, self.evaluations())
    }

    /// The value at `x`, one of several points that are requested at once in any order, after `before` others.
    fn value_of_several(&self, x: &[f64], before: usize) -> Result<Option<ObjectiveValue>, SearchError> {
        self.count(x, self.evaluator.evaluate(x)?, before)
    }

    /// The values at `points`.
    fn values(&self, points: &[Vec<f64>]) -> Result<Vec<Option<ObjectiveValue>>, SearchError> {
        let outcomes = self.evaluator.evaluate_all(points)?;
        let count = |(x, evaluation): (&Vec<f64>, Evaluation)| self.count(x, evaluation, self.evaluations());
        points.iter().zip(outcomes).map(count).collect()
    }

    /// Evaluates points ahead, as [`Evaluator::prepare`]; not counted.
    fn prepare(&self, points: &[Vec<f64>], probable: &[Vec<f64>]) -> Result<(), SearchError> {
        self.evaluator.prepare(points, probable)
    }

    /// Number of points that the method requested.
    fn evaluations(&self) -> usize {
        base::lock(&self.tally).evaluations
    }

    pub(in crate::identify) fn tally(&self) -> Tally {
        base::lock(&self.tally).clone()
    }

    fn count(&self, x: &[f64], evaluation: Evaluation, before: usize) -> Result<Option<ObjectiveValue>, SearchError> {
        let mut tally = base::lock(&self.tally);
        tally.evaluations += 1;
        match evaluation {
            Evaluation::Value(value) => Ok(Some(value)),
            Evaluation::Fatal(error) => Err(error.into()),
            Evaluation::Failed { cause, .. } => {
                tally.push(Failure { before, x: x.into(), cause });
                Ok(None)
            }
        }
    }
}

/// The limit of `search` that ended it after `iterations`.
fn limit(iterations: usize, search: &Search) -> String {
    let limit = if iterations >= search.max_iterations { "max_iterations" } else { "max_evaluations" };
    format!("{limit} was reached")
}

/// An order of points requested at once: by their first entries, then by the second.
fn order(a: &[f64], b: &[f64]) -> Ordering {
    let entries = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    entries.fold(Ordering::Equal, Ordering::then)
}

/// The point with each unknown on the bound beside which it converged, where the objective is no higher there: towards
/// a bound the transform flattens, and the tolerances are met before it.
fn onto_bounds(mut result: StartResult, search: &Search, trials: &Trials<'_>) -> Result<StartResult, SearchError> {
    if !result.converged {
        return Ok(result);
    }
    // One unknown after the other: a bound that lowers the objective stays while the next one is tried.
    for (index, bound) in search.bounds.beside(&result.x) {
        let mut x = result.x.clone();
        x[index] = bound;
        // Not a trial that the search asks for: without a value there, the point beside the bound stands.
        let f = match trials.at_start(&x) {
            Err(SearchError::Trial { .. }) => continue,
            value => value?.value(),
        };
        if f <= result.f {
            (result.x, result.f) = (x, f);
        }
    }
    Ok(result)
}

/// Whether the objective falls beyond the bound on which unknown `index` of `x` lies, by the gradient of the sum of
/// squares there, rᵀ ∂r/∂x, of a difference inwards; none where that has no residuals.
pub(in crate::identify) fn falls_beyond(
    (index, side): (usize, Side),
    x: &[f64],
    search: &Search,
    trials: &Trials<'_>,
) -> Result<Option<bool>, SearchError> {
    let step = search.step(index, x[index]);
    let mut inside = x.to_vec();
    inside[index] += if side == Side::Lower { step } else { -step };
    let mut found = Vec::new();
    for point in [x, &inside] {
        match trials.at_start(point) {
            Ok(ObjectiveValue::Residuals(residuals)) => found.push(residuals),
            Ok(ObjectiveValue::Scalar(_)) | Err(SearchError::Trial { .. }) => return Ok(None),
            Err(error) => return Err(error),
        }
    }
    let [here, there] = &found[..] else { return Ok(None) };
    // Only the sign is asked for, so the difference is not divided by the step.
    let rise: f64 = here.iter().zip(there).map(|(here, there)| here * (there - here)).sum();
    Ok(Some(rise > 0.0))
}
