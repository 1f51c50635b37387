//! `minimize` and `minimize_all`, and their options.

use rhai::{Array, Dynamic, Engine, EvalAltResult, FnPtr, INT, Map, NativeCallContext};

use super::objective::OnRupture;
use super::{SearchHost, integer};
use crate::identify::convergence::{Labels, SignalLabel, thinned};
use crate::identify::options::{Bounds, Method, Search, Starts};
use crate::identify::search::{Iteration, SearchResult, StartResult};
use crate::script::{HostResult, findings_map, number, numbers, record, refuse, refuse_within, unknown, word};
use base::finding::Finding;
use base::removed;

/// Registers `minimize` and `minimize_all`.
pub(super) fn register(engine: &mut Engine, host: &SearchHost) {
    let own = host.clone();
    engine.register_fn(
        "minimize",
        move |context: NativeCallContext, method: &str, start: Array, options: Map, call: FnPtr| {
            minimize(&own, &context, ScriptSearch::new(method, &start, &options, call)?)
        },
    );
    let own = host.clone();
    engine.register_fn("minimize", move |context: NativeCallContext, method: &str, start: Array, call: FnPtr| {
        minimize(&own, &context, ScriptSearch::new(method, &start, &Map::new(), call)?)
    });
    let own = host.clone();
    engine.register_fn(
        "minimize_all",
        move |context: NativeCallContext, method: &str, starts: Array, options: Dynamic, calls: Array| {
            let searches = searches(method, &starts, &options, calls)?;
            let results = minimize_all(&own, &context, &searches)?;
            Ok::<Array, Box<EvalAltResult>>(results.into_iter().map(Dynamic::from).collect())
        },
    );
}

fn minimize(host: &SearchHost, context: &NativeCallContext, search: ScriptSearch) -> HostResult<Map> {
    let mut results = minimize_all(host, context, &[search])?;
    results.pop().ok_or_else(|| refuse("the search has no result"))
}

fn minimize_all(host: &SearchHost, context: &NativeCallContext, searches: &[ScriptSearch]) -> HostResult<Vec<Map>> {
    let values = |ScriptSearch { search, .. }: &ScriptSearch| {
        history_values(searches.len(), search.starts.count(), search.start.len())
    };
    let Some(values) = searches.iter().map(values).collect::<Option<Vec<_>>>() else {
        let count = searches.len();
        return Err(refuse!("the results of {count} searches are more values than a list holds: call it for fewer"));
    };
    let results = host.with_objectives(context, searches, |session, searches| host.minimize_all(session, searches))?;
    let found = results.iter().zip(searches).zip(values);
    Ok(found.map(|((found, search), values)| of_search(found, &search.search.names, values)).collect())
}

/// The searches of `minimize_all`. `options` are those of all, or a list with those of each.
fn searches(method: &str, starts: &Array, options: &Dynamic, calls: Array) -> HostResult<Vec<ScriptSearch>> {
    let count = calls.len();
    let check_length = |list: &Array, what: &str| match list.len() {
        found if found == count => Ok(()),
        found => Err(refuse!("minimize_all has {found} {what} for {count} objectives")),
    };
    check_length(starts, "starts")?;
    let options: Vec<Dynamic> = match options.read_lock::<Array>() {
        Some(list) => check_length(&list, "maps of options").map(|()| list.clone())?,
        None => vec![options.clone(); count],
    };
    let searches = starts.iter().zip(options).zip(calls).enumerate().map(|(number, ((start, options), call))| {
        let of_search = |error| refuse_within(&format!("search {}", number + 1), error);
        let start = start.read_lock::<Array>().ok_or_else(|| of_search(refuse("its start is a list of numbers")))?;
        let options = options.read_lock::<Map>().ok_or_else(|| of_search(refuse("its options are a map")))?;
        let call =
            call.try_cast::<FnPtr>().ok_or_else(|| of_search(refuse("its objective is a function, as in `|x| …`")))?;
        ScriptSearch::new(method, &start, &options, call).map_err(of_search)
    });
    searches.collect()
}

/// Largest limit of iterations or evaluations.
const MAX_COUNT: INT = 100_000;

/// Largest length of a title or a name, characters.
const MAX_LENGTH: usize = 200;

/// Names of the options.
pub(super) const OPTIONS: [&str; 13] = [
    "tol_x",
    "tol_f",
    "max_iterations",
    "max_evaluations",
    "lower",
    "upper",
    "seed",
    "starts",
    "on_rupture",
    "difference",
    "names",
    "title",
    "signals",
];

const ON_RUPTURE: [(&str, OnRupture); 2] = [("fail", OnRupture::Fail), ("keep", OnRupture::Keep)];

/// A search of a script.
pub(super) struct ScriptSearch {
    pub(super) search: Search,
    pub(super) on_rupture: OnRupture,
    pub(super) labels: Labels,
    /// The objective.
    pub(super) call: FnPtr,
}

impl ScriptSearch {
    /// The search for the arguments of `minimize`.
    pub(super) fn new(method: &str, start: &Array, options: &Map, call: FnPtr) -> HostResult<ScriptSearch> {
        let method = word("method", method, &Method::NAMES)?;
        let mut search = Search::new(method, numbers(start, "start")?);
        let mut on_rupture = OnRupture::default();
        let unknowns = search.start.len();
        let mut labels = Labels::default();
        let mut signals: Vec<String> = vec![];
        let mut sides = [None, None];
        for (option, value) in options {
            let list = || match value.read_lock::<Array>() {
                Some(list) => Ok(list.clone()),
                None => Err(refuse!("`{option}` is a list, not {}", value.type_name())),
            };
            let text = || {
                let text = value.clone().into_immutable_string();
                text.map_err(|found| refuse!("`{option}` must be a string, not {found}"))
            };
            match option.as_str() {
                "tol_x" => search.tol_x = number(value, option)?,
                "tol_f" => search.tol_f = number(value, option)?,
                "difference" => search.difference = number(value, option)?,
                "max_iterations" => search.max_iterations = count(value, option, MAX_COUNT)?,
                "max_evaluations" => search.max_evaluations = count(value, option, MAX_COUNT)?,
                "seed" => search.seed = whole(value, option)?.cast_unsigned(),
                "lower" => sides[0] = Some(side(&list()?, f64::NEG_INFINITY, option)?),
                "upper" => sides[1] = Some(side(&list()?, f64::INFINITY, option)?),
                "starts" if value.is_array() => search.starts = Starts::Given(points(&list()?)?),
                "starts" => search.starts = Starts::Spread(count(value, option, MAX_COUNT)?),
                "on_rupture" => on_rupture = word(option, &text()?, &ON_RUPTURE)?,
                "names" => search.names = list()?.iter().map(Dynamic::to_string).collect(),
                "title" => labels.title = Some(text()?.to_string()),
                "signals" => signals = list()?.iter().map(Dynamic::to_string).collect(),
                other => return Err(unknown_option("minimize", other, OPTIONS)),
            }
        }
        if search.names.len() != unknowns {
            return Err(refuse!("`names` has {found} entries for {unknowns} unknowns", found = search.names.len()));
        }
        check_labels(&search.names, &labels, &signals)?;
        labels.signals = signals.iter().map(|text| SignalLabel::parse(text)).collect();
        let [lower, upper] = sides;
        search.bounds = Bounds::new(&search.names, lower, upper).map_err(refuse)?;
        Ok(ScriptSearch { search, on_rupture, labels, call })
    }
}

fn check_labels(names: &[String], labels: &Labels, signals: &[String]) -> HostResult<()> {
    let mut all = names.iter().chain(signals).chain(&labels.title);
    let fits = |text: &String| !text.trim().is_empty() && text.chars().count() <= MAX_LENGTH;
    let message =
        || format!("`title`, `names` and `signals` of a search must be strings of 1 to {MAX_LENGTH} characters");
    if all.all(fits) { Ok(()) } else { Err(refuse(message())) }
}

/// The error for an option that `function` does not have.
pub(super) fn unknown_option<'k>(
    function: &str,
    option: &str,
    known: impl IntoIterator<Item = &'k str> + Clone,
) -> Box<EvalAltResult> {
    let gone = |function: &str| removed::function(&format!("{function}.{option}"));
    match gone(function).or_else(|| gone("minimize")) {
        Some(hint) => refuse!("unknown option `{option}` ({hint})"),
        None => unknown("option", option, known),
    }
}

/// An integer of 1 to `max`.
pub(super) fn count(value: &Dynamic, option: &str, max: INT) -> HostResult<usize> {
    let count = whole(value, option)?;
    let fits = usize::try_from(count).ok().filter(|_| (1..=max).contains(&count));
    fits.ok_or_else(|| refuse!("`{option}` is {count}, which must be 1 to {max}"))
}

fn whole(value: &Dynamic, option: &str) -> HostResult<INT> {
    value.as_int().map_err(|found| refuse!("`{option}` is a whole number, not {found}"))
}

/// Bounds of one side; `()` is `none`.
fn side(list: &Array, none: f64, what: &str) -> HostResult<Vec<f64>> {
    list.iter().map(|item| if item.is_unit() { Ok(none) } else { number(item, what) }).collect()
}

fn points(list: &Array) -> HostResult<Vec<Vec<f64>>> {
    let point = |item: &Dynamic| match item.read_lock::<Array>() {
        Some(point) => numbers(&point, "starts"),
        None => Err(refuse!("`starts` is a number or a list of lists, with {} in it", item.type_name())),
    };
    list.iter().map(point).collect()
}

/// Largest number of values in the results of one call, below the limit of a script's values.
const MAX_VALUES: usize = 9_000;

/// Largest number of them in histories.
const MAX_OF_HISTORIES: usize = 6_000;

/// Least number of them that are left for the histories, which are thinned to that.
const LEAST_OF_HISTORIES: usize = 1_000;

/// Largest number of values in the history of each of so many searches, with so many starts over so many unknowns; `None`
/// where the results are too large without any.
fn history_values(searches: usize, starts: usize, unknowns: usize) -> Option<usize> {
    const OF_A_START: usize = 8;
    let others = searches * ((1 + starts) * (OF_A_START + unknowns) + OF_A_START);
    let left = MAX_VALUES.checked_sub(others).filter(|left| *left >= LEAST_OF_HISTORIES)?;
    Some(left.min(MAX_OF_HISTORIES) / searches)
}

/// The result of a search over unknowns with these names, with so many values in its history.
fn of_search(result: &SearchResult, names: &[String], values: usize) -> Map {
    let history = history(&result.starts, names, values, result.starts.len() > 1);
    let total: usize = result.starts.iter().map(|start| start.evaluations).sum();
    // JSON has no infinity, which the value of a search has none of whose trials succeeded.
    let of_start = |start: &StartResult| record(start, [("f", start.f.into())]);
    let starts: Array = result.starts.iter().map(|start| of_start(start).into()).collect();
    let mut map = of_start(&result.best);
    map.extend([
        ("history".into(), history.into()),
        ("starts".into(), starts.into()),
        ("total_evaluations".into(), integer(total)),
    ]);
    map.extend(findings_map(&result.warnings.iter().map(Finding::new).collect::<Vec<_>>()));
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rhai::{INT, Scope};

    use super::super::test_engine;
    use super::*;
    use crate::script::{Limits, Script, refuse_key};

    #[test]
    fn a_mistake_in_an_objective_is_reported_at_its_position() {
        let error =
            test_engine(Limits::STUDY).run("let a = 1;\nminimize(\"nelder-mead\", [1], |x| {\n  x[7]\n})").unwrap_err();
        assert_eq!(error.unwrap_inner().position().line(), Some(3));
    }

    /// At the start, where it stands in the objective; a later trial with it counts as failed.
    #[test]
    fn a_misspelt_key_in_an_objective_is_reported_at_its_place() {
        let mut engine = test_engine(Limits::STUDY);
        engine.register_fn("with", |changes: Map| match changes["k"].as_float() {
            Ok(k) if k >= 1.0 => Ok(k),
            _ => Err(refuse_key("k", "`k` must be at least 1", None)),
        });
        let fault = |text: &str| {
            let script = Script::compile(&engine, &Scope::new(), Path::new("s.rhai"), text).expect("a script");
            script.run(&engine, Scope::new()).map_err(|fault| (fault.line, fault.column, fault.message))
        };
        for call in ["minimize(\"nelder-mead\", [0.5]", "confidence([0.5]"] {
            let text =
                format!("let far = #{{ k: 1 }};\n{call}, |x| {{\n  [with(#{{ k: x[0] }}), 1, 2]\n}});\n#{{ k: 2 }};");
            assert_eq!(fault(&text), Err((3, 12, "`k` must be at least 1".into())), "{text}");
        }
        assert_eq!(fault("minimize(\"nelder-mead\", [1.04], |x| with(#{ k: x[0] }))"), Ok(()));
    }

    /// The search stops at its limit of trials before it comes to 1.2 or below, where the index is out of range.
    #[test]
    fn a_mistake_in_an_unused_trial_is_not_reported() {
        let text = "let few = minimize(\"nelder-mead\", [2.0], #{ max_evaluations: 6 }, |x| {
        if x[0] <= 1.2 { return [0][9]; }
        if x[0] < 1.5 { let s = 0; for i in 0..20000 { s += 1; } }
        x[0]
    });
    few.x[0]";
        for threads in [1, 2, 4] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let least = pool.install(|| test_engine(Limits::STUDY).eval::<f64>(text)).unwrap();
            assert!(least > 1.2, "{threads}: {least}");
        }
    }

    #[test]
    fn concurrent_searches_have_the_results_of_each_alone() {
        let text =
            "let calls = [|x| [10 * (x[1] - x[0] ** 2), 1 - x[0]], |x| [x[0] - 3, x[0] * x[1]], |x| [x[0], x[1] - 1]];
        let starts = [[-1.2, 1], [1.0, 2], [0.5, 0.5]];
        for method in [\"nelder-mead\", \"levenberg-marquardt\", \"cma-es\"] {
            let together = minimize_all(method, starts, #{ max_evaluations: 150 }, calls);
            for (found, place) in together {
                let alone = minimize(method, starts[place], #{ max_evaluations: 150 }, calls[place]);
                if found.x != alone.x || found.f != alone.f || found.evaluations != alone.evaluations
                    || found.history.len() != alone.history.len() { throw method + place }
            }
        }";
        test_engine(Limits::STUDY).run(text).unwrap();
    }

    #[test]
    fn a_script_that_searches_without_end_reaches_its_time_limit() {
        let limits = Limits { time: std::time::Duration::from_millis(300), ..Limits::STUDY };
        let engine = test_engine(limits);
        let error = engine
            .run("loop { minimize(\"nelder-mead\", [1.0], |x| { let s = 0; for i in 0..1000 { s += 1; } x[0] }) }");
        let error = error.unwrap_err();
        assert!(matches!(error.unwrap_inner(), EvalAltResult::ErrorTerminated(..)), "{error}");
    }

    #[test]
    fn changes_of_captured_variables_are_lost_after_each_trial() {
        let text = "let n = 0; let l = [0];
        let best = minimize(\"nelder-mead\", [1.0], |x| { n += 1; l.push(n); x[0] ** 2 + l.len() + n });
        best.f - 3.0 < 1e-6 && n == 0 && l.len() == 1";
        assert!(test_engine(Limits::STUDY).eval::<bool>(text).unwrap());
    }

    #[test]
    fn findings_have_code_severity_message_and_figures() {
        let text = "let best = minimize(\"nelder-mead\", [2.0], #{ lower: [1.5] }, |x| x[0] ** 2);
        let found = best.findings[0];
        found.code == \"on-bound\" && found.severity == \"warning\" && found.message == best.warnings[0]
            && found.parameter == \"x0\" && found.side == \"lower\" && found.value == 1.5";
        assert!(test_engine(Limits::STUDY).eval::<bool>(text).unwrap());
    }

    #[test]
    fn a_note_is_among_the_findings_and_not_among_the_warnings() {
        let text = "let best = minimize(\"nelder-mead\", [1.5], #{ lower: [1.5] }, |x| x[0]);
        let notes = best.findings.filter(|found| found.severity == \"note\");
        notes.len() == 1 && notes[0].code == \"start-on-bound\" && best.warnings.len() == best.findings.len() - 1
            && best.warnings.all(|text| !text.contains(\"start 1\"))";
        assert!(test_engine(Limits::STUDY).eval::<bool>(text).unwrap());
    }

    /// A script's values are limited, all results of a call together.
    #[test]
    fn many_results_share_the_limit_of_values() {
        let engine = test_engine(Limits::STUDY);
        let all = |count: usize| {
            format!(
                "let starts = []; let calls = [];
            for i in 0..{count} {{ starts.push([3.0, 4, 5, 6]); calls.push(|x| x.reduce(|s, x| s + x ** 2, 0.0)); }}
            let all = minimize_all(\"nelder-mead\", starts, #{{ max_evaluations: 400, tol_x: 0, tol_f: 0 }}, calls);
            all.map(|one| one.history.len()).reduce(|a, b| a + b, 0)"
            )
        };
        let rows = engine.eval::<INT>(&all(80)).unwrap();
        assert!((160..1000).contains(&rows), "{rows}");
        let error = engine.eval::<INT>(&all(400)).unwrap_err().to_string();
        assert!(error.contains("the results of 400 searches are more values than a list holds"), "{error}");
    }

    #[test]
    fn a_long_history_is_thinned_and_contains_its_ends() {
        let text = "let o = #{ max_iterations: 1000, max_evaluations: 3000, tol_x: 0, tol_f: 0 };
        let best = minimize(\"nelder-mead\", [3.0, 4, 5, 6], o, |x| x.reduce(|s, x| s + x ** 2, 0.0));
        [best.history.len(), best.history[0].iteration, best.history[-1].iteration, best.iterations]";
        let found: Vec<INT> =
            test_engine(Limits::STUDY).eval::<Array>(text).unwrap().iter().map(|n| n.as_int().unwrap()).collect();
        assert!(found[0] > 300 && found[0] <= 600 && found[1] == 1 && found[2] == found[3], "{found:?}");
    }
}
