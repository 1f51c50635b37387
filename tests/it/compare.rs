//! `droptower compare`: several runs compared with the first.

use std::fs;
use std::path::Path;

use serde_json::Value as Json;
use tempfile::TempDir;

use crate::workbench::{close, droptower, error, figures, printed, root};

/// Two drops with eight and nine layers, coarse and short.
fn bench() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |scenario: &str, more: &[&str]| {
        let scenario = root().join("scenarios").join(scenario).display().to_string();
        printed(&droptower(folder.path(), &[&["run", &scenario, "--quiet"], more].concat()));
    };
    let quick = ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=12ms"];
    run("drop/1008.toml", &[&quick[..], &["--out", "runs/drop/eight"]].concat());
    run("drop/1008.toml", &[&quick[..], &["--set", "layers.count=9", "--out", "runs/drop/nine"]].concat());
    folder
}

fn json(path: &Path) -> Json {
    serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON")
}

#[test]
fn runs_are_compared_with_the_first() {
    let bench = bench();
    let compare =
        |more: &[&str]| droptower(bench.path(), &[&["compare", "runs/drop/eight", "runs/drop/nine"], more].concat());
    let text = printed(&compare(&[]));
    let has = |start: &str, parts: &[&str]| {
        let line =
            text.lines().find(|line| line.trim().starts_with(start)).unwrap_or_else(|| panic!("no {start}: {text}"));
        assert!(parts.iter().all(|part| line.contains(part)), "{line}");
    };
    has("scenario", &["eight", "nine"]);
    has("layers.count", &["8", "9"]);
    has("ruptured", &["no"]);
    has("displacement (m)", &[" %"]);
    assert!(!text.contains("wall"), "cost is no result: {text}");
    assert!(printed(&compare(&["--all"])).contains("wall (s)"));

    // The printed figures, the stored ones and the two summaries agree.
    let folder = bench.path().join("runs/compare");
    let summary = json(&folder.join("summary.json"));
    assert_eq!(figures(&compare(&["--json"])), summary);
    let of = |name: &str| json(&bench.path().join("runs/drop").join(name).join("summary.json"));
    let peaks = ["eight", "nine"].map(|name| of(name)["peak_acceleration_m_s2"].as_f64().expect("a peak"));
    let found = &summary["figures"]["peak_acceleration_m_s2"];
    assert_eq!(found["values"], serde_json::json!(peaks));
    close(found["differences"][1].as_f64().expect("a difference"), peaks[1] / peaks[0] - 1.0, 1e-12);
    assert_eq!(summary["keys"], serde_json::json!({ "layers.count": ["8", "9"] }));
    assert!(summary["errors"]["displacement_m"][1].as_f64().is_some_and(|error| error > 0.0 && error < 0.1));
    let page = fs::read_to_string(folder.join("report.html")).expect("a page");
    assert!(
        page.contains("<h3>Acceleration filtered</h3>")
            && page.contains("<td title=\"layers.count\">Layers per face</td>")
    );
    let place = |what: &str| page.find(what).unwrap_or_else(|| panic!("the page has no {what}"));
    assert!(place("<p class=\"lead\">nine against eight: ") < place("nine against eight</h3>"));
    assert!(place("nine against eight</h3>") < place("<h2>Scenarios</h2>"), "differences come first");
    assert!(!folder.join("recording.rrd").exists(), "only runs have one");

    // Those of other runs are not replaced unasked.
    let swapped = ["compare", "runs/drop/nine", "runs/drop/eight"];
    let refused = droptower(bench.path(), &swapped);
    assert_eq!(refused.status.code(), Some(2), "{}", error(&refused));
    assert!(error(&refused).contains("eight and 1 more and is not replaced"), "{}", error(&refused));
    assert_eq!(json(&folder.join("summary.json")), summary);
    printed(&droptower(bench.path(), &[&swapped[..], &["--force"]].concat()));

    // One signal alone.
    let alone = figures(&compare(&["--json", "--signal", "velocity_m_s", "--force"]));
    assert_eq!(alone["errors"].as_object().expect("errors").keys().collect::<Vec<_>>(), ["velocity_m_s"]);
}

#[test]
fn a_failed_run_is_a_warning_and_one_without_samples_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    printed(&droptower(folder.path(), &["new", "drop", "drop.toml"]));
    let run = |more: &[&str]| {
        let quick = ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=40ms", "--quiet"];
        droptower(folder.path(), &[&["run", "drop.toml"], &quick[..], more].concat())
    };
    printed(&run(&["--out", "runs/whole"]));
    // Fibres that become stiff at 30 % make the stable step collapse.
    let wall = "specimen.material.fabric.md={yield=[[0.2,'5 MPa'],[0.3,'6 MPa']],break=[0.31,1e15]}";
    let failed =
        run(&["--out", "runs/stiff", "--set", wall, "--set", "specimen.material.fabric.scale={k1=1,ke=1,ky=1}"]);
    assert_eq!(failed.status.code(), Some(3), "{}", error(&failed));
    let place = folder.path().join("runs/stiff.failed");
    let cause = fs::read_to_string(place.join("failure.txt")).expect("a cause");
    assert!(cause.contains("the time step fell"), "{cause}");

    let compare =
        |more: &[&str]| droptower(folder.path(), &[&["compare", "runs/whole", "runs/stiff.failed"], more].concat());
    let message = format!("stiff.failed failed: {}", cause.trim());
    let text = printed(&compare(&[]));
    assert!(text.contains(&format!("  warning[failed-run]: {message}\n")), "{text}");
    let found = figures(&compare(&["--json"]));
    let expected =
        serde_json::json!({ "code": "failed-run", "severity": "warning", "message": message, "run": "stiff.failed" });
    assert!(found["findings"].as_array().expect("findings").contains(&expected), "{}", found["findings"]);

    // A run that fails in its first step has the header of its signals alone.
    let signals = fs::read_to_string(place.join("signals.csv")).expect("signals");
    let header = signals.lines().next().expect("a header");
    fs::write(place.join("signals.csv"), format!("{header}\n")).expect("a file");
    let output = compare(&["--out", "runs/other"]);
    assert_eq!(output.status.code(), Some(2), "{}", error(&output));
    let expected = "runs/stiff.failed has no samples: the run failed before the first: the time step fell";
    assert!(error(&output).contains(expected), "{}", error(&output));
    assert!(error(&output).contains("run its scenario again once the cause of the failure is removed"));
    assert!(!folder.path().join("runs/other").exists());
}
