//! Scenarios against recorded results: `tests/golden/<case>/{scenario.toml, expected.csv, README.md}`.
//!
//! A table in the README has the tolerance of each channel and its reason. `DROPTOWER_BLESS=1` renews
//! `expected.csv`; a failure leaves a picture of old against new under `target/golden/<case>/`.

mod picture;
mod tolerance;

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use droptower::post::Plan;
use droptower::scenario::Document;
use droptower::signal::{Recording, csv};
use droptower::{diagnostic, model, simulate};

use tolerance::Tolerance;

/// Largest distance of a sample from its recorded time, s.
const TIME: f64 = 1e-9;

#[test]
fn golden_cases_agree_with_their_recordings() {
    let cases = cases();
    assert!(!cases.is_empty(), "no cases in tests/golden");
    let failures: Vec<String> = cases.iter().filter_map(|case| check(case).err()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

fn cases() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut cases: Vec<PathBuf> = entries.filter(|path| path.is_dir()).collect();
    cases.sort();
    cases
}

fn check(case: &Path) -> Result<(), String> {
    let name = case.file_name().unwrap_or_default().to_string_lossy();
    let failed = |what: String| format!("golden case `{name}`: {what}");
    let readme = fs::read_to_string(case.join("README.md"));
    let readme = readme.map_err(|error| failed(format!("README.md: {error}")))?;
    let tolerances = tolerance::table(&readme).map_err(failed)?;
    let actual = simulated(&case.join("scenario.toml")).map_err(failed)?;
    let expected = case.join("expected.csv");
    if std::env::var_os("DROPTOWER_BLESS").is_some_and(|value| value == "1") {
        let file = File::create(&expected).map_err(|error| failed(error.to_string()))?;
        return csv::write(&actual, file).map_err(|error| failed(error.to_string()));
    }
    let expected = csv::read(&expected).map_err(|error| failed(error.to_string()))?;
    let strays = compare(&expected, &actual, &tolerances);
    if strays.is_empty() {
        return Ok(());
    }
    let picture = picture::draw(&name, &expected, &actual).map_err(failed)?;
    let strays = strays.join("\n  ");
    Err(failed(format!(
        "\n  {strays}\n  old against new: {}\n  if the new is right: DROPTOWER_BLESS=1 cargo test --release golden",
        picture.display()
    )))
}

/// The channels of `signals.csv` of a run of `scenario`.
fn simulated(scenario: &Path) -> Result<Recording, String> {
    let rendered = |mistakes: Vec<diagnostic::Diagnostic>| diagnostic::render(&mistakes, false);
    let document = Document::read(scenario).map_err(rendered)?;
    let model = model::check(&document).map_err(rendered)?;
    let plan = Plan::prepare(&model).map_err(|error| error.to_string())?;
    let outcome = simulate::run(&model, &mut |_| {}).map_err(|error| error.to_string())?;
    let results = plan.measure(&model, &outcome);
    Ok(results.map_err(|error| error.to_string())?.signals)
}

/// What strays, one line each.
fn compare(expected: &Recording, actual: &Recording, tolerances: &[Tolerance]) -> Vec<String> {
    let names = |recording: &Recording| -> Vec<String> { recording.channels.iter().map(|c| c.name.clone()).collect() };
    if names(expected) != names(actual) {
        let [old, new] = [expected, actual].map(|recording| names(recording).join(", "));
        return vec![format!("channels were {old} and are {new}")];
    }
    let (old, new) = (&expected.time, &actual.time);
    if old.len() != new.len() || old.iter().zip(new).any(|(a, b)| (a - b).abs() > TIME) {
        return vec!["the samples are at other times".to_owned()];
    }
    let strays = expected.channels.iter().zip(&actual.channels);
    let strays = strays.filter_map(|(old, new)| {
        let tolerance = tolerances.iter().find(|t| t.channel == old.name);
        let Some(tolerance) = tolerance else {
            return Some(format!("{}: README.md states no tolerance", old.name));
        };
        tolerance.stray(&expected.time, &old.values, &new.values)
    });
    let known = names(expected);
    let unknown = tolerances.iter().filter(|t| !known.contains(&t.channel));
    let unknown = unknown.map(|t| format!("README.md has a tolerance for no channel `{}`", t.channel));
    strays.chain(unknown).collect()
}
