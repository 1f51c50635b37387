//! Kinematic contact between faces of film.
//!
//! Every node follows the nearest triangle of the next face on either side of its own ([`tracking`]), every edge the
//! edges that it crosses there ([`crossing`]); the [`broad_phase`] finds the first of them. Where one of them would
//! come closer than the film is thick in a step ([`narrow_phase`]), a constraint gives both films opposite impulses
//! ([`constraint`], [`solver`]; theory.md, section 6). The side on which a node lies is that on which it came, so film
//! that moves by more than its thickness in a step does not pass through. A face that meets itself has pairs of its own
//! ([`self_contact`]), whose constraints are solved with the others.

mod broad_phase;
mod constraint;
mod crossing;
mod due;
mod narrow_phase;
mod self_contact;
mod solver;
mod surface;
mod tracking;
#[cfg(test)]
mod tests;

pub(super) use solver::{ROUNDS, SWEEPS, TOLERANCE};

use serde::{Deserialize, Serialize};

use super::energy::ContactLoss;
use super::film::Film;
use super::nodes::{Nodes, Vectors};
use super::thread_pool::ThreadPool;
use constraint::{Carried, FilmConstraint};
use crossing::Crossings;
use narrow_phase::Found;
use self_contact::SelfContact;
use solver::Sweeps;
use surface::{NONE, Surface, are_below, place};
use tracking::Tracking;

/// Share of the thickness of two films by which they may approach each other: aligned meshes on a curved body come a
/// little closer than that along the normals of their triangles.
const SLOP: f64 = 0.1;

/// Distance up to which films are searched for beyond twice the largest allowed one, over the longest edge of an element as
/// mounted.
const REACH: f64 = 0.75;

/// Contact between all faces of film, and of each with itself.
pub struct FilmContact {
    friction: f64,
    /// Whether faces meet each other.
    is_between_faces: bool,
    /// Contact of each face with itself, where it is computed.
    itself: Option<SelfContact>,
    multiplicity: f64,
    surface: Surface,
    /// Half the thickness of each face, m.
    half: Vec<f64>,
    /// Largest least allowed distance of two faces, m.
    largest_bound: f64,
    /// Distance up to which films are searched for, m.
    reach: f64,
    constraints: Vec<FilmConstraint>,
    /// Whether the constraints of the present step have been found.
    has_begun: bool,
    sweeps: Sweeps,
    /// Results of each task of a detection.
    found: Vec<Found>,
    /// Motion of nodes since the last detection that it allows for, m.
    detected_within: f64,
    /// Half a step before the present one, m/s.
    previous_velocity: Vectors,
    pub(super) history: History,
}

/// What contact between films keeps from step to step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct History {
    /// Towards the faces before that of each node, and after it.
    tracking: [Tracking; 2],
    crossings: Crossings,
    /// Impulses of the last step, by what they belong to.
    carried: Vec<Carried>,
    /// Edges whose crossings have to be found anew.
    stale: Vec<u32>,
    /// Whether any node follows another face.
    is_near: bool,
    /// Motion of film that is left until faces are searched again, m.
    margin: f64,
    /// Bound on the motion of a node in the last step, m.
    last_motion: f64,
    /// Largest motion of a node by contact in the last step, m.
    pushed: f64,
    /// Positions at the last detection, m; none before the first.
    detected: Vectors,
    /// Path of film so far, m, as of [`due`].
    path: f64,
    /// Steps so far.
    steps: u64,
    /// Times that a node or a crossing was lost.
    lost: u64,
    /// Steps whose sweeps did not converge.
    unresolved: u64,
    /// Dissipated since the start.
    pub(super) loss: ContactLoss,
}

/// State of contact between films, and of faces with themselves, from step to step.
pub(super) type FilmContactHistory = (History, Option<self_contact::State>);

/// State of contact between faces at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmContactState {
    /// Least distance of the middle surfaces of two faces, m, up to the distance in which it is followed; negative
    /// where one has passed through the other.
    pub distance: f64,
    /// Nodes that press on another face.
    pub nodes: usize,
    /// Times so far that contact between two faces was given up at a node or two edges, because these lay beyond each
    /// other: where film folds sharply, or has passed through.
    pub lost: u64,
    /// Steps so far in which the impulses between faces did not converge, and all steps.
    pub unresolved: [u64; 2],
}

impl FilmContact {
    /// Contact of `films` mounted on `nodes`, counted for `multiplicity` mirror images, with the coefficient
    /// `friction`: of none so far.
    pub fn new(films: &[Film], nodes: &Nodes, friction: f64, multiplicity: f64) -> FilmContact {
        let count = nodes.mass.len();
        let surface = Surface::new(films);
        let length = |[a, b]: &[u32; 2]| (nodes.position_of(*a as usize) - nodes.position_of(*b as usize)).norm();
        let longest = surface.edges.iter().map(length).fold(0.0, f64::max);
        let tracking = [(); 2].map(|()| Tracking::new(count));
        let history = History { tracking, crossings: Crossings::new(surface.edges.len()), ..History::default() };
        let largest_bound = (1.0 - SLOP) * films.iter().map(|film| film.thickness).fold(0.0, f64::max);
        FilmContact {
            friction,
            is_between_faces: false,
            itself: None,
            multiplicity,
            surface,
            half: films.iter().map(|film| 0.5 * film.thickness).collect(),
            largest_bound,
            // Beyond the allowed distance, so that film has to move until what was not found touches.
            reach: REACH * longest + 2.0 * largest_bound,
            constraints: vec![],
            has_begun: false,
            sweeps: Sweeps::default(),
            found: vec![],
            detected_within: 0.0,
            previous_velocity: Vectors::zero(count),
            history,
        }
    }

    /// Lets faces meet each other.
    pub(super) fn meet_each_other(&mut self) {
        self.is_between_faces = true;
    }

    /// Lets each of `films` meet itself, which have not moved since they were mounted on `nodes`.
    pub(super) fn meet_themselves(&mut self, films: &[Film], nodes: &Nodes) {
        self.itself = Some(SelfContact::new(films, &self.surface, nodes));
    }

    /// Searches anew before the next step, after film was moved.
    pub(super) fn invalidate(&mut self) {
        self.history.margin = 0.0;
        self.itself.iter_mut().for_each(SelfContact::invalidate);
    }

    /// Forgets the elements of `films` that have failed.
    pub(super) fn remove_deleted(&mut self, films: &[Film]) {
        if !self.surface.remove_deleted(films) {
            return;
        }
        self.itself.iter_mut().for_each(|itself| itself.remove_deleted(&self.surface));
        let History { tracking, crossings, stale, margin, .. } = &mut self.history;
        for tracking in tracking {
            for node in 0..tracking.triangle.len() {
                let triangle = tracking.triangle[node];
                // A node that has lost all of its elements is a point mass beside the film.
                let is_kept = |triangle: u32| {
                    self.surface.is_intact[triangle as usize] && self.surface.is_intact_node(node as u32)
                };
                if triangle != NONE && !is_kept(triangle) {
                    tracking.lose(node);
                    stale.extend_from_slice(self.surface.edges_at(node as u32));
                }
            }
        }
        // From the last one on, since a removed place is filled by the last crossing.
        for place in crossings.places().rev() {
            if crossings.edges(place).iter().any(|edge| !self.surface.is_intact_edge[*edge as usize]) {
                crossings.remove(place);
            }
        }
        *margin = 0.0;
    }

    /// Searches where that is due, before the nodes move, and records their velocities.
    pub(super) fn prepare(&mut self, films: &[Film], nodes: &Nodes) {
        // Films that were too far apart may come nearer by the motion of both.
        // A motion that is not finite must not leave a list in use for ever.
        if self.is_between_faces
            && (self.history.margin.is_nan() || self.history.margin <= 2.0 * self.history.last_motion)
        {
            self.search(films, nodes);
        }
        self.itself.iter_mut().for_each(|itself| itself.prepare(&self.surface, nodes, self.history.last_motion));
        self.list_crossings(&nodes.position);
        self.constraints.clear();
        if self.is_near() {
            // All nodes: which of them contact will reach is known only in the step.
            self.previous_velocity.clone_from(&nodes.velocity);
        } else {
            self.history.carried.clear();
        }
    }

    /// Whether any node follows another face, or parts of a face are near each other.
    pub(super) fn is_near(&self) -> bool {
        self.history.is_near || self.itself.as_ref().is_some_and(|itself| !itself.state.pairs.is_empty())
    }

    /// Reduces the motion that is left until the next search, after a step in which nodes have moved by at most
    /// `distance` (m).
    pub(super) fn reduce_margin(&mut self, distance: f64) {
        self.history.margin -= 2.0 * distance;
        self.itself.iter_mut().for_each(|itself| itself.reduce_margin(distance));
        self.history.last_motion = distance;
        self.history.steps += 1;
    }

    /// Marks the edges whose crossings a node changes that follows `triangle`, or did so before.
    fn mark(&mut self, node: u32, triangle: u32) {
        self.history.stale.extend_from_slice(self.surface.edges_at(node));
        self.history.stale.extend_from_slice(&self.surface.edges_of[triangle as usize]);
    }

    /// Finds the crossings of the stale edges anew: of these, and of all that crossed one of them.
    fn list_crossings(&mut self, position: &Vectors) {
        let History { tracking, crossings, stale: edges, path, .. } = &mut self.history;
        if edges.is_empty() {
            return;
        }
        edges.sort_unstable();
        edges.dedup();
        let mut places: Vec<u32> = edges.iter().flat_map(|edge| crossings.of_edge(*edge)).copied().collect();
        places.sort_unstable();
        places.dedup();
        // From the last one on, since it takes the place of what is removed.
        for place in places.iter().rev() {
            // The partner may cross others as well by now: it is looked at, too.
            edges.extend(crossings.remove(*place as usize));
        }
        edges.sort_unstable();
        edges.dedup();
        edges.retain(|edge| self.surface.is_intact_edge[*edge as usize]);
        // Corners first: a crossing next to a node that lies on a corner is not listed.
        for node in edges.iter().flat_map(|edge| self.surface.edges[*edge as usize]) {
            tracking.iter_mut().for_each(|tracking| tracking.find_corner(node as usize, position));
        }
        let [before, after] = &*tracking;
        let mut found = vec![];
        for edge in &*edges {
            // From both faces: each edge is walked over the other face, and a crossing that both find is pushed once.
            for tracking in [[before, after], [after, before]] {
                crossing::find(&self.surface, (position, *path), tracking, *edge, &mut found);
            }
        }
        for crossing in found {
            if crossings.place(crossing.edges).is_none() {
                crossings.push(crossing, &self.surface);
            }
        }
        edges.clear();
    }

    /// The present state.
    pub(super) fn state(&self, nodes: &Nodes, pool: &ThreadPool) -> FilmContactState {
        let position = &nodes.position;
        let mut distance = self.reach;
        for tracking in self.history.tracking.iter().filter(|_| self.history.is_near) {
            let followed = |n: &usize| tracking.triangle[*n] != NONE && tracking.pairs.sign[*n] != 0.0;
            for n in (0..tracking.triangle.len()).filter(followed) {
                let foot = tracking::foot(&self.surface, position, &place(position, n), tracking.triangle[n]);
                // Beside the outline the distance along the normal means nothing.
                if foot.is_over {
                    distance = distance.min(tracking.pairs.sign[n] * foot.distance);
                }
            }
        }
        distance = self.least_of_crossings(position, distance, pool);
        if let Some(itself) = &self.itself {
            distance = itself.least_distance(&self.surface, position, distance);
        }
        FilmContactState {
            distance,
            nodes: self.pressed_nodes(),
            lost: self.history.lost,
            unresolved: [self.history.unresolved, self.history.steps],
        }
    }

    /// Whether `films` that have not moved yet lie on the sides of each other on which they were mounted, where they meet
    /// each other.
    pub(super) fn find_in_order(&mut self, films: &[Film], nodes: &Nodes) -> bool {
        if !self.is_between_faces {
            return true;
        }
        self.search(films, nodes);
        let is_wrong = |(tracking, expected): (&Tracking, f64)| tracking.pairs.sign.contains(&-expected);
        !self.history.tracking.iter().zip([-1.0, 1.0]).any(is_wrong)
    }

    /// The state after the last step.
    pub(super) fn save(&self) -> FilmContactHistory {
        (self.history.clone(), self.itself.as_ref().map(|itself| itself.state.clone()))
    }

    /// Restores the state of a scene of the same `films`, whose elements have failed as they had then.
    pub(super) fn restore(&mut self, (history, of_faces): FilmContactHistory, films: &[Film]) {
        self.surface.remove_deleted(films);
        if let (Some(itself), Some(state)) = (&mut self.itself, of_faces) {
            itself.restore(state, &self.surface);
        }
        self.history = history;
    }

    /// Whether a state fits its faces.
    pub(super) fn fits(&self, (history, of_faces): &FilmContactHistory) -> bool {
        let (nodes, surface) = (self.previous_velocity.len(), &self.surface);
        let edges = surface.edges.len();
        history.tracking.iter().all(|tracking| tracking.fits(nodes, surface))
            && history.crossings.fits(nodes, edges)
            && history.carried.iter().all(|carried| carried.fits(nodes, surface))
            && history.detected.is_whole()
            && [0, nodes].contains(&history.detected.len())
            && are_below(&history.stale, edges)
            && of_faces.is_some() == self.itself.is_some()
            && of_faces.as_ref().is_none_or(|state| state.fits(nodes, surface))
    }
}
