//! Progress of a search and an estimate of its remaining time.

use std::fmt;
use std::time::{Duration, Instant};

use super::iteration::Iteration;
use super::options::Search;
use base::number::wall_time;

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
    /// Number of starts.
    pub starts: usize,
    /// The iteration.
    pub iteration: Iteration,
    /// Limit of evaluations of one start.
    pub max_evaluations: usize,
    /// Remaining wall time of this start, if simplex and values keep shrinking at their mean rate; none where they do
    /// not shrink, or so slowly that the end recedes.
    pub remaining: Option<Duration>,
}

/// Estimates the remaining time of a search from its iterations.
pub(crate) struct ProgressEstimator<'s> {
    search: &'s Search,
    title: Option<String>,
    iterations: Vec<Observation>,
    /// The end as the last iteration estimated it.
    end: Option<Instant>,
}

/// The part of an iteration that the estimate needs.
struct Observation {
    time: Instant,
    iteration: usize,
    /// Size and spread over their tolerances.
    excess: Option<[f64; 2]>,
}

impl<'s> ProgressEstimator<'s> {
    /// An estimator for a search with this title.
    pub(crate) fn new(search: &'s Search, title: Option<String>) -> ProgressEstimator<'s> {
        ProgressEstimator { search, title, iterations: vec![], end: None }
    }

    /// Progress after an iteration that ended now.
    pub(crate) fn update(&mut self, iteration: &Iteration) -> Progress {
        self.update_at(iteration, Instant::now())
    }

    fn update_at(&mut self, iteration: &Iteration, time: Instant) -> Progress {
        if self.iterations.last().is_some_and(|last| iteration.iteration < last.iteration) {
            self.iterations.clear();
            self.end = None;
        }
        let excess = iteration.size.zip(iteration.spread);
        let excess = excess.map(|(size, spread)| [size / self.search.tol_x, spread / self.search.tol_f]);
        self.iterations.push(Observation { time, iteration: iteration.iteration, excess });
        if self.iterations.len() > LOOK_BACK {
            self.iterations.remove(0);
        }
        let left = self.left();
        let end = left.and_then(|left| time.checked_add(left));
        let recedes = self.end.zip(end).is_some_and(|(before, now)| now > before);
        self.end = end;
        Progress {
            search: self.title.clone(),
            names: self.search.names.clone(),
            starts: self.search.starts.count(),
            iteration: iteration.clone(),
            max_evaluations: self.search.max_evaluations,
            remaining: left.filter(|_| !recedes),
        }
    }

    /// The estimated time to the end of this start.
    fn left(&self) -> Option<Duration> {
        let [first, .., last] = self.iterations.as_slice() else { return None };
        let done = last.iteration.saturating_sub(first.iteration);
        if done < MIN_ITERATIONS {
            return None;
        }
        let pace = last.time.duration_since(first.time).as_secs_f64() / done as f64;
        let (before, now) = first.excess.zip(last.excess)?;
        Duration::try_from_secs_f64(pace * left(before, now, done as f64)?).ok()
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
        if self.starts > 1 {
            write!(out, " start {} of {}", self.iteration.start + 1, self.starts)?;
        }
        let x: Vec<String> = self.names.iter().zip(x).map(|(name, x)| format!("{name} {x:.5}")).collect();
        write!(out, "{iteration:>5}  f {f:<11.6}  {}", x.join("  "))?;
        if let Some(size) = size {
            write!(out, "  size {size:.2e}")?;
        }
        write!(out, "  {evaluations} of at most {} evaluations", self.max_evaluations)?;
        match self.remaining {
            Some(time) if self.starts == 1 => write!(out, "  about {} to go", wall_time(time.as_secs_f64())),
            Some(time) => write!(out, "  about {} to the end of this start", wall_time(time.as_secs_f64())),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::iteration::Step;
    use crate::identify::options::Method;

    /// Estimates after each iteration of a search that takes 2 s for each, with these sizes of its simplex.
    fn remaining(search: &Search, size: impl Fn(i32) -> f64) -> Vec<Option<Duration>> {
        let begin = Instant::now();
        let mut estimator = ProgressEstimator::new(search, None);
        let update = |number: usize| {
            let size = size(number as i32);
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
        let estimates = remaining(&search, |number| 0.5_f64.powi(number));
        assert_eq!(estimates[6], None);
        for (index, remaining) in estimates.iter().enumerate().skip(8) {
            let time = remaining.expect("an estimate");
            let left = 2.0 * (20.0 - (index as f64 + 1.0));
            assert!((time.as_secs_f64() - left).abs() < 0.01, "{time:?} for {left}");
        }
    }

    #[test]
    fn progress_shows_the_names_of_unknowns() {
        let names = vec!["k1".into(), "ke".into()];
        let search = Search { names, ..Search::new(Method::CmaEs, vec![1.0, 2.0]) };
        let mut estimator = ProgressEstimator::new(&search, Some("1008".into()));
        let (x, step) = (vec![2.75, 1.0 / 3.0], Step::Shrunk);
        let iteration =
            Iteration { start: 0, iteration: 7, evaluations: 15, x, f: 0.1, size: None, spread: None, step };
        let text = estimator.update(&iteration).to_string();
        assert_eq!(text, "1008    7  f 0.100000     k1 2.75000  ke 0.33333  15 of at most 400 evaluations");
        let several = Progress { starts: 3, remaining: Some(Duration::from_secs(7)), ..estimator.update(&iteration) };
        let text = several.to_string();
        assert!(
            text.starts_with("1008 start 1 of 3 ") && text.ends_with("  about 7 s to the end of this start"),
            "{text}"
        );
    }

    #[test]
    fn a_simplex_that_does_not_shrink_has_no_estimate() {
        let estimates = remaining(&Search::new(Method::NelderMead, vec![1.0]), |_| 1.0);
        assert_eq!(estimates, [None; 12]);
    }

    /// From an iteration with an estimate to the next, the time to go falls at least by the time that has passed.
    #[test]
    fn the_time_to_go_falls() {
        let slower = |number: i32| (1.0 / f64::from(number)).powi(2) * (1.0 + 0.3 * f64::from(number % 3));
        let estimates = remaining(&Search::new(Method::NelderMead, vec![1.0]), slower);
        assert!(estimates[8..].iter().any(Option::is_none), "{estimates:?}");
        for pair in estimates.windows(2) {
            if let [Some(before), Some(after)] = pair {
                assert!(*after + Duration::from_secs(2) <= *before + Duration::from_millis(1), "{estimates:?}");
            }
        }
    }
}
