//! Topology of the films of a run.

use serde::{Deserialize, Serialize};

use crate::mesh::Quality;

/// Topology of one face, for pictures of it; it is serialized without its elements and edges.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Film {
    /// Number of nodes.
    pub nodes: usize,
    /// Corners of the quadrilaterals, counted among the nodes of the face.
    #[serde(skip)]
    pub quads: Vec<[u32; 4]>,
    /// Corners of the triangles.
    #[serde(skip)]
    pub tris: Vec<[u32; 3]>,
    /// Edges by which the frame or the jaws hold it, as pairs of nodes.
    #[serde(skip)]
    pub held: Vec<[u32; 2]>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Shape of its elements.
    pub quality: Quality,
}

impl Film {
    /// Corners of the elements, quadrilaterals and then triangles; a triangle has its last one twice.
    pub fn outlines(&self) -> impl Iterator<Item = [u32; 4]> {
        self.quads.iter().copied().chain(self.tris.iter().map(|&[a, b, c]| [a, b, c, c]))
    }
}
