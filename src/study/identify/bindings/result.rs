//! The results of searches and confidence intervals as maps of a script.

use rhai::{Array, Dynamic, INT, Map};

use crate::identify::convergence::thinned;
use crate::identify::search::Iteration;
use crate::identify::search::{SearchResult, StartResult};
use crate::script::{findings_map, list};
use base::finding::Finding;
use lab::confidence::Confidence;

/// Largest number of values in the results of one call, below the limit of a script's values.
const MAX_VALUES: usize = 9_000;

/// Largest number of them in histories.
const MAX_OF_HISTORIES: usize = 6_000;

/// Least number of them that are left for the histories, which are thinned to that.
const LEAST_OF_HISTORIES: usize = 1_000;

/// Largest number of values in the history of each of so many searches, with so many starts over so many unknowns; `None`
/// where the results are too large without any.
pub(super) fn history_values(searches: usize, starts: usize, unknowns: usize) -> Option<usize> {
    const OF_A_START: usize = 8;
    let others = searches * ((1 + starts) * (OF_A_START + unknowns) + OF_A_START);
    let left = MAX_VALUES.checked_sub(others).filter(|left| *left >= LEAST_OF_HISTORIES)?;
    Some(left.min(MAX_OF_HISTORIES) / searches)
}

/// The result of a search over unknowns with these names, with so many values in its history.
pub(super) fn of_search(result: &SearchResult, names: &[String], values: usize) -> Map {
    let mut map = of_start(&result.best);
    let history = history(&result.starts, names, values, result.starts.len() > 1);
    map.insert("history".into(), history.into());
    map.extend(findings_map(&result.warnings.iter().map(Finding::new).collect::<Vec<_>>()));
    let starts: Array = result.starts.iter().map(|start| of_start(start).into()).collect();
    map.insert("starts".into(), starts.into());
    let total: usize = result.starts.iter().map(|start| start.evaluations).sum();
    map.insert("total_evaluations".into(), integer(total));
    map
}

fn of_start(result: &StartResult) -> Map {
    let mut map = Map::new();
    map.insert("x".into(), list(&result.x).into());
    map.insert("f".into(), result.f.into());
    map.insert("iterations".into(), integer(result.iterations));
    map.insert("evaluations".into(), integer(result.evaluations));
    map.insert("converged".into(), result.converged.into());
    map.insert("reason".into(), result.reason.clone().into());
    map.insert("simplex_size".into(), or_unit(result.size));
    map
}

/// Iterations as rows of a table, thinned evenly to so many values.
fn history(starts: &[StartResult], names: &[String], values: usize, several: bool) -> Array {
    let all: Vec<&Iteration> = starts.iter().flat_map(|start| &start.history).collect();
    let shown = thinned(&all, values / (names.len() + 7));
    shown.map(|iteration| history_row(iteration, names, several).into()).collect()
}

fn history_row(iteration: &Iteration, names: &[String], several: bool) -> Map {
    let mut map = Map::new();
    if several {
        map.insert("start".into(), integer(iteration.start + 1));
    }
    map.insert("iteration".into(), integer(iteration.iteration));
    map.insert("evaluations".into(), integer(iteration.evaluations));
    map.insert("f".into(), iteration.f.into());
    if let Some(size) = iteration.size {
        map.insert("size".into(), size.into());
    }
    map.insert("step".into(), iteration.step.into());
    for (name, x) in names.iter().zip(&iteration.x) {
        map.insert(name.as_str().into(), (*x).into());
    }
    map
}

/// Confidence intervals.
pub(super) fn of_confidence(confidence: &Confidence) -> Map {
    let names = &confidence.names;
    let count = names.len();
    let matrix = |entry: &dyn Fn(usize, usize) -> f64| -> Array {
        (0..count).map(|row| (0..count).map(|column| entry(row, column).into()).collect::<Array>().into()).collect()
    };
    let side = |side: usize| list(&confidence.intervals.iter().map(|ends| ends[side]).collect::<Vec<_>>());
    let mut map = Map::new();
    map.insert("names".into(), names.iter().map(|name| name.clone().into()).collect::<Array>().into());
    map.insert("x".into(), list(&confidence.x).into());
    map.insert("standard_errors".into(), list(&confidence.standard_errors).into());
    map.insert("lower".into(), side(0).into());
    map.insert("upper".into(), side(1).into());
    map.insert("covariance".into(), matrix(&|row, column| confidence.covariance[(row, column)]).into());
    map.insert("correlation".into(), matrix(&|row, column| confidence.correlation[(row, column)]).into());
    map.insert("samples".into(), integer(confidence.samples));
    map.insert("effective_samples".into(), confidence.effective_samples.into());
    map.insert("degrees_of_freedom".into(), confidence.freedom.into());
    map.insert("condition".into(), confidence.condition.into());
    map.extend(findings_map(&confidence.warnings.iter().map(Finding::new).collect::<Vec<_>>()));
    let rows = (0..count).map(|index| confidence_row(confidence, index).into());
    map.insert("table".into(), rows.collect::<Array>().into());
    let correlations = (0..count).map(|index| correlation_row(confidence, index).into());
    map.insert("correlation_table".into(), correlations.collect::<Array>().into());
    let shifts = confidence.shifts.iter().map(|(held, shifts)| {
        let names = names.iter().map(String::as_str);
        Dynamic::from(named(held, names.zip(shifts.iter().copied())))
    });
    map.insert("shift_table".into(), shifts.collect::<Array>().into());
    map
}

fn confidence_row(confidence: &Confidence, index: usize) -> Map {
    let [lower, upper] = confidence.intervals[index];
    let figures = [
        ("value", confidence.x[index]),
        ("standard_error", confidence.standard_errors[index]),
        ("lower_95", lower),
        ("upper_95", upper),
    ];
    named(&confidence.names[index], figures)
}

fn correlation_row(confidence: &Confidence, index: usize) -> Map {
    let names = confidence.names.iter().enumerate();
    let pairs = names.map(|(other, name)| (name.as_str(), confidence.correlation[(index, other)]));
    named(&confidence.names[index], pairs)
}

fn named<'n>(name: &str, figures: impl IntoIterator<Item = (&'n str, f64)>) -> Map {
    let figures = figures.into_iter().map(|(name, value)| (name.into(), value.into()));
    std::iter::once(("parameter".into(), name.to_owned().into())).chain(figures).collect()
}

fn or_unit(value: Option<f64>) -> Dynamic {
    value.map_or(Dynamic::UNIT, Dynamic::from)
}

fn integer(count: usize) -> Dynamic {
    INT::try_from(count).unwrap_or(INT::MAX).into()
}
