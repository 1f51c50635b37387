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
    /// Springs of the frame on which it hangs.
    #[serde(skip)]
    pub springs: Vec<FilmSpring>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Shape of its elements.
    pub quality: Quality,
}

/// A spring between the frame and the edge of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSpring {
    /// Its end on the frame, m.
    pub anchor: [f32; 3],
    /// Nodes between which its other end is, counted among those of the face.
    pub nodes: [u32; 2],
    /// Their weights.
    pub shares: [f32; 2],
}

impl FilmSpring {
    /// Its end on the film, from the positions of the nodes of the face (m).
    pub fn end(&self, positions: &[[f32; 3]]) -> [f32; 3] {
        let [from, to] = self.nodes.map(|node| positions[node as usize]);
        [0, 1, 2].map(|axis| self.shares[0] * from[axis] + self.shares[1] * to[axis])
    }
}

impl Film {
    /// Corners of the elements, quadrilaterals and then triangles; a triangle has its last one twice.
    pub fn outlines(&self) -> impl Iterator<Item = [u32; 4]> {
        self.quads.iter().copied().chain(self.tris.iter().map(|&[a, b, c]| [a, b, c, c]))
    }
}
