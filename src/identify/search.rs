//! One search: a method, one or several starts, and what the user should know about the result.

use std::cmp::Ordering;
use std::error::Error;
use std::sync::{Mutex, MutexGuard, PoisonError};

use thiserror::Error;

use super::crew::{CrewError, Desk};
use super::nelder_mead::{Limits, Simplex, Values};
use super::objective::{Answer, Evaluation};
use super::options::{Method, OnFailure, Search};
use super::{cma_es, foresight, levenberg_marquardt, starts};

/// New simplices around a best point on a bound, at most.
const MOST_RESTARTS: usize = 5;

/// Where a search stands after an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Iteration {
    /// Counted over all starts.
    pub start: usize,
    pub iteration: usize,
    pub evaluations: usize,
    /// Best so far.
    pub x: Vec<f64>,
    pub f: f64,
    /// Nelder–Mead: largest distance of a corner from the best along an axis. CMA-ES: standard deviation.
    pub size: Option<f64>,
    /// Nelder–Mead: largest difference of a corner's value from the best.
    pub spread: Option<f64>,
    /// What the iteration did.
    pub step: &'static str,
}

/// How one start ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    pub x: Vec<f64>,
    pub f: f64,
    pub iterations: usize,
    /// Points that the search asked for.
    pub evaluations: usize,
    pub converged: bool,
    /// Why it ended.
    pub reason: String,
    pub size: Option<f64>,
    pub history: Vec<Iteration>,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Best {
    /// The best of all starts.
    pub best: Ended,
    /// How every start ended.
    pub starts: Vec<Ended>,
    /// What the user should know before trusting it.
    pub warnings: Vec<String>,
}

/// Why a search found nothing.
#[derive(Debug, Error)]
pub enum SearchError {
    #[error(transparent)]
    Crew(#[from] CrewError),
    #[error("the objective has no value at the start {x:?}: {cause}")]
    Start { x: Vec<f64>, cause: String, numerical: bool },
    /// There is no value at the start, nor at any of the fallback starts.
    #[error("{start}; nor at any of {tried} fallback starts, the last of them {last:?}: {cause}")]
    Fallback { start: Box<SearchError>, tried: usize, last: Vec<f64>, cause: String },
    #[error("a trial failed at {x:?}: {cause}")]
    Failed { x: Vec<f64>, cause: String, numerical: bool },
    #[error(
        "levenberg-marquardt needs residuals, and the objective gave a number: return a signal or a list, or use nelder-mead"
    )]
    NotResiduals,
    #[error("the objective gave {found} residuals at {x:?}, and {expected} at the start")]
    Residuals { x: Vec<f64>, found: usize, expected: usize },
    #[error("the objective gave {found} residuals for {unknowns} unknowns: levenberg-marquardt needs at least as many")]
    TooFew { found: usize, unknowns: usize },
    #[error("cma-es cannot begin: {0}")]
    CmaEs(String),
}

/// Why nothing was found.
pub(super) trait Unfound: Error + 'static {
    /// Whether a simulation went wrong numerically.
    fn is_numerical(&self) -> bool;
}

impl Unfound for SearchError {
    fn is_numerical(&self) -> bool {
        match self {
            SearchError::Start { numerical, .. } | SearchError::Failed { numerical, .. } => *numerical,
            SearchError::Fallback { start, .. } => start.is_numerical(),
            _ => false,
        }
    }
}

/// Searches from every start; trials are asked for at `desk`, `listener` hears of every iteration.
///
/// # Errors
/// A start without a value, a failed trial where that is to stop the search, an objective that is broken or not of the
/// method's kind.
pub fn minimise(
    search: &Search,
    desk: &Desk<'_, '_>,
    listener: &mut (dyn FnMut(&Iteration) + Send),
) -> Result<Best, SearchError> {
    let mut ended = Vec::new();
    let mut warnings = Vec::new();
    let mut failures = Failures::default();
    for (number, start) in starts::all(search).into_iter().enumerate() {
        let trials = Trials::new(search, desk);
        let (start, note) = trials.beginning(start)?;
        warnings.extend(note);
        if let [first, ..] = search.bounds.touched(&start)[..] {
            warnings.push(format!("start {} lies on the bound of x[{first}]", number + 1));
        }
        let course = Course { search, trials: &trials, number, listener };
        ended.push(match search.method {
            Method::NelderMead => nelder_mead(&start, course)?,
            Method::LevenbergMarquardt => levenberg_marquardt::search(&start, course)?,
            Method::CmaEs => cma_es::search(&start, course)?,
        });
        failures.add(trials.failures());
    }
    warnings.extend(failures.warning(search.on_failure));
    let Some(best) = ended.iter().min_by(|a, b| a.f.total_cmp(&b.f)).cloned() else {
        return Err(CrewError::Broken("there is no start".into()).into());
    };
    if !best.converged {
        warnings.push(format!("not converged: {}", best.reason));
    }
    for place in search.bounds.touched(&best.x) {
        warnings.push(format!("the best x[{place}] = {} lies on its bound", best.x[place]));
    }
    warnings.extend(starts::disagreement(search, &best, &ended));
    Ok(Best { best, starts: ended, warnings })
}

/// The trials of one start, counted.
pub(super) struct Trials<'c, 'a> {
    pub(super) search: &'c Search,
    desk: &'c Desk<'c, 'a>,
    tally: Mutex<Tally>,
}

#[derive(Default)]
struct Tally {
    evaluations: usize,
    failures: Failures,
}

/// Trials without a value.
#[derive(Clone, Debug, Default)]
struct Failures {
    count: usize,
    first: Option<Failure>,
}

#[derive(Clone, Debug)]
struct Failure {
    /// Trials that the search had asked for before.
    before: usize,
    x: Vec<f64>,
    cause: String,
}

/// A search on its way.
pub(super) struct Course<'s, 'c, 'a> {
    pub(super) search: &'s Search,
    pub(super) trials: &'s Trials<'c, 'a>,
    /// Of the start, from zero.
    pub(super) number: usize,
    pub(super) listener: &'s mut (dyn FnMut(&Iteration) + Send),
}

impl Failures {
    fn add(&mut self, other: Failures) {
        self.count += other.count;
        self.first = self.first.take().or(other.first);
    }

    /// Takes one more; of those that were asked for at once, the first in their order counts as first.
    fn note(&mut self, failure: Failure) {
        self.count += 1;
        let is_before =
            |first: &Failure| failure.before.cmp(&first.before).then_with(|| order(&failure.x, &first.x)).is_lt();
        if self.first.as_ref().is_none_or(is_before) {
            self.first = Some(failure);
        }
    }

    fn warning(&self, rule: OnFailure) -> Option<String> {
        let Failure { x, cause, .. } = self.first.as_ref()?;
        let counted = if rule == OnFailure::Retry { ", also when repeated," } else { "" };
        Some(format!("{} trials failed{counted} and counted as worst, the first at {x:?}: {cause}", self.count))
    }
}

impl<'c, 'a> Trials<'c, 'a> {
    pub(super) fn new(search: &'c Search, desk: &'c Desk<'c, 'a>) -> Trials<'c, 'a> {
        Trials { search, desk, tally: Mutex::default() }
    }

    /// Where a search begins that was to begin at `start`: there, or else at the first fallback that has a value, and what the
    /// user should know about that.
    fn beginning(&self, start: Vec<f64>) -> Result<(Vec<f64>, Option<String>), SearchError> {
        let refused = match self.at_start(&start) {
            Err(refused @ SearchError::Start { .. }) => refused,
            found => return found.map(|_| (start, None)),
        };
        let mut last = None;
        for fallback in &self.search.fallback {
            match self.at_start(fallback) {
                Ok(_) => return Ok((fallback.clone(), Some(format!("{refused}; begun at {fallback:?} instead")))),
                Err(SearchError::Start { x, cause, .. }) => last = Some((x, cause)),
                Err(error) => return Err(error),
            }
        }
        let tried = self.search.fallback.len();
        Err(match last {
            Some((last, cause)) => SearchError::Fallback { start: Box::new(refused), tried, last, cause },
            None => refused,
        })
    }

    /// What the objective answers at a start, without which there is nothing to compare with. Not counted: the search asks
    /// for it again.
    pub(super) fn at_start(&self, x: &[f64]) -> Result<Answer, SearchError> {
        match self.desk.evaluate(x)? {
            Evaluation::Answer(answer) => Ok(answer),
            Evaluation::Failed { cause, numerical } => Err(SearchError::Start { x: x.into(), cause, numerical }),
            Evaluation::Broken(cause) => Err(CrewError::Broken(cause).into()),
        }
    }

    /// What the objective answers at `x`; none where the trial failed and counts as worst.
    pub(super) fn answer(&self, x: &[f64]) -> Result<Option<Answer>, SearchError> {
        let found = self.desk.evaluate(x)?;
        self.count(x, found, self.evaluations())
    }

    /// What it answers at `x`, one of several points that are asked for at once and in any order, after `before` others.
    pub(super) fn answer_of_several(&self, x: &[f64], before: usize) -> Result<Option<Answer>, SearchError> {
        let found = self.desk.evaluate(x)?;
        self.count(x, found, before)
    }

    /// What it answers at all of `points`.
    pub(super) fn answers(&self, points: &[Vec<f64>]) -> Result<Vec<Option<Answer>>, SearchError> {
        let found = self.desk.evaluate_all(points)?;
        points.iter().zip(found).map(|(x, found)| self.count(x, found, self.evaluations())).collect()
    }

    /// Points that may be asked for next, the likeliest first.
    pub(super) fn expect(&self, points: &[Vec<f64>]) {
        self.desk.expect(points);
    }

    /// What was found at `x`, if that is known by now; not counted.
    pub(super) fn known(&self, x: &[f64]) -> Option<Evaluation> {
        self.desk.known(x)
    }

    /// Points that are worth foreseeing: two for every core that may work ahead.
    fn foreseeable(&self) -> usize {
        2 * (self.desk.threads() - 1)
    }

    /// Points that were asked for.
    pub(super) fn evaluations(&self) -> usize {
        self.tally().evaluations
    }

    fn failures(&self) -> Failures {
        self.tally().failures.clone()
    }

    fn count(&self, x: &[f64], found: Evaluation, before: usize) -> Result<Option<Answer>, SearchError> {
        let mut tally = self.tally();
        tally.evaluations += 1;
        match found {
            Evaluation::Answer(answer) => Ok(Some(answer)),
            Evaluation::Broken(cause) => Err(CrewError::Broken(cause).into()),
            Evaluation::Failed { cause, numerical } if self.search.on_failure == OnFailure::Stop => {
                Err(SearchError::Failed { x: x.into(), cause, numerical })
            }
            Evaluation::Failed { cause, .. } => {
                tally.failures.note(Failure { before, x: x.into(), cause });
                Ok(None)
            }
        }
    }

    fn tally(&self) -> MutexGuard<'_, Tally> {
        self.tally.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Trials as a simplex asks for them, within the bounds.
struct Confined<'s, 'c, 'a>(&'s Trials<'c, 'a>);

impl Values for Confined<'_, '_, '_> {
    type Error = SearchError;

    fn value(&mut self, x: &[f64]) -> Result<f64, SearchError> {
        Ok(self.0.answer(x)?.map_or(f64::INFINITY, |answer| answer.value()))
    }

    fn expect(&mut self, points: &[Vec<f64>]) {
        self.0.expect(points);
    }

    fn foresee(&self, simplex: &Simplex) -> Vec<Vec<f64>> {
        match self.0.foreseeable() {
            0 => vec![],
            most => foresight::points(simplex, self.0, most),
        }
    }

    fn confine(&self, x: &mut [f64]) {
        self.0.search.bounds.project(x);
    }
}

/// A simplex that was pressed flat against a bound cannot leave it again. Where one converged with its best point on a bound, a
/// new one is therefore made around that point, until that finds nothing better.
fn nelder_mead(start: &[f64], course: Course<'_, '_, '_>) -> Result<Ended, SearchError> {
    let Course { search, trials, number, listener } = course;
    let mut values = Confined(trials);
    let limits = Limits {
        tol_x: search.tol_x,
        tol_f: search.tol_f,
        most_iterations: search.most_iterations,
        most_evaluations: search.most_evaluations,
    };
    let mut history = Vec::new();
    let mut hear = |simplex: &Simplex| {
        let iteration = seen(simplex, number);
        listener(&iteration);
        history.push(iteration);
    };
    let mut simplex = Simplex::around(start, &mut values)?;
    let mut restarts = 0;
    loop {
        hear(&simplex);
        let before = simplex.corners[0].f;
        while !simplex.has_converged(&limits) && !limits.are_met(&simplex) {
            simplex.advance(&mut values)?;
            hear(&simplex);
        }
        let best = simplex.corners[0].clone();
        let pressed = !search.bounds.touched(&best.x).is_empty() && !limits.are_met(&simplex);
        let improved = restarts == 0 || before - best.f > search.tol_f;
        if !pressed || !improved || restarts == MOST_RESTARTS {
            break;
        }
        restarts += 1;
        let so_far = [simplex.iterations, simplex.evaluations];
        simplex = Simplex::around(&best.x, &mut values)?.after(so_far);
    }
    let converged = simplex.has_converged(&limits);
    let reason = if converged {
        "the simplex is within tol_x and tol_f".into()
    } else {
        limit(simplex.iterations, search).into()
    };
    let best = &simplex.corners[0];
    let (iterations, evaluations) = (simplex.iterations, simplex.evaluations);
    let (x, f, size) = (best.x.clone(), best.f, Some(simplex.size()));
    Ok(Ended { x, f, iterations, evaluations, converged, reason, size, history })
}

fn seen(simplex: &Simplex, start: usize) -> Iteration {
    let best = &simplex.corners[0];
    Iteration {
        start,
        iteration: simplex.iterations,
        evaluations: simplex.evaluations,
        x: best.x.clone(),
        f: best.f,
        size: Some(simplex.size()),
        spread: Some(simplex.spread()),
        step: simplex.step.name(),
    }
}

/// Points that are asked for at once have an order of their own: by their first entries, then by the second.
pub(super) fn order(a: &[f64], b: &[f64]) -> Ordering {
    let entries = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    entries.fold(Ordering::Equal, Ordering::then)
}

/// Which limit ended a search.
pub(super) fn limit(iterations: usize, search: &Search) -> &'static str {
    if iterations >= search.most_iterations { "max_iterations was reached" } else { "max_evaluations was reached" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::{Bounds, Crew, Objective, Task};
    use crate::simulate::Cancellation;

    fn banana(x: &[f64]) -> f64 {
        100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2)
    }

    fn found(search: &Search, objective: &dyn Objective, threads: usize) -> Result<Best, SearchError> {
        let task = Task { objective, on_failure: search.on_failure, history: None };
        let found = Crew::new(vec![task], threads).at_work(1 << 20, |desk, _| minimise(search, desk, &mut |_| {}));
        found.map(|mut best| best.remove(0)).map_err(|(_, error)| error)
    }

    fn residuals(f: impl Fn(&[f64]) -> Vec<f64> + Sync) -> impl Objective {
        struct Residuals<F>(F);
        impl<F: Fn(&[f64]) -> Vec<f64> + Sync> Objective for Residuals<F> {
            fn evaluate(&self, x: &[f64], _: &Cancellation) -> Evaluation {
                Answer::Residuals((self.0)(x)).checked()
            }
        }
        Residuals(f)
    }

    #[test]
    fn any_number_of_threads_finds_the_same_bits() {
        let rough = |x: &[f64]| banana(x) + 0.1 * (31.0 * x[0]).sin().abs();
        let curve = residuals(|x| vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0], 0.3 * x[0]]);
        let searches: [(Method, &dyn Objective); 3] =
            [(Method::NelderMead, &rough), (Method::LevenbergMarquardt, &curve), (Method::CmaEs, &rough)];
        for (method, objective) in searches {
            let search = Search { most_evaluations: 300, ..Search::new(method, vec![-1.2, 1.0]) };
            let one = found(&search, objective, 1).unwrap();
            for threads in [2, 3, 8] {
                assert_eq!(found(&search, objective, threads).unwrap(), one, "{method:?} on {threads} threads");
            }
        }
    }

    #[test]
    fn rosenbrock_takes_what_fminsearch_takes_with_cores_that_work_ahead() {
        let best = found(&Search::new(Method::NelderMead, vec![-1.2, 1.0]), &banana, 4).unwrap().best;
        assert_eq!((best.iterations, best.evaluations, best.converged), (85, 159, true));
        assert_eq!(best.history.len(), 85);
    }

    /// Minimum 2·124.3622 = ‖r‖² of the problem of Jennrich and Sampson at x = (0.257825, 0.257825) (Moré, Garbow and
    /// Hillstrom, ACM Trans. Math. Softw. 7, 1981, problem 6); and Rosenbrock's residuals, which vanish at (1, 1).
    #[test]
    fn textbook_residuals_by_levenberg_and_marquardt() {
        let jennrich = residuals(|x| {
            (1..=10)
                .map(|i| 2.0 + 2.0 * f64::from(i) - (f64::from(i) * x[0]).exp() - (f64::from(i) * x[1]).exp())
                .collect()
        });
        let search = Search { tol_x: 1e-8, tol_f: 1e-10, ..Search::new(Method::LevenbergMarquardt, vec![0.3, 0.4]) };
        let best = found(&search, &jennrich, 2).unwrap().best;
        assert!((best.f * best.f - 124.362).abs() < 1e-2, "{best:?}");
        assert!(best.x.iter().all(|x| (x - 0.2578).abs() < 2e-3), "{best:?}");
        let rosenbrock = residuals(|x| vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
        let search = Search { start: vec![-1.2, 1.0], ..search };
        let best = found(&search, &rosenbrock, 2).unwrap().best;
        assert!(best.converged && best.x.iter().all(|x| (x - 1.0).abs() < 1e-6), "{best:?}");
    }

    #[test]
    fn a_bound_that_is_active_holds_the_others_do_not_feel_it() {
        // Smallest at (2, 3) without bounds; with x₀ ≤ 1 at (1, 2.5).
        let bowl = |x: &[f64]| vec![x[0] - 2.0, x[1] - 3.0, 1.0 * (x[0] - x[1] + 1.0)];
        let at_bound = [1.0, 2.5];
        let bounds = Bounds::new(2, Some(vec![0.0, -10.0]), Some(vec![1.0, 10.0])).unwrap();
        for method in [Method::NelderMead, Method::LevenbergMarquardt, Method::CmaEs] {
            let search = Search {
                bounds: bounds.clone(),
                most_evaluations: 2000,
                most_iterations: 1000,
                tol_x: 1e-6,
                tol_f: 1e-8,
                ..Search::new(method, vec![0.5, 0.5])
            };
            let best = found(&search, &residuals(bowl), 2).unwrap();
            let near = best.best.x.iter().zip(at_bound).all(|(x, e)| (x - e).abs() < 2e-3);
            assert!(near, "{method:?}: {best:?}");
            let told = best
                .warnings
                .iter()
                .any(|warning| warning.contains("x[0] = ") && warning.contains("lies on its bound"));
            assert!(told || method == Method::CmaEs, "{method:?}: {:?}", best.warnings);
        }
    }

    /// Pressed against x₁ ≥ 0 on its way, the simplex is flat and would end at (·, 0); the minimum is inside.
    #[test]
    fn a_simplex_pressed_flat_gets_up_again() {
        let valley = |x: &[f64]| (x[0] - 3.0).powi(2) + (x[1] - 0.2 * (x[0] - 1.0).max(0.0)).powi(2) + 0.05 * x[1];
        let bounds = Bounds::new(2, Some(vec![-5.0, 0.0]), None).unwrap();
        let search = Search { bounds, tol_x: 1e-7, tol_f: 1e-12, ..Search::new(Method::NelderMead, vec![-4.0, 0.0]) };
        let free = Search { bounds: Bounds::none(2), start: vec![3.0, 0.4], ..search.clone() };
        let (best, free) = (found(&search, &valley, 1).unwrap(), found(&free, &valley, 1).unwrap());
        assert!((best.best.f - free.best.f).abs() < 1e-6, "{best:?} {free:?}");
        assert_eq!(best.warnings, ["start 1 lies on the bound of x[1]"]);
    }

    #[test]
    fn failed_trials_count_as_worst_and_are_told() {
        let half = |x: &[f64]| if x[0] < 0.5 { f64::NAN } else { x[0].powi(2) + x[1].powi(2) };
        for method in [Method::NelderMead, Method::CmaEs] {
            let search = Search { most_evaluations: 500, ..Search::new(method, vec![2.0, 1.0]) };
            let best = found(&search, &half, 2).unwrap();
            assert!((best.best.x[0] - 0.5).abs() < 0.02 && best.best.x[0] >= 0.5, "{method:?} {best:?}");
            assert!(best.warnings.iter().any(|warning| warning.contains("the objective is not a number")), "{best:?}");
        }
        let slope = residuals(|x| vec![(x[0] - 0.4).ln(), x[1]]);
        let best = found(&Search::new(Method::LevenbergMarquardt, vec![20.0, 1.0]), &slope, 2).unwrap();
        assert!(best.best.converged && (best.best.x[0] - 1.4).abs() < 1e-3, "{best:?}");
    }

    #[test]
    fn a_failed_trial_is_repeated_aside_or_ends_the_search() {
        let hole = |x: &[f64]| if x[0] == 1.5 { f64::NAN } else { (x[0] - 1.0).powi(2) };
        let search = |on_failure| Search {
            on_failure,
            starts: super::super::Starts::Given(vec![vec![1.5]]),
            ..Search::new(Method::NelderMead, vec![2.0])
        };
        assert!(matches!(found(&search(OnFailure::Worst), &hole, 1), Err(SearchError::Start { .. })));
        assert!(found(&search(OnFailure::Retry), &hole, 1).unwrap().warnings.is_empty());
        let cliff = |x: &[f64]| if x[0] < 1.0 { f64::NAN } else { x[0] };
        let stopped =
            found(&Search { on_failure: OnFailure::Stop, ..Search::new(Method::NelderMead, vec![2.0]) }, &cliff, 4);
        assert!(matches!(stopped, Err(SearchError::Failed { x, .. }) if x[0] < 1.0));
    }

    /// Of the trials of one generation, which fail in any order, the same one is told.
    #[test]
    fn a_generation_s_first_failure_does_not_depend_on_who_was_quicker() {
        let calls = std::sync::atomic::AtomicU64::new(0);
        let half = |x: &[f64]| {
            let call = calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            std::thread::sleep(std::time::Duration::from_micros(call * 7919 % 13 * 100));
            if x[0] < 2.2 { f64::NAN } else { x[0] + x[1].abs() }
        };
        for on_failure in [OnFailure::Worst, OnFailure::Stop] {
            let search = Search {
                on_failure,
                most_evaluations: 20,
                starts: super::super::Starts::Given(vec![vec![2.3, 1.0]]),
                ..Search::new(Method::CmaEs, vec![2.3, 1.0])
            };
            let told = |threads| match found(&search, &half, threads) {
                Ok(best) => best.warnings,
                Err(error) => vec![error.to_string()],
            };
            let one = told(1);
            assert!(one[0].contains("not a number"), "{one:?}");
            for round in 0..20 {
                assert_eq!(told(1 + round % 4), one);
            }
        }
    }

    #[test]
    fn fallback_starts_that_fail_are_told() {
        let half = |x: &[f64]| if x[0] < 0.5 { f64::NAN } else { x[0] };
        let fallback = vec![vec![0.2], vec![0.3], vec![0.4]];
        let search = Search { fallback, ..Search::new(Method::NelderMead, vec![0.1]) };
        assert_eq!(
            found(&search, &half, 2).unwrap_err().to_string(),
            "the objective has no value at the start [0.1]: the objective is not a number; nor at any of 3 fallback starts, \
             the last of them [0.4]: the objective is not a number"
        );
    }

    /// Cores that work ahead think the simplex onto its bounds, where all points are known.
    #[test]
    fn a_minimum_on_bounds_is_found_by_any_number_of_threads() {
        let flat = residuals(|x| vec![x[0], 1.0]);
        let corner = residuals(|x| vec![x[0], x[1]]);
        let cases: [(&[f64], &dyn Objective); 2] = [(&[1.5001], &flat), (&[2.0, 3.0], &corner)];
        for (start, objective) in cases {
            let bounds = Bounds::new(start.len(), Some(vec![1.5; start.len()]), None).unwrap();
            let search = Search { bounds, ..Search::new(Method::NelderMead, start.into()) };
            let one = found(&search, objective, 1).unwrap();
            assert!(one.best.x.iter().all(|x| *x == 1.5), "{one:?}");
            for threads in [2, 8] {
                assert_eq!(found(&search, objective, threads).unwrap(), one, "{start:?} on {threads} threads");
            }
        }
    }

    #[test]
    fn a_search_that_does_not_converge_says_so() {
        let search = Search { most_evaluations: 20, ..Search::new(Method::NelderMead, vec![-1.2, 1.0]) };
        let best = found(&search, &banana, 1).unwrap();
        assert!(!best.best.converged);
        assert_eq!(best.warnings, ["not converged: max_evaluations was reached"]);
    }
}
