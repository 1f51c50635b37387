//! A search: one method from one or several starts, its iterations and its result.

use super::evaluator::Evaluator;
use super::method::{SearchContext, Tally, Trials, cma_es, falls_beyond, levenberg_marquardt, nelder_mead};
use super::objective::{Evaluation, SearchError, refused};
use super::options::{Method, Point, Search, Starts};
use super::warning::Warning;
use serde::Serialize;
use uncertainty::design::{self, Levels};

/// Minimizes the objective of `evaluator` from all starts of `search`; `observer` is called after each iteration.
///
/// The result does not depend on the number of threads, to the bit.
///
/// # Errors
/// A start without a value, a fatal error of the objective, or an objective that does not suit the method.
pub fn minimize(
    search: &Search,
    evaluator: &Evaluator<'_>,
    observer: &mut (dyn FnMut(&Iteration) + Send),
) -> Result<SearchResult, SearchError> {
    let mut results = Vec::new();
    let mut warnings = Vec::new();
    let mut tally = Tally::default();
    let mut left_out = Vec::new();
    let (starts, screened) = all_starts(search, evaluator)?;
    for (number, start) in starts.into_iter().enumerate() {
        // Each start has its own count of trials and failures, so that its result does not depend on those before it.
        let trials = Trials::new(search, evaluator);
        match trials.at_start(&start) {
            // The first start is what the user wrote: without a value there the search has no base. Of the others, which are
            // drawn, one may fall where the model has none.
            Err(SearchError::Trial { cause, .. }) if number > 0 && matches!(search.starts, Starts::Spread(_)) => {
                left_out.push((start, cause));
                continue;
            }
            value => drop(value?),
        }
        if let [(index, side), ..] = search.bounds.active(&start)[..] {
            warnings.push(Warning::StartOnBound { start: number, parameter: search.names[index].clone(), side });
        }
        let context = SearchContext { search, trials: &trials, start: number, observer };
        let result = match search.method {
            Method::NelderMead => nelder_mead::search(&start, context)?,
            Method::LevenbergMarquardt => levenberg_marquardt::search(&start, context)?,
            Method::CmaEs => cma_es::search(&start, context)?,
        };
        // Where a bound stops the search no gradient vanishes: the criterion was met, but not at a minimum.
        results.push(match result.converged && !search.bounds.active(&result.x).is_empty() {
            true => StartResult { converged: false, reason: ON_BOUND.into(), ..result },
            false => result,
        });
        tally.add(trials.tally());
    }
    warnings.extend(left_out_starts(search, left_out));
    warnings.extend(tally.warning(search));
    let Some(best) = results.iter().min_by(|a, b| a.f.total_cmp(&b.f)).cloned() else {
        return Err(refused!("there is no start"));
    };
    if !best.converged && best.reason != ON_BOUND {
        warnings.push(Warning::NotConverged { reason: best.reason.clone() });
    }
    // Trials beside the best point, on the far side of a bound, tell whether the bound costs anything.
    let trials = Trials::new(search, evaluator);
    for (index, side) in search.bounds.active(&best.x) {
        let (parameter, value) = (search.names[index].clone(), best.x[index]);
        let falls_beyond = match search.method {
            Method::LevenbergMarquardt => falls_beyond((index, side), &best.x, search, &trials)?,
            Method::NelderMead | Method::CmaEs => None,
        };
        warnings.push(Warning::OnBound { parameter, value, side, falls_beyond });
    }
    warnings.extend(disagreement(search, &best, &results));
    Ok(SearchResult { best, starts: results, screened, warnings })
}

/// Why a search stopped whose tolerances are met at a point on a bound.
const ON_BOUND: &str = "the best point lies on a bound";

/// Relative difference of objective values, or of points, above which the results of two starts differ, where the
/// tolerances are not wider.
const DIFFERENT: f64 = 0.01;

/// The starts of `search`, its own first, and how many evaluations they took.
///
/// # Errors
/// An evaluation is fatal.
pub(super) fn all_starts(search: &Search, evaluator: &Evaluator<'_>) -> Result<(Vec<Vec<f64>>, usize), SearchError> {
    let (others, evaluations) = match &search.starts {
        Starts::One => (vec![], 0),
        Starts::Given(starts) => (starts.clone(), 0),
        Starts::Spread(count) => (spread(search, count.saturating_sub(1)), 0),
        Starts::Lowest(_, points) => (lowest(points, search.starts.count() - 1, evaluator)?, points.len()),
    };
    Ok((std::iter::once(search.start.clone()).chain(others).collect(), evaluations))
}

/// The `count` points with the lowest values; those without a value are none.
fn lowest(points: &[Vec<f64>], count: usize, evaluator: &Evaluator<'_>) -> Result<Vec<Vec<f64>>, SearchError> {
    let mut found: Vec<(f64, &Vec<f64>)> = Vec::new();
    for (x, evaluation) in points.iter().zip(evaluator.evaluate_all(points)?) {
        match evaluation {
            Evaluation::Value(value) => found.push((value.value(), x)),
            Evaluation::Failed { .. } => {}
            Evaluation::Fatal(error) => return Err(error.into()),
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(found.into_iter().take(count).map(|(_, x)| x.clone()).collect())
}

/// A Latin hypercube over the bounds.
fn spread(search: &Search, count: usize) -> Vec<Vec<f64>> {
    let axes = vec![Levels::Continuous; search.start.len()];
    // Without an unknown, or another start, there is nothing to spread.
    let design = design::points(design::Method::LatinHypercube, &axes, count, search.seed).unwrap_or_default();
    let within = |point: Vec<f64>| -> Vec<f64> {
        point.iter().zip(search.bounds.pairs()).map(|(u, [lower, upper])| lower + (upper - lower) * u).collect()
    };
    design.into_iter().map(within).collect()
}

/// A warning where starts of `search` are left out.
pub(super) fn left_out_starts(search: &Search, left_out: Vec<(Vec<f64>, String)>) -> Option<Warning> {
    let (count, starts) = (left_out.len(), search.starts.count());
    let (x, cause) = left_out.into_iter().next()?;
    Some(Warning::StartsLeftOut { count, starts, first: Point::new(&search.names, &x), cause })
}

/// Warnings where not all `results` are the best one.
pub(super) fn disagreement(search: &Search, best: &StartResult, results: &[StartResult]) -> Vec<Warning> {
    let is_higher = |other: &&StartResult| other.f - best.f > (DIFFERENT * best.f.abs()).max(10.0 * search.tol_f);
    let is_elsewhere = |other: &&StartResult| {
        let differs = |(index, (a, b)): (usize, (&f64, &f64))| {
            let [apart, size] = match search.method {
                // It ends where all u together change by less than a share, also one that is zero.
                Method::LevenbergMarquardt => [search.bounds.apart(index, *a, *b), search.bounds.room(index, *b)],
                Method::NelderMead | Method::CmaEs => [(a - b).abs(), 1.0],
            };
            (a - b).abs() > DIFFERENT * b.abs() && apart > 10.0 * search.tol_x * size
        };
        !is_higher(other) && other.x.iter().zip(&best.x).enumerate().any(differs)
    };
    let starts = results.len();
    let values: Vec<f64> = results.iter().filter(is_higher).map(|other| other.f).collect();
    let higher = (!values.is_empty()).then_some(Warning::StartsDisagree { starts, best: best.f, values });
    let count = results.iter().filter(is_elsewhere).count();
    let elsewhere = (count > 0).then_some(Warning::NotUnique { count, starts });
    higher.into_iter().chain(elsewhere).collect()
}

/// The state of a search after an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Iteration {
    /// Number of the start, from zero.
    pub start: usize,
    /// Number of the iteration, from one.
    pub iteration: usize,
    /// Points that the search has requested so far.
    pub evaluations: usize,
    /// The best point so far.
    pub x: Vec<f64>,
    /// Its objective value.
    pub f: f64,
    /// Nelder–Mead: largest distance of a vertex from the best along an axis. CMA-ES: step size σ.
    pub size: Option<f64>,
    /// Nelder–Mead: largest difference of the value at a vertex from the best.
    pub spread: Option<f64>,
    /// The kind of step that the iteration made: `initial` and `final`, of Nelder–Mead `reflected`, `expanded`,
    /// `contracted_outside`, `contracted_inside` and `shrunk`, of Levenberg–Marquardt `step`, of CMA-ES `generation`.
    pub step: &'static str,
}

/// The result of one start, as scripts have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StartResult {
    /// The best point.
    pub x: Vec<f64>,
    /// Its objective value.
    pub f: f64,
    /// Number of iterations.
    pub iterations: usize,
    /// Points that the search requested.
    pub evaluations: usize,
    /// Whether a tolerance was met.
    pub converged: bool,
    /// Why the search stopped, in words.
    pub reason: String,
    /// [`Iteration::size`] at the end.
    #[serde(rename = "simplex_size")]
    pub size: Option<f64>,
    /// All iterations.
    #[serde(skip)]
    pub history: Vec<Iteration>,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchResult {
    /// The best of all starts.
    pub best: StartResult,
    /// The results of all starts, in their order.
    pub starts: Vec<StartResult>,
    /// Points that were evaluated to choose starts among them.
    pub screened: usize,
    /// Doubts about the result.
    pub warnings: Vec<Warning>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::evaluator::with_evaluator;
    use crate::identify::objective::{Evaluation, Objective, ObjectiveValue};
    use crate::identify::options::{Bounds, Method, Side, unnamed};

    fn banana(x: &[f64]) -> f64 {
        100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2)
    }

    fn found(search: &Search, objective: &dyn Objective, threads: usize) -> Result<SearchResult, SearchError> {
        with_evaluator(objective, threads, |evaluator| minimize(search, evaluator, &mut |_| {}))
    }

    #[test]
    fn any_number_of_threads_finds_the_same_bits() {
        let rough = |x: &[f64]| banana(x) + 0.1 * (31.0 * x[0]).sin().abs();
        let curve = |x: &[f64]| vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0], 0.3 * x[0]];
        let searches: [(Method, &dyn Objective); 3] =
            [(Method::NelderMead, &rough), (Method::LevenbergMarquardt, &curve), (Method::CmaEs, &rough)];
        for (method, objective) in searches {
            let search = Search { max_evaluations: 300, ..Search::new(method, vec![-1.2, 1.0]) };
            let one = found(&search, objective, 1).unwrap();
            for threads in [2, 3, 8] {
                assert_eq!(found(&search, objective, threads).unwrap(), one, "{method:?} on {threads} threads");
            }
        }
    }

    #[test]
    fn rosenbrock_takes_the_iterations_of_fminsearch_with_trials_ahead() {
        let best = found(&Search::new(Method::NelderMead, vec![-1.2, 1.0]), &banana, 4).unwrap().best;
        assert_eq!((best.iterations, best.evaluations, best.converged), (85, 159, true));
        assert_eq!(best.history.len(), 85);
    }

    /// Minimum 2·124.3622 = ‖r‖² of the problem of Jennrich and Sampson at x = (0.257825, 0.257825) (Moré, Garbow and
    /// Hillstrom, ACM Trans. Math. Softw. 7, 1981, problem 6); and Rosenbrock's residuals, which vanish at (1, 1).
    #[test]
    fn textbook_residuals_by_levenberg_and_marquardt() {
        let jennrich = |x: &[f64]| -> Vec<f64> {
            (1..=10)
                .map(|i| 2.0 + 2.0 * f64::from(i) - (f64::from(i) * x[0]).exp() - (f64::from(i) * x[1]).exp())
                .collect()
        };
        let search = Search { tol_x: 1e-8, tol_f: 1e-10, ..Search::new(Method::LevenbergMarquardt, vec![0.3, 0.4]) };
        let best = found(&search, &jennrich, 2).unwrap().best;
        assert!((best.f * best.f - 124.362).abs() < 1e-2, "{best:?}");
        assert!(best.x.iter().all(|x| (x - 0.2578).abs() < 2e-3), "{best:?}");
        let rosenbrock = |x: &[f64]| vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]];
        let search = Search { start: vec![-1.2, 1.0], ..search };
        let best = found(&search, &rosenbrock, 2).unwrap().best;
        assert!(best.converged && best.x.iter().all(|x| (x - 1.0).abs() < 1e-6), "{best:?}");
    }

    #[test]
    fn an_active_bound_is_kept_and_the_others_have_no_effect() {
        // Smallest at (2, 3) without bounds; with x₀ ≤ 1 at (1, 2.5).
        let bowl = |x: &[f64]| vec![x[0] - 2.0, x[1] - 3.0, 1.0 * (x[0] - x[1] + 1.0)];
        let at_bound = [1.0, 2.5];
        let bounds = Bounds::new(&unnamed(2), Some(vec![0.0, -10.0]), Some(vec![1.0, 10.0])).unwrap();
        for method in [Method::NelderMead, Method::LevenbergMarquardt, Method::CmaEs] {
            let search = Search {
                bounds: bounds.clone(),
                max_evaluations: 2000,
                max_iterations: 1000,
                tol_x: 1e-6,
                tol_f: 1e-8,
                ..Search::new(method, vec![0.5, 0.5])
            };
            let best = found(&search, &bowl, 2).unwrap();
            let near = best.best.x.iter().zip(at_bound).all(|(x, e)| (x - e).abs() < 2e-3);
            assert!(near, "{method:?}: {best:?}");
            let falls_beyond = (method == Method::LevenbergMarquardt).then_some(true);
            let parameter = "x0".to_owned();
            let on_bound = Warning::OnBound { parameter, value: 1.0, side: Side::Upper, falls_beyond };
            assert_eq!(best.warnings, [on_bound], "{method:?}");
            assert!(!best.best.converged && best.best.reason == ON_BOUND, "{best:?}");
        }
    }

    /// Nine times the lower bound is far from it along the logarithm.
    #[test]
    fn a_search_along_the_logarithm_is_not_stopped_by_a_bound_that_is_far() {
        let decades = |x: &[f64]| vec![10.0 * (x[0] / 0.009).ln(), 0.3];
        let bounds = Bounds::new(&unnamed(1), Some(vec![1e-3]), Some(vec![100.0])).unwrap();
        // The last is in the middle but for rounding, where the transform is nearly zero.
        for start in [0.009_45, 20.0, 0.1_f64.sqrt() * (1.0 + 1e-15)] {
            let method = Search::new(Method::LevenbergMarquardt, vec![start]);
            let search = Search { bounds: bounds.clone().along_logarithms(vec![true]), ..method };
            let best = found(&search, &decades, 1).unwrap();
            assert!((best.best.x[0] / 0.009 - 1.0).abs() < 1e-3 && best.best.converged, "{best:?}");
            assert!(best.warnings.is_empty(), "{best:?}");
        }
    }

    /// In the transform the centre is zero; a share of that would show the roughness rather than the slope.
    #[test]
    fn a_rough_objective_is_left_from_the_centre_of_its_bounds() {
        let rough = |x: &[f64]| vec![x[0] - 2.0 + 1e-3 * (1e4 * x[0]).sin()];
        let bounds = Bounds::new(&unnamed(1), Some(vec![0.0]), Some(vec![10.0])).unwrap();
        for start in [4.999, 5.0, 5.0001] {
            let method = Search::new(Method::LevenbergMarquardt, vec![start]);
            let search = Search { bounds: bounds.clone(), difference: 0.01, ..method };
            let best = found(&search, &rough, 1).unwrap().best;
            assert!((best.x[0] - 2.0).abs() < 5e-3, "from {start}: {best:?}");
        }
    }

    /// From 0 the search ends in the minimum beside it, from the lowest of the points in the other one; a point without a value is
    /// none, and does not count as a failed trial.
    #[test]
    fn the_lowest_of_several_points_are_starts() {
        let two = |x: &[f64]| match x[0] < -5.0 {
            true => Evaluation::failed("nowhere"),
            false => ObjectiveValue::Residuals(vec![(x[0] * (x[0] - 4.0)).powi(2) + 0.5 * (4.0 - x[0]), 0.0]).into(),
        };
        let points = vec![vec![-6.0], vec![1.9], vec![4.3], vec![0.4]];
        let search = Search { tol_x: 1e-6, tol_f: 1e-9, ..Search::new(Method::NelderMead, vec![0.1]) };
        let alone = found(&search, &two, 1).unwrap();
        assert!(alone.best.x[0].abs() < 0.1 && alone.screened == 0, "{alone:?}");
        let both = found(&Search { starts: Starts::Lowest(2, points), ..search }, &two, 2).unwrap();
        assert!((both.best.x[0] - 4.0).abs() < 0.1, "{both:?}");
        assert_eq!((both.starts.len(), both.screened), (2, 4));
        assert!(!both.warnings.iter().any(|own| matches!(own, Warning::FailedTrials { .. })), "{both:?}");
    }

    /// The unknowns of the minimum are 0 and 0.004: the first lies on its bound, the second beside it.
    #[test]
    fn each_unknown_beside_a_bound_is_moved_onto_it_on_its_own() {
        let corner = |x: &[f64]| vec![x[0] + 1.0, 10.0 * (x[1] - 0.004)];
        let bounds = Bounds::new(&unnamed(2), Some(vec![0.0; 2]), Some(vec![1.0; 2])).unwrap();
        let (tol_x, tol_f, max_evaluations, max_iterations) = (1e-6, 1e-8, 2000, 1000);
        let start = Search::new(Method::CmaEs, vec![0.5, 0.5]);
        let search = Search { bounds, tol_x, tol_f, max_evaluations, max_iterations, ..start };
        let best = found(&search, &corner, 1).unwrap();
        assert!(best.best.x[0] == 0.0 && (best.best.x[1] - 0.004).abs() < 1e-3, "{best:?}");
        assert!(matches!(&best.warnings[..], [Warning::OnBound { parameter, .. }] if parameter == "x0"), "{best:?}");
    }

    /// Both end on the bound of x₀: a minimum of all values, beyond which the objective rises again, and one of those
    /// within the bounds.
    #[test]
    fn the_gradient_tells_whether_the_objective_falls_beyond_a_bound() {
        let bounds = Bounds::new(&unnamed(1), Some(vec![0.0]), Some(vec![3.0])).unwrap();
        for (least, expected) in [(0.0, false), (-0.5, true), (3.0, false), (3.5, true)] {
            let bowl = |x: &[f64]| vec![x[0] - least, 1.0];
            let search = Search { bounds: bounds.clone(), ..Search::new(Method::LevenbergMarquardt, vec![1.0]) };
            let best = found(&search, &bowl, 1).unwrap();
            let [Warning::OnBound { falls_beyond, .. }] = &best.warnings[..] else { panic!("{best:?}") };
            assert_eq!(*falls_beyond, Some(expected), "{least}: {best:?}");
        }
    }

    /// The simplex collapses onto x₁ = 0 and would end at (·, 0); the minimum is inside.
    #[test]
    fn a_collapsed_simplex_restarts() {
        let valley = |x: &[f64]| (x[0] - 3.0).powi(2) + (x[1] - 0.2 * (x[0] - 1.0).max(0.0)).powi(2) + 0.05 * x[1];
        let bounds = Bounds::new(&unnamed(2), Some(vec![-5.0, 0.0]), None).unwrap();
        let search = Search { bounds, tol_x: 1e-7, tol_f: 1e-12, ..Search::new(Method::NelderMead, vec![-4.0, 0.0]) };
        let free = Search { bounds: Bounds::none(2), start: vec![3.0, 0.4], ..search.clone() };
        let (best, free) = (found(&search, &valley, 1).unwrap(), found(&free, &valley, 1).unwrap());
        assert!((best.best.f - free.best.f).abs() < 1e-6, "{best:?} {free:?}");
        assert_eq!(best.warnings, [Warning::StartOnBound { start: 0, parameter: "x1".into(), side: Side::Lower }]);
    }

    /// Half of the box has no value: the starts there are left out, and one that is given there is an error.
    #[test]
    fn spread_starts_without_a_value_are_left_out() {
        let half = |x: &[f64]| if x[0] > 5.0 { f64::NAN } else { (x[0] - 2.0).powi(2) };
        let bounds = Bounds::new(&unnamed(1), Some(vec![0.0]), Some(vec![10.0])).unwrap();
        let search = Search { bounds, starts: Starts::Spread(5), ..Search::new(Method::NelderMead, vec![1.0]) };
        let best = found(&search, &half, 2).unwrap();
        assert_eq!((best.starts.len(), best.best.converged), (3, true), "{best:?}");
        let left_out = |warning: &Warning| matches!(warning, Warning::StartsLeftOut { count: 2, starts: 5, .. });
        assert!(best.warnings.iter().any(left_out), "{:?}", best.warnings);
        let given = Search { starts: Starts::Given(vec![vec![7.0]]), ..search };
        assert!(matches!(found(&given, &half, 2), Err(SearchError::Trial { .. })));
    }

    /// The first has its minimum at (0, 0.7), the second along a line.
    #[test]
    fn starts_that_end_elsewhere_are_told_also_beside_zero() {
        let point = |x: &[f64]| vec![x[0] * (1.0 + x[1] * x[1]), 2.0 * (x[1] - 0.7), 0.3];
        let line = |x: &[f64]| vec![x[0] + x[1] - 0.7, 0.3];
        let bounds = Bounds::new(&unnamed(2), Some(vec![-1.0; 2]), Some(vec![1.5; 2])).unwrap();
        let cases: [(&dyn Objective, bool); 2] = [(&point, false), (&line, true)];
        for (objective, is_elsewhere) in cases {
            let method = Search::new(Method::LevenbergMarquardt, vec![0.5, 0.2]);
            let search = Search { bounds: bounds.clone(), starts: Starts::Spread(6), ..method };
            let best = found(&search, objective, 1).unwrap();
            let not_unique = |own: &Warning| matches!(own, Warning::NotUnique { starts: 6, .. });
            assert_eq!(best.warnings.iter().any(not_unique), is_elsewhere, "{best:?}");
        }
    }

    #[test]
    fn failed_trials_count_as_worst_with_a_warning() {
        let half = |x: &[f64]| if x[0] < 0.5 { f64::NAN } else { x[0].powi(2) + x[1].powi(2) };
        for method in [Method::NelderMead, Method::CmaEs] {
            let search = Search { max_evaluations: 500, ..Search::new(method, vec![2.0, 1.0]) };
            let best = found(&search, &half, 2).unwrap();
            assert!((best.best.x[0] - 0.5).abs() < 0.02 && best.best.x[0] >= 0.5, "{method:?} {best:?}");
            let not_finite = "the objective is not finite";
            let failed =
                |warning: &Warning| matches!(warning, Warning::FailedTrials { cause, .. } if cause == not_finite);
            assert!(best.warnings.iter().any(failed), "{best:?}");
        }
        let slope = |x: &[f64]| vec![(x[0] - 0.4).ln(), x[1]];
        let best = found(&Search::new(Method::LevenbergMarquardt, vec![20.0, 1.0]), &slope, 2).unwrap();
        assert!(best.best.converged && (best.best.x[0] - 1.4).abs() < 1e-3, "{best:?}");
    }

    /// Of the trials of one generation, which fail in any order, the same one is reported.
    #[test]
    fn the_first_failure_of_a_generation_does_not_depend_on_the_order_of_trials() {
        let calls = std::sync::atomic::AtomicU64::new(0);
        let half = |x: &[f64]| {
            let call = calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            std::thread::sleep(std::time::Duration::from_micros(call * 7919 % 13 * 100));
            if x[0] < 2.2 { f64::NAN } else { x[0] + x[1].abs() }
        };
        let search = Search {
            max_evaluations: 20,
            starts: Starts::Given(vec![vec![2.3, 1.0]]),
            ..Search::new(Method::CmaEs, vec![2.3, 1.0])
        };
        let reported = |threads| -> Vec<String> {
            found(&search, &half, threads).unwrap().warnings.iter().map(Warning::to_string).collect()
        };
        let one = reported(1);
        assert!(one[0].contains("not finite"), "{one:?}");
        for round in 0..20 {
            assert_eq!(reported(1 + round % 4), one);
        }
    }

    /// The simplex moves onto its bounds, where its points are known.
    #[test]
    fn a_minimum_on_bounds_is_found_by_any_number_of_threads() {
        let flat = |x: &[f64]| vec![x[0], 1.0];
        let corner = |x: &[f64]| vec![x[0], x[1]];
        let cases: [(&[f64], &dyn Objective); 2] = [(&[1.5001], &flat), (&[2.0, 3.0], &corner)];
        for (start, objective) in cases {
            let bounds = Bounds::new(&unnamed(start.len()), Some(vec![1.5; start.len()]), None).unwrap();
            let search = Search { bounds, ..Search::new(Method::NelderMead, start.into()) };
            let one = found(&search, objective, 1).unwrap();
            assert!(one.best.x.iter().all(|x| *x == 1.5), "{one:?}");
            for threads in [2, 8] {
                assert_eq!(found(&search, objective, threads).unwrap(), one, "{start:?} on {threads} threads");
            }
        }
    }

    #[test]
    fn a_search_that_does_not_converge_has_a_warning() {
        let search = Search { max_evaluations: 20, ..Search::new(Method::NelderMead, vec![-1.2, 1.0]) };
        let best = found(&search, &banana, 1).unwrap();
        assert!(!best.best.converged);
        assert_eq!(best.warnings, [Warning::NotConverged { reason: "max_evaluations was reached".into() }]);
    }

    #[test]
    fn every_part_of_every_axis_holds_one_start() {
        let bounds = Bounds::new(&unnamed(2), Some(vec![-1.0, 10.0]), Some(vec![1.0, 20.0])).unwrap();
        let search = Search { bounds, seed: 7, ..Search::new(Method::NelderMead, vec![0.0, 11.0]) };
        let points = spread(&search, 8);
        assert_eq!(points.len(), 8);
        for (axis, [lower, upper]) in search.bounds.pairs().enumerate() {
            let mut parts: Vec<usize> =
                points.iter().map(|x| (8.0 * (x[axis] - lower) / (upper - lower)) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, [0, 1, 2, 3, 4, 5, 6, 7]);
        }
        assert_ne!(spread(&Search { seed: 8, ..search.clone() }, 8), points);
        assert_eq!(spread(&search, 8), points);
    }
}
