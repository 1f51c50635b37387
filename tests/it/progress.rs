//! The page of a study while it runs, what a stop leaves, and why an evaluation would be computed again.

use std::fs;
use std::path::Path;
use std::process::{Child, Output};

use crate::workbench::{await_of, droptower, error, figures, json, names, printed, root, scene, start};
use serde_json::Value as Json;

const VARIATION: &str = "[variation]\nsamples = 6\n\"impactor.mass\" = { uniform = [\"10 kg\", \"12 kg\"] }\n\
                         \"impactor.friction\" = { uniform = [0.1, 0.5] }\n";

/// Waits for a file of a process that runs.
fn wait_for(child: &mut Child, what: impl Fn() -> bool) {
    assert!(await_of(child, what), "the process ended before it could be stopped");
}

#[cfg(unix)]
fn interrupt(child: Child) -> Output {
    let killed = std::process::Command::new("kill").args(["-INT".to_owned(), child.id().to_string()]).status();
    assert!(killed.expect("kill starts").success());
    child.wait_with_output().expect("it ends")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn the_page_of_a_sweep_becomes_its_report() {
    let scene = scene(VARIATION);
    let folder = scene.path();
    let output = droptower(folder, &["sweep", "drop.toml"]);
    let told = error(&output);
    let first = "note: runs/.progress/drop.sweep/progress.html shows how far it is";
    assert_eq!(told.lines().next(), Some(first), "{told}");
    let progress = folder.join("runs/.progress/drop.sweep");
    assert_eq!(names(&progress), ["progress.html"]);
    let page = read(&progress.join("progress.html"));
    assert!(page.contains("content=\"0; url=../../drop.sweep/report.html\""), "{page}");
    assert!(progress.join("../../drop.sweep/report.html").is_file());
    let events = droptower(folder, &["sweep", "drop.toml", "--json"]);
    let first: Json = serde_json::from_str(error(&events).lines().next().expect("an event")).expect("JSON");
    assert_eq!([&first["event"], &first["path"]], ["page", "runs/.progress/drop.sweep/progress.html"]);
    let part = droptower(folder, &["sweep", "drop.toml", "--shard", "1/2", "--quiet"]);
    assert!(part.status.success() && error(&part).is_empty());
    assert_eq!(names(&progress), ["progress.html"], "a part that has ended leaves no page");
}

#[cfg(unix)]
#[test]
fn an_interrupted_sweep_lets_runs_end_and_leaves_what_is_done() {
    let scene = scene(VARIATION);
    let folder = scene.path();
    let mut child = start(folder, &["sweep", "drop.toml", "-n", "100000"]);
    let progress = folder.join("runs/.progress/drop.sweep");
    let has_records = || {
        let listed = figures(&droptower(folder, &["store", "list", "--json"]));
        listed.as_array().expect("a list").iter().any(|build| build["evaluations"].as_u64() > Some(3))
    };
    wait_for(&mut child, || progress.join("progress.html").is_file() && has_records());
    assert!(read(&progress.join("progress.html")).contains("data-lives=\"true\""));
    let output = interrupt(child);
    assert_eq!(output.status.code(), Some(1), "{}", error(&output));
    assert!(error(&output).contains("runs/.progress/drop.sweep has it so far"), "{}", error(&output));
    let stopped = json(&progress.join("stopped.json"));
    let listed = figures(&droptower(folder, &["store", "list", "--json"]));
    assert_eq!(stopped["stopped"], true);
    assert_eq!(stopped["runs"], listed[0]["evaluations"], "every run that had begun has ended");
    let rows = read(&progress.join("table.csv")).lines().count() as u64 - 1;
    assert_eq!(Some(rows), stopped["runs"].as_u64());
    let page = read(&progress.join("progress.html"));
    for part in [": stopped</h1>", "data-lives=\"false\"", "<pre>droptower sweep drop.toml -n 100000</pre>"] {
        assert!(page.contains(part), "{part} is not on the page");
    }
    assert!(!folder.join("runs/drop.sweep").exists(), "a part is not stored as the whole");
    printed(&droptower(folder, &["sweep", "drop.toml"]));
    assert_eq!(names(&progress), ["progress.html"], "nothing of the stop is left");
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_says_what_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    printed(&droptower(folder, &["new", "drop", "drop.toml"]));
    let slow = ["run", "drop.toml", "--set", "specimen.mesh.size=5mm", "--set", "specimen.symmetry=none"];
    let left = || fs::read_dir(folder.join("runs/drop.checkpoint")).is_ok_and(|files| files.count() > 0);
    let mut child = start(folder, &[&slow[..], &["--checkpoint-every", "0.5 ms"]].concat());
    wait_for(&mut child, left);
    let output = interrupt(child);
    let told = error(&output);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("drop was stopped before its end") && told.contains("with --resume goes on"), "{told}");
    assert!(left(), "its checkpoints are kept");
}

const SEARCH: &str = include_str!("studies/long-search.rhai");

#[cfg(unix)]
#[test]
fn an_interrupted_search_lets_trials_end_and_leaves_the_best_so_far() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("search.rhai"), SEARCH).expect("a script");
    let scenario = root().join("scenarios/drop/1008.toml").display().to_string();
    let set = ["--set", "specimen.mesh.size=80 mm", "--set", "loading.impact.duration=10 ms"];
    let arguments = [&["script", "search.rhai", "--scenario", &scenario][..], &set].concat();
    let mut child = start(folder, &arguments);
    let progress = folder.join("runs/.progress/search");
    let has_best = || fs::read_to_string(progress.join("progress.html")).is_ok_and(|page| page.contains("Best so far"));
    wait_for(&mut child, has_best);
    let output = interrupt(child);
    let told = error(&output);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert_eq!(told.lines().next(), Some("note: runs/.progress/search/progress.html shows how far it is"), "{told}");
    assert!(told.contains("note: stops once what runs has ended; Ctrl-C again gives it up"), "{told}");
    assert!(told.contains("search.rhai was stopped before its end"), "{told}");
    let stopped = json(&progress.join("stopped.json"));
    let search = &stopped["searches"][0];
    assert_eq!([&stopped["stopped"], &search["title"]], [&Json::from(true), &"drop & film".into()]);
    let counts = ["done", "waiting", "failed"].map(|name| search["trials"][name].as_u64().expect("a count"));
    assert!(counts[0] > 0 && counts[2] == 0, "{search}");
    assert!(search["error"].as_f64().is_some_and(|error| error > 0.0 && error < 1.0), "{search}");
    let page = read(&progress.join("progress.html"));
    for part in
        [": stopped</h1>", "<h2>Best so far</h2>", "drop &amp; film: acceleration", "\"best so far\"", "\"current\""]
    {
        assert!(page.contains(part), "{part} is not on the page");
    }
    assert!(page.contains("<li>begins</li>") && page.contains("drop &amp; film: error"));
    assert!(!folder.join("runs/search").exists(), "a part is not stored as the whole");
    let again = [&arguments[..], &["--stop-after", "300 ms", "--quiet"]].concat();
    assert_eq!(droptower(folder, &again).status.code(), Some(1));
}

#[test]
fn a_script_without_runs_has_no_page() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("sum.rhai"), "measure(\"sum\", 1 + 1);").expect("a script");
    let output = droptower(folder.path(), &["script", "sum.rhai"]);
    assert!(printed(&output).contains("runs/sum: summary.json") && !error(&output).contains("progress.html"));
    assert_eq!(names(&folder.path().join("runs")), ["sum"]);
    // Nor does one that fails by a mistake before its first run.
    fs::write(folder.path().join("none.rhai"), "scenario(\"none.toml\").simulate();").expect("a script");
    assert_eq!(droptower(folder.path(), &["script", "none.rhai"]).status.code(), Some(2));
    assert_eq!(names(&folder.path().join("runs")), ["sum"]);
}
