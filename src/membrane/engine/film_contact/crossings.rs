//! The list of all crossings, as arrays for lanes, and the crossings of each edge.

use std::ops::Range;

use super::crossing::Crossing;
use super::surface::{NONE, Surface};
use crate::engine::footprint::bytes;

/// All crossings, in an order that follows from how they came and went.
#[derive(Clone, Debug, Default)]
pub(super) struct Crossings {
    edges: Vec<[u32; 2]>,
    /// Nodes of the first edge, then of the second.
    pub(super) nodes: [Vec<u32>; 4],
    /// As in [`Crossing`].
    pub(super) sign: Vec<f64>,
    /// Least allowed distance, m.
    pub(super) bound: Vec<f64>,
    /// Place of its impulse in the last step among those that are carried on, or [`NONE`].
    pub(super) carried: Vec<u32>,
    /// As in [`Crossing`].
    pub(super) due: Vec<f64>,
    /// Places in the list, of each edge of the surface.
    of_edge: Vec<Vec<u32>>,
}

impl Crossings {
    /// None between `edges` edges.
    pub(super) fn new(edges: usize) -> Crossings {
        Crossings { of_edge: vec![vec![]; edges], ..Crossings::default() }
    }

    pub(super) fn len(&self) -> usize {
        self.edges.len()
    }

    /// Numbers of its two edges.
    pub(super) fn edges(&self, place: usize) -> [u32; 2] {
        self.edges[place]
    }

    /// Places of the crossings of an edge.
    pub(super) fn of_edge(&self, edge: u32) -> &[u32] {
        &self.of_edge[edge as usize]
    }

    /// Places of the list.
    pub(super) fn places(&self) -> Range<usize> {
        0..self.edges.len()
    }

    pub(super) fn get(&self, place: usize) -> Crossing {
        Crossing { edges: self.edges[place], sign: self.sign[place], bound: self.bound[place], due: self.due[place] }
    }

    /// The place of the crossing of two edges.
    pub(super) fn place(&self, edges: [u32; 2]) -> Option<usize> {
        self.of_edge(edges[0]).iter().map(|place| *place as usize).find(|place| self.edges[*place] == edges)
    }

    /// Distance (m) below which there is a constraint of the crossing at `place`, `margin` (m) beyond the least allowed
    /// one. What had an impulse in the last step finds its constraint at any distance: that impulse has been applied
    /// already.
    #[inline(always)]
    pub(super) fn limit(&self, place: usize, margin: f64) -> f64 {
        if self.carried[place] == NONE { self.bound[place] + margin } else { f64::INFINITY }
    }

    /// Adds a crossing that the list does not have yet.
    pub(super) fn push(&mut self, crossing: Crossing, surface: &Surface) {
        let place = self.edges.len() as u32;
        let Crossing { edges, sign, bound, due } = crossing;
        edges.iter().for_each(|edge| self.of_edge[*edge as usize].push(place));
        for (all, node) in self.nodes.iter_mut().zip(crossing.nodes(surface)) {
            all.push(node);
        }
        self.edges.push(edges);
        self.sign.push(sign);
        self.bound.push(bound);
        self.carried.push(NONE);
        self.due.push(due);
    }

    /// Removes the crossing at `place`, which the last one of the list takes.
    pub(super) fn remove(&mut self, place: usize) -> Crossing {
        let removed = self.get(place);
        for edge in removed.edges {
            self.of_edge[edge as usize].retain(|other| *other as usize != place);
        }
        let last = self.edges.len() - 1;
        if place != last {
            for edge in self.edges[last] {
                let places = &mut self.of_edge[edge as usize];
                places.iter_mut().filter(|other| **other as usize == last).for_each(|other| *other = place as u32);
            }
        }
        // Structure of arrays without gaps: the narrow phase reads it in whole lanes.
        self.edges.swap_remove(place);
        for all in &mut self.nodes {
            all.swap_remove(place);
        }
        self.sign.swap_remove(place);
        self.bound.swap_remove(place);
        self.carried.swap_remove(place);
        self.due.swap_remove(place);
        removed
    }

    /// All of them, in their order.
    pub(super) fn iter(&self) -> impl Iterator<Item = Crossing> + '_ {
        self.places().map(|place| self.get(place))
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        let nodes: usize = self.nodes.iter().map(|all| bytes(all)).sum();
        let of_edge = bytes(&self.of_edge) + self.of_edge.iter().map(|of| bytes(of)).sum::<usize>();
        let numbers = bytes(&self.sign) + bytes(&self.bound) + bytes(&self.carried) + bytes(&self.due);
        bytes(&self.edges) + nodes + numbers + of_edge
    }
}
