//! Searches: started again after a kill, on any number of threads, their results and their errors.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex};

use droptower::functions;
use droptower::identify::{self, SearchEvent, SearchHost};
use droptower::scenario::Assignment;
use droptower::scenario_functions::{self, Scenarios};
use droptower::script::{ConvergenceHistory, Limits, key_mistake};
use droptower::signal::Series;
use rhai::Engine;
use tempfile::TempDir;

use crate::verification::tower::checked;
use crate::workbench::{await_of, command, droptower, error, figures, printed, told};

const SEARCH: &str = include_str!("studies/search.rhai");

const TRUST: &str = include_str!("studies/trust.rhai");

/// A folder with the recording of a coarse run of 1008 in `recording/signals.csv`, its multipliers those of Table 8,
/// and the script of a search.
struct Bench {
    folder: TempDir,
    mesh: String,
}

impl Bench {
    fn new(mesh: &str) -> Bench {
        let bench =
            Bench { folder: tempfile::tempdir().expect("a folder"), mesh: format!("specimen.mesh.size={mesh}") };
        fs::write(bench.path("search.rhai"), SEARCH).expect("writable");
        let scenario = shipped("scenarios/drop/1008.toml");
        let changes = ["--set", &bench.mesh, "--set", "output.frames=4"];
        printed(&bench.droptower(&[&["run", &scenario, "--out", "recording"][..], &changes].concat()));
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        command(self.folder.path(), &[arguments, &["--quiet"]].concat())
    }

    fn droptower(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().expect("the binary starts")
    }

    /// The arguments of a script over the run that was recorded.
    fn over_the_recording<'a>(&'a self, script: &'a str, scenario: &'a str, more: &[&'a str]) -> Vec<&'a str> {
        let set = ["--set", self.mesh.as_str(), "--set", "reference.signals=recording/signals.csv"];
        [&["script", script, "--scenario", scenario][..], &set, more].concat()
    }

    /// The search over the first milliseconds, with its results in `out`.
    fn search<'a>(&'a self, scenario: &'a str, out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
        let window = ["--set", "reference.window=[0, \"8 ms\"]", "--out", out];
        self.over_the_recording("search.rhai", scenario, &[&window, more].concat())
    }

    /// Number of whole runs in the store.
    fn stored(&self) -> usize {
        let pattern = self.path("runs/.evaluations/*/runs/*/*.run");
        glob::glob(pattern.to_str().expect("UTF-8")).expect("a pattern").count()
    }

    fn table(&self, out: &str, name: &str) -> Vec<u8> {
        fs::read(self.path(&format!("{out}/tables/{name}.csv"))).expect("a table")
    }
}

fn shipped(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).display().to_string()
}

/// A killed search that is started again takes its runs from the store.
#[test]
fn a_killed_search_continues_with_the_same_bits() {
    let (bench, scenario) = (Bench::new("40 mm"), shipped("scenarios/drop/1008.toml"));
    let (other, killed) = (Bench::new("40 mm"), bench.search(&scenario, "killed", &["--threads", "2"]));
    printed(&other.droptower(&other.search(&scenario, "through", &["--threads", "2"])));

    // One that ends before it is killed, on a busy machine, is started over.
    loop {
        let before = bench.stored();
        let mut child =
            bench.command(&killed).stderr(Stdio::null()).stdout(Stdio::null()).spawn().expect("the binary starts");
        let has_trials = await_of(&mut child, || bench.stored() > before + 20);
        child.kill().expect("killed");
        child.wait().expect("gone");
        assert!(has_trials, "the search fails");
        if !bench.path("killed").exists() {
            break;
        }
        for path in ["killed", "runs/.evaluations"] {
            fs::remove_dir_all(bench.path(path)).expect("results");
        }
    }
    let told = told(&droptower(bench.folder.path(), &bench.search(&scenario, "killed", &["--threads", "1"])));
    assert!(told.contains("runs were computed before"), "{told}");
    for name in ["history", "best"] {
        assert!(other.table("through", name) == bench.table("killed", name), "{name} differs");
    }
}

#[test]
fn intervals_of_multipliers_contain_them_and_do_not_depend_on_threads() {
    let (bench, scenario) = (Bench::new("40 mm"), shipped("scenarios/drop/1008.toml"));
    fs::write(bench.path("trust.rhai"), TRUST).expect("writable");
    let ask = |threads: &str| {
        let more = ["--arg", "seed=1", "--threads", threads, "--out", threads, "--json"];
        figures(&bench.droptower(&bench.over_the_recording("trust.rhai", &scenario, &more)))
    };
    let (summary, _) = (ask("1"), ask("2"));
    for name in ["confidence", "correlation"] {
        assert!(bench.table("1", name) == bench.table("2", name), "{name} differs");
    }
    let tables = &summary["tables"];
    let figure = |table: &str, row: usize, name: &str| tables[table][row][name].as_f64().expect("a number");
    let counts = [figure("counts", 0, "samples"), figure("counts", 0, "effective")];
    assert!(counts[1] > 0.1 * counts[0] && counts[1] < 0.9 * counts[0], "{counts:?}");
    for (place, truth) in [2.75, 3.41, 1.0].into_iter().enumerate() {
        let [lower, upper] = ["lower_95", "upper_95"].map(|side| figure("confidence", place, side));
        assert!(lower < truth && truth < upper, "{truth} is not within {lower} to {upper}");
        assert!(upper - lower < 0.2 * truth, "{lower} to {upper}");
    }
}

/// An engine in which `recorded` is the scenario 1008 on a coarse mesh with the recording of `bench` as its reference.
fn engine(bench: &Bench, changes: &[&str]) -> Engine {
    engine_with(bench, changes, SearchHost::new(|_| {}))
}

fn engine_with(bench: &Bench, changes: &[&str], host: SearchHost) -> Engine {
    let recording = format!("reference.signals={}", bench.path("recording/signals.csv").display());
    let changes = [bench.mesh.as_str(), recording.as_str()].into_iter().chain(changes.iter().copied());
    let read = |change| checked(Assignment::from_argument(change));
    let mut engine = functions::engine(Limits::STUDY);
    scenario_functions::register(&mut engine, &Scenarios { changes: changes.map(read).collect(), evaluations: None });
    identify::register(&mut engine, &host);
    engine
}

fn script(body: &str) -> String {
    format!(
        "let test = scenario({:?});\nlet once = #{{ max_evaluations: 1 }};\n{body}",
        shipped("scenarios/drop/1008.toml")
    )
}

#[test]
fn a_run_within_an_objective_ends_with_the_window_and_has_the_same_errors() {
    let bench = Bench::new("40 mm");
    let engine = engine(&bench, &[]);
    let text = script(
        r#"
        let other = test.with(#{ "specimen.material.fabric.scale.ky": 1.3 });
        let whole = other.simulate();
        let r = test.reference;
        let a = relative_error(whole.acceleration, r.acceleration, test.window);
        let d = relative_error(whole.displacement, r.displacement, test.window);
        let in_trials = |f| minimize("nelder-mead", [1.0], once, |x| f.call(other.simulate())).f;
        [
            in_trials.call(|run| relative_error(run.acceleration, r.acceleration, test.window)) / a - 1,
            in_trials.call(|run| relative_error(run.displacement, r.displacement, test.window)) - d,
            in_trials.call(|run| run.time.end()) - test.window[1],
            whole.time.end(),
            // Figures of the end of a run are missing.
            in_trials.call(|run| {
                let known = run.summary;
                if known.energy_absorption == () && known.rebound_velocity_m_s == () && known.peak_displacement_m < -0.1 { 1 } else { 0 }
            }),
        ]"#,
    );
    let found = engine.eval::<rhai::Array>(&text).unwrap_or_else(|error| panic!("{error}"));
    let found: Vec<f64> = found.iter().map(|value| value.as_float().expect("a number")).collect();
    println!("relative change of the error of acceleration: {:.1e}", found[0]);
    assert!(found[0].abs() < 1e-6, "{found:?}");
    assert_eq!(found[1], 0.0);
    // CFC 1000: 2 ms, and three samples of 0.1 ms.
    assert!(found[2] > 0.0019 && found[2] < 0.0024 && found[3] > 0.119, "{found:?}");
    assert_eq!(found[4], 1.0);
}

/// A search has the simulated samples of its best point, on any number of threads.
#[test]
fn the_curves_of_a_search_are_those_of_its_best_point() {
    let bench = Bench::new("50 mm");
    let text = script(
        r#"
        let scaled = |x| test.with(#{ "specimen.material.fabric.scale.ke": x[0] }).simulate();
        let o = #{ max_evaluations: 12, title: "1008", names: ["ke"], signals: ["displacement (m)"] };
        let best = minimize("nelder-mead", [2.0], o, |x| {
            relative_error(scaled.call(x).displacement, test.reference.displacement, test.window)
        });
        [scaled.call(best.x).displacement, test.reference.displacement]"#,
    );
    let searched = |threads| {
        let seen: Arc<Mutex<Vec<ConvergenceHistory>>> = Arc::default();
        let events = Arc::clone(&seen);
        let host = SearchHost::new(move |event| {
            if let SearchEvent::Finished(convergence) = event {
                events.lock().expect("whole").push(convergence.clone());
            }
        });
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let engine = engine_with(&bench, &[], host);
        let runs = pool.install(|| engine.eval::<rhai::Array>(&text)).unwrap_or_else(|error| panic!("{error}"));
        let found = seen.lock().expect("whole").clone();
        (runs, found)
    };
    let (runs, found) = searched(2);
    let [best, reference] = [0, 1].map(|place: usize| runs[place].clone().cast::<Series>());
    let [ConvergenceHistory { title, unknowns, objectives, history, fits, .. }] = &found[..] else {
        panic!("{found:?}")
    };
    assert_eq!((title.as_str(), unknowns.as_slice(), objectives.len()), ("1008", &["ke".to_owned()][..], 1));
    assert_eq!(history.len(), objectives[0].len());
    let [fit] = &fits[..] else { panic!("{fits:?}") };
    let assert_shown = |values: &[f32], signal: &Series| {
        assert_eq!(values.len(), fit.target.places.len());
        for (place, value) in fit.target.places.iter().zip(values) {
            let [_, expected] = signal.samples().find(|[time, _]| *time as f32 == *place).expect("a sample");
            assert_eq!(*value, expected as f32, "at {place}");
        }
    };
    assert_shown(&fit.target.values, &reference);
    assert_shown(&fit.values, &best);
    let (_, alone) = searched(1);
    assert_eq!(format!("{alone:?}"), format!("{found:?}"));
}

#[test]
fn a_ruptured_run_counts_as_on_rupture_sets() {
    let bench = Bench::new("40 mm");
    let engine = engine(&bench, &[]);
    let warnings = |rule: &str| {
        let text = script(&format!(
            r#"
            once.on_rupture = "{rule}";
            let best = minimize("nelder-mead", [1.0], once, |x| {{
                let run = test.with(#{{ "layers.count": if x[0] > 1 {{ 2 }} else {{ 8 }} }}).simulate();
                relative_error(run.acceleration, test.reference.acceleration, test.window) + 1
            }});
            best.warnings.reduce(|all, one| all + one + "; ", "")"#
        ));
        engine.eval::<String>(&text).unwrap_or_else(|error| panic!("{error}"))
    };
    let failed = warnings("fail");
    assert!(failed.contains("1 trial failed and counted as worst") && failed.contains("the film broke at"), "{failed}");
    assert_eq!(warnings("keep"), "not converged: max_evaluations was reached; ");
}

#[test]
fn errors_in_a_search_are_reported() {
    let bench = Bench::new("40 mm");
    let short = "reference.window=[\"0.11 ms\", \"0.12 ms\"]";
    for (body, expected) in [
        (
            r#"minimize("nelder-mead", [1.0], |x| relative_error(test.simulate().acceleration, test.reference.acceleration, test.window))"#,
            "no value at the start [1.0]: the reference has no sample between 0.00011 s",
        ),
        (
            r#"minimize("nelder-mead", [1.0], |x| test.with(#{ "layers.cuont": x[0] }).simulate().time.end())"#,
            "unknown key `cuont`",
        ),
        (r#"minimize("nelder-mead", [1.0], |x| test.simulate().nosuch)"#, "a run has no `nosuch`"),
        (r#"minimize("nelder-mead", [1.0], |x| test.written("layers.cuont"))"#, "a scenario has no key `layers.cuont`"),
    ] {
        let error = engine(&bench, &[short]).run(&script(body)).expect_err("a mistake");
        let text = key_mistake(&error).unwrap_or_else(|| error.to_string());
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn a_numerical_failure_is_no_error_of_the_script() {
    let (bench, scenario) = (Bench::new("50 mm"), shipped("scenarios/drop/1008.toml"));
    // A film as stiff as diamond beyond 30 % makes the stable time step collapse.
    let diamond = "specimen.material.fabric.md={yield=[[0.2,'5 MPa'],[0.3,'6 MPa']],break=[0.31,1e15]}";
    let measured = "specimen.material.fabric.scale={k1=1,ke=1,ky=1}";
    for (body, status) in [
        ("test.simulate()", 3),
        ("minimize(\"nelder-mead\", [1.0], |x| test.simulate().time.end())", 3),
        (
            "minimize(\"nelder-mead\", [1.0], #{ max_evaluations: 4 }, |x| if x[0] == 1 { 1 } else { test.simulate().time.end() })",
            0,
        ),
        ("minimize(\"nelder-mead\", [1.0], |x| { throw \"no\" })", 2),
        ("try { test.simulate() } catch (e) { throw \"no: \" + e }", 2),
        ("try { test.simulate() } catch (e) { if !e.contains(\"time step\") { throw e } }", 0),
    ] {
        fs::write(bench.path("wrong.rhai"), format!("let test = scenario(args.scenario);\n{body};")).expect("writable");
        let more = ["--set", diamond, "--set", measured, "--out", "wrong"];
        // The second time, what ran comes from the store.
        for _ in 0..2 {
            let output = bench.droptower(&bench.over_the_recording("wrong.rhai", &scenario, &more));
            assert_eq!(output.status.code(), Some(status), "{body}: {}", error(&output));
        }
    }
}
