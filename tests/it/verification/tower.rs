//! Scenarios, shipped or changed, and their results.

use std::path::Path;

use droptower::diagnostic::{self, Diagnostic};
use droptower::finding::Report;
use droptower::model::{self, Model};
use droptower::post::{Impact, Measures, Plan};
use droptower::scenario::{Assignment, Document};
use droptower::signal::Recording;
use droptower::simulate::{self, Outcome};

/// The model of a file under `scenarios/`, with changes written as for `--set`.
pub fn shipped(name: &str, changes: &[&str]) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name);
    let changes: Vec<Assignment> = changes.iter().map(|c| checked(Assignment::from_argument(c))).collect();
    let document = checked(Document::read(&path)).with(&changes);
    let mut model = checked(model::check(&document));
    model.post = None;
    model
}

/// The model of a scenario written in a test.
pub fn written(text: &str) -> Model {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scenario.toml");
    std::fs::write(&path, text).expect("a file");
    checked(model::check(&checked(Document::read(&path))))
}

/// What was read; a test with mistakes in its scenario fails by their messages.
pub fn checked<T>(read: Result<T, Vec<Diagnostic>>) -> T {
    read.unwrap_or_else(|mistakes| panic!("{}", diagnostic::render(&mistakes, false)))
}

/// Test 1008 until just after the lowest point, with changes.
pub fn loading_of_1008(changes: &[&str]) -> Model {
    shipped("drop/1008.toml", &[&["loading.impact.duration=62ms"], changes].concat())
}

/// Runs `model` to its end.
pub fn run(model: &Model) -> Outcome {
    simulate::run(model, &mut |_| {}).unwrap_or_else(|error| panic!("{}: {error}", model.name))
}

/// Runs an impact and measures it.
pub fn impact(model: &Model) -> Impact {
    measured(model, &run(model))
}

/// The measures of an impact that has run.
pub fn measured(model: &Model, outcome: &Outcome) -> Impact {
    // Without its recording, whose reduction takes longer than a coarse run.
    let model = &Model { reference: None, ..model.clone() };
    let plan = Plan::prepare(model).expect("a plan");
    match plan.measure(model, outcome).expect("measures").measures {
        Measures::Impact(impact) => impact,
        _ => panic!("{} is no impact", model.name),
    }
}

/// Peak displacement (m) and peak filtered acceleration (m/s²).
pub fn peaks(impact: &Impact) -> [f64; 2] {
    let of = |value: Option<f64>| value.expect("a peak");
    [of(impact.first().peak_displacement_m), of(impact.first().peak_acceleration_m_s2)]
}

/// Codes of the warnings of a run.
pub fn codes(outcome: &Outcome) -> Vec<&str> {
    outcome.warnings.iter().map(|warning| warning.code().name).collect()
}

/// A channel that is there.
pub fn channel<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    recording.channel(name).unwrap_or_else(|| panic!("no channel {name}"))
}

/// Its value at the end.
pub fn last(recording: &Recording, name: &str) -> f64 {
    *channel(recording, name).last().expect("a sample")
}

/// Largest absolute value.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// Largest difference of two channels over the largest value of the second.
pub fn off(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).fold(0.0_f64, |most, (x, y)| most.max((x - y).abs())) / largest(other)
}

/// Root mean square of the difference of two channels over that of the first.
pub fn apart(one: &[f64], other: &[f64]) -> f64 {
    let square: f64 = one.iter().map(|value| value * value).sum();
    (one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / square).sqrt()
}
