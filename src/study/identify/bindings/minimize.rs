//! `minimize` and `minimize_all`.

use rhai::{Array, Dynamic, Engine, EvalAltResult, FnPtr, Map, NativeCallContext};

use super::host::SearchHost;
use super::options::ScriptSearch;
use super::result;
use crate::script::{Entry, HostResult, refuse, thrown};

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
        result::history_values(searches.len(), search.starts.count(), search.start.len())
    };
    let Some(values) = searches.iter().map(values).collect::<Option<Vec<_>>>() else {
        let count = searches.len();
        return Err(refuse(format!(
            "the results of {count} searches are more values than a list holds: call it for fewer"
        )));
    };
    let results = host.minimize(context, searches)?;
    let found = results.iter().zip(searches).zip(values);
    Ok(found.map(|((found, search), values)| result::of_search(found, &search.search.names, values)).collect())
}

/// The searches of `minimize_all`. `options` are those of all, or a list with those of each.
fn searches(method: &str, starts: &Array, options: &Dynamic, calls: Array) -> HostResult<Vec<ScriptSearch>> {
    let count = calls.len();
    let check_length = |list: &Array, what: &str| match list.len() {
        found if found == count => Ok(()),
        found => Err(refuse(format!("minimize_all has {found} {what} for {count} objectives"))),
    };
    check_length(starts, "starts")?;
    let options: Vec<Dynamic> = match options.read_lock::<Array>() {
        Some(list) => check_length(&list, "maps of options").map(|()| list.clone())?,
        None => vec![options.clone(); count],
    };
    let searches = starts.iter().zip(options).zip(calls).enumerate().map(|(number, ((start, options), call))| {
        let of_search = |error: Box<EvalAltResult>| match &*error {
            EvalAltResult::ErrorRuntime(value, _) => refuse(format!("search {}: {}", number + 1, thrown(value))),
            _ => error,
        };
        let start = start.read_lock::<Array>().ok_or_else(|| of_search(refuse("its start is a list of numbers")))?;
        let options = options.read_lock::<Map>().ok_or_else(|| of_search(refuse("its options are a map")))?;
        let call =
            call.try_cast::<FnPtr>().ok_or_else(|| of_search(refuse("its objective is a function, as in `|x| …`")))?;
        ScriptSearch::new(method, &start, &options, call).map_err(of_search)
    });
    searches.collect()
}

/// The reference of `minimize`.
pub(super) const ENTRIES: &[Entry] = &[
    Entry {
        call: "minimize(method, start, options, |x| …)",
        gives: "the minimum of the objective: #{ x, f, iterations, evaluations, converged, reason, simplex_size, \
            history, starts, warnings, findings }; `findings` are maps with code, severity, message and figures, \
            `warnings` the messages of those of severity \"warning\". Methods: \"nelder-mead\" (as MATLAB's \
            fminsearch), \"levenberg-marquardt\" (residuals), \"cma-es\" (rough objectives). The objective gives a \
            number, or a \
            signal or list of residuals, of which \"nelder-mead\" and \"cma-es\" take the norm. It is called from \
            several threads with copies of the variables that it captures, made when the search began. A trial may \
            take 1 000 000 operations; all searches of a script share its time limit of a week",
        example: r#"let banana = |x| 100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2;
                    let best = minimize("nelder-mead", [-1.2, 1], #{}, banana);
                    best.iterations == 85 && best.evaluations == 159 && best.converged"#,
    },
    Entry {
        call: "minimize_all(method, [start, …], options, [|x| …, …])",
        gives: "the results of `minimize` for independent objectives, in their order and to the same bit, from \
            concurrent searches on all cores; options are one map for all or a list of maps. If a search fails, \
            earlier ones run to their ends, later ones are cancelled, and the call fails with the first error",
        example: r#"let found = minimize_all("nelder-mead", [[2.0], [3.0]], #{ tol_f: 1e-6 },
                        [|x| x[0] ** 2, |x| (x[0] - 1) ** 2]);
                    found[1].f == minimize("nelder-mead", [3.0], #{ tol_f: 1e-6 }, |x| (x[0] - 1) ** 2).f"#,
    },
    Entry {
        call: "#{ tol_x, tol_f, max_iterations, max_evaluations }",
        gives: "tolerances, 1e-4 each, absolute for \"nelder-mead\" and \"cma-es\" and relative for \
            \"levenberg-marquardt\"; limits, 200 for each unknown",
        example: r#"let o = #{ max_iterations: 3 }; let best = minimize("nelder-mead", [1], o, |x| x[0] ** 2);
                    !best.converged && best.reason == "max_iterations was reached" && best.history.len() == 3"#,
    },
    Entry {
        call: "#{ lower: [..], upper: [..] }",
        gives: "bounds, `()` for none: by projection, with restarts on a bound (\"nelder-mead\"), or by transform (the \
            others)",
        example: r#"let best = minimize("nelder-mead", [2.0], #{ lower: [1.5] }, |x| x[0] ** 2); best.x[0] == 1.5"#,
    },
    Entry {
        call: "#{ starts: 5, seed: 1 }, #{ starts: [[..], ..] }",
        gives: "further starts, in a Latin hypercube over the bounds or as given; warnings say if their results \
            disagree",
        example: r#"let o = #{ lower: [-3], upper: [3], starts: 4 };
                    let best = minimize("nelder-mead", [1.2], o, |x| (x[0] ** 2 - 1) ** 2 + 0.3 * x[0]);
                    best.x[0] < 0 && best.warnings[0].contains("local minima")"#,
    },
    Entry {
        call: "#{ on_rupture: \"fail\" | \"keep\" }",
        gives: "whether a run with a ruptured film is a trial that failed, as one is that throws or is not finite. Such \
            trials count as worse than all others, and are noted in warnings",
        example: r#"let best = minimize("nelder-mead", [2.0], #{}, |x| if x[0] < 1 { throw "too small" } else { x[0] });
                    best.x[0] >= 1 && best.warnings[0].contains("too small")"#,
    },
    Entry {
        call: "#{ title: \"1008\", signals: [\"acceleration (m/s²)\", ..] }",
        gives: "title of the search in the report, which shows the objective, the unknowns and the signals \
            that the objective compares with references (`relative_error`, `relative_residuals`, `rate`) by iteration; \
            and names of these signals, in the order in which they are compared",
        example: r#"let read = signal([0, 1, 2], [5, 7, 9]);
                    let o = #{ title: "line", signals: ["force (N)"], names: ["offset"] };
                    let line = |x| signal([0, 1, 2], [x[0], x[0] + 2, x[0] + 4]);
                    let best = minimize("nelder-mead", [4.0], o, |x| relative_error(line.call(x), read, [0, 2]));
                    (best.x[0] - 5).abs() < 1e-3"#,
    },
    Entry {
        call: "#{ names: [..], difference: 1e-3 }",
        gives: "names of the unknowns, which are columns of the history; relative step of the differences of the \
            Jacobian",
        example: r#"minimize("nelder-mead", [2.0], #{ names: ["k1"] }, |x| x[0] ** 2).history[0].k1 == 2.0"#,
    },
];

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
    fn a_mistake_in_an_unused_speculative_trial_is_not_reported() {
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
