//! Contact of a face with itself: where it folds, and where the lips of a cut or a tear meet.
//!
//! Every node and triangle and every two edges of one face that are near each other, but not along the film, are a pair
//! with a history: the side on which they have come to each other ([`pairs`]). A search finds them in bounding volumes
//! with cones of normals ([`hierarchy`]), so that film without folds costs next to nothing; [`detection`] finds those that
//! would come too close in a step, and their constraints (theory.md, section 6).

mod closest;
mod detection;
mod hierarchy;
mod pairs;
mod topology;

pub(super) use detection::{FoundPairs, Step};
pub(super) use pairs::{Pairs, Parts};

use serde::{Deserialize, Serialize};

use super::SLOP;
use super::surface::Surface;
use super::tracking::place;
use crate::engine::film::Film;
use crate::engine::nodes::{Nodes, Vectors};
use detection::{distance, signed_distance};
use hierarchy::Hierarchy;
use pairs::SelfPair;
use topology::Topology;

/// Distance up to which parts of a face are searched for, over the mean edge of its elements as mounted.
const REACH: f64 = 0.3;

/// Distance along the film, over its thickness, within which its parts do not meet: film that is bent back on itself
/// about its own thickness has a middle surface of half a circle, π/2.
const ALONG: f64 = 2.0;

/// Least share of the allowed distance by which a pair is kept apart that was found closer.
const LEAST: f64 = 0.25;

/// Steps with the motion of the last one for which film that cannot meet itself is not searched, at least: for less its
/// folds are looked at.
const SPARED_STEPS: f64 = 4.0;

/// Contact of every face with itself.
pub(super) struct SelfContact {
    topology: Topology,
    /// Of each face.
    hierarchies: Vec<Hierarchy>,
    /// Of each face, m.
    reach: Vec<f64>,
    /// Whether a face has edges of cuts, tears, holes or notches.
    has_open_edges: Vec<bool>,
    /// Least allowed distance of each face, m.
    bound: Vec<f64>,
    pub(super) pairs: Pairs,
    /// Positions before the nodes move in a step, m.
    start: Vectors,
    /// Motion of film over itself that is left until it is searched again, m.
    margin: f64,
}

/// History of the contact of faces with themselves.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SelfContactHistory {
    pairs: Vec<SelfPair>,
    margin: f64,
}

impl SelfContact {
    /// Of `films` as mounted on `nodes`.
    pub(super) fn new(films: &[Film], surface: &Surface, nodes: &Nodes) -> SelfContact {
        let position = &nodes.position;
        let along: Vec<f64> = films.iter().map(|film| ALONG * film.thickness).collect();
        let bound: Vec<f64> = films.iter().map(|film| (1.0 - SLOP) * film.thickness).collect();
        let topology = Topology::new(films, surface, position, &along);
        let faces = || surface.faces.iter().cloned();
        let hierarchies: Vec<Hierarchy> =
            faces().map(|triangles| Hierarchy::new(surface, position, triangles)).collect();
        let mean_edge = |triangles: std::ops::Range<u32>| {
            let edges = triangles.clone().flat_map(|triangle| surface.edges_of[triangle as usize]);
            let length = |edge: u32| {
                let [a, b] = surface.edges[edge as usize].map(|n| place(position, n as usize));
                (b - a).norm()
            };
            edges.map(length).sum::<f64>() / (3.0 * triangles.len() as f64)
        };
        // Beyond the allowed distance, so that film has to move until a pair that was not listed touches.
        let reach = faces().zip(&bound).map(|(triangles, bound)| REACH * mean_edge(triangles) + 2.0 * bound).collect();
        let has_open_edges = hierarchies.iter().map(|hierarchy| hierarchy.has_open_edges(surface)).collect();
        let (pairs, start) = (Pairs::default(), Vectors::default());
        SelfContact { topology, hierarchies, reach, has_open_edges, bound, pairs, start, margin: 0.0 }
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        let hierarchies: usize = self.hierarchies.iter().map(Hierarchy::bytes).sum();
        self.topology.bytes() + hierarchies + self.pairs.bytes() + self.start.bytes()
    }

    /// Searches anew before the next step, after film was moved.
    pub(super) fn invalidate(&mut self) {
        self.margin = 0.0;
    }

    /// Takes over that triangles of `surface` were deleted.
    pub(super) fn remove_deleted(&mut self, surface: &Surface) {
        self.topology.update(surface);
        let open = self.hierarchies.iter().map(|hierarchy| hierarchy.has_open_edges(surface));
        self.has_open_edges = open.collect();
        self.margin = 0.0;
    }

    /// Reduces the motion that is left until the next search, after a step in which nodes have moved by at most
    /// `distance` (m).
    pub(super) fn reduce_margin(&mut self, distance: f64) {
        self.margin -= 2.0 * distance;
    }

    /// Searches where that is due, before the nodes move in a step, and records their positions. In the last step nodes
    /// have moved by at most `last_motion` (m).
    pub(super) fn prepare(&mut self, surface: &Surface, nodes: &Nodes, last_motion: f64) {
        // The next step may be a larger motion than the last one. A motion that is not finite must not leave a list in use
        // for ever.
        if self.margin.is_nan() || self.margin <= 2.0 * (2.0 * last_motion) {
            self.search(surface, &nodes.position, last_motion);
        }
        if !self.pairs.is_empty() {
            self.start.clone_from(&nodes.position);
        }
    }

    /// Finds all pairs that are near.
    fn search(&mut self, surface: &Surface, position: &Vectors, last_motion: f64) {
        let mut found = vec![];
        self.margin = f64::INFINITY;
        for face in 0..self.hierarchies.len() {
            if !self.has_open_edges[face] {
                let spared = self.hierarchies[face].spared(surface, position);
                if spared > SPARED_STEPS * 2.0 * last_motion && spared > 0.0 {
                    self.margin = self.margin.min(spared);
                    continue;
                }
            }
            let (reach, bound) = (self.reach[face], self.bound[face]);
            // What is not found is farther than `reach`.
            let margin = reach - bound;
            self.margin = self.margin.min(margin);
            self.hierarchies[face].refit(surface, position, margin);
            let topology = &self.topology;
            self.hierarchies[face].for_each_pair(surface, reach, &mut |one, other| {
                topology.candidates(surface, [one, other], &mut |parts| {
                    let distance = distance(surface, position, parts);
                    if distance < reach {
                        found.push(SelfPair { parts, sign: 0.0, bound, whole: bound, due: 0.0 });
                    }
                });
            });
        }
        found.sort_unstable_by_key(|pair| pair.parts);
        let pairs = &self.pairs;
        let with_history = found.into_iter().map(|pair| pairs.place(pair.parts).map_or(pair, |place| pairs.get(place)));
        let all: Vec<SelfPair> = with_history.collect();
        self.pairs.replace(all);
    }

    /// Least distance of the pairs, m, where it is less than `distance`.
    pub(super) fn least_distance(&self, surface: &Surface, position: &Vectors, distance: f64) -> f64 {
        let of_pair = |place: usize| signed_distance(surface, position, &self.pairs.get(place));
        self.pairs.places().map(of_pair).fold(distance, f64::min)
    }

    /// The history after the last step.
    pub(super) fn save(&self) -> SelfContactHistory {
        let pairs = self.pairs.places().map(|place| self.pairs.get(place)).collect();
        SelfContactHistory { pairs, margin: self.margin }
    }

    /// Restores the history of the same faces, with the deleted elements that `surface` has.
    pub(super) fn restore(&mut self, history: SelfContactHistory, surface: &Surface) {
        self.remove_deleted(surface);
        self.pairs.replace(history.pairs);
        self.margin = history.margin;
    }
}

impl SelfContactHistory {
    /// Whether it fits a scene of so many nodes on `surface`.
    pub(super) fn fits(&self, nodes: usize, surface: &Surface) -> bool {
        self.pairs.iter().all(|pair| pair.fits(nodes, surface)) && self.pairs.is_sorted_by_key(|pair| pair.parts)
    }
}

#[cfg(test)]
impl SelfContact {
    pub(super) fn show(&self, surface: &Surface, position: &Vectors, triangles: [u32; 2]) {
        for [one, other] in [triangles, [triangles[1], triangles[0]]] {
            for node in surface.corners[one as usize] {
                let parts = Parts::Node { node, triangle: other };
                println!("  {parts:?} {:.3e} {:?} {:?}", distance(surface, position, parts), self.pairs.place(parts).map(|p| self.pairs.get(p)), self.pairs.place(parts).map(|p| signed_distance(surface, position, &self.pairs.get(p))));
            }
        }
        for one in surface.edges_of[triangles[0] as usize] {
            for other in surface.edges_of[triangles[1] as usize] {
                let parts = Parts::Edges([one.min(other), one.max(other)]);
                println!("  {parts:?} {:?}-{:?} {:.3e} {:?} {:?}", surface.edges[one as usize], surface.edges[other as usize], distance(surface, position, parts), self.pairs.place(parts).map(|p| self.pairs.get(p)), self.pairs.place(parts).map(|p| signed_distance(surface, position, &self.pairs.get(p))));
            }
        }
    }
}
