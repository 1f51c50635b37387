//! The neighbour list.

use std::ops::Range;

use nalgebra::{Isometry3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::{Contact, FACE_BOUND, PIECE, WATCHED_FROM};
use crate::engine::film::Film;
use crate::engine::nodes::Nodes;

/// Skin of the neighbour list over the impactor's size.
const SKIN: f64 = 0.04;

/// Nodes and elements that could touch before the list is made again.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct NearList {
    /// In order.
    pub(super) nodes: Vec<u32>,
    /// Parts of `nodes` that one thread looks at together, none of them on two faces.
    #[serde(skip)]
    pub(super) pieces: Vec<Range<usize>>,
    /// All nodes that may get momentum, in order.
    #[serde(skip)]
    pub(super) remembered: Vec<u32>,
    pub(super) elements: Vec<NearElement>,
    /// Those whose deepest point has to be watched between the nodes.
    pub(super) watched: Vec<NearElement>,
    /// Relative motion that is left until then, m.
    pub(super) margin: f64,
    /// Relative motion in the last step, m.
    pub(super) pace: f64,
}

/// An element near the impactor.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct NearElement {
    /// A triangle repeats its last.
    pub(super) corners: [u32; 4],
    /// Square of the longest line between two corners when it was listed, m².
    pub(super) longest_squared: f64,
}

impl Contact {
    /// Lists what could touch before film and impactor have moved by the skin.
    pub(super) fn list_neighbours(&mut self, films: &[Film], nodes: &Nodes, pose: &Isometry3<f64>) {
        let size = self.surface.size();
        let skin = SKIN * size;
        let fine = 8.0 * WATCHED_FROM * FACE_BOUND * size * size;
        let centre = Point3::from(pose.translation.vector);
        let distance_squared = |n: u32| nalgebra::distance_squared(&nodes.place(n as usize), &centre);
        let surface = &self.surface;
        let within = |n: u32, margin: f64| {
            let margin = margin + self.offset[n as usize];
            let radius = surface.bounding_radius() + margin;
            distance_squared(n) < radius * radius && surface.touch(pose, &nodes.place(n as usize)).gap < margin
        };
        let near = &mut self.near;
        near.nodes.clear();
        near.elements.clear();
        near.watched.clear();
        for film in films {
            near.nodes.extend((film.nodes.start as u32..film.nodes.end as u32).filter(|n| within(*n, skin)));
        }
        self.normals.fill(Vector3::zeros());
        for film in films {
            film.for_each_intact(|corners| {
                let squared = longest_line_squared(corners, nodes);
                let longest = squared.sqrt();
                if !corners.iter().any(|n| within(*n, skin + longest)) {
                    return;
                }
                let corners = [corners[0], corners[1], corners[2], corners[corners.len() - 1]];
                let element = NearElement { corners, longest_squared: squared };
                near.elements.push(element);
                if !surface.is_round() || squared > fine {
                    near.watched.push(element);
                }
            });
        }
        near.divide(films);
        near.margin = skin;
    }
}

impl NearList {
    /// Works out the pieces and the nodes to be remembered, which follow from the rest.
    pub(super) fn divide(&mut self, films: &[Film]) {
        self.pieces.clear();
        for film in films {
            let [first, end] = [film.nodes.start, film.nodes.end].map(|n| self.place(n));
            self.pieces.extend((first..end).step_by(PIECE).map(|from| from..end.min(from + PIECE)));
        }
        if self.pieces.is_empty() {
            // Elements may be met where no node is near; what goes through them needs a place.
            self.pieces.push(0..0);
        }
        // Corners of watched elements may lie outside the skin; what they get is accounted for like that of all others.
        let mut extra: Vec<u32> = self.watched.iter().flat_map(|element| element.corners).collect();
        extra.sort_unstable();
        extra.dedup();
        self.remembered.clone_from(&self.nodes);
        self.remembered.extend(extra.into_iter().filter(|n| self.nodes.binary_search(n).is_err()));
        self.remembered.sort_unstable();
    }

    /// Where the nodes from number `node` on begin.
    fn place(&self, node: usize) -> usize {
        self.nodes.partition_point(|n| (*n as usize) < node)
    }

    /// Whether it is a list of a scene with so many nodes: every node once, in order, and no other.
    pub(super) fn is_of(&self, nodes: usize) -> bool {
        let corners = self.elements.iter().chain(&self.watched).flat_map(|element| element.corners);
        let mut all = self.nodes.iter().copied().chain(corners);
        self.nodes.is_sorted_by(|a, b| a < b) && all.all(|n| (n as usize) < nodes)
    }
}

/// Square of the longest line between any two corners, m².
fn longest_line_squared(corners: &[u32], nodes: &Nodes) -> f64 {
    let at = |n: u32| nodes.place(n as usize);
    let mut longest = 0.0_f64;
    for (k, a) in corners.iter().enumerate() {
        for b in &corners[k + 1..] {
            longest = longest.max(nalgebra::distance_squared(&at(*a), &at(*b)));
        }
    }
    longest
}
