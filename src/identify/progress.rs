//! Where a search stands, for people who wait.

use std::fmt;
use std::time::{Duration, Instant};

use super::options::Search;
use super::search::Iteration;

/// Iterations that an estimate looks back on, and how many it takes to make one.
const LOOK_BACK: usize = 30;
const TELLING: usize = 8;

/// Where a search stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// What the search is called, where it is one of several or has a title.
    pub search: Option<String>,
    /// Names of the unknowns.
    pub names: Vec<String>,
    pub iteration: Iteration,
    pub to_go: ToGo,
}

/// How long a search will take; nobody knows, so it is told what the figure is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToGo {
    /// Too early to tell.
    Unknown,
    /// Where simplex and values go on shrinking as they did of late.
    About(Duration),
    /// Where all iterations that are left are used up.
    AtMost(Duration),
}

/// Follows a search on the clock.
pub(super) struct Watch<'s> {
    search: &'s Search,
    name: Option<String>,
    unknowns: &'s [String],
    seen: Vec<Seen>,
}

struct Seen {
    at: Instant,
    iteration: usize,
    evaluations: usize,
    /// Size and spread over their tolerances.
    excess: Option<[f64; 2]>,
}

impl<'s> Watch<'s> {
    /// `name` tells the search from others, `unknowns` are called so.
    pub(super) fn new(search: &'s Search, name: Option<String>, unknowns: &'s [String]) -> Watch<'s> {
        Watch { search, name, unknowns, seen: vec![] }
    }

    /// Where the search stands after an iteration that ended just now.
    pub(super) fn look(&mut self, iteration: &Iteration) -> Progress {
        self.look_at(iteration, Instant::now())
    }

    fn look_at(&mut self, iteration: &Iteration, at: Instant) -> Progress {
        if self.seen.last().is_some_and(|last| iteration.iteration < last.iteration) {
            self.seen.clear();
        }
        let excess = iteration.size.zip(iteration.spread);
        let excess = excess.map(|(size, spread)| [size / self.search.tol_x, spread / self.search.tol_f]);
        let Iteration { iteration: number, evaluations, .. } = *iteration;
        self.seen.push(Seen { at, iteration: number, evaluations, excess });
        if self.seen.len() > LOOK_BACK {
            self.seen.remove(0);
        }
        let (search, names) = (self.name.clone(), self.unknowns.to_vec());
        Progress { search, names, iteration: iteration.clone(), to_go: self.to_go() }
    }

    fn to_go(&self) -> ToGo {
        let [first, .., last] = self.seen.as_slice() else {
            return ToGo::Unknown;
        };
        let done = last.iteration.saturating_sub(first.iteration);
        if done < TELLING {
            return ToGo::Unknown;
        }
        let pace = last.at.duration_since(first.at) / done as u32;
        let per_iteration = (last.evaluations - first.evaluations) as f64 / done as f64;
        let evaluations = self.search.most_evaluations.saturating_sub(last.evaluations) as f64;
        let most = (evaluations / per_iteration.max(1.0)).ceil();
        let most = most.min(self.search.most_iterations.saturating_sub(last.iteration) as f64);
        match first.excess.zip(last.excess).and_then(|(before, now)| left(before, now, done as f64)) {
            Some(left) if left < most => ToGo::About(pace.mul_f64(left)),
            _ => ToGo::AtMost(pace.mul_f64(most)),
        }
    }
}

/// Iterations until both are down at one, where they go on falling as they did over the last `done`; none where they do not.
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
        write!(out, "  {evaluations} evaluations{}", self.to_go)
    }
}

impl fmt::Display for ToGo {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ToGo::Unknown => Ok(()),
            ToGo::About(time) => write!(out, "  about {} to go", words(*time)),
            ToGo::AtMost(time) => write!(out, "  at most {} to go", words(*time)),
        }
    }
}

fn words(time: Duration) -> String {
    match time.as_secs_f64() {
        seconds if seconds < 90.0 => format!("{} s", seconds.ceil()),
        seconds if seconds < 5400.0 => format!("{:.0} min", seconds / 60.0),
        seconds => format!("{:.1} h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Method;

    /// A search that halves its simplex in every iteration and takes 2 s for each.
    fn told(search: &Search, halves: bool) -> Vec<ToGo> {
        let begin = Instant::now();
        let mut watch = Watch::new(search, None, &[]);
        let look = |iteration: usize| {
            let size = if halves { 0.5_f64.powi(iteration as i32) } else { 1.0 };
            let evaluations = 2 * iteration;
            let (size, spread) = (Some(size), Some(size * 1e-3));
            let seen =
                Iteration { start: 0, iteration, evaluations, x: vec![1.0], f: 0.1, size, spread, step: "shrunk" };
            watch.look_at(&seen, begin + Duration::from_secs(2 * iteration as u64)).to_go
        };
        (1..=12).map(look).collect()
    }

    #[test]
    fn what_shrinks_steadily_is_foreseen() {
        let search = Search { tol_x: 0.5_f64.powi(20), tol_f: 1.0, ..Search::new(Method::NelderMead, vec![1.0]) };
        let told = told(&search, true);
        assert_eq!(told[6], ToGo::Unknown);
        for (place, to_go) in told.iter().enumerate().skip(8) {
            let ToGo::About(time) = to_go else { panic!("{to_go:?}") };
            let left = 2.0 * (20.0 - (place as f64 + 1.0));
            assert!((time.as_secs_f64() - left).abs() < 0.01, "{time:?} for {left}");
        }
    }

    #[test]
    fn unknowns_are_told_by_their_names() {
        let (search, names) = (Search::new(Method::CmaEs, vec![1.0, 2.0]), ["k1".to_owned(), "ke".to_owned()]);
        let mut watch = Watch::new(&search, Some("1008".into()), &names);
        let (x, step) = (vec![2.75, 1.0 / 3.0], "shrunk");
        let seen = Iteration { start: 0, iteration: 7, evaluations: 15, x, f: 0.1, size: None, spread: None, step };
        let told = watch.look(&seen).to_string();
        assert_eq!(told, "1008    7  f 0.100000     k1 2.75000  ke 0.33333  15 evaluations");
    }

    #[test]
    fn what_does_not_shrink_has_a_limit_and_no_more() {
        let told = told(&Search::new(Method::NelderMead, vec![1.0]), false);
        // 200 evaluations, two an iteration, 24 used.
        assert_eq!(told[11], ToGo::AtMost(Duration::from_secs(2 * 88)));
    }
}
