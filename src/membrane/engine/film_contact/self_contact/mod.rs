//! Contact of a face with itself: where it folds, and where the lips of a cut or a tear meet.
//!
//! Every node and triangle and every two edges of one face that are near each other, but not along the film, are a pair
//! with a history: the side on which they have come to each other ([`pairs`]). A search finds them in bounding volumes
//! with the deformation gradients of their triangles ([`hierarchy`], [`gradient`]), so that film without folds costs next
//! to nothing; [`detection`] finds those that would come too close in a step, and their constraints (theory.md, section 6).

mod closest;
mod detection;
mod gradient;
mod hierarchy;
mod pairs;
#[cfg(test)]
mod tests;
mod topology;

pub(super) use pairs::{Parts, SelfPairs};

use serde::{Deserialize, Serialize};

use super::SLOP;
use super::surface::Surface;
use crate::engine::film::Film;
use crate::engine::nodes::{Nodes, Vectors};
use detection::{distance_within, signed_distance};
use hierarchy::Hierarchy;
use topology::Topology;

/// Distance up to which parts of a face are searched for, over the mean edge of its elements as mounted.
const REACH: f64 = 0.3;

/// Distance along the film, over its thickness, within which its parts do not meet: film that is bent back on itself
/// about its own thickness has a middle surface of half a circle, π/2.
const ALONG: f64 = 2.0;

/// Least share of the allowed distance by which a pair is kept apart that was found closer.
const LEAST: f64 = 0.5;

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
    /// Positions before the nodes move in a step, m.
    start: Vectors,
    pub(super) state: State,
}

/// What contact of faces with themselves keeps from step to step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::engine) struct State {
    pub(super) pairs: SelfPairs,
    /// Motion of film over itself that is left until it is looked at whether it has to be searched again, m.
    margin: f64,
    /// Positions at the last search, m, and the motion of film over itself that it allows for, m.
    searched: (Vectors, f64),
    /// Positions at the last detection, m; none before the first.
    detected: Vectors,
    /// Path of film over itself so far, m, as of [`super::due`], but for its motion as a whole.
    pub(super) path: f64,
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
                let [a, b] = surface.ends_at(position, edge);
                (b - a).norm()
            };
            edges.map(length).sum::<f64>() / (3.0 * triangles.len() as f64)
        };
        // Beyond the allowed distance, so that film has to move until a pair that was not listed touches.
        let reach = faces().zip(&bound).map(|(triangles, bound)| REACH * mean_edge(triangles) + 2.0 * bound).collect();
        let has_open_edges = hierarchies.iter().map(|hierarchy| hierarchy.has_open_edges(surface)).collect();
        SelfContact {
            topology,
            hierarchies,
            reach,
            has_open_edges,
            bound,
            start: Vectors::default(),
            state: State::default(),
        }
    }

    /// Searches anew before the next step, after film was moved.
    pub(super) fn invalidate(&mut self) {
        (self.state.margin, self.state.searched.1) = (0.0, 0.0);
    }

    /// Takes over that triangles of `surface` were deleted.
    pub(super) fn remove_deleted(&mut self, surface: &Surface) {
        self.topology.update(surface);
        let open = self.hierarchies.iter().map(|hierarchy| hierarchy.has_open_edges(surface));
        self.has_open_edges = open.collect();
        self.invalidate();
    }

    /// Reduces the motion that is left until the next search, after a step in which nodes have moved by at most
    /// `distance` (m).
    pub(super) fn reduce_margin(&mut self, distance: f64) {
        self.state.margin -= 2.0 * distance;
    }

    /// Searches where that is due, before the nodes move in a step, and records their positions. In the last step nodes
    /// have moved by at most `last_motion` (m).
    pub(super) fn prepare(&mut self, surface: &Surface, nodes: &Nodes, last_motion: f64) {
        // The next step may be a larger motion than the last one. A motion that is not finite must not leave a list in use
        // for ever.
        let next = 2.0 * (2.0 * last_motion);
        let State { margin, searched: (searched, allowed), .. } = &mut self.state;
        if margin.is_nan() || *margin <= next {
            // Film that flies moves over itself much less than through space.
            *margin = *allowed - 2.0 * relative_motion(searched, &nodes.position);
            if margin.is_nan() || *margin <= next {
                self.search(surface, &nodes.position, last_motion);
                self.state.searched = (nodes.position.clone(), self.state.margin);
            }
        }
        if !self.state.pairs.is_empty() {
            self.start.clone_from(&nodes.position);
        }
    }

    /// Notes the positions of a detection.
    pub(super) fn add_path(&mut self, position: &Vectors) {
        let State { pairs, path, detected, .. } = &mut self.state;
        if pairs.is_empty() {
            return;
        }
        // Both parts may have moved by that.
        *path += 2.0 * relative_motion(detected, position);
        detected.clone_from(position);
    }

    /// Finds all pairs that are near.
    fn search(&mut self, surface: &Surface, position: &Vectors, last_motion: f64) {
        let mut found = vec![];
        let mut margin = f64::INFINITY;
        for face in 0..self.hierarchies.len() {
            let (reach, bound) = (self.reach[face], self.bound[face]);
            let hierarchy = &mut self.hierarchies[face];
            hierarchy.measure(surface, position);
            if !self.has_open_edges[face] {
                let spared = hierarchy.spared(bound);
                if spared > SPARED_STEPS * 2.0 * last_motion && spared > 0.0 {
                    margin = margin.min(spared);
                    continue;
                }
            }
            // What is not found is farther than `reach`.
            margin = margin.min(reach - bound);
            hierarchy.refit(surface, position);
            let topology = &self.topology;
            hierarchy.for_each_pair(surface, reach, &mut |one, other| {
                topology.candidates(surface, [one, other], &mut |parts| {
                    if distance_within(surface, position, parts, reach).is_some() {
                        found.push((parts, bound));
                    }
                });
            });
        }
        self.state.pairs = self.state.pairs.renewed(found);
        self.state.margin = margin;
    }

    /// Least distance of the pairs, m, where it is less than `distance`; where film passes through film, less the largest
    /// depth.
    pub(super) fn least_distance(&self, surface: &Surface, position: &Vectors, distance: f64) -> f64 {
        let of_pair = |place: usize| signed_distance(surface, position, &self.state.pairs.known(place));
        let least = self.state.pairs.places().map(of_pair).fold(distance, f64::min);
        let depth = self.largest_depth(surface, position);
        if depth > 0.0 { least.min(-depth) } else { least }
    }

    /// Restores the state of the same faces, with the deleted elements that `surface` has.
    pub(super) fn restore(&mut self, state: State, surface: &Surface) {
        self.remove_deleted(surface);
        self.state = state;
    }
}

/// Largest distance of a node from where it was `before`, but for the mean motion of all, m; zero before the first
/// positions are known.
fn relative_motion(before: &Vectors, after: &Vectors) -> f64 {
    if before.is_empty() {
        return 0.0;
    }
    let ([x, y, z], [u, v, w]) = (before.axes(), after.axes());
    let count = x.len() as f64;
    // One sum a component, in the order of the nodes.
    let mut mean = [0.0; 3];
    for n in 0..x.len() {
        mean[0] += u[n] - x[n];
        mean[1] += v[n] - y[n];
        mean[2] += w[n] - z[n];
    }
    let [p, q, r] = [mean[0] / count, mean[1] / count, mean[2] / count];
    let mut largest = 0.0;
    for n in 0..x.len() {
        let (a, b, c) = (u[n] - x[n] - p, v[n] - y[n] - q, w[n] - z[n] - r);
        let squared = a * a + b * b + c * c;
        // Also what is not a number.
        if squared > largest || squared.is_nan() {
            largest = squared;
        }
    }
    largest.sqrt()
}

impl State {
    /// Whether it fits a scene of so many nodes on `surface`.
    pub(super) fn fits(&self, nodes: usize, surface: &Surface) -> bool {
        let positions = [&self.searched.0, &self.detected];
        self.pairs.fits(nodes, surface) && positions.iter().all(|all| all.is_whole() && [0, nodes].contains(&all.len()))
    }
}
