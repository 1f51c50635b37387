//! Face contact: elements that penetrate between their nodes.

use nalgebra::{Isometry3, Vector3};

use super::friction::Friction;
use super::impulse_sums::ImpulseSums;
use super::neighbours::NeighbourElement;
use super::surface::{DeepestPoint, Followed, UNKNOWN};
use super::{Contact, FACE_PENETRATION, Impulse, SAGITTA_SHARE};
use crate::engine::film_contact::{self, FilmContact};
use crate::engine::nodes::Nodes;
use crate::engine::rigid_body::RigidBody;
use crate::engine::thread_pool::ThreadPool;

/// Share of a penetration beyond the allowed one that is recovered in one step, so that an element which is already too
/// deep when it is listed does not gain velocity.
const RECOVERY: f64 = 0.02;

/// The same on a body with edges, and of elements beside what holds them: film that is lifted there gains energy, which a slower
/// recovery leaves to be small.
const RECOVERY_AT_EDGES: f64 = 0.002;

/// Largest number of Gauss–Seidel sweeps in a step.
const SWEEPS: usize = 10;

/// The same on a body with edges, where an element meets several at once.
const SWEEPS_AT_EDGES: usize = 40;

/// Change of impulse in a sweep, over the largest impulse, below which the sweeps have converged.
const TOLERANCE: f64 = 1e-3;

/// Depth over the allowed one by which a point that is followed may be off the deepest.
const FOLLOWED: f64 = 0.02;

/// A contact constraint: the least normal velocity of a node, or of the deepest point of an element, over the surface.
struct Constraint {
    nodes: [usize; 4],
    weights: [f64; 4],
    normal: Vector3<f64>,
    arm: Vector3<f64>,
    /// Relative velocity per impulse, 1/kg.
    inverse_effective_mass: f64,
    /// Least normal velocity over the surface, m/s.
    target: f64,
    /// Sum over the sweeps, N s.
    normal_impulse: f64,
    /// Sum over the sweeps, N s.
    tangential_impulse: Vector3<f64>,
    /// Place of its element among the candidates, and corner from which the side of its triangle begins.
    source: Option<[usize; 2]>,
}

/// Parameters of a sweep.
struct Sweep {
    multiplicity: f64,
    friction: Friction,
    /// s.
    dt: f64,
}

impl Constraint {
    /// Velocity of the point over the surface, m/s.
    fn relative_velocity(&self, nodes: &Nodes, body: &RigidBody) -> Vector3<f64> {
        let film = (0..4).filter(|a| self.weights[*a] > 0.0);
        let film: Vector3<f64> = film.map(|a| nodes.velocity_of(self.nodes[a]) * self.weights[a]).sum();
        film - body.velocity_at(&self.arm)
    }

    /// Applies `impulse` (N s) to the film, whose positions follow, and its opposite to the body.
    fn apply(&self, impulse: Vector3<f64>, nodes: &mut Nodes, body: &mut RigidBody, sweep: &Sweep) {
        for (n, weight) in self.nodes.iter().zip(self.weights).filter(|(_, weight)| *weight > 0.0) {
            nodes.apply_impulse(*n, &(impulse * weight), sweep.dt);
        }
        body.apply_impulse_at(&(-sweep.multiplicity * impulse), &self.arm);
    }

    /// Starts with the `impulse` (N s) that the same point had in the last step.
    fn start_from(&mut self, impulse: &Vector3<f64>, nodes: &mut Nodes, body: &mut RigidBody, sweep: &Sweep) {
        self.normal_impulse = impulse.dot(&self.normal).max(0.0);
        if self.normal_impulse > 0.0 {
            self.tangential_impulse = impulse - self.normal * impulse.dot(&self.normal);
            self.apply(self.normal * self.normal_impulse + self.tangential_impulse, nodes, body, sweep);
        }
    }

    /// Projected Gauss–Seidel: corrects the normal impulse, which stays compressive, then the tangential one, which
    /// stays within Coulomb's cone. Returns the size of the change, N s.
    fn solve(&mut self, nodes: &mut Nodes, body: &mut RigidBody, sweep: &Sweep) -> f64 {
        let violation = self.target - self.relative_velocity(nodes, body).dot(&self.normal);
        let normal_impulse = (self.normal_impulse + violation / self.inverse_effective_mass).max(0.0);
        let normal_change = normal_impulse - self.normal_impulse;
        self.apply(self.normal * normal_change, nodes, body, sweep);
        self.normal_impulse = normal_impulse;

        let relative = self.relative_velocity(nodes, body);
        let slip = relative - self.normal * relative.dot(&self.normal);
        let sticking = self.tangential_impulse - slip / self.inverse_effective_mass;
        let bound = sweep.friction.at(self.nodes[0]) * normal_impulse;
        let tangential_impulse = if sticking.norm() <= bound { sticking } else { sticking * (bound / sticking.norm()) };
        let tangential_change = tangential_impulse - self.tangential_impulse;
        self.apply(tangential_change, nodes, body, sweep);
        self.tangential_impulse = tangential_impulse;
        normal_change.abs().max(tangential_change.norm())
    }

    /// The node, where it belongs to one.
    fn node(&self) -> Option<usize> {
        (self.weights[0] == 1.0).then_some(self.nodes[0])
    }

    /// The impulses on its nodes.
    fn impulses(self) -> impl Iterator<Item = Impulse> {
        (0..4).filter(move |a| self.weights[*a] > 0.0).map(move |a| Impulse {
            node: self.nodes[a],
            arm: self.arm,
            normal: self.normal * (self.normal_impulse * self.weights[a]),
            tangential: self.tangential_impulse * self.weights[a],
        })
    }
}

impl Contact {
    /// Limits the penetration of every candidate element to [`FACE_PENETRATION`]: Gauss–Seidel sweeps over the
    /// constraints at the deepest point of each, at the nodes in contact, and `between` faces (theory.md, section 6).
    pub(super) fn resolve_faces(
        &mut self,
        nodes: &mut Nodes,
        body: &mut RigidBody,
        dt: f64,
        pool: &ThreadPool,
        mut between: Option<&mut FilmContact>,
    ) {
        if between.is_none() && self.neighbours.face_candidates.is_empty() {
            return;
        }
        let pose = body.predicted(dt);
        let mut followed = std::mem::take(&mut self.neighbours.followed);
        let mut faces: Vec<Constraint> = vec![];
        for (place, element) in self.neighbours.face_candidates.iter().enumerate() {
            if self.has_small_sagitta(element, nodes) || self.is_clear(element, nodes, &pose) {
                continue;
            }
            let mut unknown = UNKNOWN;
            let followed = followed.get_mut(place).unwrap_or(&mut unknown);
            faces.extend(self.face_constraints((place, element.corners), nodes, body, &pose, dt, followed));
        }
        let has_faces = !faces.is_empty();
        if !has_faces && between.is_none() {
            self.neighbours.followed = followed;
            return;
        }
        // Beside the elements that are too deep, nodes of a body with edges stay where their own contact put them.
        let mut coupled: Vec<usize> = faces.iter().flat_map(|face| face.nodes).collect();
        coupled.sort_unstable();
        coupled.dedup();
        let takes_all = between.is_some() || self.surface.is_round();
        let is_coupled = |impulse: &&Impulse| takes_all || coupled.binary_search(&impulse.node).is_ok();
        let at_nodes = self.contacts.iter().flat_map(|contacts| &contacts.impulses);
        let mut constraints: Vec<Constraint> = at_nodes
            .clone()
            .filter(is_coupled)
            .map(|impulse| self.node_constraint(impulse, nodes, body))
            .chain(faces)
            .collect();
        let kept: Vec<Impulse> = at_nodes.filter(|impulse| !is_coupled(impulse)).cloned().collect();
        let sweep = Sweep { multiplicity: self.multiplicity, friction: self.friction, dt };
        let films_meet = between.as_mut().is_some_and(|between| between.begin(nodes, dt, pool));
        if !has_faces && !films_meet {
            self.neighbours.followed = followed;
            return;
        }
        for constraint in &mut constraints {
            if let Some([place, side]) = constraint.source
                && let Some(points) = followed.get(place)
            {
                constraint.start_from(&(Vector3::from(points[side].force) * dt), nodes, body, &sweep);
            }
        }
        followed.iter_mut().flatten().for_each(|point| point.force = [0.0; 3]);
        if let Some(between) = &between {
            self.add_near_constraints(&mut constraints, [dt, between.detected_within()], nodes, body, &pose);
        }
        let [most, rounds] =
            if between.is_some() { [film_contact::SWEEPS, film_contact::ROUNDS] } else { [self.most_sweeps(), 1] };
        for _ in 0..rounds {
            for done in 1..=most {
                let (mut change, mut largest, mut moved) = (0.0_f64, 0.0_f64, 0.0_f64);
                for constraint in &mut constraints {
                    let of_this = constraint.solve(nodes, body, &sweep);
                    change = change.max(of_this);
                    largest = largest.max(constraint.normal_impulse);
                    moved =
                        moved.max(of_this * constraint.inverse_effective_mass * dt / self.offset[constraint.nodes[0]]);
                }
                let is_converged = match &mut between {
                    Some(between) => between.sweep(nodes, dt) && (moved <= film_contact::TOLERANCE || done >= SWEEPS),
                    None => change <= TOLERANCE * largest,
                };
                if is_converged {
                    break;
                }
            }
            let Some(between) = &mut between else { break };
            if !between.extend(nodes, dt, pool) {
                break;
            }
            self.add_near_constraints(&mut constraints, [dt, between.detected_within()], nodes, body, &pose);
        }
        for constraint in &constraints {
            if let Some([place, side]) = constraint.source
                && let Some(points) = followed.get_mut(place)
            {
                let impulse = constraint.normal * constraint.normal_impulse + constraint.tangential_impulse;
                points[side].force = (impulse / dt).into();
            }
        }
        self.neighbours.followed = followed;
        let active = constraints.into_iter().filter(|constraint| constraint.normal_impulse > 0.0);
        self.replace_impulses(nodes, kept.into_iter().chain(active.flat_map(Constraint::impulses)));
    }

    /// Largest number of sweeps in a step, without contact between faces.
    fn most_sweeps(&self) -> usize {
        if self.surface.is_round() { SWEEPS } else { SWEEPS_AT_EDGES }
    }

    /// Replaces the impulses of the node contacts by `impulses`, of which a node may have several.
    fn replace_impulses(&mut self, nodes: &Nodes, impulses: impl Iterator<Item = Impulse>) {
        for contacts in &mut self.contacts {
            contacts.impulses.clear();
            (contacts.sums, contacts.largest_speed_squared) = (ImpulseSums::default(), 0.0);
        }
        let Some(first) = self.contacts.first_mut() else { return };
        for impulse in impulses {
            let after = nodes.velocity_of(impulse.node);
            first.largest_speed_squared = first.largest_speed_squared.max(after.norm_squared());
            let mean = 0.5 * (after + Vector3::from(self.previous_velocity.at(impulse.node)));
            first.sums.add(&impulse, &mean);
            first.impulses.push(impulse);
        }
    }

    /// Whether the normals of the surface at the corners of an element differ so little that its sagitta, (longest
    /// line) times angle over 8, is well below the allowed penetration.
    fn has_small_sagitta(&self, element: &NeighbourElement, nodes: &Nodes) -> bool {
        // Between the corners there may be a smaller part or an edge, and a held corner is no contact of its own.
        let at_support = || element.corners.iter().any(|n| nodes.is_held(*n as usize));
        if self.surface.has_parts()
            || FACE_PENETRATION * self.surface.edge_radius() < self.neighbours.allowance
            || at_support()
        {
            return false;
        }
        let normals = element.corners.map(|n| self.normals[n as usize]);
        let least_cosine = normals[1..].iter().map(|n| normals[0].dot(n)).fold(normals[1].dot(&normals[3]), f64::min);
        let sagitta = 8.0 * SAGITTA_SHARE * self.neighbours.allowance;
        2.0 * (1.0 - least_cosine) * element.longest_squared < sagitta * sagitta
    }

    /// Whether the tangent plane of a convex body at one of the corners of an element tells that all of it is outside.
    fn is_clear(&self, element: &NeighbourElement, nodes: &Nodes, pose: &Isometry3<f64>) -> bool {
        if self.heights.is_empty() {
            return false;
        }
        let turned = pose.rotation.coords - self.predicted_pose.rotation.coords;
        let moved = (pose.translation.vector - self.predicted_pose.translation.vector).norm()
            + 4.0 * turned.norm() * self.surface.bounding_radius();
        let corners = element.corners.map(|n| nodes.position_of(n as usize).coords);
        let bound = self.offset[element.corners[0] as usize] - self.neighbours.allowance + moved;
        element.corners.iter().any(|n| {
            let (normal, height) = (&self.normals[*n as usize], self.heights[*n as usize]);
            height > f64::NEG_INFINITY && corners.iter().all(|corner| normal.dot(corner) - height >= bound)
        })
    }

    /// Adds constraints of nodes that are not in contact, but less than `margin` (m) from the body at `pose`, so that other
    /// film may press them onto it.
    fn add_near_constraints(
        &self,
        constraints: &mut Vec<Constraint>,
        [dt, margin]: [f64; 2],
        nodes: &Nodes,
        body: &RigidBody,
        pose: &Isometry3<f64>,
    ) {
        let mut known: Vec<usize> = constraints.iter().filter_map(Constraint::node).collect();
        known.sort_unstable();
        let listed = self.neighbours.nodes.iter().map(|n| *n as usize);
        for n in listed.filter(|n| known.binary_search(n).is_err() && !nodes.is_held(*n)) {
            let found = self.surface.project(pose, &nodes.position_of(n));
            let gap = found.distance - self.offset[n];
            if gap > margin {
                continue;
            }
            let arm = nodes.position_of(n).coords - pose.translation.vector;
            let impulse = Impulse { node: n, arm, normal: found.normal, tangential: Vector3::zeros() };
            let mut constraint = self.node_constraint(&impulse, nodes, body);
            constraint.normal_impulse = 0.0;
            constraint.target -= gap / dt;
            constraints.push(constraint);
        }
    }

    /// The constraint of a node contact, with its `impulse`.
    fn node_constraint(&self, impulse: &Impulse, nodes: &Nodes, body: &RigidBody) -> Constraint {
        let normal_impulse = impulse.normal.norm();
        let normal = impulse.normal / normal_impulse;
        let mut constraint = Constraint {
            nodes: [impulse.node; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal,
            arm: impulse.arm,
            inverse_effective_mass: 1.0 / nodes.mass[impulse.node]
                + self.multiplicity * body.inverse_effective_mass(&normal, &impulse.arm),
            target: 0.0,
            normal_impulse,
            tangential_impulse: impulse.tangential,
            source: None,
        };
        constraint.target = constraint.relative_velocity(nodes, body).dot(&normal);
        constraint
    }

    /// Whether the body at `pose` has reached what holds some corners of an element: such a corner is inside, or all are held.
    fn reaches_support(&self, corners: [usize; 4], nodes: &Nodes, pose: &Isometry3<f64>) -> bool {
        let is_inside = |n: usize| self.surface.project(pose, &nodes.position_of(n)).distance < self.offset[n];
        corners.iter().all(|n| nodes.is_held(*n)) || corners.iter().any(|n| nodes.is_held(*n) && is_inside(*n))
    }

    /// The constraints at points of an element, the candidate at this place, that would penetrate too far; none of one that is held at a corner which
    /// the body has not reached: coarse elements beside the support would else be a stiff edge. What supports a held corner takes
    /// its part of the impulse; none where neither film nor body yields.
    fn face_constraints(
        &self,
        (place, corners): (usize, [u32; 4]),
        nodes: &Nodes,
        body: &RigidBody,
        pose: &Isometry3<f64>,
        dt: f64,
        followed: &mut Followed,
    ) -> Vec<Constraint> {
        let corners = corners.map(|n| n as usize);
        let positions = corners.map(|n| nodes.position_of(n));
        let is_supported = corners.iter().any(|n| nodes.is_held(*n));
        if is_supported && !self.reaches_support(corners, nodes, pose) {
            return vec![];
        }
        let bound = self.offset[corners[0]] - self.neighbours.allowance;
        let points = self.rounded.deep_points(pose, &positions, bound, followed, FOLLOWED * self.neighbours.allowance);
        let recovery = if self.surface.is_round() && !is_supported { RECOVERY } else { RECOVERY_AT_EDGES };
        let constraint = |DeepestPoint { projection, weights, side, .. }: DeepestPoint| {
            let point: Vector3<f64> = (0..4).map(|a| positions[a].coords * weights[a]).sum();
            let arm = point - pose.translation.vector;
            let normal = projection.normal;
            // What holds a corner takes its part.
            let yields = |a: &usize| !nodes.is_held(corners[*a]);
            let inverse_mass = |a: usize| weights[a].powi(2) / nodes.mass[corners[a]];
            let inverse_effective_mass = (0..4).filter(yields).map(inverse_mass).sum::<f64>()
                + self.multiplicity * body.inverse_effective_mass(&normal, &arm);
            if inverse_effective_mass <= 0.0 {
                return None;
            }
            let mut constraint = Constraint {
                nodes: corners,
                weights,
                normal,
                arm,
                inverse_effective_mass,
                target: 0.0,
                normal_impulse: 0.0,
                tangential_impulse: Vector3::zeros(),
                source: Some([place, side]),
            };
            let to_bound = constraint.relative_velocity(nodes, body).dot(&normal) + (bound - projection.distance) / dt;
            constraint.target = if to_bound > 0.0 { recovery * to_bound } else { to_bound };
            Some(constraint)
        };
        points.into_iter().filter_map(constraint).collect()
    }
}
