//! Trials of one or several searches in parallel, each point once.
//!
//! What a search finds depends neither on the number of threads, nor on the order in which trials end, nor on other searches.

use std::collections::HashMap;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard};
use std::thread;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::identify::objective::{Evaluation, Objective, ObjectiveValue, SearchError, Trial, refused};
use crate::identify::options::Search;
use crate::script::STACK;
use base::cancellation::Cancellation;
use lab::confidence::Linearization;
use lab::experiment::fit::moved;

/// The threads that evaluate the trials of searches.
pub struct TrialPool<'a> {
    threads: usize,
    observer: Observer<'a>,
    objectives: Vec<&'a dyn Objective>,
}

/// Called with the number of a search and what becomes of one of its trials, by several threads.
type Observer<'a> = Box<dyn Fn(usize, TrialEvent<'_>) + Send + Sync + 'a>;

/// What becomes of a trial of a search.
#[derive(Clone, Copy, Debug)]
pub enum TrialEvent<'a> {
    /// A thread has started it.
    Begun {
        /// The point.
        x: &'a [f64],
        /// Requested trials that no thread has started.
        waiting: usize,
    },
    /// It has ended.
    Ended {
        /// The point.
        x: &'a [f64],
        /// The outcome; none of a trial that was cancelled.
        trial: Option<&'a Trial>,
        /// Requested trials that no thread has started.
        waiting: usize,
    },
}

/// Evaluates the objective of one search.
pub struct Evaluator<'a> {
    objective: &'a dyn Objective,
    pool: &'a ThreadPool,
    /// Points that are evaluated at once where the search needs fewer.
    share: usize,
    observer: Box<dyn Fn(TrialEvent<'_>) + Send + Sync + 'a>,
    /// Outcomes by the bits of their points: a point gets no value of one that differs from it by rounding.
    known: Mutex<HashMap<Vec<u64>, Evaluation>>,
    /// Requested trials that no thread has started.
    waiting: AtomicUsize,
    cancellation: Cancellation,
}

/// Ends searches when dropped by a search that panics or fails.
struct EndGuard<'e, 'a> {
    evaluators: &'e [Evaluator<'a>],
    number: usize,
    succeeded: bool,
}

impl Drop for EndGuard<'_, '_> {
    fn drop(&mut self) {
        // The error of the first search counts: those before it go on unless there is a panic.
        let first = if thread::panicking() { 0 } else { self.number };
        let ended = if self.succeeded { &[] } else { &self.evaluators[first..] };
        ended.iter().for_each(|evaluator| evaluator.cancellation.cancel());
    }
}

impl<'a> TrialPool<'a> {
    /// A pool of `threads` for `objectives`, one for each search.
    pub fn new(objectives: Vec<&'a dyn Objective>, threads: usize) -> TrialPool<'a> {
        TrialPool { threads: threads.max(1), observer: Box::new(|_, _| {}), objectives }
    }

    /// The pool that tells `observer` of every trial. No lock is held meanwhile.
    pub fn with_observer(self, observer: impl Fn(usize, TrialEvent<'_>) + Send + Sync + 'a) -> TrialPool<'a> {
        TrialPool { observer: Box::new(observer), ..self }
    }

    /// Runs `search` for all objectives at the same time; it gets an evaluator and the number of its objective. The results
    /// in the order of the objectives.
    ///
    /// # Errors
    /// The number and the error of the first search that failed: its objective has a fatal error, or `search` fails. Earlier
    /// searches run to their ends, later ones are ended: the error is the one that searches one after the other would give.
    ///
    /// # Panics
    /// Where an objective does; all searches are ended first.
    pub fn run<T: Send>(
        &self,
        search: impl Fn(&Evaluator<'_>, usize) -> Result<T, SearchError> + Sync,
    ) -> Result<Vec<T>, (usize, SearchError)> {
        // Simulations within a pool of threads take one thread each.
        let pool = ThreadPoolBuilder::new().num_threads(self.threads).stack_size(STACK).build();
        let pool = pool.map_err(|error| (0, refused!("cannot start threads for trials: {error}")))?;
        let evaluator = |(number, objective): (usize, &&'a dyn Objective)| Evaluator {
            objective: *objective,
            pool: &pool,
            share: self.threads / self.objectives.len(),
            observer: Box::new(move |event| (self.observer)(number, event)),
            known: Mutex::default(),
            waiting: AtomicUsize::new(0),
            cancellation: Cancellation::default(),
        };
        let evaluators: Vec<Evaluator<'_>> = self.objectives.iter().enumerate().map(evaluator).collect();
        let run_one = |number: usize| {
            let mut guard = EndGuard { evaluators: &evaluators, number, succeeded: false };
            let result = search(&evaluators[number], number);
            guard.succeeded = result.is_ok();
            result
        };
        let results: Vec<Result<T, SearchError>> = thread::scope(|threads| {
            let run_one = &run_one;
            let others: Vec<_> = (1..evaluators.len()).map(|number| threads.spawn(move || run_one(number))).collect();
            let first = (!evaluators.is_empty()).then(|| run_one(0));
            let others = others.into_iter().map(|other| other.join().unwrap_or_else(|panic| resume_unwind(panic)));
            first.into_iter().chain(others).collect()
        });
        results.into_iter().enumerate().map(|(number, result)| result.map_err(|error| (number, error))).collect()
    }
}

/// Runs `search` on one objective with a pool of `threads`.
///
/// # Errors
/// The errors of [`TrialPool::run`].
///
/// # Panics
/// Where the objective does.
pub fn with_evaluator<T: Send>(
    objective: &dyn Objective,
    threads: usize,
    search: impl Fn(&Evaluator<'_>) -> Result<T, SearchError> + Sync,
) -> Result<T, SearchError> {
    let results = TrialPool::new(vec![objective], threads).run(|evaluator, _| search(evaluator));
    results.map_err(|(_, error)| error)?.pop().ok_or(SearchError::Ended)
}

impl Evaluator<'_> {
    /// The outcome at `x`.
    ///
    /// # Errors
    /// The search was ended.
    pub fn evaluate(&self, x: &[f64]) -> Result<Evaluation, SearchError> {
        let mut outcomes = self.evaluate_all(std::slice::from_ref(&x.to_vec()))?;
        outcomes.pop().ok_or(SearchError::Ended)
    }

    /// The outcomes at `points`, which are evaluated at once.
    ///
    /// # Errors
    /// The search was ended.
    pub fn evaluate_all(&self, points: &[Vec<f64>]) -> Result<Vec<Evaluation>, SearchError> {
        let keys: Vec<Vec<u64>> = points.iter().map(|x| x.iter().map(|x| x.to_bits()).collect()).collect();
        let mut new: Vec<(&Vec<u64>, &Vec<f64>)> = Vec::new();
        {
            let known = self.known();
            for (key, x) in keys.iter().zip(points) {
                if !known.contains_key(key) && !new.iter().any(|(other, _)| *other == key) {
                    new.push((key, x));
                }
            }
        }
        self.waiting.fetch_add(new.len(), Ordering::Relaxed);
        let evaluate = || new.par_iter().with_max_len(1).map(|(_, x)| self.trial(x)).collect();
        let found: Vec<Evaluation> = if new.is_empty() { vec![] } else { self.pool.install(evaluate) };
        if self.cancellation.is_cancelled() {
            return Err(SearchError::Ended);
        }
        let mut known = self.known();
        known.extend(new.into_iter().map(|(key, _)| key.clone()).zip(found));
        keys.iter().map(|key| known.get(key).cloned().ok_or(SearchError::Ended)).collect()
    }

    /// Evaluates points that the search is about to ask for, and of those that it may ask for next, the most probable first, as
    /// many as there are threads for.
    ///
    /// # Errors
    /// The search was ended.
    pub fn prepare(&self, points: &[Vec<f64>], probable: &[Vec<f64>]) -> Result<(), SearchError> {
        if self.share < 2 {
            return Ok(());
        }
        let more = self.share.saturating_sub(points.len()).min(probable.len());
        self.evaluate_all(&[points, &probable[..more]].concat()).map(drop)
    }

    fn trial(&self, x: &[f64]) -> Evaluation {
        let waiting = self.waiting.fetch_sub(1, Ordering::Relaxed) - 1;
        if self.cancellation.is_cancelled() {
            return Evaluation::failed("the search was ended");
        }
        (self.observer)(TrialEvent::Begun { x, waiting });
        let trial = self.objective.trial(x, &self.cancellation);
        let ended = (!self.cancellation.is_cancelled()).then_some(&trial);
        let waiting = self.waiting.load(Ordering::Relaxed);
        (self.observer)(TrialEvent::Ended { x, trial: ended, waiting });
        trial.evaluation
    }

    fn known(&self) -> MutexGuard<'_, HashMap<Vec<u64>, Evaluation>> {
        base::lock(&self.known)
    }
}

/// The linearization at the start of `search`, by central differences where bounds and failed trials allow; all
/// trials are evaluated at once. The step is `difference` times the parameter.
///
/// # Errors
/// No residuals at the estimate, too few of them, or failed trials on both sides of a parameter.
pub fn linearize_at_start(search: &Search, evaluator: &Evaluator<'_>) -> Result<Linearization, SearchError> {
    // With as many unknowns as residuals, no degree of freedom is left from which to estimate their variance.
    linearize(search, evaluator, search.start.len() + 1)
}

/// The same of residuals whose variance is known, of which there may be fewer than parameters.
///
/// # Errors
/// No residuals at the estimate, or failed trials on both sides of a parameter.
pub fn weigh_at_start(search: &Search, evaluator: &Evaluator<'_>) -> Result<Linearization, SearchError> {
    linearize(search, evaluator, 0)
}

/// The linearization of at least `fewest` residuals.
fn linearize(search: &Search, evaluator: &Evaluator<'_>, fewest: usize) -> Result<Linearization, SearchError> {
    let x = &search.start;
    let steps: Vec<[Option<f64>; 2]> = (0..x.len()).map(|index| steps(search, index)).collect();
    // The estimate itself first, then all steps: one batch, so that all threads have work from the beginning.
    let mut points = vec![x.clone()];
    points.extend(
        steps
            .iter()
            .enumerate()
            .flat_map(|(index, steps)| steps.iter().flatten().map(move |step| moved(x, index, *step))),
    );
    let mut found = evaluator.evaluate_all(&points)?.into_iter();
    let first = found.next().ok_or(SearchError::Ended)?;
    let residuals = residuals(first, || format!("the objective has no value at the estimate {x:?}"))?;
    if residuals.len() < fewest {
        return Err(refused!(
            "the objective gave {found} residuals for {unknowns} parameters: there must be more residuals than parameters",
            found = residuals.len(),
            unknowns = x.len()
        ));
    }
    let mut linearization = Linearization {
        x: x.clone(),
        jacobian: DMatrix::zeros(residuals.len(), x.len()),
        parts: vec![residuals.len()],
        residuals: DVector::from_vec(residuals),
        roughness: 0.0,
        one_sided: vec![],
    };
    for (index, steps) in steps.into_iter().enumerate() {
        let sides = steps.into_iter().flatten().zip(&mut found).collect();
        set_column(&mut linearization, search, index, sides)?;
    }
    Ok(linearization)
}

/// Sets one column of the Jacobian from the outcomes on both sides.
fn set_column(
    linearization: &mut Linearization,
    search: &Search,
    index: usize,
    sides: Vec<(f64, Evaluation)>,
) -> Result<(), SearchError> {
    let beside_parameter =
        |x: &[f64]| format!("the trials beside {} failed, there is no derivative: at {x:?}", search.names[index]);
    let mut slopes = Vec::new();
    let mut failure = None;
    for (step, found) in sides {
        let x = moved(&linearization.x, index, step);
        match residuals(found, || beside_parameter(&x)) {
            Ok(there) => slopes.push((step, difference(linearization, &x, there)?)),
            Err(failed @ SearchError::Trial { .. }) => failure = Some(failed),
            Err(error) => return Err(error),
        }
    }
    let slope = match (&slopes[..], failure) {
        ([(up, above), (down, below)], _) => {
            // The first order cancels: curvature over the step is left, or scatter.
            linearization.roughness = linearization.roughness.max((above + below).norm());
            (above - below) / (up - down)
        }
        ([(step, difference)], _) => {
            linearization.one_sided.push(index);
            difference / *step
        }
        (_, Some(failure)) => return Err(failure),
        (_, None) => return Err(SearchError::Ended),
    };
    if slope.iter().any(|slope| !slope.is_finite()) {
        let (place, cause) = (beside_parameter(&linearization.x), "the differences of the residuals overflow".into());
        return Err(SearchError::Trial { place, cause, numerical: false });
    }
    linearization.jacobian.set_column(index, &slope);
    Ok(())
}

/// The residuals `there`, at `x`, less those at the estimate.
fn difference(linearization: &Linearization, x: &[f64], there: Vec<f64>) -> Result<DVector<f64>, SearchError> {
    let (found, expected) = (there.len(), linearization.residuals.len());
    if found != expected {
        return Err(refused!("the objective gave {found} residuals at {x:?}, and {expected} at the estimate"));
    }
    Ok(DVector::from_vec(there) - &linearization.residuals)
}

/// Steps up and down that stay within the bounds; at least one does.
fn steps(search: &Search, index: usize) -> [Option<f64>; 2] {
    let (x, [lower, upper]) = (search.start[index], search.bounds.pair(index));
    let step = search.step(index, x);
    let within = |step: &f64| (lower..=upper).contains(&(x + step));
    [Some(step).filter(within), Some(-step).filter(within)]
}

/// The residuals of a trial at this place.
fn residuals(found: Evaluation, place: impl FnOnce() -> String) -> Result<Vec<f64>, SearchError> {
    match found.value_at(place)? {
        ObjectiveValue::Residuals(residuals) => Ok(residuals),
        ObjectiveValue::Scalar(_) => {
            Err(refused!("the objective gave a number, and a confidence needs residuals: return a signal or a list"))
        }
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::mpsc;
    use std::time::Duration;

    use crate::identify::objective::FatalError;

    use super::*;

    /// Points that may be asked for next are evaluated at once with those that are, as far as there are threads.
    #[test]
    fn no_point_is_evaluated_twice() {
        for (threads, ahead) in [(1, 0), (2, 2), (3, 3), (8, 4)] {
            let calls = AtomicUsize::new(0);
            let value = |x: &[f64]| {
                calls.fetch_add(1, Ordering::Relaxed);
                x[0]
            };
            let points = [1.0, 2.0, 1.0, 3.0, 4.0].map(|x| vec![x]);
            let found = TrialPool::new(vec![&value as &dyn Objective], threads).run(|evaluator, _| {
                evaluator.prepare(&points[..1], &[vec![2.0], vec![3.0], vec![4.0]])?;
                assert_eq!(calls.load(Ordering::Relaxed), ahead, "{threads} threads");
                evaluator.evaluate_all(&points)
            });
            let expected = points.clone().map(|x| Evaluation::Value(ObjectiveValue::Scalar(x[0])));
            assert_eq!((&found.unwrap()[0][..], calls.into_inner()), (&expected[..], 4));
        }
    }

    #[test]
    fn the_error_is_that_of_the_first_problem() {
        let value = |x: &[f64]| x[0];
        for threads in [1, 2, 4] {
            let pool = TrialPool::new((0..4).map(|_| &value as &dyn Objective).collect(), threads);
            let requested = AtomicUsize::new(0);
            let found: Result<Vec<()>, (usize, SearchError)> = pool.run(|evaluator, number| {
                for trial in 0..20 {
                    evaluator.evaluate(&[f64::from(trial)])?;
                    requested.fetch_add(usize::from(number == 0), Ordering::Relaxed);
                    // The third fails at once, the second at its end, the others do not.
                    if number == 2 || (number == 1 && trial == 19) {
                        return Err(SearchError::Fatal(FatalError::new(format!("search {number}"))));
                    }
                }
                Ok(())
            });
            let (number, error) = found.unwrap_err();
            assert_eq!((number, error.to_string()), (1, "search 1".into()));
            assert_eq!(requested.load(Ordering::Relaxed), 20, "an earlier search runs to its end");
        }
    }

    #[test]
    fn a_panic_in_an_objective_ends_the_searches_and_propagates() {
        for (threads, searches) in [(1, 1), (2, 1), (4, 3)] {
            let (sender, receiver) = mpsc::channel();
            thread::spawn(move || {
                let calls = AtomicUsize::new(0);
                let panics = |x: &[f64]| {
                    assert!(calls.fetch_add(1, Ordering::Relaxed) != 2, "the third call");
                    x[0]
                };
                let pool = TrialPool::new((0..searches).map(|_| &panics as &dyn Objective).collect(), threads);
                let work = || {
                    pool.run(|evaluator, _| (0..100).try_for_each(|n| evaluator.evaluate(&[f64::from(n)]).map(drop)))
                };
                let panic = catch_unwind(AssertUnwindSafe(work)).map(drop);
                sender.send(panic.map_err(|panic| panic.downcast_ref::<&str>().map(|message| (*message).to_owned())))
            });
            let ended = receiver.recv_timeout(Duration::from_secs(30));
            assert_eq!(ended, Ok(Err(Some("the third call".into()))), "{threads} threads, {searches} searches");
        }
    }

    /// A trial may run parallel tasks in the same pool, as an objective of several simulations does.
    #[test]
    fn trials_with_parallel_tasks_end() {
        let parallel = |x: &[f64]| (0..40).into_par_iter().map(|i| (f64::from(i) * x[0]).sin()).sum::<f64>().abs();
        for number in 0..400 {
            let pool = TrialPool::new(vec![&parallel as &dyn Objective], 2);
            let found = pool.run(|evaluator, _| evaluator.evaluate(&[f64::from(number)]));
            assert!(matches!(found.unwrap()[..], [Evaluation::Value(_)]));
        }
    }
}
