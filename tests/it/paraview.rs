//! A run as ParaView reads it: the content of the files, and that they are written on request only.

use std::fs;
use std::path::Path;

use nalgebra::Vector3;
use rayon::iter::ParallelIterator;
use roxmltree::Document as Xml;
use vtkio::Vtk;
use vtkio::model::{
    Attribute, Attributes, CellType, Cells, DataSet, IOBuffer, Piece, UnstructuredGridPiece, VertexNumbers,
};

use droptower::model;
use droptower::report::vtu;
use droptower::scenario::{Assignment, Document};
use droptower::signal::csv;
use droptower::simulate::{self, RunOptions};

use crate::workbench::{close, droptower, printed, root};

/// Coarse and short.
const QUICK: [&str; 6] =
    ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=12ms", "--set", "output.frames=4"];

/// Times and files of a `.pvd`.
fn states(folder: &Path, name: &str) -> Vec<(f64, UnstructuredGridPiece)> {
    let text = fs::read_to_string(folder.join(name)).expect("a collection");
    let document = Xml::parse(&text).expect("XML");
    let entries = document.descendants().filter(|node| node.has_tag_name("DataSet"));
    let read = |node: roxmltree::Node| {
        let attribute = |name| node.attribute(name).expect("an attribute");
        (attribute("timestep").parse().expect("a time"), grid(&folder.join(attribute("file"))))
    };
    entries.map(read).collect()
}

fn grid(path: &Path) -> UnstructuredGridPiece {
    // Where nothing is left the piece is empty, which VTK reads and this reader does not.
    if fs::read_to_string(path).expect("a VTU").contains("NumberOfCells=\"0\"") {
        return nothing();
    }
    let DataSet::UnstructuredGrid { pieces, .. } = Vtk::import(path).expect("a VTU").data else { panic!("no grid") };
    let [Piece::Inline(piece)] = &pieces[..] else { panic!("not one piece") };
    (**piece).clone()
}

fn nothing() -> UnstructuredGridPiece {
    let cell_verts = VertexNumbers::XML { connectivity: vec![], offsets: vec![] };
    UnstructuredGridPiece {
        points: IOBuffer::F32(vec![]),
        cells: Cells { cell_verts, types: vec![] },
        data: Attributes::new(),
    }
}

/// The numbers of an array.
fn array(of: &[Attribute], name: &str) -> Vec<f64> {
    let found = of.iter().find(|attribute| attribute.name() == name).unwrap_or_else(|| panic!("no {name}"));
    let Attribute::DataArray(array) = found else { panic!("{name} is no array") };
    array.data.cast_into().expect("numbers")
}

fn points(grid: &UnstructuredGridPiece) -> Vec<Vector3<f64>> {
    let numbers: Vec<f64> = grid.points.cast_into().expect("points");
    numbers.chunks(3).map(Vector3::from_column_slice).collect()
}

/// How far the points reach along an axis, in one sense.
fn farthest(grid: &UnstructuredGridPiece, axis: usize, sense: f64) -> f64 {
    points(grid).iter().map(|point| sense * point[axis]).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn the_series_of_a_drop_agree_with_its_signals() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/drop/1008.toml").display().to_string();
    let arguments = [&["run", &scenario, "--vtu", "--out", "results"][..], &QUICK].concat();
    printed(&droptower(folder.path(), &arguments));
    // What was written is ours: it is replaced by the next run, with or without it.
    printed(&droptower(folder.path(), &arguments));
    let results = folder.path().join("results");
    let (film, body) = (states(&results, "film.pvd"), states(&results, "impactor.pvd"));
    let times = |series: &[(f64, UnstructuredGridPiece)]| series.iter().map(|(time, _)| *time).collect::<Vec<_>>();
    assert_eq!(film.len(), 4);
    assert_eq!(times(&film), times(&body));
    let signals = csv::read(&results.join("signals.csv")).expect("signals");
    for ((time, film), (_, body)) in film.iter().zip(&body) {
        let cells = |name: &str| array(&film.data.cell, name);
        // A quarter of 4 x 4 elements on each of two faces, and three mirror images.
        assert_eq!(film.cells.num_cells(), 2 * 4 * 16);
        let (image, face, element) = (cells("image"), cells("face"), cells("element"));
        let strain = ["strain_md", "strain_td", "shear_angle_rad"].map(cells);
        for cell in 0..image.len() {
            let own = (0..image.len()).find(|o| [image[*o], face[*o], element[*o]] == [0.0, face[cell], element[cell]]);
            let own = own.expect("what was computed");
            assert_eq!([strain[0][cell], strain[1][cell]], [strain[0][own], strain[1][own]]);
            let sense = if [1.0, 2.0].contains(&image[cell]) { -1.0 } else { 1.0 };
            assert_eq!(strain[2][cell], sense * strain[2][own]);
        }
        // Eight layers of 12 µm.
        for part in ["md", "td", "shear"] {
            let (stress, resultant) = (cells(&format!("stress_{part}_Pa")), cells(&format!("resultant_{part}_N_m")));
            stress.iter().zip(resultant).for_each(|(s, n)| assert!((n - s * 96e-6).abs() <= 1e-6 * n.abs()));
        }
        assert!(film.data.cell.iter().all(|a| a.name() != "thickness_m"), "a fabric has no thickness");
        // The mirror images close the film: its extent is that of the frame.
        for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
            close(farthest(film, axis, sign), 0.2, 1e-6);
        }
        let value = |name: &str| signals.series(name).expect("a channel").value_at(*time);
        if let (Some(largest), Some(travel)) = (value("max_strain_md"), value("displacement_m")) {
            let most = strain[0].iter().copied().fold(0.0, f64::max);
            assert!((most - largest).abs() < 2e-3, "{most} at {time} s, {largest} in the signals");
            let lowest = -farthest(body, 2, -1.0);
            assert!((lowest - travel).abs() < 1e-3, "{lowest} at {time} s, {travel} in the signals");
        }
    }
    let displacement = |state: usize| array(&film[state].1.data.point, "displacement_m");
    assert!(displacement(0).iter().all(|d| *d == 0.0));
    let [first, last] = [0, 3].map(|state: usize| points(&film[state].1));
    let moved = displacement(3);
    assert_eq!((first.len(), moved.len()), (last.len(), 3 * last.len()));
    let mut places = first.iter().zip(moved.chunks(3)).zip(&last);
    assert!(places.all(|((first, moved), last)| (first + Vector3::from_column_slice(moved) - last).amax() < 1e-6));
    assert!(array(&film[3].1.data.point, "touching").contains(&1.0));
}

#[test]
fn failed_elements_are_left_out_and_series_written_on_request_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/stretch/md-0.2.toml").display().to_string();
    let run = |more: &[&str]| {
        let arguments = ["run", &scenario, "--set", "output.frames=8", "--force"];
        printed(&droptower(folder.path(), &[&arguments[..], &["--out", "results"], more].concat()));
    };
    let results = folder.path().join("results");
    run(&["--vtu", "--set", "loading.stretch.until=1.45"]);
    let film = states(&results, "film.pvd");
    let last = &film.last().expect("a state").1.data.cell;
    assert_eq!((array(last, "layers_left_md"), array(last, "layers_left_td")), (vec![0.0], vec![1.0]));

    // Oblique fibres are strained alike, so that both sets break.
    let fibres = |key: &str| format!("specimen.material.fabric.{key}={{ curve = [[0.3, 8e6]] }}");
    let (md, td) = (fibres("md"), fibres("td"));
    let oblique = ["--vtu", "--set", "loading.stretch.direction=45 deg", "--set", "loading.stretch.until=0.6"];
    run(&[&oblique[..], &["--set", &md, "--set", &td]].concat());
    let film = states(&results, "film.pvd");
    let cells: Vec<usize> = film.iter().map(|(_, grid)| grid.cells.num_cells()).collect();
    assert_eq!(cells, [1, 1, 1, 1, 1, 1, 1, 0]);
    assert!(!results.join("impactor.pvd").exists(), "nothing hits a coupon");
    run(&["--set", "loading.stretch.until=1.45"]);
    assert!(!results.join("film.pvd").exists() && !results.join("vtu").exists());
}

/// Bars around a square: they reach beyond it by their radius, and the ball is a series of its own.
#[test]
fn the_bars_of_a_frame_have_a_series() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "specimen.shape.rectangle = [0.2, 0.2]
         specimen.mesh = { element = \"quad4\", size = 0.02 }
         specimen.material = { density = 915, thickness = 20e-6, elastic = { young = 1e6, poisson = 0.3 } }
         layers.prestrain = { md = 0.02, td = 0.02 }
         frame.bars = { radius = 0.01, friction = 0.2 }
         impactor = { shape.sphere.radius = 0.02, mass = 0.1, friction = 0.0 }
         loading.impact = { velocity = 1, duration = 0.002 }
         output = { frames = 2, filter = \"none\" }";
    fs::write(folder.path().join("bars.toml"), text).expect("a file");
    printed(&droptower(folder.path(), &["run", "bars.toml", "--vtu", "--out", "results"]));
    // All series are ours: they are replaced by the next run.
    printed(&droptower(folder.path(), &["run", "bars.toml", "--vtu", "--out", "results"]));
    let series = |name: &str| states(&folder.path().join("results"), name);
    let (ball, bars) = (series("impactor.pvd"), series("frame.pvd"));
    assert_eq!((ball.len(), bars.len()), (2, 2));
    close(farthest(&ball[0].1, 0, 1.0), 0.02, 1e-3);
    close(farthest(&bars[0].1, 0, 1.0), 0.11, 1e-3);
    assert!(ball[0].1.data.cell.is_empty(), "one body has no number");
}

/// A coarse trampoline for a short time.
const BED: [&str; 6] =
    ["--set", "specimen.mesh.size=200mm", "--set", "loading.impact.duration=40ms", "--set", "output.frames=5"];

#[test]
fn springs_are_lines_that_follow_the_film() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/trampoline/bed.toml").display().to_string();
    printed(&droptower(folder.path(), &[&["run", &scenario, "--vtu", "--out", "results"][..], &BED].concat()));
    let results = folder.path().join("results");
    let (film, springs) = (states(&results, "film.pvd"), states(&results, "springs.pvd"));
    let signals = csv::read(&results.join("signals.csv")).expect("signals");
    assert_eq!((film.len(), springs.len()), (5, 5));
    let first = points(&springs[0].1);
    let mut compared = 0;
    for (time, lines) in &springs {
        let cells = |name: &str| array(&lines.data.cell, name);
        assert_eq!(lines.cells.types, [CellType::Line; 80], "a quarter has 20, and three mirror images");
        assert_eq!(cells("image").iter().filter(|image| **image == 3.0).count(), 20);
        assert_eq!(cells("face"), vec![1.0; 80]);
        let ends = points(lines);
        let (elongation, force) = (cells("elongation_m"), cells("force_N"));
        let mut downwards = 0.0;
        for line in 0..80 {
            let (frame, end) = (ends[2 * line], ends[2 * line + 1]);
            assert_eq!(frame, first[2 * line], "the frame stands still");
            // 210 mm at 78 N, so 180 mm without force.
            close((frame - end).norm() - elongation[line], 0.18, 1e-6);
            downwards -= force[line] * (end - frame).z / (end - frame).norm();
        }
        for (force, elongation) in force.iter().zip(&elongation) {
            let expected = (2600.0 * elongation).max(0.0);
            assert!((force - expected).abs() < 0.05, "{force} N for {expected} N at {time} s");
        }
        let value = |name: &str| signals.series(name).expect("a channel").value_at(*time);
        for (name, found) in [
            ("spring_elongation_m", elongation.iter().copied().fold(0.0, f64::max)),
            ("spring_force_N", force.iter().copied().fold(0.0, f64::max)),
            ("frame_force_N", downwards),
        ] {
            // The last state may be after the last sample.
            let Some(expected) = value(name) else { continue };
            compared += 1;
            let apart = (found - expected).abs();
            assert!(apart < 1e-4 * expected.abs() + 1e-5, "{name}: {found} for {expected} at {time} s");
        }
    }
    assert!(compared >= 3 * 4, "{compared} figures");
}

/// A tetrahedron whose tip points down, m.
const TIP: &str = "solid tip
facet normal 0 0 0\nouter loop\nvertex 0 0 -0.1\nvertex 0 0.1 0.1\nvertex 0.1 -0.1 0.1\nendloop\nendfacet
facet normal 0 0 0\nouter loop\nvertex 0 0 -0.1\nvertex -0.1 -0.1 0.1\nvertex 0 0.1 0.1\nendloop\nendfacet
facet normal 0 0 0\nouter loop\nvertex 0 0 -0.1\nvertex 0.1 -0.1 0.1\nvertex -0.1 -0.1 0.1\nendloop\nendfacet
facet normal 0 0 0\nouter loop\nvertex 0 0.1 0.1\nvertex -0.1 -0.1 0.1\nvertex 0.1 -0.1 0.1\nendloop\nendfacet
endsolid tip
";

#[test]
fn an_impactor_is_written_though_its_file_was_deleted() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tip.stl");
    fs::write(&path, TIP).expect("a file");
    let shape = format!("impactor.shape={{ mesh = '{}' }}", path.display());
    let changes = [&shape, "specimen.symmetry=none", "specimen.mesh.size=50mm", "loading.impact.duration=2ms"];
    let changes = changes.map(|change| Assignment::from_argument(change).expect("a change"));
    let document = Document::read(&root().join("scenarios/drop/1008.toml")).expect("a scenario").with(&changes);
    let model = model::check(&document).expect("a model");
    let options = RunOptions { detailed: true, ..RunOptions::default() };
    let outcome = simulate::run_with(&model, options, &mut |_| {}).expect("an outcome");
    fs::remove_file(&path).expect("the file was there");

    let files: Vec<vtu::File> = vtu::files(&model, &outcome).collect::<Result<_, _>>().expect("all files");
    let shown = files.iter().find(|file| file.name == "vtu/impactor_0000.vtu").expect("the impactor");
    let place = folder.path().join("impactor.vtu");
    fs::write(&place, &shown.content).expect("a file");
    assert_eq!(grid(&place).cells.num_cells(), 4);
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    let mut sorted = names.clone();
    sorted.sort_unstable_by_key(|name| (name.contains("impactor"), name.ends_with(".pvd"), name.to_string()));
    assert_eq!(names, sorted, "however many threads wrote them");
}
