//! The scene of a stored run as binary glTF: what is in it.

use std::fs;

use serde_json::Value as Json;

use crate::workbench::{droptower, figures, printed};

/// The JSON of a file.
fn json(file: &[u8]) -> Json {
    let length = u32::from_le_bytes(file[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&file[20..20 + length]).expect("JSON")
}

#[test]
fn a_state_is_written_in_3d() {
    let bench = tempfile::tempdir().expect("a folder");
    printed(&droptower(bench.path(), &["new", "drop", "drop.toml"]));
    let changes = ["--set", "specimen.mesh.size=40mm", "--set", "loading.impact.duration=60ms"];
    printed(&droptower(bench.path(), &[&["run", "drop.toml", "--out", "run"][..], &changes].concat()));
    let draw = |out: &str, more: &[&str]| droptower(bench.path(), &[&["picture", "run", "-o", out], more].concat());
    let told = figures(&draw("a.glb", &["--at", "last", "--json"]));
    let file = fs::read(bench.path().join("a.glb")).expect("a file");
    let found = json(&file);
    assert_eq!(found["asset"]["extras"]["time_s"], told["time_s"]);
    let names: Vec<&str> =
        found["nodes"].as_array().expect("nodes").iter().filter_map(|n| n["name"].as_str()).collect();
    assert!(names.contains(&"film 1") && names.contains(&"body 1"), "{names:?}");
    // The film hangs below its frame: y is up, and the ball is above the film.
    let ends = |node: usize, key: &str| -> Vec<f64> {
        let mesh = found["nodes"][node]["mesh"].as_u64().expect("a mesh") as usize;
        let position = &found["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"];
        let accessor = &found["accessors"][position.as_u64().expect("an accessor") as usize];
        accessor[key].as_array().expect("ends").iter().filter_map(Json::as_f64).collect()
    };
    let body = names.iter().position(|name| *name == "body 1").expect("a body");
    let (low, high) = (ends(0, "min"), ends(0, "max"));
    assert!(low[1] < -0.01 && high[1] < 1e-6, "{low:?} to {high:?}");
    assert!((low[0] + high[0]).abs() < 1e-6 && (low[2] + high[2]).abs() < 1e-6, "mirror images complete the film");
    assert!(ends(body, "max")[1] > high[1]);

    printed(&draw("b.glb", &["--at", "last"]));
    assert_eq!(file, fs::read(bench.path().join("b.glb")).expect("a file"), "the same bytes each time");
}
