//! Shipped files: every scenario and material checks, every scenario starts.

use std::fs;
use std::path::{Path, PathBuf};

use droptower::diagnostic::{Diagnostic, render};
use droptower::model::loading::Test;
use droptower::model::{self, Model};
use droptower::post::{Plan, Results};
use droptower::scenario::{Assignment, Document};
use droptower::simulate;
use droptower::units::DIMENSIONS;

fn files(pattern: &str) -> Vec<PathBuf> {
    let root = env!("CARGO_MANIFEST_DIR");
    let paths = glob::glob(&format!("{root}/{pattern}")).expect("a good pattern");
    let paths: Vec<PathBuf> = paths.map(|path| path.expect("a readable folder")).collect();
    assert!(!paths.is_empty(), "nothing at {pattern}");
    paths
}

/// The value, or a panic that shows the mistakes in `path`.
fn sound<T>(path: &Path, result: Result<T, Vec<Diagnostic>>) -> T {
    result.unwrap_or_else(|mistakes| panic!("{}\n{}", path.display(), render(&mistakes, false)))
}

fn read(path: &Path) -> Document {
    sound(path, Document::read(path))
}

/// All shipped scenarios; the other files are materials.
fn scenarios() -> Vec<(PathBuf, Document)> {
    let documents = files("scenarios/**/*.toml").into_iter().map(|path| (path.clone(), read(&path)));
    documents.filter(|(_, document)| !document.is_material()).collect()
}

#[test]
fn materials_check() {
    let materials = files("scenarios/**/*.toml").into_iter().filter(|path| read(path).is_material());
    let checked =
        materials.map(|path| sound(&path, Document::read_material(&path).and_then(|m| model::check_material(&m))));
    assert!(checked.count() >= 2);
}

#[test]
fn scenarios_and_their_resolved_copies_check() {
    let folder = tempfile::tempdir().expect("a folder");
    let resolved = folder.path().join("scenario.toml");
    for (path, document) in scenarios() {
        let model = sound(&path, model::check(&document));
        fs::write(&resolved, document.resolved()).expect("writable");
        let again = sound(&path, model::check(&read(&resolved)));
        assert_eq!(without_folder(again), without_folder(model), "{}", path.display());
    }
}

/// The model without what depends on the folder of its file.
fn without_folder(mut model: Model) -> Model {
    model.name.clear();
    let reference = model.reference.iter_mut().flat_map(|reference| {
        reference.signals.iter_mut().chain(reference.field.iter_mut().flat_map(|field| &mut field.files))
    });
    for path in model.post.iter_mut().chain(reference) {
        *path = fs::canonicalize(&path).expect("a file");
    }
    model
}

/// A few samples on a coarse mesh.
fn shortened(document: &Document, path: &Path) -> Model {
    let model = sound(path, model::check(document));
    let changes: &[&str] = match model.loading.test() {
        Test::Impact => &["specimen.mesh.size=40mm", "loading.impact.duration=3ms", "output.frames=2"],
        Test::Stretch => &["loading.stretch.until=0.03", "output.frames=2"],
        Test::Indent { .. } => &["specimen.mesh.size=5mm", "loading.indent.depth=8mm", "output.frames=2"],
        Test::Inflation => &["specimen.mesh.size=15mm", "output.frames=2"],
    };
    let changes: Vec<Assignment> =
        changes.iter().map(|change| sound(path, Assignment::from_argument(change))).collect();
    sound(path, model::check(&document.with(&changes)))
}

fn run(model: &Model) -> Results {
    let message = |error: &dyn std::fmt::Display| format!("{}: {error}", model.name);
    let plan = Plan::prepare(model).unwrap_or_else(|error| panic!("{}", message(&error)));
    let outcome = simulate::run(model, &mut |_| {}).unwrap_or_else(|error| panic!("{}", message(&error)));
    assert!(outcome.energy_balance_error < 0.01, "{}: balance {}", model.name, outcome.energy_balance_error);
    plan.evaluate(model, &outcome).unwrap_or_else(|error| panic!("{}", message(&error)))
}

#[test]
fn scenarios_start() {
    for (path, document) in scenarios() {
        let signals = run(&shortened(&document, &path)).signals;
        assert!(signals.time.len() >= 10, "{}: {} samples", path.display(), signals.time.len());
        for channel in &signals.channels {
            assert!(channel.values.iter().all(|v| v.is_finite()), "{}: {}", path.display(), channel.name);
        }
    }
}

#[test]
fn post_scripts_add_figures() {
    let path = files("scenarios/drop/tower.toml").remove(0);
    for script in files("scripts/post/*.rhai") {
        let model = Model { post: Some(script.clone()), ..shortened(&read(&path), &path) };
        assert!(!run(&model).script_output.measures.is_empty(), "{} adds nothing", script.display());
    }
}

fn texts(value: &toml::Value, found: &mut Vec<String>) {
    match value {
        toml::Value::String(text) => found.push(text.clone()),
        toml::Value::Array(items) => items.iter().for_each(|item| texts(item, found)),
        toml::Value::Table(table) => table.values().for_each(|item| texts(item, found)),
        _ => {}
    }
}

#[test]
fn quantities_read_back_as_they_are_shown() {
    let mut found = Vec::new();
    for path in files("scenarios/**/*.toml") {
        let text = fs::read_to_string(&path).expect("a text file");
        texts(&toml::from_str(&text).expect("TOML"), &mut found);
    }
    let quantities = found.iter().filter_map(|text| {
        let dimension = DIMENSIONS.iter().find(|dimension| dimension.parse(text).is_ok())?;
        Some((text, dimension, dimension.parse(text).ok()?))
    });
    let mut read = 0;
    for (text, dimension, value) in quantities {
        let shown = dimension.show(value);
        assert_eq!(dimension.parse(&shown), Ok(value), "{text} is shown as {shown}");
        read += 1;
    }
    assert!(read >= 50, "only {read} quantities in the scenarios");
}
