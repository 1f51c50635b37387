//! The safety system of scenarios/restraint: its map, its made-up head, and its figures.

use std::fs;

use serde_json::Value as Json;
use thorough::thorough;

use crate::workbench::{close, column, droptower, figure, printed, root, summary};

#[test]
fn the_shipped_head_is_that_of_its_script() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("head");
    printed(&droptower(&root(), &["script", "scripts/make-head.rhai", "--out", out.to_str().expect("UTF-8")]));
    let read = |path| fs::read_to_string(path).expect("a head");
    let numbers = |text: String| -> Vec<f64> { text.split_whitespace().filter_map(|word| word.parse().ok()).collect() };
    let [made, shipped] = [out.join("head.obj"), root().join("scenarios/restraint/head.obj")].map(read).map(numbers);
    assert_eq!(made.len(), shipped.len());
    // Sines may differ in the last digit between machines.
    assert!(made.iter().zip(&shipped).all(|(made, shipped)| (made - shipped).abs() < 2e-3));
}

/// On a mesh of 80 mm, a first look: what is harder to stop, goes further; what is stiffer, brakes harder.
#[test]
fn the_map_finds_layers_and_distance() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("map");
    let mut arguments = vec!["script", "scripts/restraint-map.rhai", "--arg", "part=map", "--arg", "mesh=80"];
    let few = ["--arg", "layers=16, 24, 32", "--arg", "distances=60, 100, 150"];
    let [distances, columns] = if thorough() { [5, 8] } else { [3, 3] };
    if !thorough() {
        arguments.extend(few);
    }
    printed(&droptower(&root(), &[&arguments[..], &["--out", out.to_str().expect("UTF-8")]].concat()));
    let summary = summary(&out);
    let rows = summary["tables"]["map"].as_array().expect("a map");
    assert_eq!(rows.len(), 2 * distances * columns);
    let whole = |pair: &[Json]| pair.iter().all(|row| row["outcome"] != "ruptures");
    for pair in rows.chunks(columns).flat_map(|line| line.windows(2)).filter(|pair| whole(pair)) {
        let [fewer, more] = [&pair[0], &pair[1]];
        assert!(figure(more, "travel_mm") < figure(fewer, "travel_mm"), "{fewer} {more}");
        assert!(figure(more, "hic15") > figure(fewer, "hic15"), "{fewer} {more}");
    }
    let (slow, fast) = rows.split_at(rows.len() / 2);
    assert!(slow.iter().zip(fast).all(|(slow, fast)| figure(slow, "travel_mm") < figure(fast, "travel_mm")));
    let layers = figure(&summary, "layers");
    assert!((16.0..=32.0).contains(&layers), "{layers} layers");
    assert!(out.join("tables/map.csv").is_file());
}

/// (speed in km/h, energy in J) of a head of 4.5 kg: section 3.2 of the study.
#[test]
fn the_head_has_the_energies_of_the_study() {
    let folder = tempfile::tempdir().expect("a folder");
    for (speed, energy) in [(30, 156.3), (50, 434.0)] {
        let out = folder.path().join(format!("head-{speed}"));
        let scenario = format!("scenarios/restraint/head-{speed}.toml");
        let coarse = ["--set", "specimen.mesh.size=80mm", "--set", "output.frames=2"];
        let arguments = [&["run", &scenario, "--out", out.to_str().expect("UTF-8")], &coarse[..]].concat();
        printed(&droptower(&root(), &arguments));
        close(column(&out.join("signals.csv"), "kinetic_energy_J")[0], energy, 1e-3);
        let figures = summary(&out);
        for name in ["hic15", "hic36", "hic_d", "clip_3ms_g", "peak_g", "travel_m", "rebound_share"] {
            assert!(figure(&figures, name) > 0.0, "{name} in {figures}");
        }
    }
}
