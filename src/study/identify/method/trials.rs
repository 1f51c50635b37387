//! The trials of one start, counted, and the context that a method searches in.

use std::cmp::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::identify::error::SearchError;
use crate::identify::iteration::Iteration;
use crate::identify::objective::{Evaluation, ObjectiveValue};
use crate::identify::options::Search;
use crate::identify::point::Point;
use crate::identify::pool::trial_pool::{Evaluator, PoolError};
use crate::identify::warning::Warning;

/// The means of a method: its search, its evaluator and its observer.
pub(in crate::identify) struct SearchContext<'s, 'c, 'a> {
    pub(in crate::identify) search: &'s Search,
    pub(in crate::identify) trials: &'s Trials<'c, 'a>,
    /// Number of the start, from zero.
    pub(in crate::identify) start: usize,
    /// Called after each iteration.
    pub(in crate::identify) observer: &'s mut (dyn FnMut(&Iteration) + Send),
}

/// The trials of one start.
pub(in crate::identify) struct Trials<'c, 'a> {
    pub(super) search: &'c Search,
    evaluator: &'c Evaluator<'c, 'a>,
    tally: Mutex<Tally>,
}

#[derive(Default)]
struct Tally {
    evaluations: usize,
    failures: Failures,
}

/// Trials without a value.
#[derive(Clone, Debug, Default)]
pub(in crate::identify) struct Failures {
    count: usize,
    first: Option<Failure>,
}

#[derive(Clone, Debug)]
struct Failure {
    /// Number of trials requested before it.
    before: usize,
    x: Vec<f64>,
    cause: String,
}

impl Failures {
    /// Adds the failures of a later start.
    pub(in crate::identify) fn add(&mut self, other: Failures) {
        self.count += other.count;
        self.first = self.first.take().or(other.first);
    }

    /// Adds one; of trials requested at once, the first in the order of their points counts as first.
    fn push(&mut self, failure: Failure) {
        self.count += 1;
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
        Some(Warning::FailedTrials { count: self.count, first: Point::new(&search.names, &x), cause })
    }
}

impl<'c, 'a> Trials<'c, 'a> {
    pub(in crate::identify) fn new(search: &'c Search, evaluator: &'c Evaluator<'c, 'a>) -> Trials<'c, 'a> {
        Trials { search, evaluator, tally: Mutex::default() }
    }

    /// The value at a start, without which a search has nothing to improve. Not counted: the method requests it again.
    pub(in crate::identify) fn at_start(&self, x: &[f64]) -> Result<ObjectiveValue, SearchError> {
        match self.evaluator.evaluate(x)? {
            Evaluation::Value(value) => Ok(value),
            Evaluation::Failed { cause, numerical } => Err(SearchError::Start { x: x.into(), cause, numerical }),
            Evaluation::Fatal(error) => Err(PoolError::Fatal(error).into()),
        }
    }

    /// The value at `x`; none where the trial failed and counts as worst.
    pub(super) fn value(&self, x: &[f64]) -> Result<Option<ObjectiveValue>, SearchError> {
        let evaluation = self.evaluator.evaluate(x)?;
        self.count(x, evaluation, self.evaluations())
    }

    /// The value at `x`, one of several points that are requested at once in any order, after `before` others.
    pub(super) fn value_of_several(&self, x: &[f64], before: usize) -> Result<Option<ObjectiveValue>, SearchError> {
        let evaluation = self.evaluator.evaluate(x)?;
        self.count(x, evaluation, before)
    }

    /// The values at `points`.
    pub(super) fn values(&self, points: &[Vec<f64>]) -> Result<Vec<Option<ObjectiveValue>>, SearchError> {
        let outcomes = self.evaluator.evaluate_all(points)?;
        let count = |(x, evaluation): (&Vec<f64>, Evaluation)| self.count(x, evaluation, self.evaluations());
        points.iter().zip(outcomes).map(count).collect()
    }

    /// Replaces the speculative points.
    pub(super) fn speculate(&self, points: &[Vec<f64>]) {
        self.evaluator.speculate(points);
    }

    /// The outcome at `x` if it is known by now; not counted.
    pub(super) fn cached(&self, x: &[f64]) -> Option<Evaluation> {
        self.evaluator.cached(x)
    }

    /// Number of speculative points that a surrogate model should provide: two for each thread that may evaluate them.
    pub(super) fn max_speculative(&self) -> usize {
        2 * (self.evaluator.threads() - 1)
    }

    /// Number of points that the method requested.
    pub(super) fn evaluations(&self) -> usize {
        self.tally().evaluations
    }

    pub(in crate::identify) fn failures(&self) -> Failures {
        self.tally().failures.clone()
    }

    fn count(&self, x: &[f64], evaluation: Evaluation, before: usize) -> Result<Option<ObjectiveValue>, SearchError> {
        let mut tally = self.tally();
        tally.evaluations += 1;
        match evaluation {
            Evaluation::Value(value) => Ok(Some(value)),
            Evaluation::Fatal(error) => Err(PoolError::Fatal(error).into()),
            Evaluation::Failed { cause, .. } => {
                tally.failures.push(Failure { before, x: x.into(), cause });
                Ok(None)
            }
        }
    }

    fn tally(&self) -> MutexGuard<'_, Tally> {
        self.tally.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// An order of points requested at once: by their first entries, then by the second.
pub(super) fn order(a: &[f64], b: &[f64]) -> Ordering {
    let entries = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    entries.fold(Ordering::Equal, Ordering::then)
}
