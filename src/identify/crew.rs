//! Trials on all cores.
//!
//! A search asks for one point after the other and says which ones it may ask for next. Those that a search waits for come
//! first, in the order in which they were asked for; cores that are idle while all searches wait work ahead, all but one, so
//! that what is asked for never waits for what is not. Nothing is evaluated twice, and what a search finds depends neither on
//! the number of threads, nor on who was quicker, nor on the searches beside it.

use std::collections::{HashMap, VecDeque};
use std::panic::resume_unwind;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Instant;

use rayon::ThreadPoolBuilder;
use thiserror::Error;

use super::history::{History, HistoryError};
use super::objective::{Broken, Evaluation, Objective, Observed};
use super::options::OnFailure;
use crate::script::{Compared, Target};
use crate::simulate::Cancellation;

/// Relative step aside of a trial that is repeated.
const ASIDE: f64 = 1e-6;

/// Most samples that the pictures of one search's trials hold together, taken up ones included; trials that are finished behind
/// that have none.
const MOST_SAMPLES: usize = 64 << 20;

/// Evaluates the trials of one or several searches in parallel, remembers them, and writes them down.
pub struct Crew<'a> {
    threads: usize,
    rules: Vec<Rule<'a>>,
    floor: Mutex<Floor<'a>>,
    changed: Condvar,
}

/// What one search has evaluated, and where that is kept.
pub struct Task<'a> {
    pub objective: &'a dyn Objective,
    pub on_failure: OnFailure,
    /// Trials in it are taken from there, others are added to it.
    pub history: Option<&'a mut History>,
}

/// Where one search asks for its trials.
#[derive(Clone, Copy)]
pub struct Desk<'c, 'a> {
    crew: &'c Crew<'a>,
    number: usize,
}

/// Why no more trials are made.
#[derive(Debug, Error)]
pub enum CrewError {
    #[error("cannot start threads for trials: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    #[error(transparent)]
    History(#[from] HistoryError),
    /// The objective cannot go on.
    #[error("{0}")]
    Broken(#[source] Broken),
    /// No more trials are made, for a reason that is told elsewhere.
    #[error("the trials have ended")]
    Over,
}

/// The bits of a point.
type Point = Vec<u64>;

struct Rule<'a> {
    objective: &'a dyn Objective,
    on_failure: OnFailure,
}

/// What all searches share.
struct Floor<'a> {
    boards: Vec<Board<'a>>,
    /// What is waited for and nobody has begun, by search.
    asked: VecDeque<(usize, Point)>,
    running: Vec<Job>,
}

/// What concerns one search.
struct Board<'a> {
    done: HashMap<Point, Observed>,
    /// What the search waits for.
    awaited: Vec<Point>,
    /// What it may ask for next, the likeliest first.
    expected: VecDeque<Point>,
    history: Option<&'a mut History>,
    error: Option<CrewError>,
    over: bool,
    /// References that trials were held against.
    targets: Vec<Arc<Target>>,
    /// Samples that the pictures of trials hold.
    samples: usize,
}

/// A trial on its way.
#[derive(Clone)]
struct Job {
    search: usize,
    point: Point,
    cancellation: Cancellation,
}

/// Says that a search is over when dropped, so that the crew goes home even where the search panics.
struct Leave<'c, 'a> {
    desk: Desk<'c, 'a>,
    found: bool,
}

impl Drop for Leave<'_, '_> {
    fn drop(&mut self) {
        let Desk { crew, number } = self.desk;
        crew.floor().leave(number);
        if !self.found {
            (number + 1..crew.rules.len()).for_each(|later| crew.floor().leave(later));
        }
        crew.changed.notify_all();
    }
}

/// Ends all searches when dropped, as they have ended when a thread has served, unless it panics in a trial: nobody then
/// waits for what that would have found.
struct Serving<'c, 'a>(&'c Crew<'a>);

impl Drop for Serving<'_, '_> {
    fn drop(&mut self) {
        (0..self.0.rules.len()).for_each(|search| self.0.floor().leave(search));
        self.0.changed.notify_all();
    }
}

impl<'a> Crew<'a> {
    /// A crew of `threads` for the trials of `tasks`, one a search.
    pub fn new(tasks: Vec<Task<'a>>, threads: usize) -> Crew<'a> {
        let rules = tasks
            .iter()
            .map(|Task { objective, on_failure, .. }| Rule { objective: *objective, on_failure: *on_failure });
        let rules = rules.collect();
        let boards = tasks.into_iter().map(|task| Board::new(task.history)).collect();
        let floor = Floor { boards, asked: VecDeque::new(), running: vec![] };
        Crew { threads: threads.max(1), rules, floor: Mutex::new(floor), changed: Condvar::new() }
    }

    /// Runs `search` for every task at the same time while the crew is at work, whose threads have stacks of `stack` bytes.
    /// What was found, in the order of the tasks.
    ///
    /// # Errors
    /// The number of the first task whose search failed, and why: its objective cannot go on, its history cannot be written, or
    /// whatever `search` says. Searches before it have run to their ends, those behind it were broken off: it is the failure that
    /// would have come first had they been made one after the other.
    ///
    /// # Panics
    /// Where an objective does; all searches are ended first.
    pub fn at_work<T: Send, E: From<CrewError> + Send>(
        &self,
        stack: usize,
        search: impl Fn(&Desk<'_, 'a>, usize) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, (usize, E)> {
        // Simulations within a pool of threads take one thread each.
        let pool = ThreadPoolBuilder::new().num_threads(self.threads).stack_size(stack).build();
        let pool = pool.map_err(|error| (0, CrewError::from(error).into()))?;
        let at_desk = |number| self.at_desk(number, &search);
        let found = pool.in_place_scope(|scope| {
            // One each, which no other thread can take: a trial that waits for work of its own within the pool would else begin to
            // serve in the middle of itself, and never end.
            scope.spawn_broadcast(|_, _| self.serve());
            thread::scope(|threads| {
                let others: Vec<_> =
                    (1..self.rules.len()).map(|number| threads.spawn(move || at_desk(number))).collect();
                let first = (!self.rules.is_empty()).then(|| at_desk(0));
                let others = others.into_iter().map(|other| other.join().unwrap_or_else(|panic| resume_unwind(panic)));
                first.into_iter().chain(others).collect::<Vec<_>>()
            })
        });
        found.into_iter().enumerate().map(|(number, found)| found.map_err(|error| (number, error))).collect()
    }

    fn at_desk<T, E: From<CrewError>>(
        &self,
        number: usize,
        search: &impl Fn(&Desk<'_, 'a>, usize) -> Result<T, E>,
    ) -> Result<T, E> {
        let desk = Desk { crew: self, number };
        let mut leave = Leave { desk, found: false };
        let found = search(&desk, number);
        let error = self.floor().boards[number].error.take();
        let found = error.map_or(found, |error| Err(error.into()));
        leave.found = found.is_ok();
        found
    }

    fn serve(&self) {
        let _serving = Serving(self);
        while let Some(job) = self.next() {
            let x: Vec<f64> = job.point.iter().map(|bits| f64::from_bits(*bits)).collect();
            let rule = &self.rules[job.search];
            let begin = Instant::now();
            let found = rule.observe(&x, &job.cancellation);
            let seconds = begin.elapsed().as_secs_f64();
            let mut floor = self.floor();
            floor.running.retain(|other| !other.cancellation.is(&job.cancellation));
            if !job.cancellation.is_cancelled() {
                floor.boards[job.search].keep(job.point, found, seconds, rule.objective);
            }
            drop(floor);
            self.changed.notify_all();
        }
    }

    /// The next trial to make; none once all searches are over.
    fn next(&self) -> Option<Job> {
        let mut floor = self.floor();
        loop {
            if floor.boards.iter().all(|board| board.over) {
                return None;
            }
            if let Some((search, point)) = floor.take(self.threads) {
                let job = Job { search, point, cancellation: Cancellation::default() };
                floor.running.push(job.clone());
                return Some(job);
            }
            floor = self.wait(floor);
        }
    }

    fn floor(&self) -> MutexGuard<'_, Floor<'a>> {
        self.floor.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'f>(&self, floor: MutexGuard<'f, Floor<'a>>) -> MutexGuard<'f, Floor<'a>> {
        self.changed.wait(floor).unwrap_or_else(PoisonError::into_inner)
    }
}

impl Desk<'_, '_> {
    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.crew.threads
    }

    /// What is found at `x`; waits for it.
    pub fn evaluate(&self, x: &[f64]) -> Result<Evaluation, CrewError> {
        let mut found = self.evaluate_all(std::slice::from_ref(&x.to_vec()))?;
        found.pop().ok_or_else(|| CrewError::Broken("the trial was not made".into()))
    }

    /// What is found at every one of `points`; waits for them all.
    pub fn evaluate_all(&self, points: &[Vec<f64>]) -> Result<Vec<Evaluation>, CrewError> {
        let points: Vec<Point> = points.iter().map(|x| bits(x)).collect();
        let mut floor = self.crew.floor();
        points.iter().for_each(|point| floor.ask(self.number, point));
        self.crew.changed.notify_all();
        loop {
            let board = &floor.boards[self.number];
            if board.error.is_some() || board.over {
                return Err(CrewError::Over);
            }
            let found: Option<Vec<Evaluation>> = points.iter().map(|point| board.found(point)).collect();
            if let Some(found) = found {
                return Ok(found);
            }
            floor = self.crew.wait(floor);
        }
    }

    /// What was found at `x`, if that is known by now.
    pub fn known(&self, x: &[f64]) -> Option<Evaluation> {
        self.crew.floor().boards[self.number].found(&bits(x))
    }

    /// What was held against references at `x`, where that is known.
    pub fn compared(&self, x: &[f64]) -> Vec<Compared> {
        let floor = self.crew.floor();
        let observed = floor.boards[self.number].done.get(&bits(x));
        observed.map_or_else(Vec::new, |observed| observed.compared.clone())
    }

    /// Points of which some will be asked for next, the likeliest first, in place of those said before. A trial that was begun
    /// ahead and is not among them is given up.
    pub fn expect(&self, points: &[Vec<f64>]) {
        let points: VecDeque<Point> = points.iter().map(|x| bits(x)).collect();
        let mut floor = self.crew.floor();
        let awaited = &floor.boards[self.number].awaited;
        let in_vain =
            |job: &&Job| job.search == self.number && !awaited.contains(&job.point) && !points.contains(&job.point);
        floor.running.iter().filter(in_vain).for_each(|job| job.cancellation.cancel());
        floor.boards[self.number].expected = points;
        self.crew.changed.notify_all();
    }
}

impl Rule<'_> {
    fn observe(&self, x: &[f64], cancellation: &Cancellation) -> Observed {
        let observed = self.objective.observe(x, cancellation);
        match observed.found {
            Evaluation::Failed { .. } if self.on_failure == OnFailure::Retry => {
                let aside: Vec<f64> = x.iter().map(|x| x * (1.0 + ASIDE)).collect();
                match self.objective.observe(&aside, cancellation) {
                    Observed { found: Evaluation::Failed { .. }, .. } => observed,
                    other => other,
                }
            }
            _ => observed,
        }
    }
}

impl Floor<'_> {
    fn ask(&mut self, search: usize, point: &Point) {
        if self.boards[search].done.contains_key(point) {
            return;
        }
        let asked = self.asked.iter().any(|(other, asked)| *other == search && asked == point);
        if !asked && !self.is_running(search, point) {
            self.asked.push_back((search, point.clone()));
        }
        self.boards[search].awaited.push(point.clone());
    }

    fn is_running(&self, search: usize, point: &Point) -> bool {
        let mut running = self.running.iter();
        running.any(|job| job.search == search && job.point == *point && !job.cancellation.is_cancelled())
    }

    /// What is asked for; or else, while all searches wait, what is expected, as long as that leaves a thread free. A search
    /// that finds everything it asks for among what is done makes no trial at all.
    fn take(&mut self, threads: usize) -> Option<(usize, Point)> {
        if let Some(asked) = self.asked.pop_front() {
            return Some(asked);
        }
        if self.boards.iter().any(|board| !board.over && board.awaited.is_empty()) {
            return None;
        }
        let ahead = self.running.iter().filter(|job| !self.boards[job.search].awaited.contains(&job.point)).count();
        if ahead + 1 >= threads {
            return None;
        }
        (0..self.boards.len()).find_map(|search| Some((search, self.take_ahead(search)?)))
    }

    fn take_ahead(&mut self, search: usize) -> Option<Point> {
        let board = &self.boards[search];
        let is_fresh = |point: &Point| !board.done.contains_key(point) && !self.is_running(search, point);
        let fresh = board.expected.iter().position(is_fresh)?;
        self.boards[search].expected.drain(..=fresh).next_back()
    }

    /// The search is over: nothing more of it is begun, and what is on its way is given up.
    fn leave(&mut self, search: usize) {
        self.boards[search].over = true;
        self.boards[search].expected.clear();
        self.asked.retain(|(other, _)| *other != search);
        self.running.iter().filter(|job| job.search == search).for_each(|job| job.cancellation.cancel());
    }
}

impl<'a> Board<'a> {
    fn new(history: Option<&'a mut History>) -> Board<'a> {
        let targets = history.iter().flat_map(|history| history.targets()).cloned().collect();
        let trials = || history.iter().flat_map(|history| history.trials());
        let samples = trials().map(|(_, observed)| samples_of(&observed.compared)).sum();
        let done = trials().map(|(x, observed)| (bits(x), observed.clone())).collect();
        let (awaited, expected) = Default::default();
        Board { done, awaited, expected, history, error: None, over: false, targets, samples }
    }

    fn found(&self, point: &Point) -> Option<Evaluation> {
        self.done.get(point).map(|observed| observed.found.clone())
    }

    fn keep(&mut self, point: Point, mut observed: Observed, seconds: f64, objective: &dyn Objective) {
        let x: Vec<f64> = point.iter().map(|bits| f64::from_bits(*bits)).collect();
        self.share_targets(&mut observed.compared);
        if let Err(error) = self.write(&x, &observed, seconds, objective) {
            self.error.get_or_insert(error.into());
        }
        self.awaited.retain(|other| *other != point);
        self.done.insert(point, observed);
    }

    /// Trials are held against the same references, each of which is kept once.
    fn share_targets(&mut self, compared: &mut Vec<Compared>) {
        for one in compared.iter_mut() {
            match self.targets.iter().find(|target| **target == one.target) {
                Some(target) => one.target = Arc::clone(target),
                None => self.targets.push(Arc::clone(&one.target)),
            }
        }
        let samples = self.samples + samples_of(compared);
        if samples > MOST_SAMPLES {
            compared.clear();
        } else {
            self.samples = samples;
        }
    }

    fn write(
        &mut self,
        x: &[f64],
        observed: &Observed,
        seconds: f64,
        objective: &dyn Objective,
    ) -> Result<(), HistoryError> {
        let Some(history) = &mut self.history else { return Ok(()) };
        history.add_inputs(objective.inputs())?;
        history.add(x, observed, seconds)
    }
}

fn samples_of(compared: &[Compared]) -> usize {
    compared.iter().map(|one| one.values.len()).sum()
}

fn bits(x: &[f64]) -> Point {
    x.iter().map(|x| x.to_bits()).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::sync::mpsc;
    use std::time::Duration;

    use rayon::prelude::*;

    use super::*;
    use crate::identify::Answer;
    use crate::identify::history::Identity;
    use crate::script::Over;

    /// At 7 a trial goes on until it is cancelled, or for half a minute; elsewhere it waits for that one to begin.
    #[derive(Default)]
    struct Endless {
        begun: AtomicBool,
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
                self.begun.store(true, Ordering::Relaxed);
                until(&|| cancellation.is_cancelled());
                self.cancelled.store(cancellation.is_cancelled(), Ordering::Relaxed);
            } else {
                until(&|| self.begun.load(Ordering::Relaxed));
            }
            Answer::Value(x[0]).checked()
        }
    }

    fn task(objective: &dyn Objective) -> Task<'_> {
        Task { objective, on_failure: OnFailure::Worst, history: None }
    }

    #[test]
    fn a_trial_in_vain_is_cancelled_when_the_search_is_over_or_expects_others() {
        type Asking = fn(&Desk<'_, '_>) -> Result<bool, CrewError>;
        let searches: [Asking; 2] = [
            |desk| desk.evaluate(&[1.0]).map(|_| true),
            |desk| {
                desk.evaluate(&[1.0])?;
                desk.expect(&[vec![2.0]]);
                let begin = Instant::now();
                while desk.known(&[2.0]).is_none() && begin.elapsed() < Duration::from_secs(30) {
                    // Only a search that waits has others work ahead.
                    desk.evaluate(&[begin.elapsed().as_secs_f64()])?;
                }
                Ok(desk.known(&[2.0]).is_some())
            },
        ];
        for search in searches {
            let endless = Endless::default();
            let crew = Crew::new(vec![task(&endless)], 2);
            let found = crew.at_work(1 << 20, |desk, _| {
                desk.expect(&[vec![7.0]]);
                search(desk)
            });
            assert!(found.unwrap()[0] && endless.cancelled.load(Ordering::Relaxed));
        }
    }

    /// Trials that end the search's room for pictures end it in the run that takes it up as well.
    #[test]
    fn pictures_that_are_taken_up_count() {
        let folder = tempfile::tempdir().unwrap();
        let open = || History::open(folder.path(), &Identity::default(), 1, BTreeMap::new()).unwrap();
        let target = Arc::new(Target { over: Over::Time, places: vec![0.0, 0.1], values: vec![1.0, 2.0] });
        let compared = vec![Compared { target, values: vec![1.5, 2.5] }];
        let observed = Observed { found: Answer::Value(1.0).checked(), compared };
        let none = |_: &[f64]| 0.0;
        let mut history = open();
        let mut board = Board::new(Some(&mut history));
        board.keep(bits(&[1.0]), observed.clone(), 0.1, &none);
        board.keep(bits(&[2.0]), observed, 0.1, &none);
        assert_eq!(board.samples, 4);
        drop(history);
        assert_eq!(Board::new(Some(&mut open())).samples, 4);
    }

    #[test]
    fn a_trial_that_was_cancelled_is_made_again_when_it_is_asked_for() {
        let calls = AtomicUsize::new(0);
        struct Twice<'n>(&'n AtomicUsize, Endless);
        impl Objective for Twice<'_> {
            fn evaluate(&self, x: &[f64], cancellation: &Cancellation) -> Evaluation {
                if x == [7.0] && self.0.fetch_add(1, Ordering::Relaxed) > 0 {
                    return Answer::Value(7.0).checked();
                }
                self.1.evaluate(x, cancellation)
            }
        }
        let twice = Twice(&calls, Endless::default());
        let found = Crew::new(vec![task(&twice)], 2).at_work(1 << 20, |desk, _| {
            desk.expect(&[vec![7.0]]);
            desk.evaluate(&[1.0])?;
            desk.expect(&[]);
            desk.evaluate(&[7.0])
        });
        assert_eq!(found.unwrap(), [Evaluation::Answer(Answer::Value(7.0))]);
        assert_eq!(calls.load(Ordering::Relaxed), 2);
    }

    #[test]
    fn the_first_failure_is_the_one_that_is_told() {
        let value = |x: &[f64]| x[0];
        for threads in [1, 2, 4] {
            let crew = Crew::new((0..4).map(|_| task(&value)).collect(), threads);
            let asked = AtomicUsize::new(0);
            let found: Result<Vec<()>, (usize, CrewError)> = crew.at_work(1 << 20, |desk, number| {
                for trial in 0..20 {
                    desk.evaluate(&[f64::from(trial)])?;
                    asked.fetch_add(usize::from(number == 0), Ordering::Relaxed);
                    // The third fails at once, the second at its end, the last never on its own.
                    if number == 2 || (number == 1 && trial == 19) {
                        return Err(CrewError::Broken(Broken::new(format!("search {number}"))));
                    }
                }
                Ok(())
            });
            let (number, error) = found.unwrap_err();
            assert_eq!((number, error.to_string()), (1, "search 1".into()));
            assert_eq!(asked.load(Ordering::Relaxed), 20, "the one before runs to its end");
        }
    }

    #[test]
    fn a_panic_in_an_objective_ends_the_searches_and_goes_on() {
        for (threads, searches) in [(1, 1), (2, 1), (4, 3)] {
            let (tell, told) = mpsc::channel();
            thread::spawn(move || {
                let calls = AtomicUsize::new(0);
                let panics = |x: &[f64]| {
                    assert!(calls.fetch_add(1, Ordering::Relaxed) != 2, "the third call");
                    x[0]
                };
                let crew = Crew::new((0..searches).map(|_| task(&panics)).collect(), threads);
                let work = || {
                    crew.at_work(1 << 20, |desk, _| (0..100).try_for_each(|n| desk.evaluate(&[f64::from(n)]).map(drop)))
                };
                let panic = catch_unwind(AssertUnwindSafe(work)).map(drop);
                tell.send(panic.map_err(|panic| panic.downcast_ref::<&str>().map(|said| (*said).to_owned())))
            });
            let ended = told.recv_timeout(Duration::from_secs(30));
            assert_eq!(ended, Ok(Err(Some("the third call".into()))), "{threads} threads, {searches} searches");
        }
    }

    /// A trial may share its own work among the crew, as one of several simulations does.
    #[test]
    fn trials_that_share_their_work_come_to_an_end() {
        let shared = |x: &[f64]| (0..40).into_par_iter().map(|i| (f64::from(i) * x[0]).sin()).sum::<f64>().abs();
        for number in 0..400 {
            let crew = Crew::new(vec![task(&shared)], 2);
            let found = crew.at_work(1 << 20, |desk, _| desk.evaluate(&[f64::from(number)]));
            assert!(matches!(found.unwrap()[..], [Evaluation::Answer(_)]));
        }
    }
}
