//! Which parts of a face belong together along the film.

use crate::engine::adjacency::Around;
use crate::engine::film::Film;
use crate::engine::film_contact::surface::{NONE, Surface, place};
use crate::engine::nodes::Vectors;

use super::pairs::Parts;

/// Neighbourhoods in all faces.
pub(super) struct Topology {
    /// First intact triangle of each node, which finds its pairs.
    of_node: Vec<u32>,
    /// First intact triangle of each edge.
    of_edge: Vec<u32>,
    /// The other intact triangle of each edge.
    behind: Vec<u32>,
    /// Nodes near each along the film, itself among them.
    near: Around<u32>,
}

impl Topology {
    /// Of `films` mounted at `position`, where nodes are near each other up to the distance `along` (m) of each face.
    pub(super) fn new(films: &[Film], surface: &Surface, position: &Vectors, along: &[f64]) -> Topology {
        let mut near = vec![];
        for (film, along) in films.iter().zip(along) {
            for node in film.nodes.clone().map(|node| node as u32) {
                near.extend(within(surface, position, node, *along).into_iter().map(|other| (node, other)));
            }
        }
        let near = Around::new(films.last().map_or(0, |film| film.nodes.end), near);
        let mut topology = Topology { of_node: vec![], of_edge: vec![], behind: vec![], near };
        topology.update(surface);
        topology
    }

    /// Takes over which triangles are intact.
    pub(super) fn update(&mut self, surface: &Surface) {
        self.of_node = vec![NONE; self.near.len()];
        [self.of_edge, self.behind] = [(); 2].map(|()| vec![NONE; surface.edges.len()]);
        for triangle in (0..surface.corners.len()).filter(|triangle| surface.is_intact[*triangle]) {
            let own = triangle as u32;
            for node in surface.corners[triangle] {
                let first = &mut self.of_node[node as usize];
                *first = own.min(*first);
            }
            for edge in surface.edges_of[triangle] {
                let edge = edge as usize;
                if self.of_edge[edge] == NONE {
                    self.of_edge[edge] = own;
                } else if self.behind[edge] == NONE {
                    self.behind[edge] = own;
                }
            }
        }
    }

    /// First intact triangle of a node.
    pub(super) fn triangle_of(&self, node: u32) -> u32 {
        self.of_node[node as usize]
    }

    /// Intact triangles of an edge, at most two.
    pub(super) fn triangles_at(&self, edge: u32) -> impl Iterator<Item = u32> {
        let both = [self.of_edge[edge as usize], self.behind[edge as usize]];
        both.into_iter().filter(|triangle| *triangle != NONE)
    }

    /// Whether two nodes are too near each other along the film to meet.
    #[inline(always)]
    fn are_near(&self, one: u32, other: u32) -> bool {
        if one == other {
            return true;
        }
        let near = self.near.at(one);
        // Nearly always the node alone.
        near.len() > 1 && near.binary_search(&other).is_ok()
    }

    /// Calls `add` with the pairs of parts of two triangles that may meet, each found in one pair of triangles only.
    pub(super) fn candidates(&self, surface: &Surface, [one, other]: [u32; 2], add: &mut impl FnMut(Parts)) {
        self.nodes_and_triangle(surface, one, other, add);
        self.nodes_and_triangle(surface, other, one, add);
        for k in 0..3 {
            let first = surface.edges_of[one as usize][k];
            if self.of_edge[first as usize] != one {
                continue;
            }
            let [a, b] = surface.edges[first as usize];
            for l in 0..3 {
                let second = surface.edges_of[other as usize][l];
                let [c, d] = surface.edges[second as usize];
                let may_meet = self.of_edge[second as usize] == other
                    && !(self.are_near(a, c) || self.are_near(a, d) || self.are_near(b, c) || self.are_near(b, d));
                if may_meet {
                    add(Parts::Edges([first.min(second), first.max(second)]));
                }
            }
        }
    }

    #[inline(always)]
    fn nodes_and_triangle(&self, surface: &Surface, one: u32, other: u32, add: &mut impl FnMut(Parts)) {
        let [a, b, c] = surface.corners[other as usize];
        for k in 0..3 {
            let node = surface.corners[one as usize][k];
            let may_meet = self.of_node[node as usize] == one
                && !(self.are_near(node, a) || self.are_near(node, b) || self.are_near(node, c));
            if may_meet {
                add(Parts::Node { node, triangle: other });
            }
        }
    }
}

/// Nodes up to the distance `along` (m) from one along edges, itself among them, each once.
fn within(surface: &Surface, position: &Vectors, node: u32, along: f64) -> Vec<u32> {
    // Dijkstra without a queue: there are few of them, mostly one.
    let mut reached = vec![(node, 0.0_f64)];
    let mut next = 0;
    while next < reached.len() {
        let (from, so_far) = reached[next];
        next += 1;
        for edge in surface.edges_at(from) {
            let [a, b] = surface.edges[*edge as usize];
            let to = if a == from { b } else { a };
            let length = so_far + (place(position, a as usize) - place(position, b as usize)).norm();
            if length > along {
                continue;
            }
            match reached.iter().position(|(node, _)| *node == to) {
                Some(known) if reached[known].1 <= length => (),
                // Found nearer: those behind it are looked at again.
                Some(known) => {
                    reached[known].1 = length;
                    reached.push((to, length));
                }
                None => reached.push((to, length)),
            }
        }
    }
    let mut nodes: Vec<u32> = reached.into_iter().map(|(node, _)| node).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
