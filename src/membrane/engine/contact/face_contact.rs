//! Face contact: elements that penetrate between their nodes.

use nalgebra::{Isometry3, Vector3};

use super::impulse_sums::ImpulseSums;
use super::neighbours::NeighbourElement;
use super::surface::{Clearance, DeepestPoint, Followed, UNKNOWN, point_of};
use super::{Contact, FACE_PENETRATION, Impulse, SAGITTA_SHARE};
use crate::engine::constraint::{Constraint, Points, Response, WeightedNodes};
use crate::engine::film_contact::{self, FilmContact};
use crate::engine::nodes::Nodes;
use crate::engine::rigid_body::{InverseMass, RigidBody};
use crate::engine::thread_pool::ThreadPool;

/// Share of a penetration beyond the allowed one that is recovered in one step, so that an element which is already too
/// deep when it is listed does not gain velocity.
const RECOVERY: f64 = 0.02;

/// Share that is recovered on a body with edges, and of elements beside what holds them: film that is lifted there
/// gains energy, which a slower recovery leaves to be small.
const RECOVERY_AT_EDGES: f64 = 0.002;

/// Largest number of Gauss–Seidel sweeps in a step on a round body: a whole film is that of its mirrored quarter to 0.4 % of the
/// force where elements are 0.6 of the radius (`tests/it/slow.rs`). Further ones change less than they cost.
const SWEEPS: usize = 20;

/// On a body with edges, where an element meets several at once.
const SWEEPS_AT_EDGES: usize = 40;

/// Sweeps for which contact between faces, once it has converged, waits for that with the body.
const AWAITED: usize = 10;

/// Change of impulse in a sweep, over the largest impulse, below which the sweeps have converged.
const TOLERANCE: f64 = 1e-3;

/// Depth over the allowed one by which a point that is followed may be off the deepest.
const FOLLOWED: f64 = 0.02;

/// Film and a body in a step, which are resolved together.
pub(super) struct Coupled<'a> {
    nodes: &'a mut Nodes,
    body: &'a mut RigidBody,
    /// Number of mirror images of the film.
    multiplicity: f64,
    /// Of the body at the end of the step.
    pose: Isometry3<f64>,
    /// s.
    dt: f64,
}

/// A point of film over one of a body: a node, or the deepest point of an element.
pub(super) struct FilmOnBody {
    film: WeightedNodes,
    /// From the body's centre of mass, m.
    arm: Vector3<f64>,
    /// Of the point of the body, with the mirror images of the film.
    of_body: InverseMass,
    /// Place of its element among the candidates, and corner from which the side of its triangle begins.
    source: Option<[usize; 2]>,
}

impl FilmOnBody {
    /// The constraint of a point of `film` over one at `arm` (m) along `normal`, as [`Constraint::new`].
    fn constraint(
        film: WeightedNodes,
        arm: Vector3<f64>,
        normal: Vector3<f64>,
        source: Option<[usize; 2]>,
        step: &Coupled<'_>,
    ) -> Constraint<FilmOnBody> {
        let InverseMass([x, y, z]) = step.body.inverse_mass_at(&arm);
        let of_body = InverseMass([x * step.multiplicity, y * step.multiplicity, z * step.multiplicity]);
        // As if no node were held in a direction: on a mirror plane the normal may be one that is, and would take any impulse.
        let response = film.inverse_free_mass() + of_body.response(&normal).dot(&normal);
        Constraint::new(FilmOnBody { film, arm, of_body, source }, normal, response)
    }
}

impl AsRef<WeightedNodes> for FilmOnBody {
    fn as_ref(&self) -> &WeightedNodes {
        &self.film
    }
}

impl Response for FilmOnBody {
    #[inline(always)]
    fn response(&self, impulse: &Vector3<f64>) -> Vector3<f64> {
        self.film.response(impulse) + self.of_body.response(impulse)
    }
}

impl Points<Coupled<'_>> for FilmOnBody {
    #[inline(always)]
    fn velocity(&self, Coupled { nodes, body, .. }: &Coupled<'_>) -> Vector3<f64> {
        self.film.sum(&nodes.velocity) - body.velocity_at(&self.arm)
    }

    #[inline(always)]
    fn apply(&self, impulse: &Vector3<f64>, Coupled { nodes, body, multiplicity, .. }: &mut Coupled<'_>) {
        self.film.apply(impulse, &mut nodes.velocity);
        body.apply_impulse_at(&(-*multiplicity * impulse), &self.arm);
    }
}

impl Constraint<FilmOnBody> {
    /// The node, where it belongs to one.
    fn node(&self) -> Option<usize> {
        let WeightedNodes { nodes, weights, .. } = &self.points.film;
        (weights[0] == 1.0).then_some(nodes[0] as usize)
    }

    /// The impulses on its nodes.
    fn impulses(self) -> impl Iterator<Item = Impulse> {
        let WeightedNodes { nodes, weights, .. } = self.points.film;
        (0..4).filter(move |a| weights[*a] > 0.0).map(move |a| Impulse {
            node: nodes[a] as usize,
            arm: self.points.arm,
            normal: self.normal * (self.pressing * weights[a]),
            tangential: self.dragging * weights[a],
        })
    }
}

impl Contact {
    /// Limits the penetration of every candidate element to [`FACE_PENETRATION`]: Gauss–Seidel sweeps over the
    /// constraints at the deepest point of each, at the nodes in contact, and `between` faces (theory.md, section 6). Several
    /// bodies take several sweeps of a step, the first of which starts from the forces of the last step.
    pub(super) fn resolve_faces(
        &mut self,
        nodes: &mut Nodes,
        body: &mut RigidBody,
        dt: f64,
        pool: &ThreadPool,
        between: Option<&mut FilmContact>,
        is_first: bool,
    ) {
        // The node contacts have been solved already; without anything between nodes that solution is final.
        if between.is_none() && self.neighbours.face_candidates.is_empty() {
            return;
        }
        let (pose, multiplicity) = (body.predicted(dt), self.multiplicity);
        let step = &mut Coupled { nodes, body, multiplicity, pose, dt };
        // Taken out so that `self` may be borrowed for the projections, and put back; constraints for their capacity.
        let mut followed = std::mem::take(&mut self.neighbours.followed);
        let mut constraints = std::mem::take(&mut self.constraints);
        let mut faces = std::mem::take(&mut self.faces);
        self.find_faces(step, &mut followed, &mut faces);
        let is_coupled = !faces.is_empty() || between.is_some();
        let kept =
            if is_coupled { self.couple_nodes(step, &faces, between.is_some(), &mut constraints) } else { vec![] };
        constraints.append(&mut faces);
        if self.sweep(step, pool, between, &mut followed, &mut constraints, is_first) {
            // An impulse that a neighbour took over entirely has neither work nor a node in contact.
            let active = constraints.drain(..).filter(Constraint::is_active);
            self.replace_impulses(step.nodes, kept.into_iter().chain(active.flat_map(Constraint::impulses)));
        }
        constraints.clear();
        self.neighbours.followed = followed;
        (self.constraints, self.faces) = (constraints, faces);
    }

    /// Adds the constraints of nodes in contact that are solved again with those of `faces`. Returns the impulses of the
    /// others: they are in the sums that the energy balance is made of.
    fn couple_nodes(
        &self,
        step: &Coupled<'_>,
        faces: &[Constraint<FilmOnBody>],
        has_films: bool,
        to: &mut Vec<Constraint<FilmOnBody>>,
    ) -> Vec<Impulse> {
        // Beside the elements that are too deep, nodes of a body with edges stay where their own contact put them.
        let takes_all = has_films || self.surface.is_round();
        let of_faces = || faces.iter().flat_map(|face| face.points.film.nodes);
        let mut coupled: Vec<u32> = if takes_all { vec![] } else { of_faces().collect() };
        coupled.sort_unstable();
        coupled.dedup();
        let mut kept = vec![];
        for impulse in self.contacts.iter().flat_map(|contacts| &contacts.impulses) {
            if takes_all || coupled.binary_search(&(impulse.node as u32)).is_ok() {
                let pressing = impulse.normal.norm();
                let constraint = node_constraint(impulse.node, impulse.arm, impulse.normal / pressing, step);
                to.push(constraint.acted(pressing, impulse.tangential));
            } else {
                kept.push(impulse.clone());
            }
        }
        kept
    }

    /// Solves `constraints` by sweeps, with those `between` faces. Returns whether there was anything to solve.
    fn sweep(
        &mut self,
        step: &mut Coupled<'_>,
        pool: &ThreadPool,
        mut between: Option<&mut FilmContact>,
        followed: &mut [Followed],
        constraints: &mut Vec<Constraint<FilmOnBody>>,
        is_first: bool,
    ) -> bool {
        let (dt, friction) = (step.dt, self.friction);
        let has_faces = constraints.last().is_some_and(|last| last.points.source.is_some());
        // After the node constraints: their targets are the velocities with which the corrector put nodes onto the
        // surface, before `begin` changes any.
        let films_meet = between.as_mut().is_some_and(|between| between.begin(step.nodes, dt, pool));
        if is_first {
            // Warm start by the force of the last step: unlike its impulse it does not depend on the step's length.
            for constraint in constraints.iter_mut() {
                if let Some([place, side]) = constraint.points.source
                    && let Some(points) = followed.get(place)
                {
                    let impulse = Vector3::from(points[side].force) * dt;
                    constraint.start_from(impulse.dot(&constraint.normal), &impulse, step);
                }
            }
            // Points without a constraint in this step must not start from an old force in a later one.
            for place in self.neighbours.pushed.drain(..) {
                followed[place as usize].iter_mut().for_each(|point| point.force = [0.0; 3]);
            }
        }
        if !has_faces && !films_meet {
            return false;
        }
        if let Some(between) = &between {
            self.add_near_constraints(constraints, between.detected_within(), step);
        }
        let [most, rounds] =
            if between.is_some() { [film_contact::SWEEPS, film_contact::ROUNDS] } else { [self.most_sweeps(), 1] };
        for _ in 0..rounds {
            for done in 1..=most {
                let (mut change, mut largest, mut moved) = (0.0_f64, 0.0_f64, 0.0_f64);
                for constraint in constraints.iter_mut() {
                    let node = constraint.points.film.nodes[0];
                    let of_this = constraint.solve(friction.at(node), step).norm();
                    change = change.max(of_this);
                    largest = largest.max(constraint.pressing);
                    // Film on film converges by distances, as its own sweeps do, here over the distance of film from
                    // the surface.
                    if of_this > 0.0 && between.is_some() {
                        moved = moved.max(of_this * dt / (constraint.effective_mass * self.offset[node as usize]));
                    }
                }
                let is_converged = match &mut between {
                    Some(between) => {
                        between.sweep(step.nodes, dt) && (moved <= film_contact::TOLERANCE || done >= AWAITED)
                    }
                    None => change <= TOLERANCE * largest,
                };
                if is_converged {
                    break;
                }
            }
            // Positions follow only here: the sweeps need velocities alone, and `extend` looks for pairs at the new
            // positions.
            for constraint in constraints.iter_mut() {
                constraint.move_nodes(&mut step.nodes.position, dt);
            }
            let Some(between) = &mut between else { break };
            if !between.extend(step.nodes, dt, pool) {
                break;
            }
            self.add_near_constraints(constraints, between.detected_within(), step);
        }
        for constraint in constraints.iter() {
            if let Some([place, side]) = constraint.points.source
                && let Some(points) = followed.get_mut(place)
            {
                // That of all sweeps of the step.
                points[side].force = (Vector3::from(points[side].force) + constraint.impulse() / dt).into();
                self.neighbours.pushed.push(place as u32);
            }
        }
        true
    }

    /// Adds the constraints of all candidates.
    fn find_faces(&mut self, step: &Coupled<'_>, followed: &mut [Followed], faces: &mut Vec<Constraint<FilmOnBody>>) {
        let Coupled { nodes, pose, .. } = step;
        // Clearances are kept in body axes, where a body that only moves or turns with the film leaves them valid. Each
        // node is turned into these once, and column by column: a product of nalgebra's matrices is a call.
        let rotation = pose.rotation.inverse().to_rotation_matrix();
        let [x, y, z] = [0, 1, 2].map(|k| rotation.matrix().column(k).into_owned());
        let mut in_body = std::mem::take(&mut self.in_body);
        in_body.clear();
        in_body.extend(self.neighbours.candidate_nodes.iter().map(|n| {
            let arm = nodes.position_of(*n as usize).coords - pose.translation.vector;
            x * arm.x + y * arm.y + z * arm.z
        }));
        let mut clearances = std::mem::take(&mut self.neighbours.clearances);
        for (place, element) in self.neighbours.face_candidates.iter().enumerate() {
            if self.has_small_sagitta(element, nodes) {
                continue;
            }
            let [a, b, c, d] = self.neighbours.candidate_corners[place];
            let corners = [in_body[a as usize], in_body[b as usize], in_body[c as usize], in_body[d as usize]];
            if clearances[place].holds(&corners) {
                continue;
            }
            let mut unknown = UNKNOWN;
            let followed = followed.get_mut(place).unwrap_or(&mut unknown);
            let known = faces.len();
            let margin = self.add_face_constraints((place, element.corners), step, followed, faces);
            clearances[place] = if faces.len() > known { Clearance::NONE } else { Clearance::new(&corners, margin) };
        }
        self.neighbours.clearances = clearances;
        self.in_body = in_body;
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
            first.sums.add(&impulse, [&self.previous_velocity.value_at(impulse.node).into(), &after]);
            first.impulses.push(impulse);
        }
    }

    /// Whether the normals of the surface at the corners of an element differ so little that its sagitta, (longest
    /// line) times angle over 8, is well below the allowed penetration.
    fn has_small_sagitta(&self, element: &NeighbourElement, nodes: &Nodes) -> bool {
        // Between the corners there may be a smaller part or an edge, and a held corner is no contact of its own.
        let [a, b, c, d] = element.corners;
        let is_held = |n: u32| nodes.is_held(n as usize);
        let at_support = || is_held(a) || is_held(b) || is_held(c) || is_held(d);
        if self.surface.has_parts()
            || FACE_PENETRATION * self.surface.edge_radius() < self.neighbours.allowance
            || at_support()
        {
            return false;
        }
        // The normal of a corner that is not near is zero, which counts as a right angle: such an element is looked at.
        let normal = |n: u32| &self.normals[n as usize];
        let (first, second, last) = (normal(a), normal(b), normal(d));
        // Written out: maps of arrays are calls, and thousands of elements are looked at in a step.
        let least_cosine = second.dot(last).min(first.dot(second)).min(first.dot(normal(c))).min(first.dot(last));
        let sagitta = 8.0 * SAGITTA_SHARE * self.neighbours.allowance;
        // Squares on both sides, (2 sin θ/2)² = 2 (1 − cos θ): neither an arccosine nor a root for thousands of
        // elements a step.
        2.0 * (1.0 - least_cosine) * element.longest_squared < sagitta * sagitta
    }

    /// Adds constraints of nodes that are not in contact, but less than `margin` (m) from the body, so that other film may
    /// press them onto it.
    fn add_near_constraints(&self, constraints: &mut Vec<Constraint<FilmOnBody>>, margin: f64, step: &Coupled<'_>) {
        let Coupled { nodes, pose, dt, .. } = step;
        let mut known: Vec<usize> = constraints.iter().filter_map(Constraint::node).collect();
        known.sort_unstable();
        // Both ascend.
        let mut known = known.into_iter().peekable();
        for n in self.neighbours.nodes.iter().map(|n| *n as usize) {
            while known.next_if(|other| *other < n).is_some() {}
            if known.peek() == Some(&n) || nodes.is_held(n) {
                continue;
            }
            // A sphere around the body sorts out most of them before any projection, which is done one by one.
            let radius = self.surface.bounding_radius() + self.offset[n] + margin;
            let arm = nodes.position_of(n).coords - pose.translation.vector;
            if arm.norm_squared() > radius * radius {
                continue;
            }
            let (gap, normal) = self.gap(nodes, pose, n);
            if gap > margin {
                continue;
            }
            let mut constraint = node_constraint(n, arm, normal, step);
            // The node may still close its gap in this step; without it, it would be held at its distance.
            constraint.target -= gap / dt;
            constraints.push(constraint);
        }
    }

    /// Whether the body at `pose` has reached what holds some corners of an element: such a corner is inside, or all
    /// are held.
    fn reaches_support(&self, corners: [u32; 4], nodes: &Nodes, pose: &Isometry3<f64>) -> bool {
        let mut held = corners.map(|n| n as usize).into_iter().filter(|n| nodes.is_held(*n));
        let is_inside = |n: usize| self.surface.project(pose, &nodes.position_of(n)).distance < self.offset[n];
        // An element that is held all around cannot become an edge of the support, and only it can stop the body there.
        held.clone().count() == corners.len() || held.any(is_inside)
    }

    /// Adds the constraints at points of an element, the candidate at this place, that would penetrate too far; none of
    /// one that is held at a corner which the body has not reached: coarse elements beside the support would else be a
    /// stiff edge. What supports a held corner takes its part of the impulse; none where neither film nor body yields.
    /// Returns how far the element may move until a point of it penetrates so far, m; negative where that is not known.
    fn add_face_constraints(
        &self,
        (place, corners): (usize, [u32; 4]),
        step: &Coupled<'_>,
        followed: &mut Followed,
        to: &mut Vec<Constraint<FilmOnBody>>,
    ) -> f64 {
        let Coupled { nodes, pose, dt, .. } = step;
        let [a, b, c, d] = [corners[0] as usize, corners[1] as usize, corners[2] as usize, corners[3] as usize];
        let positions = [nodes.position_of(a), nodes.position_of(b), nodes.position_of(c), nodes.position_of(d)];
        let is_supported = nodes.is_held(a) || nodes.is_held(b) || nodes.is_held(c) || nodes.is_held(d);
        if is_supported && !self.reaches_support(corners, nodes, pose) {
            return -1.0;
        }
        // Corners of an element belong to one face and have one offset.
        let bound = self.offset[corners[0] as usize] - self.neighbours.allowance;
        let found = self.rounded.deep_points(pose, &positions, bound, followed, FOLLOWED * self.neighbours.allowance);
        let recovery = if self.surface.is_round() && !is_supported { RECOVERY } else { RECOVERY_AT_EDGES };
        for DeepestPoint { projection, weights, side, .. } in found.points {
            let arm = point_of(&positions, &weights) - pose.translation.vector;
            let film = WeightedNodes::new(corners, weights, nodes);
            let mut constraint = FilmOnBody::constraint(film, arm, projection.normal, Some([place, side]), step);
            if constraint.effective_mass == 0.0 {
                continue;
            }
            let along = constraint.points.velocity(step).dot(&projection.normal);
            // `distance` is that at the end of the step as predicted, so the present velocity is part of it.
            let to_bound = along + (bound - projection.distance) / dt;
            // What is left to the bound may be used up at once; what is too deep comes back slowly, since lifting film
            // against its tension adds energy (theory.md, section 6).
            constraint.target = if to_bound > 0.0 { recovery * to_bound } else { to_bound };
            to.push(constraint);
        }
        found.least - bound
    }
}

/// The constraint of a `node` at `arm` (m) from the centre of a body: it keeps its normal velocity. After the corrector a node in
/// contact is exactly on the surface.
fn node_constraint(node: usize, arm: Vector3<f64>, normal: Vector3<f64>, step: &Coupled<'_>) -> Constraint<FilmOnBody> {
    let film = WeightedNodes::of_node(node as u32, step.nodes);
    let mut constraint = FilmOnBody::constraint(film, arm, normal, None, step);
    constraint.target = constraint.points.velocity(step).dot(&normal);
    constraint
}
