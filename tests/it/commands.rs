//! The built binary, for the commands that do not simulate.

use std::fs;
use std::process::Output;

use droptower::scenario::grammar::{self, Rule};
use serde_json::Value as Json;

use crate::workbench;

fn droptower(arguments: &[&str]) -> Output {
    workbench::droptower(&workbench::root(), arguments)
}

fn standard_output(arguments: &[&str]) -> String {
    workbench::printed(&droptower(arguments))
}

#[test]
fn findings_are_printed_with_severity_and_code() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run");
    let out = out.to_str().expect("UTF-8");
    let short = ["--set", "specimen.mesh.size=40mm", "--set", "loading.impact.duration=2ms", "--out", out];
    let drop = ["reduce", "drop", "data/virtual/1509.csv", "--mass", "10.72 kg", "--height", "1.5 m"];
    let cases: [(Vec<&str>, &[&str]); 3] = [
        (
            [&["run", "scenarios/drop/1509.toml"], &short[..]].concat(),
            &["  note[no-laser]: reference: no laser", "  warning[virtual-reference]: reference: VIRTUAL drop test"],
        ),
        (drop.to_vec(), &["  note[no-laser]: no laser", "  warning[virtual-recording]: VIRTUAL drop test"]),
        (vec!["signal", "info", "data/virtual/1509.csv"], &["  warning[virtual-recording]: VIRTUAL drop test"]),
    ];
    for (arguments, expected) in cases {
        let text = standard_output(&arguments);
        for start in expected {
            assert_eq!(text.lines().filter(|line| line.starts_with(start)).count(), 1, "{start}: {text}");
        }
    }
    let summary = workbench::summary(&folder.path().join("run"));
    let codes = workbench::finding_codes(&summary);
    assert!(codes.contains(&"no-laser") && codes.contains(&"virtual-reference"), "{summary}");
    assert!(!summary["warnings"].to_string().contains("no laser"), "a note is no warning: {summary}");
    let page = fs::read_to_string(folder.path().join("run/report.html")).expect("a page");
    let place = |text: &str| page.find(text).unwrap_or_else(|| panic!("no {text}"));
    let (warning, note) = (place("<code>virtual-reference</code>"), place("<code>no-laser</code>"));
    assert!(warning < place("<summary>Notes: ") && place("<summary>Notes: ") < note);
}

#[test]
fn shipped_scenarios_are_plausible() {
    for pattern in ["scenarios/*/*.toml", "tests/golden/*/scenario.toml"] {
        let text = standard_output(&["check", pattern]);
        assert!(text.lines().count() > 2 && !text.contains("implausible"), "{text}");
    }
}

#[test]
fn every_key_has_a_sentence() {
    fn without_sentence(rule: &Rule, name: &str, found: &mut Vec<String>) {
        let table = rule.table().or_else(|| rule.item(0)?.table());
        for key in table.into_iter().flat_map(|table| &table.keys) {
            let name = format!("{name}.{}", key.name);
            if key.sentence.is_none() {
                found.push(name.clone());
            }
            without_sentence(&key.rule, &name, found);
        }
    }
    let mut found = Vec::new();
    without_sentence(grammar::scenario(), "", &mut found);
    assert!(found.is_empty(), "no sentence for {found:?}");
}

#[test]
fn the_schema_allows_no_further_keys_and_requires_none() {
    let schema: Json = serde_json::from_str(&standard_output(&["schema"])).expect("JSON");
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["properties"]["specimen"]["additionalProperties"], false);
    assert_eq!(schema["properties"]["specimen"]["properties"]["mesh"]["properties"]["size"]["x-unit"], "m");
    assert!(!schema.to_string().contains("\"required\""));
}

/// What a scenario hardly means is printed before its run and is a finding of a script; a rebound that says nothing is
/// one of runs that rebound.
#[test]
fn early_findings_are_printed_before_a_run_and_are_those_of_scripts() {
    let folder = tempfile::tempdir().expect("a folder");
    workbench::droptower(folder.path(), &["new", "drop", "drop.toml"]);
    let text =
        "let t = scenario(\"drop.toml\"); t.with(#{ title: \"again\" }); measure(\"duration\", t.model.duration);";
    fs::write(folder.path().join("read.rhai"), text).expect("a script");
    let changes = ["--set", "impactor.friction=5", "--unset", "specimen.material.fabric.absorption"];
    workbench::printed(&workbench::droptower(folder.path(), &[&["script", "read.rhai"][..], &changes].concat()));
    let summary = |run: &str| workbench::summary(&folder.path().join("runs").join(run));
    let read = summary("read");
    assert_eq!(workbench::finding_codes(&read), ["implausible-value", "absorption-not-given"], "each once");
    let quick = ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=2ms"];
    let run = workbench::droptower(folder.path(), &[&["run", "drop.toml"][..], &changes, &quick].concat());
    assert!(workbench::error(&run).contains("warning[implausible-value]: `impactor.friction`"));
    let drop = summary("drop");
    let found = workbench::finding_codes(&drop);
    assert!(found.contains(&"implausible-value"), "{found:?}");
    assert!(!found.contains(&"absorption-not-given"), "no rebound: {found:?}");
}
