//! The work of one process on a sweep, and what is left of it: runs that neither an earlier sweep, nor this process, nor another has
//! computed.

use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::{Case, Sweep};
use crate::evaluate::{Evaluated, Evaluation, EvaluationError, EvaluationKeys, Evaluations, RunEvent};
use crate::store::evaluations::Share;
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
#[derive(Clone, Copy)]
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
        let waiting = base::lock(&self.queue).len();
        let done = base::lock(&self.done);
        let begun = self.work.sweep.len().saturating_sub(done.len() + waiting);
        Position { waiting, begun, computed: done.computed }
    }

    /// At most so many places of runs that wait, spread evenly.
    fn sample(&self, most: usize) -> Vec<usize> {
        let queue = base::lock(&self.queue);
        let count = queue.len().min(most);
        (0..count).map(|turn| queue[turn * queue.len() / count]).collect()
    }

    fn take_all(&self) {
        let _guard = PanicGuard(&self.has_panicked);
        while !self.ends() {
            let next = base::lock(&self.queue).pop_front();
            let result = match next {
                Some(place) => self.take(place),
                None if self.wait() => continue,
                None => return,
            };
            if let Err(error) = result {
                base::lock(&self.error).get_or_insert(error);
            }
        }
    }

    /// Whether no run may begin any more.
    fn ends(&self) -> bool {
        // A run that the deadline would cut off is not begun, as the longest so far tells.
        let longest = Duration::from_millis(self.longest.load(Ordering::Relaxed));
        let Stop { requested, given_up, deadline } = self.work.stop;
        let is_requested = requested.is_cancelled() || given_up.is_cancelled();
        let is_late = deadline.is_some_and(|deadline| Instant::now() + longest > deadline);
        let has_panicked = self.has_panicked.load(Ordering::Relaxed);
        is_requested || is_late || has_panicked || base::lock(&self.error).is_some()
    }

    /// Looks again for runs that other processes compute; `false` where there are none, or it is not this process that
    /// waits for them.
    fn wait(&self) -> bool {
        if self.work.gather || !self.work.waits || base::lock(&self.elsewhere).is_empty() {
            return false;
        }
        thread::sleep(TICK);
        let places = std::mem::take(&mut *base::lock(&self.elsewhere));
        base::lock(&self.queue).extend(places);
        true
    }

    fn take(&self, place: usize) -> Result<(), EvaluationError> {
        let Work { sweep, evaluations, gather, .. } = self.work;
        let Case { model, plan, keys } = match sweep.case(place)? {
            Ok(case) => case,
            Err(cause) => {
                evaluations.tell(RunEvent::Refused(&cause));
                self.refuse(place, cause);
                return Ok(());
            }
        };
        if self.take_record(place, keys)? {
            return Ok(());
        }
        let (store, failed) = (evaluations.store(), |error| evaluations.failed(error));
        if gather {
            if let Some(cause) = store.refusal(keys.figures).map_err(failed)? {
                evaluations.tell(RunEvent::Refused(&cause));
                self.refuse(place, cause);
            }
            return Ok(());
        }
        let Some(claim) = store.claim(keys.figures).map_err(failed)? else {
            // Not waited for here: the thread takes other runs, and looks again once the queue is empty.
            base::lock(&self.elsewhere).push(place);
            return Ok(());
        };
        // Whoever held the claim before may have ended since the look.
        if self.take_record(place, keys)? {
            return Ok(());
        }
        let begin = Instant::now();
        let evaluated = match evaluations.evaluate(&model, &plan, keys, &self.work.stop.given_up) {
            Err(EvaluationError::Cancelled) => return Ok(()),
            Err(EvaluationError::Passing(cause)) => {
                claim.refuse(&cause).map_err(failed)?;
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
    /// Notes a run that has a record; `false` where it has none.
    fn take_record(&self, place: usize, keys: EvaluationKeys) -> Result<bool, EvaluationError> {
        let evaluations = self.work.evaluations;
        if !evaluations.store().contains(keys.figures).map_err(|error| evaluations.failed(error))? {
            return Ok(false);
        }
        let mut done = base::lock(&self.done);
        done.cache_hits += 1;
        done.keys.insert(place, keys);
        // The observer may be slow: no other thread waits for it at this lock.
        drop(done);
        evaluations.tell(RunEvent::Taken);
        (self.observer)(Event::Taken(place, keys));
        Ok(true)
    }

    /// Notes a run without an evaluation.
    fn refuse(&self, place: usize, cause: String) {
        (self.observer)(Event::Refused(place, &cause));
        base::lock(&self.done).refused.insert(place, cause);
    }

    /// Notes an evaluation.
    fn add(&self, place: usize, keys: EvaluationKeys, evaluated: &Evaluated) {
        let Evaluated { evaluation, is_new } = evaluated;
        let mut done = base::lock(&self.done);
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

/// Most runs of a sample.
const MOST: usize = 200;

/// Most time for a sample.
const LIMIT: Duration = Duration::from_millis(300);

/// Time until the first sample, and the longest between two: each is twice the one before.
const FIRST: Duration = Duration::from_millis(500);
const LONGEST: Duration = Duration::from_secs(60);

/// Remaining work of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RemainingWork {
    /// Runs that are still to be computed, by this process or others.
    pub left: usize,
    /// Runs that other processes have computed since this one began.
    pub elsewhere: usize,
}

/// Runs that are computed before an estimate: the mean of ten is within a third of that of runs which differ by a half.
const MEASURED_RUNS: usize = 10;

/// Time for the runs that are `left`, s, where so many were computed in `seconds`; none of too few.
pub fn seconds_to_go(computed: usize, seconds: f64, left: f64) -> Option<f64> {
    (computed >= MEASURED_RUNS && seconds > 0.0).then(|| left * seconds / computed as f64)
}

/// How far a process is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Position {
    /// Runs that nobody here has looked at.
    pub waiting: usize,
    /// Runs that are under way, here or elsewhere.
    pub begun: usize,
    /// Runs that were computed here.
    pub computed: usize,
}

/// Estimates what is left from samples of the runs that wait.
#[derive(Debug)]
pub(super) struct Estimator {
    /// Records of others when the process began.
    before: usize,
    /// What the last sample found, and the runs that were computed here by then.
    sampled: Option<(RemainingWork, usize)>,
    next: Instant,
    pause: Duration,
}

impl Estimator {
    /// Of a process that begins now.
    pub(super) fn new(evaluations: &Evaluations) -> Estimator {
        let before = others(evaluations);
        Estimator { before, sampled: None, next: Instant::now() + FIRST, pause: FIRST }
    }

    /// The work left at `position`, where `sample` gives at most so many places of runs that wait, spread evenly; none
    /// before the first sample, and where all records are of this process, which knows it then.
    pub(super) fn remaining_work(
        &mut self,
        sweep: &Sweep,
        evaluations: &Evaluations,
        Position { waiting, begun, computed }: Position,
        sample: impl FnOnce(usize) -> Vec<usize>,
    ) -> Option<RemainingWork> {
        if Instant::now() >= self.next {
            let others = others(evaluations);
            self.sampled = (others > 0).then(|| {
                let unknown = waiting as f64 * unknown_share(sweep, evaluations, &sample(MOST));
                let left = unknown.round() as usize + begun;
                (RemainingWork { left, elsewhere: others.saturating_sub(self.before) }, computed)
            });
            // A sample takes time from the runs: in a long sweep it becomes rare.
            self.pause = (2 * self.pause).min(LONGEST);
            self.next = Instant::now() + self.pause;
        }
        let (RemainingWork { left, elsewhere }, by_then) = self.sampled?;
        let since = computed.saturating_sub(by_then);
        // A sample may err; the runs that have begun are left for certain.
        Some(RemainingWork { left: left.saturating_sub(since).max(begun), elsewhere })
    }
}

/// Records of other processes; none where they cannot be read, which the next run says.
fn others(evaluations: &Evaluations) -> usize {
    evaluations.store().others().unwrap_or(0)
}

/// The share of the runs at `places` that have no record, of as many as there is time for.
fn unknown_share(sweep: &Sweep, evaluations: &Evaluations, places: &[usize]) -> f64 {
    let begin = Instant::now();
    let is_unknown = |place: usize| match sweep.case(place) {
        Ok(Ok(Case { keys, .. })) => !evaluations.store().contains(keys.figures).unwrap_or(false),
        _ => false,
    };
    let (mut looked, mut unknown) = (0_usize, 0_usize);
    // In steps that cover the places evenly, however early it ends.
    for turn in Share::WHOLE.order(places.len()) {
        if looked > 0 && begin.elapsed() > LIMIT {
            break;
        }
        looked += 1;
        unknown += usize::from(is_unknown(places[turn]));
    }
    if looked == 0 { 0.0 } else { unknown as f64 / looked as f64 }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::path::Path;
    use std::sync::atomic::AtomicUsize;
    use std::sync::mpsc;

    use super::*;
    use base::cancellation::Cancellation;
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
            let evaluations = Evaluations::new(folder.path());
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

    /// A sweep of so many masses.
    fn sweep(folder: &Path, count: usize) -> Sweep {
        let path = folder.join("a.toml");
        let masses: Vec<String> = (0..count).map(|number| format!("{}", 10.0 + 0.01 * number as f64)).collect();
        let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/drop/1008.toml");
        fs::write(&path, format!("extends = {base:?}\nunset = [\"reference\", \"post\"]\n")).unwrap();
        let set = [
            "specimen.mesh.size=\"80 mm\"".to_owned(),
            "loading.impact.duration=\"3 ms\"".to_owned(),
            format!("variation={{ \"impactor.mass\" = [{}] }}", masses.join(", ")),
        ];
        let set: Vec<Assignment> = set.iter().map(|text| Assignment::from_argument(text).unwrap()).collect();
        Sweep::prepare(&Document::read(&path).unwrap().with(&set), None).unwrap()
    }

    fn compute(sweep: &Sweep, evaluations: &Evaluations, places: impl Iterator<Item = usize>) {
        for place in places {
            let Case { model, plan, keys } = sweep.case(place).unwrap().unwrap();
            evaluations.evaluate(&model, &plan, keys, &Cancellation::default()).unwrap();
        }
    }

    #[test]
    fn runs_of_earlier_sweeps_and_of_other_processes_are_not_left() {
        let folder = tempfile::tempdir().unwrap();
        let store = folder.path().join("store");
        let sweep = sweep(folder.path(), 30);
        let now = |estimator: &mut Estimator| estimator.next = Instant::now();
        let later = |estimator: &mut Estimator| estimator.next = Instant::now() + Duration::from_secs(3600);
        let at = |computed| Position { waiting: 26, begun: 2, computed };
        let waiting = |_: usize| (4..30).collect();

        let alone = Evaluations::new(&store);
        let mut estimator = Estimator::new(&alone);
        now(&mut estimator);
        assert_eq!(estimator.remaining_work(&sweep, &alone, at(2), waiting), None);
        compute(&sweep, &alone, (10..20).chain([0]));

        let [here, other] = [(); 2].map(|()| Evaluations::new(&store));
        let mut estimator = Estimator::new(&here);
        later(&mut estimator);
        assert_eq!(estimator.remaining_work(&sweep, &here, at(2), waiting), None);
        now(&mut estimator);
        let left = 26 - 10 + 2;
        assert_eq!(estimator.remaining_work(&sweep, &here, at(2), waiting), Some(RemainingWork { left, elsewhere: 0 }));
        later(&mut estimator);
        compute(&sweep, &other, 25..28);
        // Until the next sample, what others compute is not known.
        let expected = RemainingWork { left: left - 1, elsewhere: 0 };
        assert_eq!(estimator.remaining_work(&sweep, &here, at(3), waiting), Some(expected));
        now(&mut estimator);
        let expected = RemainingWork { left: left - 3, elsewhere: 3 };
        assert_eq!(estimator.remaining_work(&sweep, &here, at(3), waiting), Some(expected));
    }
}
