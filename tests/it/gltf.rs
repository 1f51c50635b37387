//! The scene of a stored run as binary glTF: what is in it, and which options it has not.

use std::fs;

use serde_json::Value as Json;

use droptower::report::StoredPage;

use crate::workbench::{droptower, error, figures, printed, root};

/// The JSON of a file.
fn json(file: &[u8]) -> Json {
    let length = u32::from_le_bytes(file[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&file[20..20 + length]).expect("JSON")
}

#[test]
fn a_state_is_written_in_3d_and_options_of_flat_pictures_are_refused() {
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
    for (options, expected) in [
        (&["--view", "front"][..], "which has no --view"),
        (&["--dpi", "300"], "which has no --dpi"),
        (&["--plot", "acceleration"], "which has no --plot"),
        (&[], "c.glb already exists"),
    ] {
        fs::write(bench.path().join("c.glb"), "mine").expect("written");
        let refused = draw("c.glb", options);
        assert_eq!(refused.status.code(), Some(2));
        assert!(error(&refused).contains(expected), "{}", error(&refused));
    }
}

/// Both ends of the lines of `springs 1` and the points of `film 1` in a file, with z upwards.
fn springs_and_film(file: &[u8]) -> (Vec<[[f32; 3]; 2]>, Vec<[f32; 3]>) {
    let found = json(file);
    let bytes = &file[20 + u32::from_le_bytes(file[12..16].try_into().expect("four bytes")) as usize + 8..];
    let part = |name: &str| {
        let meshes = found["meshes"].as_array().expect("meshes");
        let mesh = meshes.iter().find(|mesh| mesh["name"] == name).unwrap_or_else(|| panic!("no {name}"));
        &mesh["primitives"][0]
    };
    let points = |part: &Json| -> Vec<[f32; 3]> {
        let accessor = &found["accessors"][part["attributes"]["POSITION"].as_u64().expect("an accessor") as usize];
        let view = &found["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
        let [from, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().expect("a number") as usize);
        let numbers = bytes[from..][..length].chunks(4).map(|part| f32::from_le_bytes(part.try_into().expect("four")));
        numbers.collect::<Vec<f32>>().chunks(3).map(|p| [p[0], -p[2], p[1]]).collect()
    };
    let springs = part("springs 1");
    assert_eq!((&springs["mode"], springs.get("indices")), (&Json::from(1), None), "lines, each of two points");
    (points(springs).chunks(2).map(|ends| [ends[0], ends[1]]).collect(), points(part("film 1")))
}

#[test]
fn springs_of_the_frame_are_lines_that_end_on_the_film() {
    let bench = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/trampoline/bed.toml").display().to_string();
    let changes = ["specimen.mesh.size=200mm", "loading.impact.duration=40ms", "output.frames=4"];
    let changes = changes.iter().flat_map(|change| ["--set", change]);
    printed(&droptower(
        bench.path(),
        &["run", &scenario, "--out", "run"].into_iter().chain(changes).collect::<Vec<_>>(),
    ));
    let draw = |at: &str, more: &[&str]| {
        printed(&droptower(bench.path(), &[&["picture", "run", "--force", "-o", "a.glb", "--at", at], more].concat()));
        springs_and_film(&fs::read(bench.path().join("a.glb")).expect("a file"))
    };
    let page = StoredPage::read(&bench.path().join("run")).expect("a page");
    let scene = page.scene().expect("a film");
    let (first, last) = (draw("first", &[]), draw("last", &[]));
    for ((springs, film), state) in [(&first, &scene.states[0]), (&last, &scene.states[scene.states.len() - 1])] {
        let own: Vec<[[f32; 3]; 2]> = scene.faces[0].spring_lines(&state.films[0]).collect();
        assert_eq!((springs.len(), own.len()), (80, 20), "a quarter is shown whole");
        assert_eq!(springs[..20], own);
        for [frame, end] in springs {
            // The hoop is where the bed of 1.62 m and a spring of 210 mm end, within a chord of the coarse mesh.
            assert!((1.81..1.831).contains(&frame[0].hypot(frame[1])), "{frame:?}");
            let apart =
                |p: &[f32; 3]| ((p[0] - end[0]).powi(2) + (p[1] - end[1]).powi(2) + (p[2] - end[2]).powi(2)).sqrt();
            assert!(film.iter().any(|point| apart(point) < 0.11), "{end:?} is beside no node of the edge");
        }
    }
    let moved = first.0.iter().zip(&last.0).map(|(a, b)| (a[0] == b[0], a[1] != b[1]));
    assert!(moved.into_iter().all(|(is_fixed, has_moved)| is_fixed && has_moved));
    assert_eq!(draw("last", &["--part", "computed"]).0.len(), 20);
}
