//! `calibrate` in scripts (`calibrations/`): several tests, verdicts, closed forms of the posterior, mistakes.

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use droptower::calibrate;
use droptower::cancellation::Cancellation;
use droptower::functions;
use droptower::identify::{self, SearchEvent, SearchHost, TrialEvent};
use droptower::scenario_functions::{self, Scenarios};
use droptower::script::{Limits, OutputCollector, ScriptOutput, Session, key_mistake};
use rhai::{Dynamic, Engine, EvalAltResult, Scope};

use crate::workbench::{self, blocks, close, droptower, root};

/// An interpreter with `calibrate`, and what it leaves.
fn engine() -> (Engine, OutputCollector) {
    engine_with(SearchHost::new(|_| {}))
}

fn engine_with(host: SearchHost) -> (Engine, OutputCollector) {
    let collector = OutputCollector::new(Vec::new());
    let mut engine = functions::engine(Limits::STUDY);
    functions::register_output(&mut engine, &collector);
    functions::register_reading(&mut engine);
    scenario_functions::register(&mut engine, &Scenarios::default());
    identify::register(&mut engine, &host);
    calibrate::register(&mut engine, &Scenarios::default(), &host, &collector, None);
    (engine, collector)
}

fn evaluated(engine: &Engine, scope: &mut Scope<'_>, text: &str) -> Result<Dynamic, String> {
    let words = |error: Box<EvalAltResult>| key_mistake(&error).unwrap_or_else(|| error.to_string());
    engine.eval_with_scope::<Dynamic>(scope, text).map_err(words)
}

/// The text of `common.rhai` and of these parts of a script in `calibrations/`.
fn text(parts: &[&str]) -> String {
    let read = |part: &&str| fs::read_to_string(root().join(format!("tests/it/calibrations/{part}.rhai"))).expect(part);
    ["common"].iter().chain(parts).map(read).collect()
}

/// What a script gives, which throws where something is not so, and its output.
fn run(parts: &[&str]) -> (Dynamic, ScriptOutput) {
    run_with(parts, vec![])
}

fn run_with(parts: &[&str], constants: Vec<(&str, Dynamic)>) -> (Dynamic, ScriptOutput) {
    let (engine, collector) = engine();
    let mut scope = Scope::new();
    for (name, value) in constants.into_iter().chain([("thorough", thorough::thorough().into())]) {
        scope.push_constant_dynamic(name, value);
    }
    let found = evaluated(&engine, &mut scope, &text(parts)).unwrap_or_else(|error| panic!("{parts:?}: {error}"));
    (found, collector.output())
}

fn holds(parts: &[&str]) {
    drop(run(parts));
}

/// Codes of the findings that a script leaves.
fn codes(parts: &[&str]) -> Vec<String> {
    run(parts).1.findings.iter().map(|found| found.code.to_string()).collect()
}

fn floats(list: Dynamic) -> Vec<f64> {
    list.into_array().expect("a list").into_iter().map(|item| item.as_float().expect("a number")).collect()
}

/// Checks that each call of a list of `broken/files/`, after `setup`, is refused in these words.
fn refused(setup: &str, list: &str, call: impl Fn(&str) -> String) {
    let (engine, _) = engine();
    let mut scope = Scope::new();
    let found = evaluated(&engine, &mut scope, setup);
    assert!(found.is_ok(), "{setup}: {found:?}");
    let functions = text(&[]);
    for [expected, own] in blocks(list) {
        let error = evaluated(&engine, &mut scope, &format!("{functions}{}", call(&own))).expect_err(&own);
        assert!(error.contains(&expected), "{own}: {error}");
    }
}

/// A study that is told to stop while a calibration searches begins no trial any more, and says that it was stopped.
#[test]
fn a_calibration_stops_with_its_study() {
    let (stop, begun) = (Arc::new(OnceLock::<Cancellation>::new()), Arc::new(AtomicUsize::new(0)));
    let (told, counted) = (Arc::clone(&stop), Arc::clone(&begun));
    let host = SearchHost::new(move |event| {
        if let SearchEvent::Trial(_, TrialEvent::Begun { .. }) = event {
            counted.fetch_add(1, Ordering::Relaxed);
            told.get().expect("the study's").cancel();
        }
    });
    let (engine, _) = engine_with(host);
    stop.set(Session::of_engine(&engine).stop().clone()).expect("once");
    let error = engine.eval::<Dynamic>(&text(&["stops"])).unwrap_err();
    assert!(matches!(error.unwrap_inner(), rhai::EvalAltResult::ErrorTerminated(..)), "{error}");
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    assert!(begun.load(Ordering::Relaxed) <= 4 * threads, "trials went on: {begun:?}");
}

thorough::cases!(holds {
    a_linear_parameter_has_the_deviation_of_its_closed_form: &["linear"];
    verdicts_say_what_the_tests_do_not_determine: &["verdicts"];
    a_drop_breaks_film_whose_break_strain_its_demand_exceeds: &["drop", "verge"];
    a_time_of_rupture_and_a_failure_mass_lead_to_the_break_strain: &["drop", "break-strain"];
    candidates_break_at_the_calibrated_strain: &["drop", "candidate"];
    candidates_may_have_the_error_of_tests: &["shared"];
    predictions_break_as_often_as_the_likelihood_says: &["drop", "both-ways"];
    signals_beside_outcomes_are_those_of_film_that_holds: &["drop", "beside"];
    contacts_and_speeds_that_are_off_move_no_parameter_beyond_its_interval: &["contacts"];
    a_plastic_law_is_found_again_from_its_coupons: &["coupons", "plastic"];
});

/// What a second call of `predict` finds stands beside the first.
#[test]
fn a_limit_is_exceeded_as_often_as_the_closed_form_says() {
    let (_, output) = run(&["limit"]);
    let table = output.tables.iter().find(|(name, _)| name == "predicted_probabilities").expect("a table");
    let scenarios: Vec<&str> = table.1.iter().filter_map(|row| row["scenario"].as_str()).collect();
    assert_eq!(scenarios, ["alone", "alone", "with errors", "with errors"]);
}

/// What has no effect, or is known to be wrong, is refused before the posterior is sampled.
#[test]
fn mistakes_about_results_are_named() {
    let text = text(&["one"]);
    refused(&text, "calibrate-results.txt", |call| format!("found.{call}"));
    assert!(codes(&["one", "nothing-left"]).contains(&"nothing-to-leave-out".to_owned()));
    let again = codes(&["one", "again"]);
    assert_eq!(again.iter().filter(|code| *code == "tables-replaced").count(), 1, "{again:?}");
}

#[test]
fn tests_share_parameters_and_have_their_own() {
    let (_, output) = run(&["own"]);
    let tables: Vec<&str> = output.tables.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(tables, ["both_parameters", "both_tests"]);
    let files: Vec<&str> = output.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(files, ["both_film_1.toml", "both_film_2.toml"], "films of two thicknesses");
}

#[test]
fn what_a_scenario_refuses_is_no_part_of_a_posterior() {
    assert!(!codes(&["refused-values"]).contains(&"posterior-runs-failed".to_owned()));
}

/// One mistake each, and the words that name it.
#[test]
fn mistakes_are_named_before_any_search() {
    let functions = text(&[]);
    let own = r#"let md = strip("MD"); let own = #{ scenario: md, name: "md", recordings: recorded(md, 0.0, 1) };
        let k = #{ key: "specimen.material.fabric.scale.k1", start: 1, within: [0.5, 2] };"#;
    refused(&format!("{functions}{own}"), "calibrate-tests.txt", |call| format!("calibrate({call})"));
}

#[test]
fn mistakes_about_outcomes_are_named() {
    let call = |tests: &str| format!("calibrate(#{{ tests: {tests}, parameters: #{{ k: parameter }} }})");
    refused(&text(&["drop"]), "calibrate-outcomes.txt", call);
}

/// Of ten specimens with a known scatter seven break: the posterior of the break strain is that of a probit, by quadrature.
#[test]
fn outcomes_have_the_posterior_of_a_probit() {
    let found = floats(run(&["drop", "specimens"]).0);
    let cumulative = uncertainty::normal::cumulative;
    let grid: Vec<f64> = (0..20_000).map(|place| -0.5 + 5e-5 * f64::from(place)).collect();
    let density = |x: &f64| cumulative(-x / 0.1).powi(7) * cumulative(x / 0.1).powi(3);
    let total: f64 = grid.iter().map(density).sum();
    let quantile = |probability: f64| {
        let mut sum = 0.0;
        let place = grid.iter().find(|x| {
            sum += density(x) / total;
            sum >= probability
        });
        found[0] * place.unwrap().exp()
    };
    for (own, probability) in found[2..].iter().zip([0.025, 0.5, 0.975]) {
        close(*own, quantile(probability), 0.02);
    }
    // Most likely where three of ten hold: z = −0.5244.
    close(found[1], found[0] * (-0.052_44_f64).exp(), 5e-3);
}

#[test]
fn a_test_that_has_no_run_with_the_parameters_of_the_others_is_a_finding() {
    let (_, output) = run(&["drop", "no-run"]);
    let failed = output.findings.iter().find(|found| found.code == "left-out-failed");
    let failed = failed.unwrap_or_else(|| panic!("{:?}", output.findings));
    assert!(failed.message.contains("closer than they are thick"), "{failed:?}");
}

#[test]
fn a_search_that_ends_early_is_told_by_the_posterior() {
    let codes = codes(&["early"]);
    let is_told = |code: &str| codes.iter().any(|own| own == code);
    assert!(is_told("posterior-elsewhere") && is_told("start-on-bound"), "{codes:?}");
}

/// Three coupons or five, each of film of another thickness, with noise that counts: the posterior of mean and deviation of the
/// specimens is that of the normal hierarchy, by quadrature, whether the search finds one thickness for all or one for each.
fn a_hierarchy_has_the_posterior_of_its_closed_form(is_own: bool) {
    let truths = &[11.0, 11.8, 12.6, 13.3, 11.5][..thorough::choose(3, 5)];
    let list = |items: Vec<Dynamic>| Dynamic::from_array(items);
    let own = if is_own { vec!["thickness".into()] } else { vec![] };
    let constants = vec![("own", list(own)), ("truths", list(truths.iter().map(|truth| (*truth).into()).collect()))];
    let found = floats(run_with(&["hierarchy"], constants).0);
    // The force is proportional to the thickness; noise is a share of the force of each specimen.
    let errors: Vec<f64> = truths.iter().map(|truth| 0.3 * truth / found[4].sqrt()).collect();
    let (mut sums, mut total) = ([0.0; 4], 0.0);
    for tau in (1..=800).map(|step| 0.005 * f64::from(step)) {
        let variances: Vec<f64> = errors.iter().map(|error| error * error + tau * tau).collect();
        for mu in (0..=400).map(|step| 9.0 + 0.015 * f64::from(step)) {
            let own = truths.iter().zip(&variances).map(|(y, v)| -0.5 * ((y - mu).powi(2) / v + v.ln())).sum::<f64>();
            let weight = (own - 0.5 * tau * tau).exp();
            let first = (mu / (tau * tau) + truths[0] / errors[0].powi(2)) / (tau.powi(-2) + errors[0].powi(-2));
            total += weight;
            [mu, mu * mu, tau, first].iter().zip(&mut sums).for_each(|(value, sum)| *sum += weight * value);
        }
    }
    let [mean, square, deviation, first] = sums.map(|sum| sum / total);
    let spread = (square - mean * mean).sqrt();
    assert!((found[0] - mean).abs() < 0.1 * spread, "{found:?}: {mean}");
    assert!((found[1] / spread - 1.0).abs() < 0.1, "{found:?}: {spread}");
    assert!((found[2] / deviation - 1.0).abs() < 0.1, "{found:?}: {deviation}");
    assert!((found[3] - first).abs() < 0.1 * errors[0], "{found:?}: {first}");
}

thorough::cases!(a_hierarchy_has_the_posterior_of_its_closed_form {
    one_for_each: true;
} thorough {
    one_for_all: false;
});

/// A recording of film on elements of a third of the size: on coarse elements no parameter is determined, unless the recording is
/// said to be of these elements; on finer ones the correction finds the curves, which differ by up to 10 % without.
#[test]
fn elements_limit_parameters_and_are_corrected_for() {
    for (size, truth) in thorough::first(1, [("60 mm", "20 mm"), ("20 mm", "8 mm")]) {
        let sizes = Dynamic::from_array(vec![size.into(), truth.into()]);
        let found = floats(run_with(&["elements"], vec![("sizes", sizes)]).0);
        let (corrected, exact) = found.split_at(3);
        let is_moved = |place: usize| (corrected[place] / exact[place] - 1.0).abs() > 1e-3;
        assert!((0..3).any(is_moved), "a correction moves something: {found:?}");
        if size == "20 mm" {
            let off = |own: &[f64]| own.iter().map(|ratio| (ratio - 1.0).abs()).fold(0.0, f64::max);
            println!("elements of 20 mm: off by {:.3} corrected, {:.3} without", off(corrected), off(exact));
            assert!(off(corrected) < 0.03 && off(exact) > 0.08, "{found:?}");
        }
    }
}

/// Film that holds on its elements and breaks on half of them tells nothing of these; with an outcome it does not break.
#[test]
fn film_that_breaks_on_finer_elements_corrects_nothing() {
    let (_, output) = run(&["drop", "finer"]);
    let found = output.findings.iter().filter(|found| found.code == "mesh-not-checked");
    let found: Vec<&str> = found.map(|found| found.message.as_str()).collect();
    let is_told = |own: &&str| own.starts_with("breaks was not run") && own.contains("the film broke");
    assert!(!found.is_empty() && found.iter().all(is_told), "{found:?}");
}

#[test]
fn a_prediction_leaves_out_what_its_scenario_lacks() {
    let (_, output) = run(&["drop", "lacking"]);
    let without = output.findings.iter().filter(|found| found.code == "prediction-without-parameter");
    let without: Vec<&str> = without.map(|found| found.message.as_str()).collect();
    let told = "friction has no part in the prediction of td: its scenario has no such key, or none that can be set";
    assert_eq!(without, [told]);
    let files: Vec<&str> = output.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(files, ["film.toml"], "the strip's, and none of a drop whose friction alone is sought");
}

#[test]
fn angles_between_follow_a_fabric_and_not_a_film_that_yields_together() {
    let (_, output) = run(&["coupons", "yields-together"]);
    assert!(output.findings.iter().any(|found| found.code == "angles-do-not-follow"), "{:?}", output.findings);
    let plots: Vec<&str> = output.plots.iter().map(|plot| plot.title.as_str()).collect();
    assert_eq!(plots, ["Modulus over the angle", "Force at 10 % over the angle"]);
    let codes = codes(&["coupons", "fabric"]);
    assert!(!codes.contains(&"angles-do-not-follow".to_owned()), "{codes:?}");
}

/// A study in a file: its parameter is found, its film is in its folder, a scenario that is predicted is read before the search, and
/// what was found before a mistake in a later line is kept.
#[test]
fn a_study_in_a_file_is_calibrated() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let base = root().join("scenarios/stretch/single-element.toml");
    let strip = |name: &str, ke: f64| {
        let text =
            format!("extends = {base:?}\nloading.stretch.until = 0.2\nspecimen.material.fabric.scale.ke = {ke}\n");
        fs::write(at.join(name), text).expect("a scenario");
    };
    strip("strip.toml", 1.0);
    strip("film.toml", 1.3);
    workbench::printed(&droptower(at, &["run", "film.toml", "--quiet"]));
    let study = |first: &str, more: &str| {
        let text = format!(
            "precision = 0.05\n{first}[[test]]\nscenario = \"strip.toml\"\ncompare = \"force\"\nrecordings = \"runs/*/signals.csv\"\nnoise = 0.01\n\
             [parameters]\nke = {{ key = \"specimen.material.fabric.scale.ke\", start = 1, within = [0.2, 5], log = true }}\n{more}"
        );
        fs::write(at.join("study.toml"), text).expect("a study");
    };
    study("", "");
    let found = workbench::figures(&droptower(at, &["calibrate", "study.toml", "--json"]));
    let own = &found["tables"]["parameters"][0];
    assert!((own["value"].as_f64().expect("a value") - 1.3).abs() < 0.01, "{own}");
    assert_eq!(own["verdict"], "determined");
    let curves = |film: &str| -> Vec<f64> {
        workbench::printed(&droptower(at, &["export", "card", film, "--for", "curves", "-o", "curves.csv", "--force"]));
        let text = fs::read_to_string(at.join("curves.csv")).expect("curves");
        text.lines().flat_map(|line| line.split(',')).filter_map(|number| number.parse().ok()).collect()
    };
    let [found, recorded] = ["runs/study", "film.toml"].map(curves);
    assert!(found.len() > 10 && found.len() == recorded.len(), "{found:?} {recorded:?}");
    assert!(found.iter().zip(&recorded).all(|(a, b)| (a - b).abs() <= 0.01 * b.abs()), "{found:?} {recorded:?}");
    // Before any run: a scenario that cannot be read.
    study("", "[predict]\nscenarios = [\"head.toml\"]\n[posterior]\nhierarchy = [\"kx\"]\n");
    let refused = droptower(at, &["calibrate", "study.toml", "--force"]);
    for expected in ["head.toml", "study.toml:10", "there is no parameter `kx`"] {
        workbench::refused(&refused, expected);
    }
    let error = workbench::error(&refused);
    assert!(!error.contains("weighted by noise"), "no search began: {error}");
    // After it: a test that is not there.
    study("left_out = [\"nobody\"]\n", "");
    let late = droptower(at, &["calibrate", "study.toml", "--force"]);
    let error = workbench::error(&late);
    assert!(late.status.code() == Some(1) && error.contains("nobody"), "{error}");
    let page = fs::read_to_string(at.join("runs/study.failed/report.html")).expect("a page");
    assert!(page.contains("ended before its end") && page.contains("determined"));
}
