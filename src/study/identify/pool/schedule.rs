//! Which trial a thread starts next: requested trials in their order, then speculative ones.

use std::collections::{HashMap, VecDeque};

use crate::identify::objective::Evaluation;
use base::cancellation::Cancellation;

/// A point by its bits.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Point(Vec<u64>);

impl Point {
    pub(super) fn new(x: &[f64]) -> Point {
        // Bits can be hashed, and a point gets no value of one that differs from it by rounding.
        Point(x.iter().map(|x| x.to_bits()).collect())
    }

    pub(super) fn x(&self) -> Vec<f64> {
        self.0.iter().map(|bits| f64::from_bits(*bits)).collect()
    }
}

/// The schedule of all searches of a pool.
pub(super) struct Schedule {
    searches: Vec<SearchState>,
    /// Requested trials that no thread has started, each with the number of its search.
    requested: VecDeque<(usize, Point)>,
    running: Vec<RunningTrial>,
}

/// The state of one search.
#[derive(Default)]
struct SearchState {
    /// Outcomes of trials that have ended.
    known: HashMap<Point, Evaluation>,
    /// Points whose trials the search waits for.
    awaited: Vec<Point>,
    /// Points that the search may request next, the most probable first.
    speculative: VecDeque<Point>,
    is_finished: bool,
}

/// A trial that a thread has started.
#[derive(Clone)]
pub(super) struct RunningTrial {
    /// Number of its search.
    pub(super) search: usize,
    pub(super) point: Point,
    pub(super) cancellation: Cancellation,
}

impl Schedule {
    /// The schedule of so many searches.
    pub(super) fn new(searches: usize) -> Schedule {
        let searches = (0..searches).map(|_| SearchState::default()).collect();
        Schedule { searches, requested: VecDeque::new(), running: vec![] }
    }

    /// The outcome of a trial that has ended.
    pub(super) fn known(&self, search: usize, point: &Point) -> Option<Evaluation> {
        self.searches[search].known.get(point).cloned()
    }

    /// Requests the trial at `point`, unless it is known, requested or running.
    pub(super) fn request(&mut self, search: usize, point: &Point) {
        if self.searches[search].known.contains_key(point) {
            return;
        }
        let is_requested = self.requested.iter().any(|(other, requested)| *other == search && requested == point);
        if !is_requested && !self.is_running(search, point) {
            self.requested.push_back((search, point.clone()));
        }
        // Also where its trial runs already: a speculative one is awaited from now on and no longer cancelled.
        self.searches[search].awaited.push(point.clone());
    }

    /// Replaces the speculative points of a search, and cancels its running trials that are neither awaited nor among
    /// them.
    pub(super) fn speculate(&mut self, search: usize, points: VecDeque<Point>) {
        let awaited = &self.searches[search].awaited;
        let is_superseded = |trial: &&RunningTrial| {
            trial.search == search && !awaited.contains(&trial.point) && !points.contains(&trial.point)
        };
        self.running.iter().filter(is_superseded).for_each(|trial| trial.cancellation.cancel());
        self.searches[search].speculative = points;
    }

    /// The next trial for one of `threads`, which counts as running from now on.
    ///
    /// Speculative trials are started only while all searches wait, and leave one thread free: a requested trial never
    /// waits for a speculative one, and a search whose trials are all known starts none.
    pub(super) fn start(&mut self, threads: usize) -> Option<RunningTrial> {
        let (search, point) = self.next(threads)?;
        let trial = RunningTrial { search, point, cancellation: Cancellation::default() };
        self.running.push(trial.clone());
        Some(trial)
    }

    fn next(&mut self, threads: usize) -> Option<(usize, Point)> {
        if let Some(requested) = self.requested.pop_front() {
            return Some(requested);
        }
        if self.searches.iter().any(|search| !search.is_finished && search.awaited.is_empty()) {
            return None;
        }
        let is_speculative = |trial: &&RunningTrial| !self.searches[trial.search].awaited.contains(&trial.point);
        if self.running.iter().filter(is_speculative).count() + 1 >= threads {
            return None;
        }
        (0..self.searches.len()).find_map(|search| Some((search, self.next_speculative(search)?)))
    }

    fn next_speculative(&mut self, search: usize) -> Option<Point> {
        let state = &self.searches[search];
        let is_new = |point: &Point| !state.known.contains_key(point) && !self.is_running(search, point);
        let new = state.speculative.iter().position(is_new)?;
        // Those before it are known or running, and need no second look.
        self.searches[search].speculative.drain(..=new).next_back()
    }

    fn is_running(&self, search: usize, point: &Point) -> bool {
        // A cancelled trial has no outcome: where its point is requested again before it has ended, it runs anew.
        let mut running = self.running.iter();
        running.any(|trial| trial.search == search && trial.point == *point && !trial.cancellation.is_cancelled())
    }

    /// A running trial has ended; its outcome counts unless it was cancelled.
    pub(super) fn end(&mut self, running: RunningTrial, found: Evaluation) {
        let RunningTrial { search, point, cancellation } = running;
        // By the cancellation, not the point: a cancelled trial may still run beside a new one of its point.
        self.running.retain(|other| !other.cancellation.is(&cancellation));
        if cancellation.is_cancelled() {
            return;
        }
        let state = &mut self.searches[search];
        state.awaited.retain(|other| *other != point);
        state.known.insert(point, found);
    }

    /// The outcomes at `points` once all are known; an error where the search cannot go on.
    pub(super) fn outcomes(&self, search: usize, points: &[Point]) -> Result<Option<Vec<Evaluation>>, Closed> {
        let state = &self.searches[search];
        if state.is_finished {
            return Err(Closed);
        }
        Ok(points.iter().map(|point| state.known.get(point).cloned()).collect())
    }

    /// Requested trials of a search that no thread has started.
    pub(super) fn waiting(&self, search: usize) -> usize {
        self.requested.iter().filter(|(other, _)| *other == search).count()
    }

    /// Ends a search: its requested and speculative trials are not started, its running trials are cancelled.
    pub(super) fn finish(&mut self, search: usize) {
        self.searches[search].is_finished = true;
        self.searches[search].speculative.clear();
        self.requested.retain(|(other, _)| *other != search);
        self.running.iter().filter(|trial| trial.search == search).for_each(|trial| trial.cancellation.cancel());
    }

    pub(super) fn is_finished(&self) -> bool {
        self.searches.iter().all(|search| search.is_finished)
    }
}

/// A search gets no more trials.
pub(super) struct Closed;
