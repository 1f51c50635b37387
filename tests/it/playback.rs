//! Recordings of runs, read back: they hold what the engine computed.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use droptower::model;
use droptower::scenario::Document;
use droptower::signal::{Recording, csv};
use droptower::simulate::{self, FilmState, Outcome};
use playback::Playback;
use tempfile::TempDir;
use viz::TIME;

use crate::workbench::{droptower, printed, root};

/// Half the distance of two positions in a recording, m.
const ROUNDED: f32 = 0.5 / 32_768.0;

/// A run of the built binary, and its folder.
fn run(scenario: &str, changes: &[&str]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = root().join(scenario);
    let changes = changes.iter().flat_map(|change| ["--set", change]);
    let arguments = ["run", scenario.to_str().expect("a path"), "--out", "out"].into_iter().chain(changes);
    printed(&droptower(folder.path(), &arguments.collect::<Vec<_>>()));
    let out = folder.path().join("out");
    (folder, out)
}

/// The same run once more, by its own scenario.
fn outcome(out: &Path) -> Outcome {
    let model = Document::read(&out.join("scenario.toml")).and_then(|document| model::check(&document));
    simulate::run(&model.expect("a model"), &mut |_| {}).expect("an outcome")
}

#[test]
fn a_recording_holds_what_the_engine_computed() {
    let changes =
        ["specimen.mesh.size=25mm", "loading.impact.velocity=8", "loading.impact.duration=50ms", "output.frames=30"];
    let (_folder, out) = run("scenarios/drop/1008.toml", &changes);
    let played = Playback::read(&out.join("recording.rrd")).expect("a recording");
    let outcome = outcome(&out);
    assert!(outcome.rupture_time.is_some(), "the film breaks, so that the recording shows it");

    let entities: BTreeSet<&str> = played.entities().collect();
    for entity in ["/scene/impactor", "/scene/frame/face-1", "/events", "/texts/summary", "/texts/scenario"] {
        assert!(entities.contains(entity), "{entity} in {entities:?}");
    }
    assert!(played.blueprint().any(|path| path.ends_with("/EyeControls3D")), "it has a camera");
    for face in 0..outcome.films.len() {
        film_is_the_engines(&played, &outcome, face);
    }
    impactor_is_the_engines(&played, &outcome);
    signals_are_those_of_the_table(&played, &csv::read(&out.join("signals.csv")).expect("signals"));
    assert!(!played.values(TIME, "/measured/displacement_mm").is_empty(), "what was measured lies beside it");
}

/// All snapshots of a face, node by node, with its failed elements and the nodes in contact.
fn film_is_the_engines(played: &Playback, outcome: &Outcome, face: usize) {
    let states: Vec<&FilmState> = outcome.snapshots.iter().map(|snapshot| &snapshot.films[face]).collect();
    let nodes = played.nodes(&format!("/scene/face-{}", face + 1));
    assert_eq!(nodes.len(), states.len());
    for ((at, shown), (snapshot, state)) in nodes.iter().zip(outcome.snapshots.iter().zip(&states)) {
        assert!((*at as f64 * 1e-9 - snapshot.time).abs() < 2e-9);
        let both = shown.iter().flatten().zip(state.positions.iter().flatten());
        assert!(both.clone().count() == 3 * outcome.films[face].nodes);
        assert!(both.into_iter().all(|(shown, computed)| (shown - computed).abs() <= 1.001 * ROUNDED), "{at} ns");
    }
    let triangles = played.triangles(&format!("/scene/face-{}", face + 1));
    let left = |state: &FilmState| 2 * state.failed.iter().filter(|failed| !**failed).count();
    assert_eq!(triangles.first().map(|(_, all)| all.len()), Some(left(states[0])));
    let last = states[states.len() - 1];
    assert_eq!(triangles.last().map(|(_, all)| all.len()), Some(left(last)));

    let touching = played.marks(&format!("/scene/contact/face-{}", face + 1));
    let most = |counts: &mut dyn Iterator<Item = usize>| counts.max();
    let computed = most(&mut states.iter().map(|state| 4 * state.in_contact.len()));
    assert_eq!(most(&mut touching.iter().map(|(_, points)| points.len())), computed, "a quarter is shown whole");
}

/// Each of several impactors is drawn under its name, and so are its signals.
#[test]
fn a_recording_names_several_impactors() {
    let changes = ["impactor.1.at=5ms", "loading.impact.duration=30ms", "output.frames=10"];
    let (_folder, out) = run("tests/golden/two-impactors/scenario.toml", &changes);
    let played = Playback::read(&out.join("recording.rrd")).expect("a recording");
    let outcome = outcome(&out);
    let table = csv::read(&out.join("signals.csv")).expect("signals");
    for (index, name) in ["head", "hand"].into_iter().enumerate() {
        let places = played.places(&format!("/scene/impactors/{name}"));
        assert_eq!(places.len(), outcome.snapshots.len());
        for ((_, place), snapshot) in places.iter().zip(&outcome.snapshots) {
            let (computed, _) = snapshot.impactors[index];
            assert_eq!(place[0], computed.map(|c| c as f32), "{name} at {} s", snapshot.time);
        }
        let drawn = played.values(TIME, &format!("/signals/{name}_contact_force_N"));
        let force = table.channel(&format!("{name}_contact_force_N")).expect("a channel");
        assert_eq!(drawn.len(), force.len());
        assert!(drawn.iter().zip(force).all(|((_, drawn), force)| (drawn - force).abs() <= 1e-6 * force.abs()));
    }
}

fn impactor_is_the_engines(played: &Playback, outcome: &Outcome) {
    let (places, turns) = (played.places("/scene/impactor"), played.rotations("/scene/impactor"));
    assert_eq!([places.len(), turns.len()], [outcome.snapshots.len(); 2]);
    for (((at, place), (_, turn)), snapshot) in places.iter().zip(&turns).zip(&outcome.snapshots) {
        assert!((*at as f64 * 1e-9 - snapshot.time).abs() < 2e-9);
        let (computed, turned) = snapshot.impactors[0];
        assert_eq!((place[0], turn[0]), (computed.map(|c| c as f32), turned.map(|c| c as f32)), "{at} ns");
    }
    let surface = &outcome.impactors[0];
    let shape = played.nodes("/scene/impactor");
    let away = |point: &[f32; 3]| point.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
    assert!(shape[0].1.len() > 500, "it is round");
    assert!(shape[0].1.iter().all(|point| (away(point) - surface.size()).abs() < 1e-6), "a ball");
}

fn signals_are_those_of_the_table(played: &Playback, table: &Recording) {
    for (entity, column, factor) in [
        ("/signals/displacement_mm", "displacement_m", 1e3),
        ("/signals/acceleration_filtered_m_s2", "acceleration_filtered_m_s2", 1.0),
        ("/signals/contact_force_N", "contact_force_N", 1.0),
        ("/signals/total_energy_J", "total_energy_J", 1.0),
        ("/signals/max_strain_md_percent", "max_strain_md", 100.0),
    ] {
        let shown = played.values(TIME, entity);
        let values = table.channel(column).expect(column);
        assert_eq!(shown.len(), values.len(), "{entity}");
        for ((at, shown), (time, value)) in shown.iter().zip(table.time.iter().zip(values)) {
            assert!((*at as f64 * 1e-9 - time).abs() < 2e-9, "{entity}");
            assert!(*shown == f64::from((value * factor) as f32) || value.is_nan(), "{entity} at {time}");
        }
    }
}

/// Of the 4.1 MB of the default run, 1.9 MB are the positions of 882 nodes in 240 snapshots, 0.6 MB its four colours,
/// 0.5 MB the nodes in contact, 0.2 MB normals, 0.6 MB the signals and texts, and 0.3 MB the index of chunks.
#[test]
fn the_default_run_stays_small() {
    let (_folder, out) = run("scenarios/drop/1008.toml", &[]);
    let bytes = fs::metadata(out.join("recording.rrd")).expect("a recording").len();
    assert!(bytes <= 4_200_000, "{bytes} bytes");
}
