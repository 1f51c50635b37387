//! Trials on all cores.
//!
//! A search asks for one point after the other and says which ones it may ask for next. Those that it waits for come first;
//! cores that are idle meanwhile work ahead, all but one, so that what is asked for never waits for what is not. Nothing is
//! evaluated twice, and what a search finds depends neither on the number of threads nor on who was quicker.

use std::collections::{HashMap, VecDeque};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use rayon::ThreadPoolBuilder;
use thiserror::Error;

use super::history::{History, HistoryError};
use super::objective::{Evaluation, Objective};
use super::options::OnFailure;

/// Relative step aside of a trial that is repeated.
const ASIDE: f64 = 1e-6;

/// Evaluates trials in parallel, remembers them, and writes them down.
pub struct Crew<'a> {
    objective: &'a dyn Objective,
    on_failure: OnFailure,
    threads: usize,
    board: Mutex<Board<'a>>,
    changed: Condvar,
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
    Broken(String),
    /// No more trials are made, for a reason that is told elsewhere.
    #[error("the trials have ended")]
    Over,
}

/// The bits of a point.
type Point = Vec<u64>;

#[derive(Default)]
struct Board<'a> {
    done: HashMap<Point, Evaluation>,
    running: Vec<Point>,
    /// What the search waits for.
    awaited: Vec<Point>,
    /// What of it nobody has begun.
    asked: VecDeque<Point>,
    /// What it may ask for next, the likeliest first.
    expected: VecDeque<Point>,
    history: Option<&'a mut History>,
    error: Option<CrewError>,
    closed: bool,
}

/// Closes the board when dropped, so that the crew goes home even where the search panics.
struct Close<'c, 'a>(&'c Crew<'a>);

impl Drop for Close<'_, '_> {
    fn drop(&mut self) {
        self.0.board().closed = true;
        self.0.changed.notify_all();
    }
}

impl<'a> Crew<'a> {
    /// A crew of `threads` for the trials of `objective`; those in `history` are taken from there, others are added to it.
    pub fn new(
        objective: &'a dyn Objective,
        on_failure: OnFailure,
        threads: usize,
        history: Option<&'a mut History>,
    ) -> Crew<'a> {
        let done = history.iter().flat_map(|history| history.trials()).map(|(x, found)| (bits(x), found.clone()));
        let board = Board { done: done.collect(), history, ..Board::default() };
        Crew { objective, on_failure, threads: threads.max(1), board: Mutex::new(board), changed: Condvar::new() }
    }

    /// Runs `search` while the crew is at work; its threads have stacks of `stack` bytes.
    ///
    /// # Errors
    /// The threads cannot be started, the objective cannot go on, or the history cannot be written.
    pub fn at_work<T: Send>(&self, stack: usize, search: impl FnOnce(&Crew<'a>) -> T + Send) -> Result<T, CrewError> {
        // Simulations within a pool of threads take one thread each.
        let pool = ThreadPoolBuilder::new().num_threads(self.threads).stack_size(stack).build()?;
        let found = pool.in_place_scope(|scope| {
            for _ in 0..self.threads {
                scope.spawn(|_| self.serve());
            }
            let _close = Close(self);
            search(self)
        });
        self.board().error.take().map_or(Ok(found), Err)
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// What is found at `x`; waits for it.
    pub fn evaluate(&self, x: &[f64]) -> Result<Evaluation, CrewError> {
        let mut found = self.evaluate_all(std::slice::from_ref(&x.to_vec()))?;
        found.pop().ok_or_else(|| CrewError::Broken("the trial was not made".into()))
    }

    /// What is found at every one of `points`; waits for them all.
    pub fn evaluate_all(&self, points: &[Vec<f64>]) -> Result<Vec<Evaluation>, CrewError> {
        let points: Vec<Point> = points.iter().map(|x| bits(x)).collect();
        let mut board = self.board();
        for point in &points {
            if !board.is_begun(point) && !board.asked.contains(point) {
                board.asked.push_back(point.clone());
            }
            if !board.done.contains_key(point) {
                board.awaited.push(point.clone());
            }
        }
        self.changed.notify_all();
        loop {
            if board.error.is_some() {
                return Err(CrewError::Over);
            }
            let found: Option<Vec<Evaluation>> = points.iter().map(|point| board.done.get(point).cloned()).collect();
            if let Some(found) = found {
                return Ok(found);
            }
            board = self.changed.wait(board).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Points of which some will be asked for next, the likeliest first, in place of those said before.
    pub fn expect(&self, points: &[Vec<f64>]) {
        let mut board = self.board();
        board.expected = points.iter().map(|x| bits(x)).collect();
        self.changed.notify_all();
    }

    fn serve(&self) {
        while let Some(point) = self.next() {
            let x: Vec<f64> = point.iter().map(|bits| f64::from_bits(*bits)).collect();
            let begin = Instant::now();
            let found = self.try_at(&x);
            let seconds = begin.elapsed().as_secs_f64();
            let mut board = self.board();
            board.keep(&x, &found, seconds, self.objective);
            board.running.retain(|other| *other != point);
            board.awaited.retain(|other| *other != point);
            board.done.insert(point, found);
            drop(board);
            self.changed.notify_all();
        }
    }

    /// The next point to work on; none once the search is over.
    fn next(&self) -> Option<Point> {
        let mut board = self.board();
        loop {
            if board.closed || board.error.is_some() {
                return None;
            }
            if let Some(point) = board.take(self.threads) {
                board.running.push(point.clone());
                return Some(point);
            }
            board = self.changed.wait(board).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn try_at(&self, x: &[f64]) -> Evaluation {
        let found = self.objective.evaluate(x);
        match found {
            Evaluation::Failed(_) if self.on_failure == OnFailure::Retry => {
                let aside: Vec<f64> = x.iter().map(|x| x * (1.0 + ASIDE)).collect();
                match self.objective.evaluate(&aside) {
                    Evaluation::Failed(_) => found,
                    other => other,
                }
            }
            _ => found,
        }
    }

    fn board(&self) -> MutexGuard<'_, Board<'a>> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Board<'_> {
    fn is_begun(&self, point: &Point) -> bool {
        self.done.contains_key(point) || self.running.contains(point)
    }

    /// What is asked for; or else, while the search waits, what is expected, as long as that leaves a thread free. A search
    /// that finds everything it asks for among what is done makes no trial at all.
    fn take(&mut self, threads: usize) -> Option<Point> {
        if let Some(point) = self.asked.pop_front() {
            return Some(point);
        }
        if self.awaited.is_empty() {
            return None;
        }
        let ahead = self.running.iter().filter(|point| !self.awaited.contains(point)).count();
        if ahead + 1 >= threads {
            return None;
        }
        let fresh = self.expected.iter().position(|point| !self.is_begun(point))?;
        self.expected.drain(..=fresh).next_back()
    }

    fn keep(&mut self, x: &[f64], found: &Evaluation, seconds: f64, objective: &dyn Objective) {
        if let Evaluation::Broken(cause) = found {
            self.error = Some(CrewError::Broken(cause.clone()));
            return;
        }
        let Some(history) = &mut self.history else { return };
        let kept = history.add_inputs(objective.inputs()).and_then(|()| history.add(x, found, seconds));
        if let Err(error) = kept {
            self.error = Some(error.into());
        }
    }
}

fn bits(x: &[f64]) -> Point {
    x.iter().map(|x| x.to_bits()).collect()
}
