//! A pool of threads that evaluates the trials of one or several searches.
//!
//! A search requests points and names those that it may request next. Requested trials come first, in their order; idle
//! threads evaluate speculative ones while all searches wait. No trial is evaluated twice, and what a search finds
//! depends neither on the number of threads, nor on the order in which trials end, nor on other searches.

use std::panic::resume_unwind;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use rayon::ThreadPoolBuilder;
use thiserror::Error;

use super::schedule::{Closed, Point, RunningTrial, Schedule};
use crate::identify::objective::{Evaluation, FatalError, Objective, Trial};

/// Stack of a thread of the pool, bytes, where nothing else is asked for.
const STACK: usize = 8 << 20;

/// Evaluates trials of searches in parallel, each once.
pub struct TrialPool<'a> {
    threads: usize,
    stack: usize,
    observer: Observer<'a>,
    objectives: Vec<&'a dyn Objective>,
    schedule: Mutex<Schedule>,
    changed: Condvar,
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
#[derive(Clone, Copy)]
pub struct Evaluator<'c, 'a> {
    pool: &'c TrialPool<'a>,
    /// Number of the search.
    number: usize,
}

/// Why there are no more trials.
#[derive(Debug, Error)]
pub enum PoolError {
    /// The threads cannot be started.
    #[error("cannot start threads for trials: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The objective cannot be evaluated any more.
    #[error("{0}")]
    Fatal(#[source] FatalError),
    /// The search was ended, for an error that is reported elsewhere.
    #[error("the search was ended")]
    Closed,
}

/// Ends a search when dropped, also where it panics; a search that failed ends those behind it.
struct SearchGuard<'c, 'a> {
    evaluator: Evaluator<'c, 'a>,
    succeeded: bool,
}

impl Drop for SearchGuard<'_, '_> {
    fn drop(&mut self) {
        let Evaluator { pool, number } = self.evaluator;
        let behind = if self.succeeded { number + 1 } else { pool.objectives.len() };
        (number..behind).for_each(|search| pool.schedule().finish(search));
        pool.changed.notify_all();
    }
}

/// Ends all searches when dropped: none would get its trials where a thread of the pool panics.
struct WorkerGuard<'c, 'a>(&'c TrialPool<'a>);

impl Drop for WorkerGuard<'_, '_> {
    fn drop(&mut self) {
        (0..self.0.objectives.len()).for_each(|search| self.0.schedule().finish(search));
        self.0.changed.notify_all();
    }
}

impl<'a> TrialPool<'a> {
    /// A pool of `threads` for `objectives`, one for each search.
    pub fn new(objectives: Vec<&'a dyn Objective>, threads: usize) -> TrialPool<'a> {
        let (schedule, changed) = (Mutex::new(Schedule::new(objectives.len())), Condvar::new());
        TrialPool {
            threads: threads.max(1),
            stack: STACK,
            observer: Box::new(|_, _| {}),
            objectives,
            schedule,
            changed,
        }
    }

    /// The pool that tells `observer` of every trial. No lock is held meanwhile.
    pub fn with_observer(self, observer: impl Fn(usize, TrialEvent<'_>) + Send + Sync + 'a) -> TrialPool<'a> {
        TrialPool { observer: Box::new(observer), ..self }
    }

    /// The pool with stacks of `bytes`.
    pub fn with_stack(self, bytes: usize) -> TrialPool<'a> {
        TrialPool { stack: bytes, ..self }
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
    pub fn run<T: Send, E: From<PoolError> + Send>(
        &self,
        search: impl Fn(&Evaluator<'_, 'a>, usize) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, (usize, E)> {
        // Simulations within a pool of threads take one thread each.
        let pool = ThreadPoolBuilder::new().num_threads(self.threads).stack_size(self.stack).build();
        let pool = pool.map_err(|error| (0, PoolError::from(error).into()))?;
        let run_one = |number| self.run_search(number, &search);
        let results = pool.in_place_scope(|scope| {
            // One for each thread: a trial that waits for tasks of its own would otherwise take a whole worker loop as
            // such a task, and never end.
            scope.spawn_broadcast(|_, _| self.work());
            thread::scope(|threads| {
                let others: Vec<_> =
                    (1..self.objectives.len()).map(|number| threads.spawn(move || run_one(number))).collect();
                // The first search needs no thread of its own: this one would only wait for the others.
                let first = (!self.objectives.is_empty()).then(|| run_one(0));
                let others = others.into_iter().map(|other| other.join().unwrap_or_else(|panic| resume_unwind(panic)));
                first.into_iter().chain(others).collect::<Vec<_>>()
            })
        });
        results.into_iter().enumerate().map(|(number, result)| result.map_err(|error| (number, error))).collect()
    }

    fn run_search<T, E: From<PoolError>>(
        &self,
        number: usize,
        search: &impl Fn(&Evaluator<'_, 'a>, usize) -> Result<T, E>,
    ) -> Result<T, E> {
        let evaluator = Evaluator { pool: self, number };
        let mut guard = SearchGuard { evaluator, succeeded: false };
        let result = search(&evaluator, number);
        guard.succeeded = result.is_ok();
        result
    }

    /// The loop of one thread.
    fn work(&self) {
        let _guard = WorkerGuard(self);
        while let Some(running) = self.next() {
            let objective = self.objectives[running.search];
            let (search, x) = (running.search, running.point.x());
            let waiting = self.schedule().waiting(search);
            (self.observer)(search, TrialEvent::Begun { x: &x, waiting });
            let trial = objective.trial(&x, &running.cancellation);
            let ended = (!running.cancellation.is_cancelled()).then(|| trial.clone());
            let waiting = {
                let mut schedule = self.schedule();
                schedule.end(running, trial.evaluation);
                schedule.waiting(search)
            };
            self.changed.notify_all();
            (self.observer)(search, TrialEvent::Ended { x: &x, trial: ended.as_ref(), waiting });
        }
    }

    /// The next trial to evaluate; none once all searches have ended.
    fn next(&self) -> Option<RunningTrial> {
        let mut schedule = self.schedule();
        loop {
            if schedule.is_finished() {
                return None;
            }
            if let Some(running) = schedule.start(self.threads) {
                return Some(running);
            }
            schedule = self.wait(schedule);
        }
    }

    fn schedule(&self) -> MutexGuard<'_, Schedule> {
        self.schedule.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'s>(&self, schedule: MutexGuard<'s, Schedule>) -> MutexGuard<'s, Schedule> {
        self.changed.wait(schedule).unwrap_or_else(PoisonError::into_inner)
    }
}

/// Runs `search` on one objective with a pool of `threads`.
///
/// # Errors
/// The errors of [`TrialPool::run`].
///
/// # Panics
/// Where the objective does.
pub fn with_evaluator<T: Send, E: From<PoolError> + Send>(
    objective: &dyn Objective,
    threads: usize,
    search: impl Fn(&Evaluator<'_, '_>) -> Result<T, E> + Sync,
) -> Result<T, E> {
    let results = TrialPool::new(vec![objective], threads).run(|evaluator, _| search(evaluator));
    results.map_err(|(_, error)| error)?.pop().ok_or_else(|| PoolError::Closed.into())
}

impl Evaluator<'_, '_> {
    /// Number of threads of the pool.
    pub fn threads(&self) -> usize {
        self.pool.threads
    }

    /// The outcome at `x`; waits for it.
    ///
    /// # Errors
    /// The search was ended.
    pub fn evaluate(&self, x: &[f64]) -> Result<Evaluation, PoolError> {
        let mut outcomes = self.evaluate_all(std::slice::from_ref(&x.to_vec()))?;
        outcomes.pop().ok_or(PoolError::Closed)
    }

    /// The outcomes at `points`; waits for all.
    ///
    /// # Errors
    /// The search was ended.
    pub fn evaluate_all(&self, points: &[Vec<f64>]) -> Result<Vec<Evaluation>, PoolError> {
        let points: Vec<Point> = points.iter().map(|x| Point::new(x)).collect();
        let mut schedule = self.pool.schedule();
        points.iter().for_each(|point| schedule.request(self.number, point));
        self.pool.changed.notify_all();
        loop {
            let outcomes = schedule.outcomes(self.number, &points).map_err(|Closed| PoolError::Closed)?;
            if let Some(outcomes) = outcomes {
                return Ok(outcomes);
            }
            schedule = self.pool.wait(schedule);
        }
    }

    /// The outcome at `x` if it is known by now.
    pub fn cached(&self, x: &[f64]) -> Option<Evaluation> {
        self.pool.schedule().known(self.number, &Point::new(x))
    }

    /// Replaces the speculative points: those that may be requested next, the most probable first. Running trials at
    /// other points are cancelled.
    pub fn speculate(&self, points: &[Vec<f64>]) {
        let points = points.iter().map(|x| Point::new(x)).collect();
        self.pool.schedule().speculate(self.number, points);
        self.pool.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::sync::mpsc;
    use std::time::{Duration, Instant};

    use rayon::prelude::*;

    use super::*;
    use crate::identify::objective::ObjectiveValue;
    use base::cancellation::Cancellation;

    /// The trial at 7 runs until it is cancelled, or for half a minute; the others wait until it has started.
    #[derive(Default)]
    struct Endless {
        started: AtomicBool,
        cancelled: AtomicBool,
    }

    impl Objective for Endless {
        fn evaluate(&self, x: &[f64], cancellation: &Cancellation) -> Evaluation {
            let begin = Instant::now();
            let until = |over: &dyn Fn() -> bool| {
                while !over() && begin.elapsed() < Duration::from_secs(30) {
                    thread::sleep(Duration::from_millis(1));
                }
            };
            if x == [7.0] {
                self.started.store(true, Ordering::Relaxed);
                until(&|| cancellation.is_cancelled());
                self.cancelled.store(cancellation.is_cancelled(), Ordering::Relaxed);
            } else {
                until(&|| self.started.load(Ordering::Relaxed));
            }
            x[0].into()
        }
    }

    #[test]
    fn superseded_speculative_trials_are_cancelled() {
        type Search = fn(&Evaluator<'_, '_>) -> Result<bool, PoolError>;
        let searches: [Search; 2] = [
            |evaluator| evaluator.evaluate(&[1.0]).map(|_| true),
            |evaluator| {
                evaluator.evaluate(&[1.0])?;
                evaluator.speculate(&[vec![2.0]]);
                let begin = Instant::now();
                while evaluator.cached(&[2.0]).is_none() && begin.elapsed() < Duration::from_secs(30) {
                    // Speculative trials are started only while the search waits.
                    evaluator.evaluate(&[begin.elapsed().as_secs_f64()])?;
                }
                Ok(evaluator.cached(&[2.0]).is_some())
            },
        ];
        for search in searches {
            let endless = Endless::default();
            let pool = TrialPool::new(vec![&endless as &dyn Objective], 2);
            let found = pool.run(|evaluator, _| {
                evaluator.speculate(&[vec![7.0]]);
                search(evaluator)
            });
            assert!(found.unwrap()[0] && endless.cancelled.load(Ordering::Relaxed));
        }
    }

    #[test]
    fn a_cancelled_trial_is_repeated_when_it_is_requested() {
        let calls = AtomicUsize::new(0);
        struct Twice<'n>(&'n AtomicUsize, Endless);
        impl Objective for Twice<'_> {
            fn evaluate(&self, x: &[f64], cancellation: &Cancellation) -> Evaluation {
                if x == [7.0] && self.0.fetch_add(1, Ordering::Relaxed) > 0 {
                    return 7.0.into();
                }
                self.1.evaluate(x, cancellation)
            }
        }
        let twice = Twice(&calls, Endless::default());
        let found = TrialPool::new(vec![&twice as &dyn Objective], 2).run(|evaluator, _| {
            evaluator.speculate(&[vec![7.0]]);
            evaluator.evaluate(&[1.0])?;
            evaluator.speculate(&[]);
            evaluator.evaluate(&[7.0])
        });
        assert_eq!(found.unwrap(), [Evaluation::Value(ObjectiveValue::Scalar(7.0))]);
        assert_eq!(calls.load(Ordering::Relaxed), 2);
    }

    #[test]
    fn the_error_is_that_of_the_first_problem() {
        let value = |x: &[f64]| x[0];
        for threads in [1, 2, 4] {
            let pool = TrialPool::new((0..4).map(|_| &value as &dyn Objective).collect(), threads);
            let requested = AtomicUsize::new(0);
            let found: Result<Vec<()>, (usize, PoolError)> = pool.run(|evaluator, number| {
                for trial in 0..20 {
                    evaluator.evaluate(&[f64::from(trial)])?;
                    requested.fetch_add(usize::from(number == 0), Ordering::Relaxed);
                    // The third fails at once, the second at its end, the others do not.
                    if number == 2 || (number == 1 && trial == 19) {
                        return Err(PoolError::Fatal(FatalError::new(format!("search {number}"))));
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
