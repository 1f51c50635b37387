//! The pairs of a face that may come near each other, as arrays.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::engine::film_contact::surface::{NONE, Surface};
use crate::engine::footprint::bytes;

/// Parts of one face that may meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(in crate::engine::film_contact) enum Parts {
    /// A node and a triangle.
    Node { node: u32, triangle: u32 },
    /// Two edges, the one with the smaller number first.
    Edges([u32; 2]),
}

/// Two parts of a face with their history.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::engine::film_contact) struct SelfPair {
    pub(super) parts: Parts,
    /// Factor on the normal of the triangle, or on the product of the edges, that makes it point to the node, or from
    /// the second edge to the first; zero where the node is not over the triangle, or the edges do not cross.
    pub(super) sign: f64,
    /// Least allowed distance, m.
    pub(super) bound: f64,
    /// Least allowed distance of parts that were not closer when they were found, m.
    pub(super) whole: f64,
    /// Path of film up to which it need not be looked at, m, as of [`super::super::due`].
    pub(super) due: f64,
}

/// What is known of a pair at the start of a step, as of [`SelfPair`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub(super) parts: Parts,
    pub(super) sign: f64,
    /// m.
    pub(super) bound: f64,
}

/// All pairs in the order of their parts.
#[derive(Debug, Default)]
pub(in crate::engine::film_contact) struct Pairs {
    parts: Vec<Parts>,
    pub(super) sign: Vec<f64>,
    pub(super) bound: Vec<f64>,
    pub(super) whole: Vec<f64>,
    pub(in crate::engine::film_contact) due: Vec<f64>,
    /// Place of its impulse in the last step among those that are carried on, or [`NONE`].
    pub(in crate::engine::film_contact) carried: Vec<u32>,
}

impl SelfPair {
    /// Whether it fits a scene of so many nodes on `surface`.
    pub(super) fn fits(&self, nodes: usize, surface: &Surface) -> bool {
        self.parts.fits(nodes, surface.edges.len())
            && match self.parts {
                Parts::Node { triangle, .. } => (triangle as usize) < surface.corners.len(),
                Parts::Edges(_) => true,
            }
    }
}

impl Parts {
    /// Whether its nodes and edges are among so many.
    pub(in crate::engine::film_contact) fn fits(&self, nodes: usize, edges: usize) -> bool {
        match self {
            Parts::Node { node, .. } => (*node as usize) < nodes,
            Parts::Edges(of) => of.iter().all(|edge| (*edge as usize) < edges),
        }
    }
}

impl Pairs {
    pub(in crate::engine::film_contact) fn len(&self) -> usize {
        self.parts.len()
    }

    pub(in crate::engine::film_contact) fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Places of the list.
    pub(super) fn places(&self) -> Range<usize> {
        0..self.parts.len()
    }

    /// The place of a pair.
    pub(in crate::engine::film_contact) fn place(&self, parts: Parts) -> Option<usize> {
        self.parts.binary_search(&parts).ok()
    }

    /// Distance (m) below which there is a constraint of the pair at `place`: what had an impulse in the last step finds its
    /// constraint at any distance, as that impulse has been applied already, another one below `distance`.
    pub(super) fn limit(&self, place: usize, distance: f64) -> f64 {
        if self.carried[place] == NONE { distance } else { f64::INFINITY }
    }

    /// Replaces all by `pairs`, which are in order.
    pub(super) fn replace(&mut self, pairs: impl IntoIterator<Item = SelfPair>) {
        *self = Pairs::default();
        for SelfPair { parts, sign, bound, whole, due } in pairs {
            self.parts.push(parts);
            self.sign.push(sign);
            self.bound.push(bound);
            self.whole.push(whole);
            self.due.push(due);
            self.carried.push(NONE);
        }
    }

    pub(super) fn known(&self, place: usize) -> Known {
        Known { parts: self.parts[place], sign: self.sign[place], bound: self.bound[place] }
    }

    pub(super) fn get(&self, place: usize) -> SelfPair {
        SelfPair {
            parts: self.parts[place],
            sign: self.sign[place],
            bound: self.bound[place],
            whole: self.whole[place],
            due: self.due[place],
        }
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        let numbers = bytes(&self.sign) + bytes(&self.bound) + bytes(&self.whole) + bytes(&self.due);
        bytes(&self.parts) + numbers + bytes(&self.carried)
    }
}
