//! The neighbour list: nodes and elements that may come into contact before it is rebuilt; with it the history of contact is
//! saved and restored.

use std::collections::HashMap;
use std::ops::Range;

use nalgebra::{Isometry3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::surface::{Clearance, Followed, UNKNOWN};
use super::{Contact, EDGE_SHARE, FACE_PENETRATION, FACE_SHARE, NODES_PER_RANGE, SAGITTA_SHARE, Work};
use crate::engine::film::Film;
use crate::engine::nodes::Nodes;

/// Skin of the neighbour list over the impactor's size.
const SKIN: f64 = 0.04;

/// Skin of bars over their radius: they are thin and much film lies beside them, so lists are rebuilt more rarely.
const LONG_SKIN: f64 = 0.3;

/// Nodes and elements within the skin around the impactor.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::engine) struct NeighbourList {
    /// Ascending.
    pub(super) nodes: Vec<u32>,
    /// Ranges of `nodes`, each a task of one thread, none of them on two faces.
    #[serde(skip)]
    pub(super) ranges: Vec<Range<usize>>,
    /// All nodes that may get an impulse: `nodes` and the corners of `face_candidates`, ascending.
    #[serde(skip)]
    pub(super) impulse_nodes: Vec<u32>,
    pub(super) elements: Vec<NeighbourElement>,
    /// Elements that may penetrate between their nodes by more than is allowed.
    pub(super) face_candidates: Vec<NeighbourElement>,
    /// The nodes of `face_candidates`, ascending, and for each of these the places of its corners among them.
    #[serde(skip)]
    pub(super) candidate_nodes: Vec<u32>,
    #[serde(skip)]
    pub(super) candidate_corners: Vec<[u32; 4]>,
    /// Places of the candidates at which a followed point has a force, some of them several times.
    #[serde(skip)]
    pub(super) pushed: Vec<u32>,
    /// Of each of `face_candidates`, on a convex body with edges.
    pub(super) followed: Vec<Followed>,
    /// Of each of `face_candidates`.
    pub(super) clearances: Vec<Clearance>,
    /// Radius that edges of the body have at least where elements meet them, m.
    pub(super) edge: f64,
    /// Allowed penetration of a face between its nodes, m.
    pub(super) allowance: f64,
    /// Relative motion of film and impactor that is left until the list is rebuilt, m.
    pub(super) margin: f64,
    /// Bound on the relative motion in the last step, m.
    pub(super) last_motion: f64,
}

/// An element within the skin.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct NeighbourElement {
    /// A triangle repeats its last.
    pub(super) corners: [u32; 4],
    /// Square of the longest line between two corners when the list was built, m².
    pub(super) longest_squared: f64,
}

impl Contact {
    /// Sets the radius of edges and the allowed penetration by the elements as they first are: film that stretches does
    /// not change them, which would do work.
    fn set_allowance(&mut self, films: &[Film], nodes: &Nodes) {
        let surface = &self.surface;
        if surface.is_round() {
            self.neighbours.allowance = FACE_PENETRATION * surface.size();
            return;
        }
        let mut smallest = f64::INFINITY;
        for film in films {
            film.for_each_intact(|corners| smallest = smallest.min(longest_line_squared(corners, nodes)));
        }
        let element = if smallest.is_finite() { smallest.sqrt() } else { 0.0 };
        self.neighbours.edge = EDGE_SHARE * element;
        self.neighbours.allowance = (FACE_SHARE * element).max(FACE_PENETRATION * surface.edge_radius());
        self.rounded = surface.with_edges(self.neighbours.edge);
    }

    /// Rebuilds the neighbour list for the present positions.
    pub(super) fn list_neighbours(&mut self, films: &[Film], nodes: &Nodes, pose: &Isometry3<f64>) {
        // Once a run: a list that is restored has it already.
        if self.neighbours.allowance == 0.0 {
            self.set_allowance(films, nodes);
        }
        let size = self.surface.size();
        let (is_smooth, is_long) = (self.surface.is_smooth(), self.surface.is_long());
        let skin = if is_long { LONG_SKIN } else { SKIN } * size;
        let radius = if self.surface.is_round() { size } else { self.surface.edge_radius() };
        // Square of the longest line with an allowed sagitta L²/(8R) (theory.md, section 6): finer elements are left to
        // their nodes.
        let fine = 8.0 * SAGITTA_SHARE * FACE_PENETRATION * radius * radius;
        let centre = Point3::from(pose.translation.vector);
        let distance_squared = |n: u32| nalgebra::distance_squared(&nodes.position_of(n as usize), &centre);
        let surface = &self.surface;
        // Of each node, once it is asked for.
        let mut distances = vec![f64::NAN; nodes.mass.len()];
        let (offset, nearest) = (&self.offset, &mut self.nearest);
        let mut within = |n: u32, margin: f64| {
            let margin = margin + offset[n as usize];
            let radius = surface.bounding_radius() + margin;
            // The bounding sphere first: a projection costs far more.
            if distance_squared(n) >= radius * radius {
                return false;
            }
            if let Some(nearest) = nearest.get_mut(n as usize) {
                let arm = nodes.position_of(n as usize).coords - pose.translation.vector;
                return surface.is_mesh_within(pose, &arm, margin, nearest);
            }
            // A node is asked for by itself and by each element around it, with different margins.
            let distance = &mut distances[n as usize];
            if distance.is_nan() {
                *distance = surface.project(pose, &nodes.position_of(n as usize)).distance;
            }
            *distance < margin
        };
        let list = &mut self.neighbours;
        list.nodes.clear();
        list.elements.clear();
        let known = list.take_known();
        for film in films {
            // In ascending order, on which the ranges, the binary searches and the order of sums rely.
            list.nodes.extend((film.nodes.start as u32..film.nodes.end as u32).filter(|n| within(*n, skin)));
        }
        // Nodes that have left the list would keep a normal that no step renews.
        self.normals.fill(Vector3::zeros());
        for film in films {
            film.for_each_intact(|corners| {
                let squared = longest_line_squared(corners, nodes);
                let longest = squared.sqrt();
                // No point of an element is farther from its corners than its longest line.
                if !corners.iter().any(|n| within(*n, skin + longest)) {
                    return;
                }
                let corners = [corners[0], corners[1], corners[2], corners[corners.len() - 1]];
                let element = NeighbourElement { corners, longest_squared: squared };
                list.elements.push(element);
                // A corner that is held is no contact of its own.
                let at_support = corners.iter().any(|n| nodes.is_held(*n as usize));
                // The edge of film that bars hold lies on them.
                let is_candidate =
                    if is_long { squared > fine && !at_support } else { !is_smooth || squared > fine || at_support };
                if is_candidate {
                    list.face_candidates.push(element);
                }
            });
        }
        list.place_known(&known, self.surface.is_convex_solid());
        list.partition(films);
        list.margin = skin;
    }
}

impl NeighbourList {
    /// Takes out the candidates with what is known of each, by their corners.
    fn take_known(&mut self) -> HashMap<[u32; 4], (Clearance, Followed)> {
        let followed = self.followed.drain(..).chain(std::iter::repeat(UNKNOWN));
        let known = self.clearances.drain(..).zip(followed);
        self.face_candidates.drain(..).map(|element| element.corners).zip(known).collect()
    }

    /// Places what is `known` of the candidates at their new places: it is of the film and of the body, not of the list,
    /// and what is new is looked at.
    fn place_known(&mut self, known: &HashMap<[u32; 4], (Clearance, Followed)>, is_convex_solid: bool) {
        for element in &self.face_candidates {
            let (clearance, followed) = known.get(&element.corners).copied().unwrap_or((Clearance::NONE, UNKNOWN));
            self.clearances.push(clearance);
            if is_convex_solid {
                self.followed.push(followed);
            }
        }
    }

    /// Derives the ranges and the nodes that may get an impulse from the rest of the list.
    pub(super) fn partition(&mut self, films: &[Film]) {
        self.ranges.clear();
        for film in films {
            let [first, end] = [film.nodes.start, film.nodes.end].map(|n| self.index_of(n));
            self.ranges.extend((first..end).step_by(NODES_PER_RANGE).map(|from| from..end.min(from + NODES_PER_RANGE)));
        }
        if self.ranges.is_empty() {
            // Face contacts may exist without a node in the list; their impulses need a range.
            self.ranges.push(0..0);
        }
        // Corners of face candidates may lie outside the skin; their impulses enter the energy balance like all others.
        let mut corners: Vec<u32> = self.face_candidates.iter().flat_map(|element| element.corners).collect();
        corners.sort_unstable();
        corners.dedup();
        self.impulse_nodes.clone_from(&self.nodes);
        self.impulse_nodes.extend(corners.iter().filter(|n| self.nodes.binary_search(n).is_err()));
        self.impulse_nodes.sort_unstable();
        let place = |n: u32| corners.partition_point(|corner| *corner < n) as u32;
        self.candidate_corners.clear();
        self.candidate_corners.extend(self.face_candidates.iter().map(|element| element.corners.map(place)));
        self.candidate_nodes = corners;
        let is_pushed = |followed: &Followed| followed.iter().any(|point| point.force != [0.0; 3]);
        let pushed = self.followed.iter().enumerate().filter(|(_, followed)| is_pushed(followed));
        self.pushed = pushed.map(|(place, _)| place as u32).collect();
    }

    /// Index of the first listed node whose number is not below `node`.
    fn index_of(&self, node: usize) -> usize {
        self.nodes.partition_point(|n| (*n as usize) < node)
    }

    /// Whether the list fits a scene of `nodes` nodes: ascending, without duplicates, no number out of range.
    pub(in crate::engine) fn fits(&self, nodes: usize) -> bool {
        let corners = self.elements.iter().chain(&self.face_candidates).flat_map(|element| element.corners);
        let mut all = self.nodes.iter().copied().chain(corners);
        let candidates = self.face_candidates.len();
        let has_all_followed = self.followed.is_empty() || self.followed.len() == candidates;
        self.clearances.len() == candidates
            && has_all_followed
            && self.nodes.is_sorted_by(|a, b| a < b)
            && all.all(|n| (n as usize) < nodes)
    }
}

/// Square of the longest line between any two corners, m².
fn longest_line_squared(corners: &[u32], nodes: &Nodes) -> f64 {
    let at = |n: u32| nodes.position_of(n as usize);
    let mut longest = 0.0_f64;
    for (k, a) in corners.iter().enumerate() {
        for b in &corners[k + 1..] {
            longest = longest.max(nalgebra::distance_squared(&at(*a), &at(*b)));
        }
    }
    longest
}

/// State of contact from step to step. The neighbour list is part of it: when it was built decides which elements are
/// candidates for face contact until the next one.
pub(crate) type ContactHistory = (NeighbourList, Work);

impl Contact {
    /// The state after the last step.
    pub(in crate::engine) fn save(&self) -> ContactHistory {
        (self.neighbours.clone(), self.work)
    }

    /// Restores the state of a scene of the same `films`.
    pub(in crate::engine) fn restore(&mut self, (neighbours, work): ContactHistory, films: &[Film]) {
        // Every step stores those of the list before it reads them.
        self.normals.fill(Vector3::zeros());
        (self.neighbours, self.work) = (neighbours, work);
        self.rounded = self.surface.with_edges(self.neighbours.edge);
        self.neighbours.partition(films);
    }
}
