//! The work of one process on a sweep.

use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::remaining::{Estimator, Position, RemainingWork};
use super::{Case, CaseError, Sweep};
use crate::evaluate::{Evaluated, Evaluation, EvaluationError, EvaluationKeys, Evaluations, RunEvent};
use base::cancellation::Cancellation;
use base::periodic;

/// Time between two looks at the clock, at signals, and at what other processes did.
const TICK: Duration = Duration::from_millis(100);

/// Time between two estimates of what is left.
const LOOK: Duration = Duration::from_millis(500);

/// When a process stops before all runs are done.
#[derive(Clone, Debug, Default)]
pub struct Stop {
    /// Cancelled where no run is to begin any more; those that have begun end.
    pub requested: Cancellation,
    /// Cancelled where runs that have begun are given up, too.
    pub given_up: Cancellation,
    /// Latest time at which a run may end.
    pub deadline: Option<Instant>,
}

/// An event in the course of a sweep's run.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// The run at this place was evaluated before, under these keys.
    Taken(usize, EvaluationKeys),
    /// The run at this place was evaluated now.
    Computed(usize, &'a Evaluation),
    /// The values of the run at this place make no valid scenario, or it failed for a cause that may pass.
    Refused(usize, &'a str),
    /// So much is left; told from time to time where there are records of other sweeps or processes.
    Left(RemainingWork),
}

/// A sweep and how a process works on it.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    /// The sweep.
    pub sweep: &'a Sweep,
    /// Records of evaluations.
    pub evaluations: &'a Evaluations,
    /// Whether it waits for runs that other processes compute.
    pub waits: bool,
    /// When it stops.
    pub stop: &'a Stop,
    /// Whether nothing is computed, and only records are gathered.
    pub gather: bool,
}

/// The results of the runs of a sweep that are known.
#[derive(Debug, Default)]
pub struct Done {
    /// Keys of the evaluations that have records, by place.
    pub keys: BTreeMap<usize, EvaluationKeys>,
    /// Why runs have no evaluation, by place.
    pub refused: BTreeMap<usize, String>,
    /// Runs that were evaluated before.
    pub cache_hits: usize,
    /// Runs that were evaluated now.
    pub computed: usize,
    /// Time that the engine took for them, s.
    pub engine_s: f64,
}

impl Done {
    /// Number of runs of which the outcome is known.
    pub fn len(&self) -> usize {
        self.keys.len() + self.refused.len()
    }

    /// Whether nothing is known.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Stop {
    fn is_requested(&self) -> bool {
        self.requested.is_cancelled() || self.given_up.is_cancelled()
    }
}

/// State that the threads share.
struct State<'a> {
    work: Work<'a>,
    queue: Mutex<VecDeque<usize>>,
    /// Runs that other processes compute.
    elsewhere: Mutex<Vec<usize>>,
    done: Mutex<Done>,
    error: Mutex<Option<EvaluationError>>,
    /// Longest time of a run so far, ms.
    longest: AtomicU64,
    /// Whether a thread panicked: its run is never done, and whoever waited for it would never end.
    has_panicked: AtomicBool,
    observer: &'a (dyn Fn(Event<'_>) + Sync),
}

/// Tells the other threads of a panic when dropped by one.
struct PanicGuard<'a>(&'a AtomicBool);

impl Drop for PanicGuard<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

impl Work<'_> {
    /// Evaluates the runs with all threads, until all are done, or computed elsewhere, or it must stop.
    ///
    /// # Errors
    /// Records or inputs cannot be read or written.
    ///
    /// # Panics
    /// Where a run or the observer does; no run begins then any more.
    pub fn run(&self, observer: &(dyn Fn(Event<'_>) + Sync)) -> Result<Done, EvaluationError> {
        let state = State {
            work: *self,
            queue: Mutex::new(self.evaluations.share().order(self.sweep.len()).into()),
            elsewhere: Mutex::default(),
            done: Mutex::default(),
            error: Mutex::default(),
            longest: AtomicU64::new(0),
            has_panicked: AtomicBool::new(false),
            observer,
        };
        self.evaluations.tell(RunEvent::Wanted(self.sweep.len()));
        let mut estimator = Estimator::new(self.evaluations);
        let estimate = || state.estimate_remaining(&mut estimator);
        let threads = 0..rayon::current_num_threads();
        let take = || rayon::scope(|scope| threads.for_each(|_| scope.spawn(|_| state.take_all())));
        periodic::during(TICK, || state.watch(), || periodic::during(LOOK, estimate, take));
        if !self.gather {
            let store = self.evaluations.store();
            store.close().and_then(|()| store.sync()).map_err(|error| self.evaluations.failed(error))?;
        }
        match state.error.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => Ok(state.done.into_inner().unwrap_or_else(PoisonError::into_inner)),
        }
    }
}

impl State<'_> {
    /// Shows other processes that this one is at work, and ends runs at the deadline.
    fn watch(&self) {
        let _guard = PanicGuard(&self.has_panicked);
        if self.work.stop.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.work.stop.given_up.cancel();
        }
        if !self.work.gather {
            // What cannot be written shows in the next record.
            let _ = self.work.evaluations.store().keep_alive();
        }
    }

    /// Tells what is left.
    fn estimate_remaining(&self, estimator: &mut Estimator) {
        let _guard = PanicGuard(&self.has_panicked);
        let Work { sweep, evaluations, gather, .. } = self.work;
        if gather {
            return;
        }
        let remaining = estimator.remaining_work(sweep, evaluations, self.position(), |most| self.sample(most));
        if let Some(remaining) = remaining {
            (self.observer)(Event::Left(remaining));
        }
    }

    fn position(&self) -> Position {
        let waiting = lock(&self.queue).len();
        let done = lock(&self.done);
        let begun = self.work.sweep.len().saturating_sub(done.len() + waiting);
        Position { waiting, begun, computed: done.computed }
    }

    /// At most so many places of runs that wait, spread evenly.
    fn sample(&self, most: usize) -> Vec<usize> {
        let queue = lock(&self.queue);
        let count = queue.len().min(most);
        (0..count).map(|turn| queue[turn * queue.len() / count]).collect()
    }

    fn take_all(&self) {
        let _guard = PanicGuard(&self.has_panicked);
        while !self.ends() {
            let next = lock(&self.queue).pop_front();
            let result = match next {
                Some(place) => self.take(place),
                None if self.wait() => continue,
                None => return,
            };
            if let Err(error) = result {
                lock(&self.error).get_or_insert(error);
            }
        }
    }

    /// Whether no run may begin any more.
    fn ends(&self) -> bool {
        // A run that the deadline would cut off is not begun, as the longest so far tells.
        let longest = Duration::from_millis(self.longest.load(Ordering::Relaxed));
        let Stop { deadline, .. } = self.work.stop;
        let is_late = deadline.is_some_and(|deadline| Instant::now() + longest > deadline);
        let has_panicked = self.has_panicked.load(Ordering::Relaxed);
        self.work.stop.is_requested() || is_late || has_panicked || lock(&self.error).is_some()
    }

    /// Looks again for runs that other processes compute; `false` where there are none, or it is not this process that
    /// waits for them.
    fn wait(&self) -> bool {
        if self.work.gather || !self.work.waits || lock(&self.elsewhere).is_empty() {
            return false;
        }
        thread::sleep(TICK);
        let places = std::mem::take(&mut *lock(&self.elsewhere));
        lock(&self.queue).extend(places);
        true
    }

    fn take(&self, place: usize) -> Result<(), EvaluationError> {
        let Work { sweep, evaluations, gather, .. } = self.work;
        let Case { model, plan, keys } = match sweep.case(place) {
            Ok(case) => case,
            Err(CaseError::Evaluation(error)) => return Err(error),
            Err(CaseError::Refused(cause)) => {
                evaluations.tell(RunEvent::Refused(&cause));
                self.refuse(place, cause);
                return Ok(());
            }
        };
        let store = evaluations.store();
        // Another process may have computed it since the last look.
        if !store.contains(keys.figures) {
            store.refresh().map_err(|error| evaluations.failed(error))?;
        }
        if store.contains(keys.figures) {
            let mut done = lock(&self.done);
            done.cache_hits += 1;
            done.keys.insert(place, keys);
            // The observer may be slow: no other thread waits for it at this lock.
            drop(done);
            evaluations.tell(RunEvent::Taken);
            (self.observer)(Event::Taken(place, keys));
            return Ok(());
        }
        if gather {
            if let Some(cause) = store.refusal(keys.figures).map_err(|error| evaluations.failed(error))? {
                self.refuse(place, cause);
            }
            return Ok(());
        }
        let Some(claim) = store.claim(keys.figures).map_err(|error| evaluations.failed(error))? else {
            // Not waited for here: the thread takes other runs, and looks again once the queue is empty.
            lock(&self.elsewhere).push(place);
            return Ok(());
        };
        let begin = Instant::now();
        let evaluated = match evaluations.evaluate(&model, &plan, keys, &self.work.stop.given_up) {
            Err(EvaluationError::Cancelled) => {
                // Else others would wait for a run that nobody computes.
                return claim.release().map_err(|error| evaluations.failed(error));
            }
            Err(EvaluationError::Passing(cause)) => {
                claim.refuse(&cause).map_err(|error| evaluations.failed(error))?;
                self.refuse(place, cause);
                return Ok(());
            }
            evaluated => evaluated?,
        };
        self.longest.fetch_max(begin.elapsed().as_millis() as u64, Ordering::Relaxed);
        self.add(place, keys, &evaluated);
        Ok(())
    }
}

impl State<'_> {
    /// Notes a run without an evaluation.
    fn refuse(&self, place: usize, cause: String) {
        (self.observer)(Event::Refused(place, &cause));
        lock(&self.done).refused.insert(place, cause);
    }

    /// Notes an evaluation.
    fn add(&self, place: usize, keys: EvaluationKeys, evaluated: &Evaluated) {
        let Evaluated { evaluation, is_new } = evaluated;
        let mut done = lock(&self.done);
        done.keys.insert(place, keys);
        if *is_new {
            done.computed += 1;
            done.engine_s += evaluation.engine_s;
        } else {
            done.cache_hits += 1;
        }
        drop(done);
        (self.observer)(if *is_new { Event::Computed(place, evaluation) } else { Event::Taken(place, keys) });
    }
}

/// No lock is held where a panic could leave its content half changed.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::path::Path;
    use std::sync::atomic::AtomicUsize;
    use std::sync::mpsc;

    use super::*;
    use scene::scenario::{Assignment, Document};

    /// A thread panics once; the other begins nothing more as soon as it is told.
    #[test]
    fn a_panic_ends_the_sweep() {
        let masses: Vec<String> = (0..40).map(|place| format!("{}", 10 + place)).collect();
        let masses = format!("variation={{ \"impactor.mass\" = [{}] }}", masses.join(", "));
        let set = ["specimen.mesh.size=\"80 mm\"", "loading.impact.duration=\"1 ms\"", &masses];
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/drop/1008.toml");
        let unset = ["reference", "post"].map(|key| Assignment::unset(key, "test"));
        let set: Vec<Assignment> = set.iter().map(|text| Assignment::from_argument(text).unwrap()).collect();
        let sweep = Sweep::prepare(&Document::read(&path).unwrap().with(&unset).with(&set), None).unwrap();
        let (told, ended) = mpsc::channel();
        thread::spawn(move || {
            let folder = tempfile::tempdir().unwrap();
            let evaluations = Evaluations::open(folder.path()).unwrap();
            let stop = Stop::default();
            let work = Work { sweep: &sweep, evaluations: &evaluations, waits: true, stop: &stop, gather: false };
            let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
            let (computed, panics) = (AtomicUsize::new(0), AtomicBool::new(true));
            let observer = |event: Event<'_>| {
                if let Event::Computed(..) = event {
                    computed.fetch_add(1, Ordering::Relaxed);
                    assert!(!panics.swap(false, Ordering::Relaxed), "the observer panics once");
                    // A panic takes a while to be printed before its thread ends.
                    thread::sleep(Duration::from_millis(100));
                }
            };
            let run = || threads.install(|| work.run(&observer));
            let has_panicked = catch_unwind(AssertUnwindSafe(run)).is_err();
            told.send((has_panicked, computed.into_inner())).unwrap();
        });
        let (has_panicked, computed) = ended.recv_timeout(Duration::from_secs(60)).unwrap();
        // Untold, the other thread would compute all that are left.
        assert!(has_panicked && computed < 40, "{computed} runs");
    }
}
