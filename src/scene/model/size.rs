//! Memory that a run needs, checked before anything is allocated.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use super::{Face, Model, ModelDiagnostics, Warning};
use crate::mesh::{Element, Outline};
use crate::scenario::Implausible;
use base::number::{grouped, rounded, significant};

/// Most memory of the film of a run, bytes. The bound is the same on every machine: a film finer than this is a mistake
/// in the unit of `specimen.mesh.size`.
const MOST_MEMORY: f64 = 4e9;
/// One sample: about 20 channels as numbers, as text of a CSV, and once more while that is written; bytes.
const PER_SAMPLE: f64 = 20.0 * 8.0 * 3.0;
/// Bytes of one element and its share of the nodes in a binary STL file. Text files have more, so that the estimate is
/// conservative.
const FILE_PER_ELEMENT: f64 = 50.0;
/// Largest mesh file that is read, bytes.
const LONGEST_FILE: f64 = 1e9;
/// Elements of a graded mesh, whose sizes step by factors of two, over the squares of the wanted sizes; at most.
const GRADED: f64 = 2.0;
/// Memory of a snapshot, bytes an element: positions of a node, strains of an element.
pub const SNAPSHOT_BYTES: f64 = 12.0 + 13.0;
/// Further memory of a snapshot with its detail, bytes an element: velocity of a node; stresses, largest strains,
/// layers left, thickness and fibres of an element.
pub const DETAIL_BYTES: f64 = 12.0 + 56.0;
/// Displacement of a node at one time of a recorded motion, bytes.
const MOTION_BYTES: f64 = 12.0;
/// Memory that the snapshots of a run may take, bytes; fewer are taken of a finer mesh.
pub const SNAPSHOT_MEMORY: f64 = 4e8;

/// Refuses runs that do not fit into memory and elements larger than the film.
pub fn check(model: &Model, mistakes: &mut ModelDiagnostics<'_>) {
    files(model, mistakes);
    let (mut total, mut film, mut memory) = (0.0, 0.0, 0.0);
    for (place, face) in model.faces.iter().enumerate() {
        let path = mesh_path(model, place, mistakes);
        if face.meshing.size > largest_side(&model.specimen.shape) {
            let message = "an element is larger than the film";
            mistakes.report_with(&path, message, "a bare number is in m");
            return;
        }
        let elements = elements(model, face);
        total += elements;
        film += elements * per_element(face.meshing.element);
        memory = film + (total * SNAPSHOT_BYTES * model.output.frames as f64).min(SNAPSHOT_MEMORY);
        if memory > MOST_MEMORY {
            let message = format!(
                "the mesh is too large for memory: {} elements need about {} GB",
                grouped(rounded(total, 3) as u64),
                significant(memory * 1e-9, 2)
            );
            let fit = total * (MOST_MEMORY - (memory - film)).max(0.0) / film;
            too_large(&path, message, fit, mistakes);
            return;
        }
    }
    if mistakes.found.0.is_empty() {
        samples(model, memory + motion(model, memory, mistakes), mistakes);
    }
}

/// Reports a mesh that is too large, of whose elements so many `fit`, at the sizes that are implausible where there are any: they are its cause.
fn too_large(path: &str, message: String, fit: f64, mistakes: &mut ModelDiagnostics<'_>) {
    let is_size = |value: &Implausible| value.key.starts_with("specimen.shape.") || value.key.ends_with("mesh.size");
    let sizes: Vec<Implausible> = mistakes.document.implausible().into_iter().filter(is_size).collect();
    let fit = grouped(rounded(fit, 2) as u64);
    let hint = format!("a run may take {} GB: about {fit} such elements", MOST_MEMORY / 1e9);
    if sizes.is_empty() {
        return mistakes.report_with(path, message, hint);
    }
    for size in sizes {
        let key = size.key.clone();
        mistakes.report_with(&key, Warning::Value(size).to_string(), format!("{message}; {hint}"));
    }
}

/// Refuses mesh files that are too large to be read.
fn files(model: &Model, mistakes: &mut ModelDiagnostics<'_>) {
    for mesh in model.meshes() {
        let length = length(mesh.path);
        if length > LONGEST_FILE {
            let message = format!("the mesh file is too long: {:.1} GB", length / 1e9);
            mistakes.report_with(&mesh.key, message, format!("at most {} GB are read", LONGEST_FILE / 1e9));
        }
    }
}

/// Memory of the recorded motion of a face, bytes; refused where it does not fit beside the rest.
fn motion(model: &Model, rest: f64, mistakes: &mut ModelDiagnostics<'_>) -> f64 {
    let Some(motion) = &model.output.motion else { return 0.0 };
    let nodes = model.faces.get(motion.face).map_or(0.0, |face| elements(model, face));
    let memory = motion.times.len() as f64 * nodes * MOTION_BYTES;
    if rest + memory > MOST_MEMORY {
        let message = format!("the film at {} times needs about {:.1} GB of memory", motion.times.len(), memory / 1e9);
        let hint = format!("a run may take {} GB: leave files out", MOST_MEMORY / 1e9);
        mistakes.report_with("reference.field.times", message, hint);
    }
    memory
}

/// Refuses recordings that do not fit into memory beside the `film`, bytes.
fn samples(model: &Model, film: f64, mistakes: &mut ModelDiagnostics<'_>) {
    let samples = model.run_time() * model.output.sample_rate;
    let memory = film + samples * PER_SAMPLE;
    if memory > MOST_MEMORY {
        let message = format!("{samples:.2e} samples and the film need about {:.1} GB of memory", memory / 1e9);
        mistakes.report_with("output.sample_rate", message, format!("a run may take {} GB", MOST_MEMORY / 1e9));
    }
}

/// Key path of the element size of a face.
fn mesh_path(model: &Model, place: usize, mistakes: &ModelDiagnostics<'_>) -> String {
    let own = format!("layer.{place}.mesh.size");
    match model.specimen.shape {
        Outline::Mesh { .. } => "specimen.shape.mesh".to_owned(),
        _ if mistakes.is_written(&own) => own,
        _ => "specimen.mesh.size".to_owned(),
    }
}

/// Bytes of a file; zero where it cannot be read, which is a mistake of its own.
fn length(path: &Path) -> f64 {
    fs::metadata(path).map_or(0.0, |file| file.len() as f64)
}

fn largest_side(shape: &Outline) -> f64 {
    match shape {
        Outline::Rectangle { x, y } => x.max(*y),
        Outline::Circle { radius } => 2.0 * radius,
        Outline::Polygon(polygon) => polygon.extent(),
        Outline::Mesh { .. } => f64::INFINITY,
    }
}

/// Memory that a run takes for one element with its share of the nodes, of contact and of observers, bytes: the
/// resident memory of a million elements with two snapshots over their number, and a little more. The engine's own
/// arrays are two thirds of it.
fn per_element(element: Element) -> f64 {
    match element {
        Element::Quad4 => 500.0,
        Element::Quad4Full => 800.0,
        Element::Tri3 => 350.0,
    }
}

/// Elements of one face; those of an imported mesh are estimated from the length of its file.
fn elements(model: &Model, face: &Face) -> f64 {
    let (size, copies) = (face.meshing.size, model.specimen.symmetry.copies());
    let triangles = if face.meshing.element == Element::Tri3 { 2.0 } else { 1.0 };
    if let (Some(grading), Some(area)) = (&face.meshing.grading, area(&model.specimen.shape)) {
        let is_computed_part = matches!(model.specimen.shape, Outline::Polygon(_));
        let parts = if is_computed_part { 1.0 } else { copies };
        return GRADED * triangles * grading.cells(area, size) / parts;
    }
    let whole = match &model.specimen.shape {
        Outline::Mesh { path, .. } => return length(path) / FILE_PER_ELEMENT,
        _ if size <= 0.0 => return 0.0, // the range was checked before
        Outline::Rectangle { x, y } => (x / size).ceil() * (y / size).ceil(),
        Outline::Circle { radius } => PI * (radius / size).powi(2),
        // Its computed part, of irregular elements.
        Outline::Polygon(polygon) => return 1.5 * triangles * polygon.area() / (size * size),
    };
    whole * triangles / copies
}

fn area(shape: &Outline) -> Option<f64> {
    match shape {
        Outline::Rectangle { x, y } => Some(x * y),
        Outline::Circle { radius } => Some(PI * radius * radius),
        Outline::Polygon(polygon) => Some(polygon.area()),
        Outline::Mesh { .. } => None,
    }
}
