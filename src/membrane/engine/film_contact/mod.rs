//! Kinematic contact between faces of film.
//!
//! Every node follows the nearest triangle of the next face on either side of its own ([`tracking`]), every edge the
//! edges that it crosses there ([`crossing`]). Where one of them would come closer than the film is thick in a step, a
//! constraint gives both films opposite impulses ([`constraint`]; theory.md, section 6). The side on which a node lies is
//! that on which it came, so film that moves by more than its thickness in a step does not pass through.

mod constraint;
mod crossing;
mod detection;
mod history;
mod search;
mod surface;
mod tracking;
#[cfg(test)]
mod tests;

pub(super) use history::FilmContactHistory;

use std::ops::Range;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::disjoint::Disjoint;
use super::film::Film;
use super::footprint::bytes;
use super::nodes::{Nodes, Vectors};
use super::thread_pool::ThreadPool;
use constraint::{Constraint, Pair, Source, Unusable};
use crossing::Crossing;
use detection::{Crossed, FoundCrossings};
use search::Search;
use surface::{NONE, Surface};
use tracking::{Foot, Tracking};

/// Share of the thickness of two films by which they may approach each other: aligned meshes on a curved body come a
/// little closer than that along the normals of their triangles.
const SLOP: f64 = 0.1;

/// Distance up to which films are searched for, over the longest edge of an element as mounted.
const REACH: f64 = 0.75;

/// Nodes of a task.
const NODES_PER_RANGE: usize = 1024;

/// Crossings of a task.
const CROSSINGS_PER_RANGE: usize = 512;

/// Largest number of Gauss–Seidel sweeps in a step.
pub(super) const SWEEPS: usize = 128;

/// How often film that comes too close by the impulses of other contacts is added to them in a step.
pub(super) const ROUNDS: usize = 6;

/// Change of the normal distance in a sweep, over the least allowed one, below which the sweeps have converged.
pub(super) const TOLERANCE: f64 = 0.02;

/// Contact between all faces of film.
pub struct FilmContact {
    friction: f64,
    multiplicity: f64,
    surface: Surface,
    /// Half the thickness of each face, m.
    half: Vec<f64>,
    /// m.
    reach: f64,
    /// Motion of film that is left until faces are searched again, m.
    margin: f64,
    /// Towards the faces before that of each node, and after it.
    tracking: [Tracking; 2],
    crossings: Vec<Crossing>,
    constraints: Vec<Constraint>,
    /// What they belong to, ascending.
    listed: Vec<Source>,
    /// Half a step before the present one, m/s.
    previous_velocity: Vectors,
    /// As predicted without contact, m/s; with damping only.
    predicted: Vectors,
    /// Edges whose crossings have to be found anew.
    stale: Vec<u32>,
    /// Whether an edge is one of these, while they are found.
    is_stale: Vec<bool>,
    /// Whether any node follows another face.
    is_near: bool,
    /// Whether the constraints of the present step have been found.
    has_begun: bool,
    /// Bound on the motion of a node in the last step, m.
    last_motion: f64,
    /// Steps so far.
    steps: u64,
    /// Times that a node or a crossing was lost.
    lost: u64,
    /// Work since the start.
    pub(super) work: FilmWork,
}

/// Running totals of the work of contact between films, J.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct FilmWork {
    /// Dissipated where films come into contact.
    pub(super) impact_loss: f64,
    /// Dissipated by friction.
    pub(super) friction_loss: f64,
}

/// State of contact between faces at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmContactState {
    /// Least distance of the middle surfaces of two faces, m, up to the distance in which it is followed; negative where one
    /// has passed through the other.
    pub distance: f64,
    /// Nodes that press on another face.
    pub nodes: usize,
    /// Times so far that contact between two faces was given up at a node or two edges, because these lay beyond each
    /// other: where film folds sharply, or has passed through.
    pub lost: u64,
}

/// What one task finds.
#[derive(Default)]
struct Found {
    near: Vec<u32>,
    crossings: FoundCrossings,
    constraints: Vec<Constraint>,
    /// Node and foot of those whose triangle or side has changed.
    moved: Vec<(u32, Foot)>,
    /// Nodes or crossings that do not lie on the sides of each other on which they were.
    lost: Vec<usize>,
}

impl FilmContact {
    /// Contact of `films` mounted on `nodes`, counted for `multiplicity` mirror images, with the coefficient `friction`.
    pub fn new(films: &[Film], nodes: &Nodes, friction: f64, multiplicity: f64) -> FilmContact {
        let count = nodes.mass.len();
        let surface = Surface::new(films);
        let length = |[a, b]: &[u32; 2]| (nodes.position_of(*a as usize) - nodes.position_of(*b as usize)).norm();
        let longest = surface.edges.iter().map(length).fold(0.0, f64::max);
        FilmContact {
            friction,
            multiplicity,
            surface,
            half: films.iter().map(|film| 0.5 * film.thickness).collect(),
            reach: REACH * longest,
            margin: 0.0,
            tracking: [(); 2].map(|()| Tracking::new(count)),
            crossings: vec![],
            constraints: vec![],
            listed: vec![],
            previous_velocity: Vectors::zero(count),
            predicted: Vectors::default(),
            stale: vec![],
            is_stale: vec![],
            is_near: false,
            has_begun: false,
            last_motion: 0.0,
            steps: 0,
            lost: 0,
            work: FilmWork::default(),
        }
    }

    /// Bytes of the arrays that grow with the mesh.
    pub(super) fn bytes(&self) -> usize {
        let tracking: usize = self.tracking.iter().map(Tracking::bytes).sum();
        let velocity = self.previous_velocity.bytes() + self.predicted.bytes();
        self.surface.bytes() + tracking + velocity + bytes(&self.crossings) + bytes(&self.is_stale)
    }

    /// Searches anew before the next step, after film was moved.
    pub(super) fn invalidate(&mut self) {
        self.margin = 0.0;
    }

    /// Forgets the elements of `films` that have failed.
    pub(super) fn remove_deleted(&mut self, films: &[Film]) {
        if !self.surface.remove_deleted(films) {
            return;
        }
        for tracking in &mut self.tracking {
            for node in 0..tracking.triangle.len() {
                let triangle = tracking.triangle[node];
                if triangle != NONE && !self.surface.is_intact[triangle as usize] {
                    tracking.lose(node);
                    self.stale.extend_from_slice(self.surface.edges_at(node as u32));
                }
            }
        }
        let is_intact = &self.surface.is_intact_edge;
        self.crossings.retain(|crossing| crossing.edges.iter().all(|edge| is_intact[*edge as usize]));
        self.margin = 0.0;
    }

    /// Searches where that is due, before the nodes move, and records their velocities.
    pub(super) fn prepare(&mut self, films: &[Film], nodes: &Nodes) {
        // Films that were too far apart may come nearer by the motion of both.
        if self.margin.is_nan() || self.margin <= 2.0 * self.last_motion {
            self.search(films, nodes);
        }
        self.list_crossings(&nodes.position);
        self.constraints.clear();
        self.has_begun = false;
        if self.is_near {
            self.previous_velocity.clone_from(&nodes.velocity);
        }
    }

    /// Whether any node follows another face.
    pub(super) fn is_near(&self) -> bool {
        self.is_near
    }

    /// Reduces the motion that is left until the next search, after a step in which nodes have moved by at most
    /// `distance` (m).
    pub(super) fn reduce_margin(&mut self, distance: f64) {
        self.margin -= 2.0 * distance;
        self.last_motion = distance;
        self.steps += 1;
    }

    /// Searches the next face on either side of every node that has none in touch.
    fn search(&mut self, films: &[Film], nodes: &Nodes) {
        let mut search = Search::new(films, &self.surface, &nodes.position, self.reach);
        let mut changed = vec![];
        for (face, film) in films.iter().enumerate() {
            for (side, tracking) in self.tracking.iter_mut().enumerate() {
                let others: Vec<usize> = match side {
                    0 => (0..face).rev().filter(|other| search.may_meet(face, *other)).collect(),
                    _ => (face + 1..films.len()).filter(|other| search.may_meet(face, *other)).collect(),
                };
                for node in film.nodes.clone() {
                    let followed = tracking.triangle[node];
                    if followed != NONE {
                        let now = tracking::foot(&self.surface, &nodes.position, &place(nodes, node), followed);
                        // Nothing comes between films that touch each other.
                        if now.is_over && now.distance.abs() < 0.1 * self.reach {
                            continue;
                        }
                    }
                    let mut beside = None;
                    let over = others.iter().find_map(|other| {
                        let foot = search.nearest(node as u32, *other)?;
                        if foot.is_over && foot.distance.abs() < self.reach {
                            return Some(foot);
                        }
                        beside = beside.or(Some(foot));
                        None
                    });
                    let Some(foot) = over.or(beside) else {
                        if followed != NONE {
                            changed.push((node as u32, followed));
                            tracking.lose(node);
                        }
                        continue;
                    };
                    let other = self.surface.face_of(foot.triangle);
                    let same_face = followed != NONE && self.surface.face_of(followed) == other;
                    let kept = if same_face { tracking.sign[node] } else { 0.0 };
                    let sign = match (foot.is_over, kept != 0.0) {
                        (true, true) => kept,
                        (true, false) => 1.0_f64.copysign(foot.distance),
                        (false, _) => 0.0,
                    };
                    let thickness = self.half[face] + self.half[other];
                    if foot.triangle != followed || sign != tracking.sign[node] {
                        changed.push((node as u32, foot.triangle));
                        changed.extend((followed != NONE).then_some((node as u32, followed)));
                    }
                    tracking.follow(node, foot.triangle, sign, &self.surface);
                    tracking.bound[node] = (1.0 - SLOP) * thickness;
                }
            }
        }
        self.margin = self.reach;
        self.is_near = self.tracking.iter().any(|tracking| tracking.triangle.iter().any(|t| *t != NONE));
        changed.into_iter().for_each(|(node, triangle)| self.mark(node, triangle));
    }

    /// Marks the edges whose crossings a node changes that follows `triangle`, or did so before.
    fn mark(&mut self, node: u32, triangle: u32) {
        self.stale.extend_from_slice(self.surface.edges_at(node));
        self.stale.extend_from_slice(&self.surface.edges_of[triangle as usize]);
    }

    /// Finds the crossings of the stale edges anew: of these, and of all that crossed one of them.
    fn list_crossings(&mut self, position: &Vectors) {
        if self.stale.is_empty() {
            return;
        }
        self.is_stale.resize(self.surface.edges.len(), false);
        self.stale.iter().for_each(|edge| self.is_stale[*edge as usize] = true);
        let mut old = vec![];
        self.crossings.retain(|crossing| {
            let is_stale = crossing.edges.iter().any(|edge| self.is_stale[*edge as usize]);
            old.extend(is_stale.then_some(*crossing));
            !is_stale
        });
        self.stale.iter().for_each(|edge| self.is_stale[*edge as usize] = false);
        let mut walkers: Vec<u32> =
            old.iter().flat_map(|crossing| crossing.edges).chain(self.stale.drain(..)).collect();
        walkers.sort_unstable();
        walkers.dedup();
        walkers.retain(|edge| self.surface.is_intact_edge[*edge as usize]);
        let mut found = vec![];
        for walker in walkers {
            for tracking in &self.tracking {
                crossing::find(&self.surface, position, tracking, walker, &mut found);
            }
        }
        old.sort_unstable_by_key(|crossing| crossing.edges);
        for crossing in &mut found {
            if let Ok(place) = old.binary_search_by_key(&crossing.edges, |old| old.edges) {
                (crossing.impulse, crossing.pressed) = (old[place].impulse, old[place].pressed);
            }
        }
        self.crossings.extend(found);
        self.crossings.sort_by_key(|crossing| crossing.edges);
        self.crossings.dedup_by_key(|crossing| crossing.edges);
    }

    /// Finds what would come too close at the end of a step of `dt` (s), for which the nodes have their predicted positions,
    /// and starts from the impulses of the last one; in further sweeps of a step, adds what is new. Returns whether there
    /// is anything.
    pub(super) fn begin(&mut self, nodes: &mut Nodes, dt: f64, pool: &ThreadPool) -> bool {
        if std::mem::replace(&mut self.has_begun, true) {
            self.extend(nodes, dt, pool);
            return !self.constraints.is_empty();
        }
        self.constraints = self.detect(nodes, dt, pool);
        for constraint in &mut self.constraints {
            let (impulse, pressed) = match constraint.source {
                Source::Node { side, node } => {
                    let tracking = &self.tracking[side];
                    (tracking.impulse[node as usize], tracking.pressed[node as usize])
                }
                Source::Crossing(place) => (self.crossings[place].impulse, self.crossings[place].pressed),
            };
            // Steps count from one here, since nothing is pressed in step zero.
            if pressed == self.steps && pressed > 0 {
                constraint.start_from(impulse, &mut nodes.velocity);
                constraint.move_nodes(&mut nodes.position, dt);
            }
        }
        !self.constraints.is_empty()
    }

    /// Moves the nodes by the impulses so far, and adds what comes too close by them. Returns whether anything does.
    pub(super) fn extend(&mut self, nodes: &mut Nodes, dt: f64, pool: &ThreadPool) -> bool {
        self.constraints.iter_mut().for_each(|constraint| constraint.move_nodes(&mut nodes.position, dt));
        self.listed.clear();
        self.listed.extend(self.constraints.iter().map(|constraint| constraint.source));
        self.listed.sort_unstable();
        let mut more = self.detect(nodes, dt, pool);
        more.retain(|constraint| self.listed.binary_search(&constraint.source).is_err());
        let any = !more.is_empty();
        self.constraints.append(&mut more);
        any
    }

    /// Constraints of what is too close, in the order of their sources.
    fn detect(&mut self, nodes: &Nodes, dt: f64, pool: &ThreadPool) -> Vec<Constraint> {
        let (count, crossings) = (nodes.mass.len(), self.crossings.len());
        let cut = |end: usize, by: usize| (0..end).step_by(by).map(move |from| from..end.min(from + by));
        let sides =
            [0, 1].into_iter().flat_map(|side| cut(count, NODES_PER_RANGE).map(move |range| (Some(side), range)));
        let tasks: Vec<(Option<usize>, Range<usize>)> =
            sides.chain(cut(crossings, CROSSINGS_PER_RANGE).map(|range| (None, range))).collect();
        let mut found: Vec<Found> = tasks.iter().map(|_| Found::default()).collect();
        let results = Disjoint::new(&mut found);
        pool.each(tasks.len(), |part| {
            // SAFETY: every part comes up once.
            let found = unsafe { results.at(part) };
            let (side, range) = tasks[part].clone();
            match side {
                Some(side) => self.near_nodes(pool, nodes, side, range, dt, found),
                None => self.near_crossings(pool, nodes, range, dt, found),
            }
        });
        let mut constraints = Vec::with_capacity(found.iter().map(|found| found.constraints.len()).sum());
        for ((side, _), found) in tasks.iter().zip(found) {
            constraints.extend(found.constraints);
            self.lost += found.lost.len() as u64;
            let Some(side) = *side else {
                let again = found.lost.iter().chain(&found.crossings.turned);
                self.stale.extend(again.flat_map(|place| self.crossings[*place].edges));
                found.lost.iter().for_each(|place| self.crossings[*place].sign = 0.0);
                continue;
            };
            for (node, foot) in found.moved {
                let n = node as usize;
                let (before, sign) = (self.tracking[side].triangle[n], self.tracking[side].sign[n]);
                let sign = match (foot.is_over, sign == 0.0) {
                    (true, false) => sign,
                    // The side on which it was before the step.
                    (true, true) => 1.0_f64.copysign(foot.distance - dt * self.approach(nodes, n, &foot)),
                    (false, _) => 0.0,
                };
                self.tracking[side].follow(n, foot.triangle, sign, &self.surface);
                self.mark(node, before);
                self.mark(node, foot.triangle);
            }
            for n in found.lost {
                self.mark(n as u32, self.tracking[side].triangle[n]);
                self.tracking[side].lose(n);
                self.margin = 0.0;
            }
        }
        constraints
    }

    /// Velocity of a node over its foot along the normal, m/s.
    fn approach(&self, nodes: &Nodes, node: usize, foot: &Foot) -> f64 {
        let corners = self.surface.corners[foot.triangle as usize];
        let film: Vector3<f64> = (0..3).map(|k| nodes.velocity_of(corners[k] as usize) * foot.weights[k]).sum();
        (nodes.velocity_of(node) - film).dot(&foot.normal)
    }

    /// Constraints of nodes of `range`, and those of them that follow another triangle from now on.
    fn near_nodes(
        &self,
        pool: &ThreadPool,
        nodes: &Nodes,
        side: usize,
        range: Range<usize>,
        dt: f64,
        found: &mut Found,
    ) {
        let tracking = &self.tracking[side];
        detection::near_nodes(pool.width(), tracking, &nodes.position, range, &mut found.near);
        for node in &found.near {
            let n = *node as usize;
            let (triangle, sign) = (tracking.triangle[n], tracking.sign[n]);
            let foot = tracking::foot(&self.surface, &nodes.position, &place(nodes, n), triangle);
            if foot.triangle != triangle || foot.is_over != (sign != 0.0) {
                found.moved.push((*node, foot));
            }
            let bound = tracking.bound[n];
            if !foot.is_over || sign == 0.0 || sign * foot.distance >= bound {
                continue;
            }
            let [a, b, c] = self.surface.corners[foot.triangle as usize];
            let pair = Pair {
                nodes: [*node, a, b, c],
                weights: [1.0, -foot.weights[0], -foot.weights[1], -foot.weights[2]],
                normal: foot.normal * sign,
                distance: sign * foot.distance,
                bound,
            };
            match Constraint::new(Source::Node { side, node: *node }, pair, nodes, dt) {
                Ok(constraint) => found.constraints.push(constraint),
                Err(Unusable::Held) => (),
                Err(Unusable::Beyond) => found.lost.push(n),
            }
        }
    }

    /// Constraints of the crossings of `range`.
    fn near_crossings(&self, pool: &ThreadPool, nodes: &Nodes, range: Range<usize>, dt: f64, found: &mut Found) {
        let (crossings, surface) = (&self.crossings, &self.surface);
        let all = &mut found.crossings;
        detection::near_crossings(pool.width(), crossings, surface, &nodes.position, range, 1.0, all);
        for Crossed { place, shares: [s, t], normal, distance } in &found.crossings.crossed {
            let crossing = &crossings[*place];
            let pair = Pair {
                nodes: crossing.nodes(surface),
                weights: [1.0 - s, *s, *t - 1.0, -*t],
                normal: Vector3::from(*normal),
                distance: *distance,
                bound: crossing.bound,
            };
            match Constraint::new(Source::Crossing(*place), pair, nodes, dt) {
                Ok(constraint) => found.constraints.push(constraint),
                Err(Unusable::Held) => (),
                Err(Unusable::Beyond) => found.lost.push(*place),
            }
        }
    }

    /// One sweep over all constraints of a step of `dt` (s), and one back. Returns whether they have converged.
    pub(super) fn sweep(&mut self, nodes: &mut Nodes, dt: f64) -> bool {
        let (friction, velocity) = (self.friction, &mut nodes.velocity);
        let mut largest = 0.0_f64;
        for constraint in &mut self.constraints {
            constraint.solve(friction, velocity);
        }
        for constraint in self.constraints.iter_mut().rev() {
            let moved = constraint.solve(friction, velocity) * dt;
            largest = largest.max(moved / constraint.bound);
        }
        largest <= TOLERANCE
    }

    /// Sweeps of a step without another body.
    pub(super) fn resolve(&mut self, nodes: &mut Nodes, dt: f64, pool: &ThreadPool) {
        let mut any = self.is_near && self.begin(nodes, dt, pool);
        for _ in 0..ROUNDS {
            if !any {
                break;
            }
            for _ in 0..SWEEPS {
                if self.sweep(nodes, dt) {
                    break;
                }
            }
            any = self.extend(nodes, dt, pool);
        }
    }

    /// Moves the nodes by the impulses of a step of `dt` (s), stores these, and adds their work. Returns the largest speed of
    /// these nodes, m/s.
    pub(super) fn finish(&mut self, nodes: &mut Nodes, dt: f64) -> f64 {
        let Nodes { position, velocity, .. } = nodes;
        let mut fastest = 0.0_f64;
        for constraint in &mut self.constraints {
            constraint.move_nodes(position, dt);
            match constraint.source {
                // Lost by the impulses of others in this step.
                Source::Node { side, node } if self.tracking[side].triangle[node as usize] == NONE => {}
                Source::Node { side, node } => {
                    self.tracking[side].impulse[node as usize] = constraint.impulse();
                    self.tracking[side].pressed[node as usize] = self.steps + 1;
                }
                Source::Crossing(place) => {
                    let crossing = &mut self.crossings[place];
                    (crossing.impulse, crossing.pressed) = (constraint.impulse(), self.steps + 1);
                }
            }
            let [normal, tangential] = constraint.work(&self.previous_velocity, velocity);
            self.work.impact_loss -= self.multiplicity * normal;
            self.work.friction_loss -= self.multiplicity * tangential;
            let squared = |n: &u32| Vector3::from(velocity.at(*n as usize)).norm_squared();
            fastest = constraint.nodes.iter().map(squared).fold(fastest, f64::max);
        }
        fastest.sqrt()
    }

    /// Records the predicted velocities of all nodes.
    pub(super) fn record_prediction(&mut self, nodes: &Nodes) {
        self.predicted.clone_from(&nodes.velocity);
    }

    /// Sum over all nodes of what contact of any kind changes in the work of mass-proportional damping, kg m²/s²:
    /// m v̄·½Δv with the mean `v̄` of the velocities before the step and of the predictor and the change `Δv` by contact.
    pub(super) fn damping_correction(&self, nodes: &Nodes) -> f64 {
        let of = |n: usize| {
            let [before, predicted, after] =
                [&self.previous_velocity, &self.predicted, &nodes.velocity].map(|all| Vector3::from(all.at(n)));
            0.25 * nodes.mass[n] * (after - predicted).dot(&(before + predicted))
        };
        (0..nodes.mass.len()).map(of).sum()
    }

    /// The present state.
    pub(super) fn state(&self, nodes: &Nodes, pool: &ThreadPool) -> FilmContactState {
        let position = &nodes.position;
        let mut distance = self.reach;
        for tracking in self.tracking.iter().filter(|_| self.is_near) {
            let followed = |n: &usize| tracking.triangle[*n] != NONE && tracking.sign[*n] != 0.0;
            for n in (0..tracking.triangle.len()).filter(followed) {
                let foot = tracking::foot(&self.surface, position, &place(nodes, n), tracking.triangle[n]);
                if foot.is_over {
                    distance = distance.min(tracking.sign[n] * foot.distance);
                }
            }
        }
        let mut found = FoundCrossings::default();
        let (all, far) = (0..self.crossings.len(), f64::INFINITY);
        let (crossings, surface) = (&self.crossings, &self.surface);
        detection::near_crossings(pool.width(), crossings, surface, position, all, far, &mut found);
        distance = found.crossed.iter().map(|crossed| crossed.distance).fold(distance, f64::min);
        let mut pressed: Vec<u32> =
            self.constraints.iter().filter(|constraint| constraint.is_active()).flat_map(|c| c.nodes).collect();
        pressed.sort_unstable();
        pressed.dedup();
        FilmContactState { distance, nodes: pressed.len(), lost: self.lost }
    }

    /// Whether `films` that have not moved yet lie on the sides of each other on which they were mounted.
    pub(super) fn find_in_order(&mut self, films: &[Film], nodes: &Nodes) -> bool {
        self.search(films, nodes);
        let is_wrong = |(tracking, expected): (&Tracking, f64)| tracking.sign.contains(&-expected);
        !self.tracking.iter().zip([-1.0, 1.0]).any(is_wrong)
    }
}

/// Position of a node.
fn place(nodes: &Nodes, node: usize) -> Vector3<f64> {
    Vector3::from(nodes.position.at(node))
}
