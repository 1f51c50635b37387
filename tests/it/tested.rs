//! `droptower test` and `droptower compare --within` by the built binary.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value as Json;
use tempfile::TempDir;

use crate::workbench::{droptower, error, figures, printed, printed_text, root};

/// A folder with a case of a short drop on a coarse film.
fn case(expectations: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("cases/short drop");
    fs::create_dir_all(&place).expect("a folder");
    let base = root().join("scenarios/drop/1008.toml");
    let text = format!(
        "extends = {base:?}\nunset = [\"reference\", \"post\"]\nspecimen.mesh.size = \"80 mm\"\n\
         loading.impact.duration = \"10 ms\"\n"
    );
    fs::write(place.join("scenario.toml"), text).expect("a scenario");
    fs::write(place.join("expect.toml"), expectations).expect("expectations");
    folder
}

const EXPECTATIONS: &str = r#"
[signals."*"]
relative = 1e-9
[signals.displacement_m]
absolute = "1 nm"
window = ["2 ms", "8 ms"]
[figures]
ruptured = false
peak_displacement_m = { relative = 1e-6, between = ["-60 mm", "-20 mm"] }
[warnings]
must_not = ["energy-balance"]
"#;

fn test(folder: &Path, more: &[&str]) -> Output {
    droptower(folder, &[&["test"], more].concat())
}

/// Verdict and differences of the only case.
fn verdict(output: &Output) -> (bool, Vec<String>) {
    let summary: Json = serde_json::from_slice(&output.stdout).expect("a summary");
    let [case] = &summary["cases"].as_array().expect("cases")[..] else { panic!("{summary}") };
    let codes = case["differences"].as_array().expect("a list").iter();
    let codes = codes.map(|difference| {
        let subject = ["signal", "figure", "finding"].into_iter().find_map(|name| difference[name].as_str());
        format!("{} {}", difference["code"].as_str().expect("a code"), subject.unwrap_or_default())
    });
    (case["passed"].as_bool().expect("a verdict"), codes.collect())
}

#[test]
fn a_run_is_held_against_its_records() {
    let folder = case(EXPECTATIONS);
    let place = folder.path().join("cases/short drop");
    let unrecorded = test(folder.path(), &["--json"]);
    assert_eq!(unrecorded.status.code(), Some(1));
    let expected = ["not-recorded *", "figure-not-recorded peak_displacement_m"].map(String::from).to_vec();
    assert_eq!(verdict(&unrecorded), (false, expected));
    assert_eq!(verdict(&test(folder.path(), &["--bless", "--json"])), (true, vec![]));
    let recorded = fs::read_to_string(place.join("expected.csv")).expect("signals");
    assert!(recorded.starts_with("time_s,displacement_m,"), "{recorded}");
    assert!(fs::read_to_string(place.join("expected.json")).expect("figures").contains("peak_displacement_m"));
    let text = printed(&test(folder.path(), &[]));
    assert!(text.starts_with("1 passed, 0 failed"), "{text}");
    // What is recorded already stays as it is.
    let written = || fs::metadata(place.join("expected.csv")).expect("a file").modified().expect("a time");
    let before = written();
    assert!(printed(&test(folder.path(), &["--bless"])).starts_with("1 passed"));
    assert_eq!(written(), before);
    // Another mass.
    let scenario = place.join("scenario.toml");
    let text = fs::read_to_string(&scenario).expect("a scenario");
    fs::write(&scenario, format!("{text}impactor.mass = \"11 kg\"\n")).expect("a scenario");
    let (passed, codes) = verdict(&test(folder.path(), &["--json"]));
    assert!(!passed && codes.contains(&"signal-differs displacement_m".to_owned()), "{codes:?}");
    assert!(codes.contains(&"figure-differs peak_displacement_m".to_owned()), "{codes:?}");
    let failed = test(folder.path(), &["--junit", "junit.xml"]);
    assert_eq!(failed.status.code(), Some(1));
    assert!(printed_text(&failed).contains("displacement_m is -0.0"), "{}", printed_text(&failed));
    assert!(error(&failed).contains("1 of 1 tests failed"), "{}", error(&failed));
    let page = fs::read_to_string(folder.path().join("runs/test/report.html")).expect("a page");
    assert!(page.contains("cases/short drop") && page.contains("recorded"));
    let hint = "the records are those of these runs";
    let blessed = case("[figures]\nruptured = true");
    assert!(error(&test(blessed.path(), &["--bless"])).contains(hint), "a record does not mend what is declared");
    // Verdicts are replaced, what others wrote is not.
    assert_eq!(test(folder.path(), &["--junit", "junit.xml"]).status.code(), Some(1));
    fs::write(folder.path().join("mine.xml"), "<mine/>").expect("a file");
    let refused = test(folder.path(), &["--junit", "mine.xml"]);
    assert!(refused.status.code() == Some(2) && error(&refused).contains("already exists"), "{}", error(&refused));
    let junit = fs::read_to_string(folder.path().join("junit.xml")).expect("a file");
    assert!(junit.contains("tests=\"1\" failures=\"1\"") && junit.contains("<failure message="), "{junit}");
}

#[test]
fn a_case_may_stand_beside_others() {
    let folder = case(EXPECTATIONS);
    let place = folder.path().join("cases/short drop");
    for [from, to] in [["scenario.toml", "a.test.toml"], ["expect.toml", "a.expect.toml"]] {
        fs::copy(place.join(from), place.join(to)).expect("a file");
    }
    assert!(printed(&test(folder.path(), &["--bless", "--filter", "a.test"])).starts_with("1 passed"));
    assert!(place.join("a.expected.csv").is_file() && !place.join("expected.csv").exists());
    let one = test(folder.path(), &["cases/short drop/a.test.toml"]);
    assert!(printed(&one).starts_with("1 passed"), "{}", error(&one));
    let both = test(folder.path(), &["cases"]);
    assert!(printed_text(&both).contains("1 passed, 1 failed"), "{}", printed_text(&both));
}

#[test]
fn a_page_draws_the_corridor_that_a_signal_leaves() {
    let folder = case("[signals.displacement_m]\ncorridor = \"corridor.csv\"\n[figures]\npeak_displacment_m = 1");
    let corridor = "time_s,lower,upper\n0,-0.001,0.001\n0.01,-0.001,0.001\n";
    fs::write(folder.path().join("cases/short drop/corridor.csv"), corridor).expect("a corridor");
    let output = test(folder.path(), &[]);
    let text = printed_text(&output);
    assert!(text.contains("expected -0.001 to 0.001"), "{text}");
    assert!(text.contains("no figure peak_displacment_m; did you mean peak_displacement_m?"), "{text}");
    let page = fs::read_to_string(folder.path().join("runs/test/report.html")).expect("a page");
    assert!(["new", "lower", "upper"].iter().all(|curve| page.contains(&format!("\"name\":\"{curve}\""))));
}

#[test]
fn a_failed_run_is_a_failed_test() {
    let folder = case("[figures]\nruptured = false");
    let scenario = folder.path().join("cases/short drop/scenario.toml");
    let text = fs::read_to_string(&scenario).expect("a scenario");
    // A film that turns into diamond at 30 % makes the stable step collapse.
    let text = text.replace("10 ms", "60 ms");
    let wall = "specimen.material.fabric.md = { yield = [[0.2, '5 MPa'], [0.3, '6 MPa']], break = [0.31, 1e15] }\n\
                specimen.material.fabric.scale = { k1 = 1, ke = 1, ky = 1 }\n";
    fs::write(&scenario, format!("{text}{wall}")).expect("a scenario");
    let (passed, codes) = verdict(&test(folder.path(), &["--json"]));
    assert!(!passed && codes == ["run-failed "], "{codes:?}");
}

#[test]
fn a_new_test_passes_once_it_is_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().join("mine.toml");
    fs::copy(case("").path().join("cases/short drop/scenario.toml"), &base).expect("a scenario");
    printed(&droptower(folder.path(), &["new", "test", "tests/mine", "--scenario", "mine.toml"]));
    assert!(printed(&test(folder.path(), &["tests", "--bless"])).starts_with("1 passed"));
    assert!(printed(&test(folder.path(), &["tests"])).starts_with("1 passed"));
    assert!(printed(&test(folder.path(), &["tests/mine"])).starts_with("1 passed"));
    printed(&droptower(folder.path(), &["new", "test", "other/mine", "--scenario", "mine.toml"]));
    let elsewhere = test(folder.path(), &["other"]);
    assert_eq!(elsewhere.status.code(), Some(2), "{}", error(&elsewhere));
    assert!(error(&elsewhere).contains("holds the verdicts of the tests in "), "{}", error(&elsewhere));
    assert!(printed(&test(folder.path(), &["other", "--bless", "--force"])).starts_with("1 passed"));
    let again = droptower(folder.path(), &["new", "test", "tests/mine"]);
    assert_eq!(again.status.code(), Some(2), "files are not replaced");
}

#[test]
fn a_comparison_has_a_verdict() {
    let folder = case(EXPECTATIONS);
    let scenario = "cases/short drop/scenario.toml";
    for (out, mass) in [("a", "10 kg"), ("b", "10.00001 kg"), ("c", "12 kg")] {
        let change = format!("impactor.mass={mass}");
        printed(&droptower(folder.path(), &["run", scenario, "--set", &change, "--out", out]));
    }
    let bounds = "[signals.displacement_m]\nrelative = 1e-5\n[figures]\npeak_displacement_m = { relative = 1e-5 }\n";
    fs::write(folder.path().join("tolerances.toml"), bounds).expect("bounds");
    let compare = |runs: &[&str]| {
        droptower(folder.path(), &[&["compare"], runs, &["--within", "tolerances.toml", "--json"]].concat())
    };
    let within = compare(&["a", "b"]);
    assert_eq!(within.status.code(), Some(0), "{}", error(&within));
    assert_eq!(figures(&within)["outside"][0]["differences"].as_array().map(Vec::len), Some(0));
    let outside = compare(&["a", "b", "c", "--force"]);
    assert_eq!(outside.status.code(), Some(1));
    let summary: Json = serde_json::from_slice(&outside.stdout).expect("a summary");
    let codes: Vec<_> = summary["outside"][1]["differences"].as_array().expect("a list").iter().collect();
    assert_eq!(codes.len(), 2, "{summary}");
    assert!(codes[0]["message"].as_str().is_some_and(|message| message.contains("displacement_m is")), "{summary}");
    let page = fs::read_to_string(folder.path().join("runs/compare/report.html")).expect("a page");
    assert!(page.contains("within the bounds"));
}
