//! Runs beside displacement fields: a field that a run made, with noise, missing points and in the axes of a camera, gives back the
//! coefficients of its film and the motion of the camera.

use std::fs;

use droptower::dic::{self, FieldFile, FieldOptions};
use serde_json::Value as Json;

use crate::workbench::{self, close, data, droptower, error, printed, root};

// Its `main` only writes the files.
#[allow(dead_code)]
#[path = "../../examples/virtual_field.rs"]
mod virtual_field;

const COARSE: &str = "specimen.mesh.size=6mm";

fn read(path: &std::path::Path) -> FieldFile {
    dic::read(path, &FieldOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_shipped_field_is_that_of_the_example() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = virtual_field::files("2.5 mm").expect("a run");
    assert_eq!(files.len(), fs::read_dir(data("virtual_field")).expect("a folder").count());
    for (name, content) in files {
        fs::write(folder.path().join(&name), content).expect("writable");
        let [made, shipped] = [folder.path().join(&name), data("virtual_field").join(&name)].map(|path| read(&path));
        assert!(shipped.annotations.is_virtual());
        assert_eq!((made.places.len(), made.missing), (shipped.places.len(), shipped.missing));
        let numbers = |file: &FieldFile| [&file.places[..], &file.displacements].concat().concat();
        // Written to a hundredth of a micrometre.
        let apart = numbers(&made).iter().zip(numbers(&shipped)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 2e-8, "{name}: {apart}");
    }
}

/// On a mesh more than twice as coarse as that of the field.
#[test]
fn coefficients_and_motion_are_found_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| root().join(name).display().to_string();
    let (script, scenario) = (path("scripts/identify-field.rhai"), path("scenarios/inflation/field.toml"));
    let arguments = ["script", &script, "--scenario", &scenario, "--set", COARSE, "--out", "found", "--quiet"];
    printed(&droptower(folder.path(), &arguments));
    let table = fs::read_to_string(folder.path().join("found/tables/coefficients.csv")).expect("a table");
    let mut cells = table.lines().nth(1).expect("a row").split(',').map(|cell| cell.parse::<f64>().expect("a number"));
    let [md, td, rms, evaluations] = std::array::from_fn(|_| cells.next().expect("a cell"));
    let expected = virtual_field::TRUE;
    close(md, expected[0], 0.02);
    close(td, expected[1], 0.02);
    assert!(rms < 1e-4 && evaluations < 40.0, "{table}");

    let scale = |fibre: &str, k1: f64| format!("specimen.material.fabric.{fibre}.scale={{ k1 = {k1} }}");
    let (md, td) = (scale("md", md), scale("td", td));
    let changes = [COARSE, &md, &td, "output.frames=4"].map(|change| ["--set", change]).concat();
    printed(&droptower(folder.path(), &[&["run", &scenario, "--out", "run", "--quiet"][..], &changes].concat()));
    let read = |name: &str| fs::read_to_string(folder.path().join("run").join(name)).expect("a text");
    let summary = workbench::summary(&folder.path().join("run"));
    let field = &summary["field"];
    let three = |key: &str| [0, 1, 2].map(|axis| field[key][axis].as_f64().expect("a number"));
    let back = virtual_field::camera().inverse();
    let found = dic::RigidMotion::new(three("translation_m"), three("rotation_rad"));
    let turned = found.rotation.angle_to(&back.rotation);
    // Where the middle of the film comes to lie.
    let middle = virtual_field::camera().apply([0.0; 3]);
    let moved = found.apply(middle).map(f64::abs).into_iter().fold(0.0, f64::max);
    assert!(turned < 2e-3 && moved < 2e-4, "{turned} rad, {moved} m");
    assert_eq!((&field["points"], &field["compared"]), (&Json::from(881), &Json::from(881)));
    assert_eq!(field["times"].as_array().map(Vec::len), Some(4));
    close(workbench::figure(&summary, "field_rms_m"), rms, 1e-6);
    assert_eq!(workbench::finding_codes(&summary), ["uncoupled-biaxial", "virtual-reference"]);

    let rows = read("field.csv");
    assert_eq!(rows.lines().count(), 882);
    assert!(rows.starts_with("time_s,x_m,y_m,z_m,u_m,v_m,w_m,simulated_u_m,simulated_v_m,simulated_w_m,error_m\n"));
    let page = read("report.html");
    assert_eq!(page.matches("<figure class=\"map\">").count(), 4);
}

#[test]
fn a_field_that_cannot_be_read_stops_before_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/inflation/field.toml").display().to_string();
    let run = |content: &str| {
        fs::write(folder.path().join("field.csv"), content).expect("writable");
        let set = ["--set", "reference.field.files=field.csv", "--set", "reference.field.times=[\"1 s\"]"];
        let output = droptower(folder.path(), &[&["run", &scenario, "--out", "run"][..], &set].concat());
        assert_eq!(output.status.code(), Some(2), "{}", error(&output));
        assert!(!folder.path().join("run").exists());
        error(&output)
    };
    let text = run("X,Y,Z,U,V,W\n1,2,3,4,5,6\n");
    assert!(text.contains("`X` states no unit of length") && text.contains("unit = \"mm\""), "{text}");
    let text = run("X [mm],Y [mm],Z [mm],U [mm],V [mm],W [mm]\n1,2,3,4,5,6\n1,2,3,4,x,6\n");
    assert!(text.contains("expected a number for `V`, found `x`") && text.contains("field.csv:3:9"), "{text}");
    let text = run("x,y,u,v\n1,2,3,4\n");
    assert!(text.contains("two-dimensional correlation are not supported"), "{text}");
}

/// What is not compared is told, and the residuals of a run that ended early are a failure of it.
#[test]
fn points_off_the_film_and_late_files_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/inflation/field.toml").display().to_string();
    let set = [
        "reference.field.align=none",
        "reference.field.times=[\"0.5 s\", \"1 s\", \"1.4 s\", \"9 s\"]",
        "specimen.mesh.size=12mm",
    ];
    let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
    let text = printed(&droptower(folder.path(), &[&["run", &scenario, "--out", "run"][..], &set].concat()));
    assert!(text.contains("field-off-film") && text.contains("0 of 662 points at 3 times"), "{text}");
    let page = fs::read_to_string(folder.path().join("run/report.html")).expect("a page");
    let words = ["The axes of the field are those of the run.", "not compared: 1 outside"];
    assert!(words.iter().all(|words| page.contains(words)), "{page}");
}
