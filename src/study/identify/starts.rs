//! Several starts of one search, and whether their results agree.

use uncertainty::design::{self, Levels};

use super::objective::Evaluation;
use super::options::{Search, Starts};
use super::point::Point;
use super::pool::trial_pool::{Evaluator, PoolError};
use super::result::StartResult;
use super::warning::Warning;

/// Relative difference of objective values, or of points, above which the results of two starts differ, where the
/// tolerances are not wider.
const DIFFERENT: f64 = 0.01;

/// The starts of `search`, its own first, and how many evaluations they took.
///
/// # Errors
/// An evaluation is fatal.
pub(super) fn all(search: &Search, evaluator: &Evaluator<'_, '_>) -> Result<(Vec<Vec<f64>>, usize), PoolError> {
    let (others, evaluations) = match &search.starts {
        Starts::One => (vec![], 0),
        Starts::Given(starts) => (starts.clone(), 0),
        Starts::Spread(count) => (spread(search, count.saturating_sub(1)), 0),
        Starts::Lowest(_, points) => (lowest(points, search.starts.count() - 1, evaluator)?, points.len()),
    };
    Ok((std::iter::once(search.start.clone()).chain(others).collect(), evaluations))
}

/// The `count` points with the lowest values; those without a value are none.
fn lowest(points: &[Vec<f64>], count: usize, evaluator: &Evaluator<'_, '_>) -> Result<Vec<Vec<f64>>, PoolError> {
    let mut found: Vec<(f64, &Vec<f64>)> = Vec::new();
    for (x, evaluation) in points.iter().zip(evaluator.evaluate_all(points)?) {
        match evaluation {
            Evaluation::Value(value) => found.push((value.value(), x)),
            Evaluation::Failed { .. } => {}
            Evaluation::Fatal(error) => return Err(PoolError::Fatal(error)),
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
pub(super) fn left_out(search: &Search, left_out: Vec<(Vec<f64>, String)>) -> Option<Warning> {
    let (count, starts) = (left_out.len(), search.starts.count());
    let (x, cause) = left_out.into_iter().next()?;
    Some(Warning::StartsLeftOut { count, starts, first: Point::new(&search.names, &x), cause })
}

/// Warnings where not all `results` are the best one.
pub(super) fn disagreement(search: &Search, best: &StartResult, results: &[StartResult]) -> Vec<Warning> {
    let is_higher = |other: &&StartResult| other.f - best.f > (DIFFERENT * best.f.abs()).max(10.0 * search.tol_f);
    let is_elsewhere = |other: &&StartResult| {
        let differs = |(a, b): (&f64, &f64)| (a - b).abs() > (DIFFERENT * b.abs()).max(100.0 * search.tol_x);
        !is_higher(other) && other.x.iter().zip(&best.x).any(differs)
    };
    let starts = results.len();
    let values: Vec<f64> = results.iter().filter(is_higher).map(|other| other.f).collect();
    let higher = (!values.is_empty()).then_some(Warning::StartsDisagree { starts, best: best.f, values });
    let count = results.iter().filter(is_elsewhere).count();
    let elsewhere = (count > 0).then_some(Warning::NotUnique { count, starts });
    higher.into_iter().chain(elsewhere).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::bounds::Bounds;
    use crate::identify::options::Method;
    use crate::identify::point::unnamed;

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
