//! All faces as triangles, with their neighbours and edges. A quadrilateral is two triangles on either side of the
//! diagonal from its first to its third corner.

use std::ops::Range;

use nalgebra::Vector3;

use crate::engine::adjacency::{Around, sorted_sides};
use crate::engine::film::Film;
use crate::engine::nodes::Vectors;

/// No triangle or no edge.
pub(super) const NONE: u32 = u32::MAX;

/// The triangles of all faces, numbered face by face.
pub(super) struct Surface {
    /// Nodes of each, counterclockwise from above as mounted.
    pub(super) corners: Vec<[u32; 3]>,
    /// The triangle across the edge that lies opposite to each corner.
    pub(super) across: Vec<[u32; 3]>,
    /// The edge that lies opposite to each corner.
    pub(super) edges_of: Vec<[u32; 3]>,
    /// Nodes of each edge.
    pub(super) edges: Vec<[u32; 2]>,
    /// Whether a triangle belongs to an element that is not deleted.
    pub(super) is_intact: Vec<bool>,
    /// Whether an edge belongs to such a triangle.
    pub(super) is_intact_edge: Vec<bool>,
    /// Triangles of each face.
    pub(super) faces: Vec<Range<u32>>,
    edges_at: Around<u32>,
    /// Triangles of each element, counted from the first of its face.
    elements: Vec<Vec<Range<u32>>>,
}

impl Surface {
    /// Surface of `films`, none of whose elements is deleted.
    pub(super) fn new(films: &[Film]) -> Surface {
        let (mut corners, mut faces, mut elements) = (vec![], vec![], vec![]);
        for film in films {
            let first = corners.len() as u32;
            let mut of_film = vec![];
            film.for_each_intact(|nodes| {
                let from = corners.len() as u32;
                corners.push([nodes[0], nodes[1], nodes[2]]);
                if let [a, _, c, d] = *nodes {
                    // The same diagonal in every quadrilateral and for the whole run: one that follows the shape would
                    // jump.
                    corners.push([a, c, d]);
                }
                of_film.push(from..corners.len() as u32);
            });
            faces.push(first..corners.len() as u32);
            elements.push(of_film);
        }
        let count = films.last().map_or(0, |film| film.nodes.end);
        let is_intact = vec![true; corners.len()];
        let [across, edges_of] = [(); 2].map(|()| vec![[NONE; 3]; corners.len()]);
        let mut surface = Surface {
            corners,
            across,
            edges_of,
            edges: vec![],
            is_intact,
            is_intact_edge: vec![],
            faces,
            edges_at: Around::new(0, vec![]),
            elements,
        };
        surface.connect(count);
        surface
    }

    /// Finds edges and neighbours of all triangles on `count` nodes.
    fn connect(&mut self, count: usize) {
        for of_edge in sorted_sides(&self.corners).chunk_by(|one, other| one.ends == other.ends) {
            let edge = self.edges.len() as u32;
            self.edges.push(of_edge[0].ends);
            of_edge.iter().for_each(|side| self.edges_of[side.triangle as usize][side.corner] = edge);
            // Not across an edge of three faces, where there is no one neighbour: it counts as an outline.
            if let [one, other] = *of_edge {
                self.across[one.triangle as usize][one.corner] = other.triangle;
                self.across[other.triangle as usize][other.corner] = one.triangle;
            }
        }
        self.is_intact_edge = vec![true; self.edges.len()];
        let ends = self.edges.iter().zip(0..).flat_map(|(nodes, edge)| nodes.map(|node| (node, edge)));
        self.edges_at = Around::new(count, ends.collect());
    }

    /// Removes the triangles of elements that were deleted since the last call. Returns whether there were any.
    pub(super) fn remove_deleted(&mut self, films: &[Film]) -> bool {
        let mut any = false;
        for (film, elements) in films.iter().zip(&self.elements) {
            let mut next = 0;
            let mut deleted = vec![];
            film.for_each_intact(|nodes| {
                // Intact triangles follow in the order in which all were listed.
                while self.corners[elements[next].start as usize] != nodes[..3] {
                    deleted.push(next);
                    next += 1;
                }
                next += 1;
            });
            deleted.extend(next..elements.len());
            for triangle in deleted.into_iter().flat_map(|element| elements[element].clone()) {
                let triangle = triangle as usize;
                any |= self.is_intact[triangle];
                self.is_intact[triangle] = false;
                for k in 0..3 {
                    let other = std::mem::replace(&mut self.across[triangle][k], NONE);
                    if other != NONE {
                        self.across[other as usize]
                            .iter_mut()
                            .filter(|t| **t == triangle as u32)
                            .for_each(|t| *t = NONE);
                    }
                }
            }
        }
        if any {
            // An edge lasts as long as one of its triangles.
            self.is_intact_edge.fill(false);
            for (edges, _) in self.edges_of.iter().zip(&self.is_intact).filter(|(_, intact)| **intact) {
                edges.iter().for_each(|edge| self.is_intact_edge[*edge as usize] = true);
            }
        }
        any
    }

    /// Edges of a node, also of elements that are deleted.
    pub(super) fn edges_at(&self, node: u32) -> &[u32] {
        self.edges_at.at(node)
    }

    /// Whether a node belongs to an element that is not deleted.
    pub(super) fn is_intact_node(&self, node: u32) -> bool {
        self.edges_at(node).iter().any(|edge| self.is_intact_edge[*edge as usize])
    }

    /// Positions of the corners of a triangle.
    #[inline(always)]
    pub(super) fn corners_at(&self, position: &Vectors, triangle: u32) -> [Vector3<f64>; 3] {
        let [a, b, c] = self.corners[triangle as usize];
        [place(position, a as usize), place(position, b as usize), place(position, c as usize)]
    }

    /// Positions of the ends of an edge.
    #[inline(always)]
    pub(super) fn ends_at(&self, position: &Vectors, edge: u32) -> [Vector3<f64>; 2] {
        let [a, b] = self.edges[edge as usize];
        [place(position, a as usize), place(position, b as usize)]
    }

    /// The face of a triangle.
    pub(super) fn face_of(&self, triangle: u32) -> usize {
        self.faces.partition_point(|face| face.end <= triangle)
    }
}

/// Position of a node.
#[inline(always)]
pub(super) fn place(position: &Vectors, node: usize) -> Vector3<f64> {
    Vector3::from(position.value_at(node))
}

/// Whether all numbers are below `end`: those of a stored state, which may be damaged.
pub(super) fn are_below(numbers: &[u32], end: usize) -> bool {
    numbers.iter().all(|number| (*number as usize) < end)
}
