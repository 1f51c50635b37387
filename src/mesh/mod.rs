//! The film divided into elements.

pub mod import;
pub mod quality;

mod disc;
mod error;
mod grid;
mod structured;
mod topology;

use nalgebra::Point3;

use crate::model::{Element, Face, Shape, Specimen};

pub use error::MeshError;
pub use quality::Quality;
pub use topology::outer_edges;

/// Nodes and elements of one face, flat or as imported, before any motion.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Positions, m.
    pub nodes: Vec<Point3<f64>>,
    /// Four-node elements, counter-clockwise seen from +z.
    pub quads: Vec<[u32; 4]>,
    /// Three-node elements, counter-clockwise seen from +z.
    pub tris: Vec<[u32; 3]>,
    /// Nodes on the film's own outer edge (not on a mirror plane), each once, ascending.
    pub rim: Vec<u32>,
    /// Nodes on the edges x-, x+, y-, y+ of the film, each once, ascending (indexed by `Side as usize`).
    pub sides: [Vec<u32>; 4],
    /// Nodes on the mirror planes x = 0 and y = 0; empty without that symmetry.
    pub mirrors: [Vec<u32>; 2],
}

/// Divides `face` of `specimen` into elements.
///
/// Rectangles and circles lie in the plane z = 0; imported meshes keep the z of their file. The
/// height of the face is for the caller to add.
pub fn build(specimen: &Specimen, face: &Face) -> Result<Mesh, MeshError> {
    let mirrored = specimen.symmetry.mirrors();
    match &specimen.shape {
        Shape::Rectangle { x, y } => structured::rectangle([*x, *y], mirrored, &face.meshing),
        Shape::Circle { radius } => disc::disc(*radius, mirrored, &face.meshing),
        Shape::Mesh(path) => import::film(path, mirrored, face.meshing.element),
    }
}

/// Elements that one quadrilateral cell becomes.
fn elements_per_cell(element: Element) -> usize {
    match element {
        Element::Quad4 | Element::Quad4Full => 1,
        Element::Tri3 => 2,
    }
}
