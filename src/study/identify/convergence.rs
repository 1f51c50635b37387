//! The course of a search: its progress and remaining time, and its history, thinned for plots.

use std::fmt;
use std::time::{Duration, Instant};

use super::options::Search;
use super::search::{Iteration, SearchResult, StartResult};
use crate::script::{Compared, ConvergenceHistory, Fit, Iterate, Over};
use base::number::wall_time;
use base::units::{Pressure, Unit};

/// Largest number of iterations in a plot.
const MAX_ITERATIONS: usize = 500;

/// Title of a search, and names of its signals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// Title of the search.
    pub title: Option<String>,
    /// Which part it is of a search in several, each of which begins where the one before ended.
    pub phase: Option<Phase>,
    /// The signals that the objective compares, as many as are given.
    pub signals: Vec<SignalLabel>,
}

/// A part of a search in several.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Its number, from zero.
    pub number: usize,
    /// Such as `stage 1 of 2`.
    pub name: String,
}

impl Labels {
    /// The title, or that of the search of this number, from zero.
    pub fn common_title(&self, number: usize) -> String {
        self.title.clone().unwrap_or_else(|| format!("search {}", number + 1))
    }

    /// The same with the phase where there is one.
    pub fn full_title(&self, number: usize) -> String {
        let title = self.common_title(number);
        self.phase.as_ref().map_or_else(|| title.clone(), |phase| format!("{title}, {}", phase.name))
    }

    /// Whether it goes on where the phase before it ended.
    pub fn continues(&self) -> bool {
        self.phase.as_ref().is_some_and(|phase| phase.number > 0)
    }

    /// The curve that the objective compares with its reference as number `index`.
    pub fn fit(&self, index: usize, Compared { target, values }: Compared) -> Fit {
        let SignalLabel { quantity, unit } = SignalLabel::for_signal(self, index, target.over);
        Fit { quantity, unit, target, values }
    }
}

/// The label of a signal: its quantity and its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalLabel {
    quantity: String,
    unit: Option<Unit>,
}

impl SignalLabel {
    /// The label that a script writes, such as `acceleration (m/s²)`. What ends with no unit in parentheses is a
    /// quantity as a whole.
    pub fn parse(text: &str) -> SignalLabel {
        let parts = text.strip_suffix(')').and_then(|text| text.rsplit_once('('));
        match parts.and_then(|(quantity, symbol)| Some((quantity.trim_end(), Unit::parse(symbol).ok()?))) {
            Some((quantity, unit)) if !quantity.is_empty() => {
                SignalLabel { quantity: quantity.into(), unit: Some(unit) }
            }
            _ => SignalLabel { quantity: text.into(), unit: None },
        }
    }

    /// The label of a stress in MPa.
    fn stress(quantity: &str) -> SignalLabel {
        SignalLabel { quantity: quantity.into(), unit: Unit::parse("MPa").ok() }
    }

    /// The label of signal `index`: of a stress, where it is compared over strain.
    fn for_signal(labels: &Labels, index: usize, over: Over) -> SignalLabel {
        let is_stress = |unit: &Unit| unit.measures(Pressure::DIMENSION);
        match (labels.signals.get(index), over) {
            (None, Over::Time | Over::Travel) => SignalLabel { quantity: format!("signal {}", index + 1), unit: None },
            (None, Over::Strain) => SignalLabel::stress("stress"),
            (Some(label), Over::Strain) if !label.unit.as_ref().is_some_and(is_stress) => {
                SignalLabel::stress(&label.quantity)
            }
            (Some(label), _) => label.clone(),
        }
    }
}

/// The convergence history of `result` over unknowns with these `names`; the objective compared these curves
/// at its best point, and `is_virtual` says whether all references are virtual recordings.
pub(crate) fn convergence_history(
    result: &SearchResult,
    title: String,
    names: &[String],
    labels: &Labels,
    is_virtual: bool,
    compared: Vec<Compared>,
) -> ConvergenceHistory {
    let objective = |start: &StartResult| thinned(&start.history, MAX_ITERATIONS).map(|i| (i.iteration, i.f)).collect();
    ConvergenceHistory {
        title,
        continues: labels.continues(),
        unknowns: names.to_vec(),
        objectives: result.starts.iter().map(objective).collect(),
        history: thinned(&result.best.history, MAX_ITERATIONS).map(iterate).collect(),
        fits: compared.into_iter().enumerate().map(|(index, compared)| labels.fit(index, compared)).collect(),
        is_virtual,
    }
}

fn iterate(Iteration { iteration, f, x, .. }: &Iteration) -> Iterate {
    Iterate { iteration: *iteration, f: *f, x: x.clone() }
}

/// At most `max` of the items, evenly from the first on, and the last.
pub(crate) fn thinned<T>(items: &[T], max: usize) -> impl Iterator<Item = &T> {
    let every = items.len().div_ceil(max.saturating_sub(1).max(1)).max(1);
    items
        .iter()
        .enumerate()
        .filter(move |(index, _)| index % every == 0 || index + 1 == items.len())
        .map(|(_, item)| item)
}

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
    use crate::identify::options::Method;
    use crate::identify::search::Step;

    /// Quantity and symbol of the unit.
    fn parts(label: &SignalLabel) -> (&str, Option<&str>) {
        (&label.quantity, label.unit.as_ref().map(Unit::symbol))
    }

    #[test]
    fn a_label_ends_with_its_unit() {
        for (text, expected) in [
            ("acceleration (m/s²)", ("acceleration", Some("m/s²"))),
            ("force (frame) (kN)", ("force (frame)", Some("kN"))),
            ("force (frame)", ("force (frame)", None)),
            ("(mm)", ("(mm)", None)),
            ("MD", ("MD", None)),
        ] {
            assert_eq!(parts(&SignalLabel::parse(text)), expected);
        }
    }

    #[test]
    fn a_signal_over_strain_is_a_stress() {
        for (texts, over, expected) in [
            (&["stress (kPa)"][..], Over::Strain, ("stress", Some("kPa"))),
            (&["MD"], Over::Strain, ("MD", Some("MPa"))),
            (&["MD (mm)"], Over::Strain, ("MD", Some("MPa"))),
            (&[], Over::Strain, ("stress", Some("MPa"))),
            (&["MD (mm)"], Over::Time, ("MD", Some("mm"))),
            (&[], Over::Time, ("signal 1", None)),
        ] {
            let signals = texts.iter().map(|text| SignalLabel::parse(text)).collect();
            let labels = Labels { signals, ..Labels::default() };
            assert_eq!(parts(&SignalLabel::for_signal(&labels, 0, over)), expected, "{texts:?}");
        }
    }

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
