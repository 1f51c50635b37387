//! The results of searches, confidence intervals and profiles as maps of a script.

use rhai::{Array, Dynamic, INT, Map};

use crate::identify::bounds::Side;
use crate::identify::confidence::profile::Profile;
use crate::identify::confidence::refinement::Refinement;
use crate::identify::convergence::thinned;
use crate::identify::iteration::Iteration;
use crate::identify::options::Search;
use crate::identify::result::{SearchResult, StartResult};
use crate::identify::warning::{NOT_CONVERGED, ON_BOUND};
use crate::script::from_json;
use base::finding::{Finding, Report, Severity};
use lab::confidence::Confidence;

/// Largest number of values in the results of one call, below the limit of a script's values.
const MAX_VALUES: usize = 9_000;

/// Largest number of them in histories: a refined search has [`REFINED`] more.
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
    insert_findings(&mut map, result.warnings.iter());
    let starts: Array = result.starts.iter().map(|start| of_start(start).into()).collect();
    map.insert("starts".into(), starts.into());
    let total: usize = result.starts.iter().map(|start| start.evaluations).sum();
    map.insert("total_evaluations".into(), integer(total));
    map
}

fn of_start(result: &StartResult) -> Map {
    let mut map = Map::new();
    map.insert("x".into(), list(result.x.iter().copied()).into());
    map.insert("f".into(), result.f.into());
    map.insert("iterations".into(), integer(result.iterations));
    map.insert("evaluations".into(), integer(result.evaluations));
    map.insert("converged".into(), result.converged.into());
    map.insert("reason".into(), result.reason.to_string().into());
    map.insert("simplex_size".into(), or_unit(result.size));
    map
}

/// Largest number of values in the history of each part of a refined search.
const REFINED: usize = 3_000;

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
    map.insert("step".into(), iteration.step.name().into());
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
        (0..count).map(|row| list((0..count).map(|column| entry(row, column))).into()).collect()
    };
    let mut map = Map::new();
    map.insert("names".into(), names.iter().map(|name| name.clone().into()).collect::<Array>().into());
    map.insert("x".into(), list(confidence.x.iter().copied()).into());
    map.insert("standard_errors".into(), list(confidence.standard_errors.iter().copied()).into());
    map.insert("lower".into(), list(confidence.intervals.iter().map(|[lower, _]| *lower)).into());
    map.insert("upper".into(), list(confidence.intervals.iter().map(|[_, upper]| *upper)).into());
    map.insert("covariance".into(), matrix(&|row, column| confidence.covariance[(row, column)]).into());
    map.insert("correlation".into(), matrix(&|row, column| confidence.correlation[(row, column)]).into());
    map.insert("samples".into(), integer(confidence.samples));
    map.insert("effective_samples".into(), confidence.effective_samples.into());
    map.insert("degrees_of_freedom".into(), confidence.freedom.into());
    map.insert("condition".into(), confidence.condition.into());
    insert_findings(&mut map, confidence.warnings.iter());
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

/// Profiles along parameters with these names.
pub(super) fn of_profiles(profiles: &[Profile], names: &[String]) -> Map {
    let side = |side: usize| -> Array { profiles.iter().map(|profile| or_unit(profile.interval[side])).collect() };
    let intervals = profiles.iter().map(|profile| {
        let mut map = named(&names[profile.parameter], []);
        map.insert("lower_95".into(), or_unit(profile.interval[0]));
        map.insert("upper_95".into(), or_unit(profile.interval[1]));
        map.insert("threshold".into(), profile.threshold.sqrt().into());
        for (name, side) in [("lower_note", Side::Lower), ("upper_note", Side::Upper)] {
            map.insert(name.into(), profile.why_open(side).unwrap_or_default().into());
        }
        Dynamic::from(map)
    });
    let mut map = Map::new();
    map.insert("lower".into(), side(0).into());
    map.insert("upper".into(), side(1).into());
    map.insert("intervals".into(), intervals.collect::<Array>().into());
    insert_findings(&mut map, profiles.iter().flat_map(|profile| &profile.warnings));
    let rows = profiles.iter().flat_map(|profile| profile_rows(profile, names));
    map.insert("table".into(), rows.collect::<Array>().into());
    map
}

/// The map of a result after profiles: the result `best` of a search, whose map may be empty, as they leave it.
pub(super) fn of_refinement(refinement: &Refinement, best: &Map, search: &Search) -> Map {
    let mut map = best.clone();
    map.insert("x".into(), list(refinement.x.iter().copied()).into());
    map.insert("f".into(), refinement.f.into());
    let Some((converged, reason)) = refinement.state(&search.bounds) else { return map };
    map.insert("converged".into(), converged.into());
    map.insert("reason".into(), reason.to_string().into());
    for result in &refinement.continued {
        let start = &result.best;
        let [iterations, evaluations] = ["iterations", "evaluations"].map(|name| count(&map, name));
        let rows = history(&result.starts, &search.names, REFINED, false).into_iter().map(|row| {
            let mut row = row.cast::<Map>();
            for (name, before) in [("iteration", iterations), ("evaluations", evaluations)] {
                row.insert(name.into(), (before + count(&row, name)).into());
            }
            Dynamic::from(row)
        });
        let before = map.get("history").and_then(|history| history.read_lock::<Array>().map(|rows| rows.clone()));
        map.insert("history".into(), before.unwrap_or_default().into_iter().chain(rows).collect::<Array>().into());
        let total = count(&map, "total_evaluations") + start.evaluations as INT;
        map.insert("iterations".into(), (iterations + start.iterations as INT).into());
        map.insert("evaluations".into(), (evaluations + start.evaluations as INT).into());
        map.insert("total_evaluations".into(), total.into());
    }
    let obsolete = [NOT_CONVERGED.name, ON_BOUND.name];
    let code = |found: &Dynamic| found.read_lock::<Map>().and_then(|map| map.get("code").map(Dynamic::to_string));
    let before = map.get("findings").and_then(|found| found.read_lock::<Array>().map(|found| found.clone()));
    let before = before.unwrap_or_default().into_iter();
    let kept = before.filter(|found| code(found).is_none_or(|code| !obsolete.contains(&code.as_str())));
    let last = refinement.continued.last().map(|result| &result.warnings);
    let own = refinement.warnings.iter().chain(last.into_iter().flatten()).map(Finding::new);
    let findings: Array = kept.chain(own.map(|finding| map_of(&finding))).collect();
    insert(&mut map, findings);
    map
}

/// The whole number `name` of a map; zero where there is none.
fn count(map: &Map, name: &str) -> INT {
    map.get(name).and_then(|count| count.as_int().ok()).unwrap_or(0)
}

/// The points of a profile as rows of a table.
fn profile_rows<'p>(profile: &'p Profile, names: &'p [String]) -> impl Iterator<Item = Dynamic> + 'p {
    profile.points.iter().map(|point| {
        let mut map = named(&names[profile.parameter], [("value", point.value)]);
        map.insert("f".into(), or_unit(point.f));
        for (name, x) in names.iter().zip(&point.x) {
            map.insert(name.as_str().into(), (*x).into());
        }
        map.into()
    })
}

/// `findings`, a list of maps with code, severity, message and figures, and `warnings`, the messages of the warnings
/// among them.
fn insert_findings<'w, W: Report + 'w>(map: &mut Map, reports: impl Iterator<Item = &'w W>) {
    insert(map, reports.map(|warning| map_of(&Finding::new(warning))).collect());
}

fn insert(map: &mut Map, findings: Array) {
    let message = |found: &Dynamic| {
        let found = found.read_lock::<Map>()?;
        let is_warning =
            found.get("severity").is_some_and(|severity| severity.to_string() == Severity::Warning.to_string());
        is_warning.then(|| found.get("message").cloned()).flatten()
    };
    map.insert("warnings".into(), findings.iter().filter_map(message).collect::<Array>().into());
    map.insert("findings".into(), findings.into());
}

fn map_of(finding: &Finding) -> Dynamic {
    serde_json::to_value(finding).map_or(Dynamic::UNIT, |json| from_json(&json))
}

fn named<'n>(name: &str, figures: impl IntoIterator<Item = (&'n str, f64)>) -> Map {
    let figures = figures.into_iter().map(|(name, value)| (name.into(), value.into()));
    std::iter::once(("parameter".into(), name.to_owned().into())).chain(figures).collect()
}

fn list(values: impl Iterator<Item = f64>) -> Array {
    values.map(Dynamic::from).collect()
}

fn or_unit(value: Option<f64>) -> Dynamic {
    value.map_or(Dynamic::UNIT, Dynamic::from)
}

fn integer(count: usize) -> Dynamic {
    INT::try_from(count).unwrap_or(INT::MAX).into()
}
