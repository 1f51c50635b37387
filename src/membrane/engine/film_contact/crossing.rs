//! Edges of different faces that cross each other, and the list of all of them, as arrays for lanes.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::due::Pairs;
use super::surface::{NONE, Surface, are_below, place};
use super::tracking::{BESIDE, Tracking, foot, normal_of, project};
use crate::engine::nodes::Vectors;

/// Square of the sine between two edges below which they count as parallel: nodes then carry the contact.
pub(super) const PARALLEL: f64 = 1e-4;

/// Triangles over which an edge is followed at most.
const LONGEST: usize = 512;

/// An edge of one face that crosses an edge of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Edge of the first of the two faces, then edge of the second.
    pub(super) edges: [u32; 2],
    /// Of the product of the first edge and the second, from the second edge to the first; zero where they are parallel.
    pub(super) sign: f64,
    /// Least allowed distance, m.
    pub(super) bound: f64,
}

/// Adds the crossings of `edge` over the faces that its nodes follow on one side. `tracking` is that of this side and
/// that of the other one. Where these are two faces, since the outline of one ends between the nodes, the edge is
/// followed over each. Crossings next to a node that lies on a corner are left out: that node has their distance. Film
/// has covered `path` (m).
pub(super) fn find(
    surface: &Surface,
    (position, path): (&Vectors, f64),
    tracking: [&Tracking; 2],
    edge: u32,
    out: &mut Vec<Crossing>,
) {
    let ends = surface.edges[edge as usize];
    let face = |n: u32| {
        let (triangle, sign) = (tracking[0].triangle[n as usize], tracking[0].pairs.sign[n as usize]);
        (triangle != NONE && sign != 0.0).then(|| surface.face_of(triangle))
    };
    let [first, second] = ends.map(face);
    if first.is_some() {
        follow(surface, (position, path), tracking, edge, ends, out);
    }
    // From the other end as well, since a walk stops at the outline of a face.
    if second.is_some() && second != first {
        follow(surface, (position, path), tracking, edge, [ends[1], ends[0]], out);
    }
}

/// Follows an edge from one of its nodes to the other over the face that the first follows.
fn follow(
    surface: &Surface,
    (position, path): (&Vectors, f64),
    [tracking, back]: [&Tracking; 2],
    edge: u32,
    [from, to]: [u32; 2],
    out: &mut Vec<Crossing>,
) {
    let [start, end] = [from, to].map(|n| place(position, n as usize));
    let [a, b] = surface.ends_at(position, edge);
    let direction = b - a;
    // The whole edge lies on the side of its first node: it came from there (theory.md, section 6).
    let (sign, bound) = (tracking.pairs.sign[from as usize], tracking.pairs.bound[from as usize]);
    let (mut triangle, mut entered) = (tracking.triangle[from as usize], NONE);
    if tracking.pairs.due[from as usize] > path {
        // It may have passed other triangles since it was looked at.
        triangle = foot(surface, position, &start, triangle).triangle;
    }
    for _ in 0..LONGEST {
        let (at_start, normal, _) = project(surface, position, &start, triangle);
        let (at_end, ..) = project(surface, position, &end, triangle);
        let edges = surface.edges_of[triangle as usize];
        // Not back over the edge by which it came, where round-off may have both weights near zero.
        let leaves = |k: &usize| at_end[*k] < -BESIDE && at_end[*k] < at_start[*k] && edges[*k] != entered;
        // Weights are linear along the edge, so the first to vanish is where it leaves the triangle.
        let share = |k: usize| at_start[k] / (at_start[k] - at_end[k]);
        let exit = (0..3).filter(leaves).fold(None, |first: Option<usize>, k| match first {
            Some(other) if share(other) <= share(k) => Some(other),
            _ => Some(k),
        });
        let Some(k) = exit else { return };
        let other = edges[k];
        // The nodes next to the crossing.
        let at_exit = share(k);
        let near = if at_exit < 0.5 { from } else { to };
        let weight = |l: usize| at_start[l] + at_exit * (at_end[l] - at_start[l]);
        let [l, m] = [(k + 1) % 3, (k + 2) % 3];
        let corner = surface.corners[triangle as usize][if weight(l) > weight(m) { l } else { m }];
        // That pair of nodes has the same distance already: two constraints for it would only slow the sweeps.
        if tracking.corner(near) != Some(corner) && back.corner(corner) != Some(near) {
            let [c, d] = surface.ends_at(position, other);
            let across = direction.cross(&(d - c));
            let up = across.dot(&normal) * sign;
            let is_across = across.norm_squared() > PARALLEL * direction.norm_squared() * (d - c).norm_squared();
            // Zero, not left out: an edge that turns out of parallel later is noticed by that.
            let sign = if is_across { 1.0_f64.copysign(up) } else { 0.0 };
            // In the other order both the product and the direction are reversed, and the sign is the same.
            let edges = [edge.min(other), edge.max(other)];
            out.push(Crossing { edges, sign, bound });
        }
        let next = surface.across[triangle as usize][k];
        // Past a sharp fold the edge lies under the surface that it is followed over.
        if next == NONE || normal_of(surface, position, next).dot(&normal) < 0.0 {
            return;
        }
        (triangle, entered) = (next, other);
    }
}

/// All crossings, in an order that follows from how they came and went: sweeps go through them in it, and another one gives
/// other bits.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Crossings {
    edges: Vec<[u32; 2]>,
    /// Nodes of the first edge, then of the second.
    pub(super) nodes: [Vec<u32>; 4],
    pub(super) pairs: Pairs,
    /// Places in the list, of each edge of the surface.
    of_edge: Vec<Vec<u32>>,
}

impl Crossings {
    /// None between `edges` edges.
    pub(super) fn new(edges: usize) -> Crossings {
        Crossings { of_edge: vec![vec![]; edges], ..Crossings::default() }
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

    /// The place of the crossing of two edges.
    pub(super) fn place(&self, edges: [u32; 2]) -> Option<usize> {
        self.of_edge(edges[0]).iter().map(|place| *place as usize).find(|place| self.edges[*place] == edges)
    }

    /// Adds a crossing that the list does not have yet.
    pub(super) fn push(&mut self, Crossing { edges, sign, bound }: Crossing, surface: &Surface) {
        let place = self.edges.len() as u32;
        edges.iter().for_each(|edge| self.of_edge[*edge as usize].push(place));
        let nodes = edges.map(|edge| surface.edges[edge as usize]);
        self.nodes.iter_mut().zip(nodes.as_flattened()).for_each(|(all, node)| all.push(*node));
        self.edges.push(edges);
        self.pairs.push([sign, bound, 0.0]);
    }

    /// Removes the crossing at `place`, which the last one of the list takes. Returns its edges.
    pub(super) fn remove(&mut self, place: usize) -> [u32; 2] {
        for edge in self.edges[place] {
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
        for all in &mut self.nodes {
            all.swap_remove(place);
        }
        self.pairs.swap_remove(place);
        self.edges.swap_remove(place)
    }

    /// Whether it fits a scene of so many nodes and edges.
    pub(super) fn fits(&self, nodes: usize, edges: usize) -> bool {
        let count = self.edges.len();
        self.pairs.fits(count)
            && are_below(self.edges.as_flattened(), edges)
            && self.nodes.iter().all(|all| all.len() == count && are_below(all, nodes))
            && self.of_edge.len() == edges
            && self.of_edge.iter().all(|places| are_below(places, count))
    }
}
