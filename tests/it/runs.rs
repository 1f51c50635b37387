//! The built binary, for the commands that simulate: folders, figures, exit statuses, scripts.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Output;
use std::sync::Arc;

use rhai::{Engine, Map, Scope};
use serde_json::Value as Json;

use droptower::calibrate;
use droptower::evaluate::Evaluations;
use droptower::functions;
use droptower::identify::{self, SearchHost};
use droptower::reference::{self, Entry};
use droptower::report::Figure;
use droptower::scenario_functions::{self, Scenarios};
use droptower::script::{Arguments, Limits, OutputCollector, Script};
use droptower::signal::csv;
use droptower::sweep;

use crate::workbench::{
    drop_bench, droptower, error, figure, figures, json, names, printed, printed_text, root, summary,
};

/// Coarse and short: what is tested is everything around the simulation.
const QUICK: [&str; 6] =
    ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=40ms", "--set", "output.frames=10"];

fn run(folder: &Path, arguments: &[&str]) -> Output {
    droptower(folder, &[&["run"], arguments, &QUICK].concat())
}

#[test]
fn a_run_writes_its_folder() {
    let bench = drop_bench();
    printed(&run(bench.path(), &["drop.toml"]));
    let folder = bench.path().join("runs/drop");
    for name in ["signals.csv", "energies.csv", "summary.json", "scenario.toml", "report.html"] {
        assert!(folder.join(name).is_file(), "{name}");
    }
    let signals = fs::read_to_string(folder.join("signals.csv")).expect("signals");
    let header = "time_s,displacement_m,velocity_m_s,acceleration_m_s2,acceleration_filtered_m_s2,contact_force_N,\
        kinetic_energy_J,potential_energy_J,absorbed_energy_J,total_energy_J,max_strain_md,max_strain_td,frame_force_x_N,\
        frame_force_y_N";
    assert_eq!(signals.lines().next(), Some(header));
    let summary = summary(&folder);
    let figures = "peak_acceleration_m_s2 time_of_peak_acceleration_s peak_displacement_m time_of_peak_displacement_s \
                 rebound_velocity_m_s energy_absorption energy_balance_error ruptured rupture_time_s acceleration_error \
                 displacement_error elements steps time_step_s wall_s ns_per_element_step";
    for name in figures.split(' ') {
        assert!(summary.get(name).is_some(), "{name}");
    }
    let page = fs::read_to_string(folder.join("report.html")).expect("a page");
    assert!(page.contains("default-src 'none'"));
    assert!(["src=", "href=\"http", "url(", "@import"].iter().all(|load| !page.contains(load)));
    assert_eq!(names(bench.path()), ["drop.toml", "droptower.schema.json", "runs"]);
    assert_eq!(names(&bench.path().join("runs")), ["drop"]);
}

/// Vector instructions can be chosen, and change no bit.
#[test]
fn a_width_is_in_the_summary_and_changes_no_bit() {
    let bench = drop_bench();
    let [widest, baseline] = [&[][..], &["--width", "baseline"]].map(|width| {
        printed(&run(bench.path(), &[&["drop.toml", "--force"], width].concat()));
        let folder = bench.path().join("runs/drop");
        let instructions = summary(&folder)["instructions"].as_str().map(str::to_owned);
        (instructions, fs::read(folder.join("signals.csv")).expect("signals"))
    });
    assert_eq!(baseline.0.as_deref(), Some("baseline"));
    assert_eq!(widest.1, baseline.1);
}

/// The largest force and elongation of a spring and the least distance of film from film stand on the terminal and in the summary.
#[test]
fn springs_and_contact_of_film_have_their_figures() {
    let bench = drop_bench();
    let springs = "frame.springs={ stiffness = \"2 kN/m\", count = 80, length = \"50 mm\" }";
    let said = printed(&run(bench.path(), &["drop.toml", "--set", springs, "--set", "contact.film=true"]));
    let summary = summary(&bench.path().join("runs/drop"));
    let figure = |name: &str| figure(&summary, name);
    assert!(figure("peak_spring_force_N") > 2000.0 * figure("peak_spring_elongation_m") * (1.0 - 1e-9), "{summary}");
    assert!(figure("least_film_distance_m") > 0.0, "{summary}");
    assert!(said.contains("  springs             up to ") && said.contains("  film from film      "), "{said}");
    let said = printed(&run(bench.path(), &["drop.toml", "--out", "plain"]));
    assert!(!said.contains("springs") && !said.contains("film from film"), "{said}");
}

#[test]
fn the_stored_scenario_gives_the_same_signals_elsewhere() {
    let (bench, elsewhere) = (drop_bench(), tempfile::tempdir().expect("a folder"));
    let scenario = fs::read_to_string(bench.path().join("drop.toml")).expect("the template");
    fs::write(bench.path().join("drop.toml"), scenario + "\n[post]\nscript = \"own.rhai\"\n").expect("a scenario");
    fs::write(bench.path().join("own.rhai"), "measure(\"twice\", 2 * run.summary.steps);").expect("a script");
    // A run replaces its former self.
    (0..2).for_each(|_| drop(printed(&run(bench.path(), &["drop.toml"]))));
    let mailed = elsewhere.path().join("runs/a/drop");
    fs::create_dir_all(mailed.parent().expect("a parent")).expect("a folder");
    fs::rename(bench.path().join("runs/drop"), &mailed).expect("a move");
    drop(bench);
    printed(&droptower(elsewhere.path(), &["run", "runs/a/drop/scenario.toml", "--out", "again"]));
    let again = elsewhere.path().join("again");
    let signals = |folder: &Path| fs::read(folder.join("signals.csv")).expect("signals");
    assert!(signals(&mailed) == signals(&again), "the signals differ");
    let again = summary(&again);
    assert_eq!(again["scenario"], "a/drop");
    assert_eq!(again["twice"], summary(&mailed)["twice"]);
}

#[test]
fn the_shipped_test_is_compared_with_its_reference() {
    let bench = tempfile::tempdir().expect("a folder");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/drop/1008.toml");
    let output = run(bench.path(), &[shipped.to_str().expect("UTF-8"), "--json", "--quiet"]);
    let printed = figures(&output);
    assert_eq!(error(&output), "");
    let folder = bench.path().join("runs/drop/1008");
    assert_eq!(printed, summary(&folder));
    for name in ["signals.csv", "energies.csv"] {
        let path = folder.join(name);
        let recording = csv::read(&path).expect("our own recording");
        let mut again = Vec::new();
        csv::write(&recording, &mut again).expect("a table");
        assert!(again == fs::read(&path).expect("a table"), "{name} changed");
    }
    let signals = csv::read(&folder.join("signals.csv")).expect("signals");
    let deepest = signals.series("displacement_m").and_then(|travel| travel.smallest()).expect("travel");
    assert_eq!(printed["peak_displacement_m"].as_f64(), Some(deepest[1]));
    assert_eq!(printed["time_of_peak_displacement_s"].as_f64(), Some(deepest[0]));
}

#[test]
fn the_page_shows_the_figures_of_the_summary() {
    let bench = drop_bench();
    printed(&run(bench.path(), &["drop.toml"]));
    let folder = bench.path().join("runs/drop");
    let page = fs::read_to_string(folder.join("report.html")).expect("a page");
    let summary = summary(&folder);
    let figures = summary.as_object().expect("figures").iter().filter(|(_, value)| value.is_number());
    for (name, value) in figures {
        let cells = Figure::from_value(name, value).expect("a figure").cells();
        let named = format!("<tr data-figure=\"{name}\" data-value=\"");
        let (_, rest) = page.split_once(&named).unwrap_or_else(|| panic!("no row of {name}"));
        let (shown, row) = rest.split_once("\">").expect("the end of the value");
        // A number may lose its last bit where it is read.
        let (shown, stored) = (shown.parse::<f64>().expect("a number"), value.as_f64().expect("a number"));
        assert!((shown - stored).abs() <= f64::EPSILON * stored.abs(), "{name}: {shown} for {stored}");
        assert!(row.starts_with(&format!("<td>{}</td></tr>", cells.join("</td><td>"))), "{name}: {row:.80}");
    }
}

#[test]
fn a_numerical_failure_stores_what_was_computed() {
    let bench = drop_bench();
    // A film that turns into diamond at 30 % makes the stable step collapse when the sphere gets there.
    let wall = "specimen.material.fabric.md={yield=[[0.2,'5 MPa'],[0.3,'6 MPa']],break=[0.31,1e15]}";
    let measured = "specimen.material.fabric.scale={k1=1,ke=1,ky=1}";
    let failing = ["drop.toml", "--json", "--set", wall, "--set", measured, "--checkpoint-every", "1 ms"];
    let output = run(bench.path(), &failing);
    assert_eq!(output.status.code(), Some(3), "{}", error(&output));
    let found: Json = serde_json::from_slice(&output.stdout).expect("an object");
    assert!(found["errors"][0]["message"].as_str().expect("a message").contains("the time step fell"), "{found}");
    assert!(error(&output).contains("drop.failed"), "{}", error(&output));
    assert_eq!(names(&bench.path().join("runs")), ["drop.failed"], "and no checkpoints");
    let folder = bench.path().join("runs/drop.failed");
    let cause = fs::read_to_string(folder.join("failure.txt")).expect("a cause");
    assert!(cause.contains("the time step fell") && cause.contains(" s at 0.0") && cause.contains("face"), "{cause}");
    let page = fs::read_to_string(folder.join("report.html")).expect("a page");
    assert!(page.contains("The run failed: the time step fell"));
    let signals = csv::read(&folder.join("signals.csv")).expect("signals");
    assert!(signals.time.len() > 100 && signals.time.len() < 400, "{} samples", signals.time.len());
    let text = printed_text(&run(bench.path(), &["drop.toml", "--force", "--set", wall, "--set", measured]));
    assert!(text.starts_with("drop  sphere") && text.contains("\n  note[") | text.contains("\n  warning["), "{text}");
    printed(&run(bench.path(), &["drop.toml"]));
    assert_eq!(names(&bench.path().join("runs")), ["drop"], "what failed is out of date");
}

#[test]
fn a_script_writes_its_tables() {
    let bench = drop_bench();
    fs::copy(root().join("scripts/layers.rhai"), bench.path().join("study.rhai")).expect("a script");
    let arguments = ["script", "study.rhai", "--scenario", "drop.toml", "--arg", "most=8"];
    printed(&droptower(bench.path(), &[&arguments[..], &QUICK].concat()));
    let folder = bench.path().join("runs/study");
    let summary = summary(&folder);
    let rows = summary["tables"]["layers"].as_array().expect("rows");
    assert_eq!(rows.iter().map(|row| row["layers"].as_i64()).collect::<Vec<_>>(), [Some(6), Some(8)]);
    assert!(figure(&rows[0], "travel_mm") > figure(&rows[1], "travel_mm"), "more layers stop earlier");
    assert_eq!(summary["study"]["script"], "study.rhai");
    assert_eq!(summary["study"]["scenario"], "drop.toml");
    assert_eq!(summary["study"]["set"][0], QUICK[1]);
    assert_eq!(summary["study"]["args"]["most"], 8);
    let table = fs::read_to_string(folder.join("tables/layers.csv")).expect("a table");
    assert!(table.starts_with("layers,peak_g,travel_mm,broke\n6,"), "{table}");
    assert!(folder.join("report.html").is_file());
}

/// An interpreter with every function of the reference, whose runs are stored in `folder`, and what collects its output.
fn engine(folder: &Path) -> (Engine, OutputCollector) {
    let evaluations = Arc::new(Evaluations::new(&folder.join("evaluations")));
    let mut engine = functions::engine(Limits::STUDY);
    let (collector, host) = (OutputCollector::new(vec!["steps".into()]), SearchHost::new(|_| {}));
    functions::register_output(&mut engine, &collector);
    functions::register_reading(&mut engine);
    scenario_functions::register(&mut engine, &Scenarios::default());
    identify::register(&mut engine, &host);
    sweep::register(&mut engine, &evaluations);
    calibrate::register(&mut engine, &Scenarios::default(), &host, &collector, None);
    Arguments::register(&mut engine);
    (engine, collector)
}

/// The files that the examples read, in `folder`, by the names of their arguments.
fn arguments(folder: &Path) -> Map {
    let base = root().join("scenarios/drop/1008.toml");
    let quick = [QUICK[1], QUICK[3]].map(|set| set.replacen('=', " = \"", 1) + "\"\n").concat();
    let scenario = format!(
        "extends = {base:?}\nunset = [\"reference\"]\n{quick}\
         reference = {{ signals = \"reference.csv\", window = [\"0 s\", \"2 ms\"] }}\n"
    );
    let rows: String = (0..40).map(|i| format!("{},{i},{}\n", f64::from(i) * 1e-4, -i)).collect();
    let reference = format!("time_s,acceleration_m_s2,displacement_m\n{rows}");
    fs::write(folder.join("reference.csv"), reference).expect("a table");
    let files = [
        ("scenario", "quick.toml", scenario.as_str()),
        ("recording", "r.csv", "time [ms],acceleration [g]\n0,1\n1,2\n"),
        ("stresses", "rubber-ut.csv", "stretch,stress_MPa\n1,0\n2,0.7\n3,1.1\n"),
    ];
    let written = files.map(|(argument, name, text)| {
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        (argument.into(), path.to_string_lossy().into_owned().into())
    });
    Map::from(written)
}

/// Every example that `droptower explain functions` prints, from the list that it prints: it is true, or it has no value
/// and leaves what its function is for.
#[test]
fn the_examples_of_the_scripting_reference_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let (engine, collector) = engine(folder.path());
    let mut scope = Scope::new();
    scope.push_constant("args", Arguments::new(arguments(folder.path())));
    let evaluated = |scope: &Scope<'static>, text: &str| {
        let script = Script::compile(&engine, scope, Path::new("s.rhai"), text);
        script.unwrap_or_else(|faults| panic!("{text}: {faults:?}")).evaluate(&engine, &mut scope.clone())
    };
    let run = evaluated(&scope, "scenario(args.scenario).simulate()").expect("a run");
    scope.push_constant_dynamic("run", run);
    let entries: Vec<&Entry> = reference::chapters().iter().flat_map(|chapter| &chapter.entries).collect();
    for entry in &entries {
        let before = collector.output();
        let held = evaluated(&scope, &entry.example).unwrap_or_else(|fault| panic!("{}: {fault:?}", entry.call));
        let after = collector.output();
        let has_left = || match entry.call.as_str() {
            call if call.starts_with("plot") || call.ends_with("page()") => after.plots.len() > before.plots.len(),
            call if call.starts_with("write") => after.files != before.files,
            call if call.starts_with("log") => after.log.len() == before.log.len() + 2,
            call if call.starts_with("warn") => after.findings.len() > before.findings.len(),
            _ => after != before,
        };
        assert!(held.as_bool() == Ok(true) || held.is_unit() && has_left(), "{}: {held:?}", entry.call);
    }
    assert!(entries.len() > 50, "{} examples", entries.len());
}

/// What editors show of a function; `node editors/vscode/generate.mjs` writes it from `droptower explain functions --json`.
#[test]
fn the_snippets_of_editors_are_those_of_the_scripting_reference() {
    let snippets = json(&root().join("editors/vscode/snippets/rhai.json"));
    let shown: BTreeSet<&str> = snippets
        .as_object()
        .into_iter()
        .flat_map(|all| all.values())
        .filter_map(|one| one["description"].as_str())
        .collect();
    // Fields and options are no calls, which are a name before a parenthesis.
    let is_call = |entry: &&Entry| {
        let names = entry.call.match_indices('(').filter_map(|(at, _)| entry.call[..at].chars().next_back());
        names.into_iter().any(|last| last.is_ascii_alphanumeric() || last == '_')
    };
    let entries: Vec<&Entry> =
        reference::chapters().iter().flat_map(|chapter| &chapter.entries).filter(is_call).collect();
    assert!(entries.len() > 50, "{} functions", entries.len());
    for entry in &entries {
        let description = format!("{}\n\n{}", entry.gives, entry.example);
        let is_shown = shown.contains(description.as_str());
        assert!(is_shown, "{} is not in editors/vscode/snippets/rhai.json as it is", entry.call);
    }
}
