//! Nodes and elements of a face.

use nalgebra::Point3;

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
    /// Nodes on the edges x-, x+, y-, y+ of the film, each once, ascending in this order.
    pub sides: [Vec<u32>; 4],
    /// Nodes on the mirror planes x = 0 and y = 0; empty without that symmetry.
    pub mirrors: [Vec<u32>; 2],
}
