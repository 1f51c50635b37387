//! The pairs of a face that may come near each other, as arrays.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::SelfContact;
use crate::engine::film_contact::due::Pairs;
use crate::engine::film_contact::surface::{Surface, are_below};
use crate::engine::nodes::Vectors;

/// Parts of one face that may meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(in crate::engine::film_contact) enum Parts {
    /// A node and a triangle.
    Node { node: u32, triangle: u32 },
    /// Two edges, the one with the smaller number first.
    Edges([u32; 2]),
}

/// What is known of a pair at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine::film_contact) struct Known {
    pub(in crate::engine::film_contact) parts: Parts,
    /// Factor on the normal of the triangle, or on the product of the edges, that makes it point to the node, or from
    /// the second edge to the first; zero where the node is not over the triangle, or the edges do not cross.
    pub(super) sign: f64,
    /// Least allowed distance, m.
    pub(super) bound: f64,
}

/// All pairs in the order of their parts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::engine) struct SelfPairs {
    parts: Vec<Parts>,
    /// Least allowed distance of parts that were not closer when they were found, m.
    pub(super) whole: Vec<f64>,
    pub(in crate::engine::film_contact) pairs: Pairs,
}

impl Parts {
    /// Whether it fits a scene of so many nodes on `surface`.
    pub(in crate::engine::film_contact) fn fits(&self, nodes: usize, surface: &Surface) -> bool {
        match self {
            Parts::Node { node, triangle } => {
                are_below(&[*node], nodes) && are_below(&[*triangle], surface.corners.len())
            }
            Parts::Edges(edges) => are_below(edges, surface.edges.len()),
        }
    }
}

impl SelfPairs {
    pub(in crate::engine::film_contact) fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Places of the list.
    pub(in crate::engine::film_contact) fn places(&self) -> Range<usize> {
        0..self.parts.len()
    }

    /// The place of a pair.
    pub(in crate::engine::film_contact) fn place(&self, parts: Parts) -> Option<usize> {
        self.parts.binary_search(&parts).ok()
    }

    pub(in crate::engine::film_contact) fn known(&self, place: usize) -> Known {
        Known { parts: self.parts[place], sign: self.pairs.sign[place], bound: self.pairs.bound[place] }
    }

    /// The `found` parts with their least allowed distances (m) as a list, with what is known of those that were listed.
    pub(super) fn renewed(&self, mut found: Vec<(Parts, f64)>) -> SelfPairs {
        found.sort_unstable_by_key(|(parts, _)| *parts);
        let mut all = SelfPairs::default();
        for (parts, bound) in found {
            let known = self.place(parts);
            all.whole.push(known.map_or(bound, |place| self.whole[place]));
            all.pairs.push(known.map_or([0.0, bound, 0.0], |place| self.pairs.get(place)));
            all.parts.push(parts);
        }
        all
    }

    /// Whether they fit a scene of so many nodes on `surface`.
    pub(super) fn fits(&self, nodes: usize, surface: &Surface) -> bool {
        let count = self.parts.len();
        self.whole.len() == count
            && self.pairs.fits(count)
            && self.parts.is_sorted()
            && self.parts.iter().all(|parts| parts.fits(nodes, surface))
    }
}

impl SelfContact {
    /// Largest depth by which an edge passes through a triangle without a common node, m: the distance of the nearer one of
    /// its ends from the plane of the triangle. Zero where none does.
    ///
    /// A point inside a triangle is at most the radius of the inscribed circle from one of its edges, 0.29 of an edge; so
    /// the two edges are a pair, but on triangles that are larger than the mean.
    pub(super) fn largest_depth(&self, surface: &Surface, position: &Vectors) -> f64 {
        let mut largest = 0.0_f64;
        for place in self.state.pairs.places() {
            let Parts::Edges([one, other]) = self.state.pairs.known(place).parts else { continue };
            for [edge, beside] in [[one, other], [other, one]] {
                for triangle in self.topology.triangles_at(beside) {
                    let corners = surface.corners[triangle as usize];
                    if surface.edges[edge as usize].iter().all(|node| !corners.contains(node)) {
                        largest = largest.max(depth(surface, position, edge, triangle));
                    }
                }
            }
        }
        largest
    }
}

/// Distance of the nearer end of an edge from the plane of a triangle through which it passes, m; zero where it does not.
fn depth(surface: &Surface, position: &Vectors, edge: u32, triangle: u32) -> f64 {
    let [a, b, c] = surface.corners_at(position, triangle);
    let [p, q] = surface.ends_at(position, edge);
    let (u, v) = (b - a, c - a);
    let across = u.cross(&v);
    let (above, below) = (across.dot(&(p - a)), across.dot(&(q - a)));
    // Nor what is not a number.
    if (above * below).is_nan() || above * below >= 0.0 {
        return 0.0;
    }
    let r = p + (q - p) * (above / (above - below)) - a;
    let (of_b, of_c) = (r.cross(&v).dot(&across), u.cross(&r).dot(&across));
    let squared = across.norm_squared();
    let is_inside = of_b >= 0.0 && of_c >= 0.0 && of_b + of_c <= squared;
    if is_inside { above.abs().min(below.abs()) / squared.sqrt() } else { 0.0 }
}
