//! Progress of a search and an estimate of its remaining time.

use std::fmt;
use std::time::{Duration, Instant};

use super::iteration::Iteration;
use super::options::Search;
use crate::number::wall_time;

/// Iterations that an estimate looks back on, and how many it needs.
const LOOK_BACK: usize = 30;
const MIN_ITERATIONS: usize = 8;

/// Progress of a search after an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Title of the search, where it has one or is one of several.
    pub search: Option<String>,
    /// Names of the unknowns.
    pub names: Vec<String>,
    /// The iteration.
    pub iteration: Iteration,
    /// Remaining wall time.
    pub remaining: Remaining,
}

/// Remaining wall time of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remaining {
    /// There are too few iterations for an estimate.
    Unknown,
    /// An estimate: simplex and values keep shrinking at their mean rate.
    About(Duration),
    /// Time for all iterations that the limits allow.
    AtMost(Duration),
}

/// Estimates the remaining time of a search from its iterations.
pub(crate) struct ProgressEstimator<'s> {
    search: &'s Search,
    title: Option<String>,
    names: &'s [String],
    iterations: Vec<Observation>,
}

/// What the estimate needs of one iteration.
struct Observation {
    time: Instant,
    iteration: usize,
    evaluations: usize,
    /// Size and spread over their tolerances.
    excess: Option<[f64; 2]>,
}

impl<'s> ProgressEstimator<'s> {
    /// An estimator for a search with this title and these names of unknowns.
    pub(crate) fn new(search: &'s Search, title: Option<String>, names: &'s [String]) -> ProgressEstimator<'s> {
        ProgressEstimator { search, title, names, iterations: vec![] }
    }

    /// Progress after an iteration that ended now.
    pub(crate) fn update(&mut self, iteration: &Iteration) -> Progress {
        self.update_at(iteration, Instant::now())
    }

    fn update_at(&mut self, iteration: &Iteration, time: Instant) -> Progress {
        if self.iterations.last().is_some_and(|last| iteration.iteration < last.iteration) {
            self.iterations.clear();
        }
        let excess = iteration.size.zip(iteration.spread);
        let excess = excess.map(|(size, spread)| [size / self.search.tol_x, spread / self.search.tol_f]);
        let Iteration { iteration: number, evaluations, .. } = *iteration;
        self.iterations.push(Observation { time, iteration: number, evaluations, excess });
        if self.iterations.len() > LOOK_BACK {
            self.iterations.remove(0);
        }
        let (search, names) = (self.title.clone(), self.names.to_vec());
        Progress { search, names, iteration: iteration.clone(), remaining: self.remaining() }
    }

    fn remaining(&self) -> Remaining {
        let [first, .., last] = self.iterations.as_slice() else {
            return Remaining::Unknown;
        };
        let done = last.iteration.saturating_sub(first.iteration);
        if done < MIN_ITERATIONS {
            return Remaining::Unknown;
        }
        let pace = last.time.duration_since(first.time) / done as u32;
        let per_iteration = (last.evaluations - first.evaluations) as f64 / done as f64;
        let evaluations = self.search.max_evaluations.saturating_sub(last.evaluations) as f64;
        let most = (evaluations / per_iteration.max(1.0)).ceil();
        let most = most.min(self.search.max_iterations.saturating_sub(last.iteration) as f64);
        match first.excess.zip(last.excess).and_then(|(before, now)| left(before, now, done as f64)) {
            Some(left) if left < most => Remaining::About(pace.mul_f64(left)),
            _ => Remaining::AtMost(pace.mul_f64(most)),
        }
    }
}

/// Iterations until both have fallen to one at their mean rate over the last `done` iterations; none where they do not
/// fall.
fn left(before: [f64; 2], now: [f64; 2], done: f64) -> Option<f64> {
    let left = |(before, now): (f64, f64)| {
        let rate = (before / now).ln() / done;
        if now <= 1.0 { Some(0.0) } else { Some(now.ln() / rate).filter(|left| *left > 0.0 && left.is_finite()) }
    };
    let mut both = before.into_iter().zip(now).map(left);
    Some(both.next()??.max(both.next()??))
}

impl fmt::Display for Progress {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Iteration { iteration, evaluations, x, f, size, .. } = &self.iteration;
        if let Some(name) = &self.search {
            write!(out, "{name}")?;
        }
        let x: Vec<String> = self.names.iter().zip(x).map(|(name, x)| format!("{name} {x:.5}")).collect();
        write!(out, "{iteration:>5}  f {f:<11.6}  {}", x.join("  "))?;
        if let Some(size) = size {
            write!(out, "  size {size:.2e}")?;
        }
        write!(out, "  {evaluations} evaluations{}", self.remaining)
    }
}

impl fmt::Display for Remaining {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Remaining::Unknown => Ok(()),
            Remaining::About(time) => write!(out, "  about {} to go", wall_time(time.as_secs_f64())),
            Remaining::AtMost(time) => write!(out, "  at most {} to go", wall_time(time.as_secs_f64())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::iteration::Step;
    use crate::identify::options::Method;

    /// Estimates after each iteration of a search that takes 2 s for each and may halve its simplex.
    fn remaining(search: &Search, halves: bool) -> Vec<Remaining> {
        let begin = Instant::now();
        let mut estimator = ProgressEstimator::new(search, None, &[]);
        let update = |number: usize| {
            let size = if halves { 0.5_f64.powi(number as i32) } else { 1.0 };
            let evaluations = 2 * number;
            let (size, spread) = (Some(size), Some(size * 1e-3));
            let iteration = Iteration {
                start: 0,
                iteration: number,
                evaluations,
                x: vec![1.0],
                f: 0.1,
                size,
                spread,
                step: Step::Shrunk,
            };
            estimator.update_at(&iteration, begin + Duration::from_secs(2 * number as u64)).remaining
        };
        (1..=12).map(update).collect()
    }

    #[test]
    fn a_simplex_that_shrinks_steadily_has_an_estimate() {
        let search = Search { tol_x: 0.5_f64.powi(20), tol_f: 1.0, ..Search::new(Method::NelderMead, vec![1.0]) };
        let estimates = remaining(&search, true);
        assert_eq!(estimates[6], Remaining::Unknown);
        for (index, remaining) in estimates.iter().enumerate().skip(8) {
            let Remaining::About(time) = remaining else { panic!("{remaining:?}") };
            let left = 2.0 * (20.0 - (index as f64 + 1.0));
            assert!((time.as_secs_f64() - left).abs() < 0.01, "{time:?} for {left}");
        }
    }

    #[test]
    fn progress_shows_the_names_of_unknowns() {
        let (search, names) = (Search::new(Method::CmaEs, vec![1.0, 2.0]), ["k1".to_owned(), "ke".to_owned()]);
        let mut estimator = ProgressEstimator::new(&search, Some("1008".into()), &names);
        let (x, step) = (vec![2.75, 1.0 / 3.0], Step::Shrunk);
        let iteration =
            Iteration { start: 0, iteration: 7, evaluations: 15, x, f: 0.1, size: None, spread: None, step };
        let text = estimator.update(&iteration).to_string();
        assert_eq!(text, "1008    7  f 0.100000     k1 2.75000  ke 0.33333  15 evaluations");
    }

    #[test]
    fn a_simplex_that_does_not_shrink_has_a_limit() {
        let estimates = remaining(&Search::new(Method::NelderMead, vec![1.0]), false);
        // 200 evaluations, two an iteration, 24 used.
        assert_eq!(estimates[11], Remaining::AtMost(Duration::from_secs(2 * 88)));
    }
}
