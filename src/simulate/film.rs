//! Topology of the films of a run.

use crate::mesh::Quality;

/// Topology of one face, for pictures of it.
#[derive(Clone, Debug)]
pub struct Film {
    /// Number of nodes.
    pub nodes: usize,
    /// Corners of the quadrilaterals, counted among the nodes of the face.
    pub quads: Vec<[u32; 4]>,
    /// Corners of the triangles.
    pub tris: Vec<[u32; 3]>,
    /// Edges by which the frame or the jaws hold it, as pairs of nodes.
    pub held: Vec<[u32; 2]>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Shape of its elements.
    pub quality: Quality,
}
