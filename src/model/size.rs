//! What a run will need of the machine, before anything is allocated.

use std::f64::consts::PI;

use super::{Element, Face, Findings, Model, Shape};

/// Memory that one run may take for its film, bytes. A bound that is the same on every machine: a film
/// finer than this is a mistake in the unit of `specimen.mesh.size`.
const MOST_MEMORY: f64 = 4e9;
/// State, history and forces of one element, bytes.
const PER_ELEMENT: f64 = 700.0;
/// Position, velocity, force and mass of one node, bytes.
const PER_NODE: f64 = 150.0;
/// One kept state: positions of a node, strains of an element, bytes.
const PER_FRAME: f64 = 12.0 + 13.0;

/// Refuses meshes that do not fit into memory and elements larger than the film.
pub fn check(model: &Model, findings: &mut Findings<'_>) {
    let mut total = 0.0;
    for (place, face) in model.faces.iter().enumerate() {
        let own = format!("layer.{place}.mesh.size");
        let path = if findings.is_written(&own) { own } else { "specimen.mesh.size".to_owned() };
        if face.meshing.size > largest_side(&model.specimen.shape) {
            let message = "an element is larger than the film";
            findings.report_with(&path, message, "a bare number is in m");
            return;
        }
        total += elements(model, face);
        let frames = PER_FRAME * model.output.frames as f64;
        let memory = total * (PER_ELEMENT + PER_NODE + frames);
        if memory > MOST_MEMORY {
            let message =
                format!("the mesh is too large for memory: {total:.2e} elements need about {:.0} GB", memory / 1e9);
            let hint = format!("a run may take {} GB; `output.frames` counts too", MOST_MEMORY / 1e9);
            findings.report_with(&path, message, hint);
            return;
        }
    }
}

fn largest_side(shape: &Shape) -> f64 {
    match shape {
        Shape::Rectangle { x, y } => x.max(*y),
        Shape::Circle { radius } => 2.0 * radius,
        Shape::Mesh(_) => f64::INFINITY,
    }
}

/// Elements of one face; an imported mesh has as many as its file.
fn elements(model: &Model, face: &Face) -> f64 {
    let size = face.meshing.size;
    if size <= 0.0 {
        return 0.0;
    }
    let whole = match model.specimen.shape {
        Shape::Rectangle { x, y } => (x / size).ceil() * (y / size).ceil(),
        Shape::Circle { radius } => PI * (radius / size).powi(2),
        Shape::Mesh(_) => 0.0,
    };
    let triangles = if face.meshing.element == Element::Tri3 { 2.0 } else { 1.0 };
    whole * triangles / model.specimen.symmetry.copies()
}
