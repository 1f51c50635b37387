//! Kinematic contact between the impactor and the film.
//!
//! Predictor: every node whose position at the end of the step lies inside the impactor violates a contact constraint.
//! Corrector: it gets the impulse that puts it onto the surface, and the impactor gets the opposite (theory.md, section
//! 6). There is no penalty stiffness: nodes do not penetrate, and the stable time step stays that of the film. Friction
//! is the tangential impulse that stops the slip of a node, bounded by μ times the normal one, so that a sticking node
//! does not creep.
//!
//! Between its nodes an element penetrates by the sagitta of its edges. Where that may exceed [`FACE_PENETRATION`] of
//! the impactor's size, the deepest point of the element is constrained as well, or several where it is folded; an impactor
//! with edges of its own is met at the deepest point of each of the element's triangles, or where corners and edges of a
//! mesh meet it.

mod contact_state;
#[cfg(test)]
mod edge_tests;
mod face_contact;
mod impulse_sums;
mod neighbours;
mod node_contact;
mod surface;

pub use contact_state::ContactState;
pub(super) use neighbours::ContactHistory;
pub(super) use surface::Meeting;
use surface::Nearest;
pub use surface::{Surface, SurfaceError};

use nalgebra::{Isometry3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::constraint::Constraint;
use super::disjoint::Disjoint;
use super::energy::{ContactLoss, StepEnergy};
use super::film::Film;
use super::film_contact::FilmContact;
use super::nodes::{Nodes, Vectors, VelocityRecord};
use super::rigid_body::{CoupledFilm, RigidBody};
use super::thread_pool::ThreadPool;
use face_contact::FilmOnBody;
use impulse_sums::{Friction, ImpulseSums};
use neighbours::NeighbourList;
use node_contact::{Corrector, NodeContacts, Predictor};

/// Contact of one impactor with all faces of film.
pub struct Contact {
    surface: Surface,
    /// The surface that elements meet between their nodes: its edges have a radius.
    rounded: Surface,
    friction: Friction,
    /// Number of mirror images of the film.
    multiplicity: f64,
    /// Distance of each node's mid-surface from the impactor in contact, m: the film in between.
    offset: Vec<f64>,
    neighbours: NeighbourList,
    /// The surface's normal at each node in contact or next to it, zero elsewhere.
    normals: Vec<Vector3<f64>>,
    /// The nearest triangle of a mesh to each node.
    nearest: Vec<Nearest>,
    /// Velocity of the nodes of the list half a step earlier, m/s.
    previous_velocity: Vectors,
    /// Of each range of the neighbour list.
    contacts: Vec<NodeContacts>,
    /// Whether the impulse of each node was listed in the last step.
    lists_impulses: bool,
    /// Work since the start.
    pub(super) work: Work,
    /// Impulses of all sweeps of the last step; none where there is one body, whose contact takes one sweep.
    swept: Option<Vec<Impulse>>,
    /// Constraints of the step and those of faces before they join them, both empty between steps: kept for their
    /// capacity.
    constraints: Vec<Constraint<FilmOnBody>>,
    faces: Vec<Constraint<FilmOnBody>>,
    /// Positions of the nodes of the candidates for face contact in the axes of the body, m.
    in_body: Vec<Vector3<f64>>,
    /// Impulse of the guide on the body in the last step, N s; none without friction of the guide.
    pub(super) guide_impulse: Option<f64>,
}

/// Allowed penetration of a face between its nodes over the impactor's size: below the one that gives a warning.
const FACE_PENETRATION: f64 = 0.008;

/// Radius of the body's edges where elements meet them, over the longest line of the smallest element (theory.md,
/// equation 211).
const EDGE_SHARE: f64 = 0.005;

/// Allowed penetration of a face between its nodes, over the longest line of the smallest element; of shapes with
/// edges.
const FACE_SHARE: f64 = 0.002;

/// Sagitta of an element over [`FACE_PENETRATION`] from which its deepest point is determined.
const SAGITTA_SHARE: f64 = 0.7;

/// Nodes of a range of the neighbour list.
const NODES_PER_RANGE: usize = 256;

/// Running totals of the work of contact, J.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Work {
    /// Done by the impactor on the film.
    pub(super) on_film: StepEnergy,
    /// Dissipated.
    pub(super) loss: ContactLoss,
    /// Momentum transferred to the impactor along z, N s.
    pub(super) impulse: f64,
}

/// The impulse on a node in one step, N s.
#[derive(Clone, Debug)]
pub(super) struct Impulse {
    node: usize,
    /// From the body's centre of mass, m.
    arm: Vector3<f64>,
    normal: Vector3<f64>,
    tangential: Vector3<f64>,
}

impl Impulse {
    /// The `impulse` (N s) of a body on a `node` that is pressed on another body, at `arm` (m) from the body's centre
    /// of mass.
    pub(super) fn pressing(node: usize, arm: Vector3<f64>, impulse: Vector3<f64>) -> Impulse {
        Impulse { node, arm, normal: impulse, tangential: Vector3::zeros() }
    }
}

impl Contact {
    /// Contact of `surface` with film whose nodes are `offset` (m) from it in contact, counted for `multiplicity`
    /// mirror images, with the coefficient `friction`.
    pub fn new(surface: Surface, friction: f64, multiplicity: f64, offset: Vec<f64>) -> Contact {
        let nodes = offset.len();
        let rounded = surface.clone();
        Contact {
            surface,
            friction: Friction::of_body(friction),
            multiplicity,
            offset,
            neighbours: NeighbourList::default(),
            normals: vec![Vector3::zeros(); nodes],
            nearest: vec![Nearest::default(); if rounded.is_mesh() { nodes } else { 0 }],
            rounded,
            previous_velocity: Vectors::zero(nodes),
            contacts: vec![],
            lists_impulses: false,
            work: Work::default(),
            swept: None,
            constraints: vec![],
            faces: vec![],
            in_body: vec![],
            guide_impulse: None,
        }
    }

    /// This contact with the coefficient `friction` between faces, the first of which has the first `nodes`.
    pub fn with_film_friction(self, friction: f64, nodes: usize) -> Contact {
        Contact { friction: self.friction.with_faces(friction, nodes), ..self }
    }

    /// This contact as that of one of several bodies, which a step may resolve in several sweeps.
    pub(super) fn beside_others(self) -> Contact {
        Contact { swept: Some(vec![]), ..self }
    }

    /// Coulomb coefficient of the body.
    pub(super) fn friction(&self) -> f64 {
        self.friction.body_on_film
    }

    /// The nodes that may get an impulse in this step, ascending.
    pub(super) fn listed(&self) -> impl Iterator<Item = u32> + '_ {
        self.neighbours.impulse_nodes.iter().copied()
    }

    /// Whether `node` may get an impulse in this step.
    pub(super) fn lists(&self, node: u32) -> bool {
        self.neighbours.impulse_nodes.binary_search(&node).is_ok()
    }

    /// Gap between `node` and the body at `pose`, m, and the surface's normal there.
    pub(super) fn gap(&self, nodes: &Nodes, pose: &Isometry3<f64>, node: usize) -> (f64, Vector3<f64>) {
        self.gap_at(&nodes.position_of(node), pose, node)
    }

    /// Gap (m) and normal of a `node` if it were at `point`.
    pub(super) fn gap_at(&self, point: &Point3<f64>, pose: &Isometry3<f64>, node: usize) -> (f64, Vector3<f64>) {
        let projection = self.surface.project(pose, point);
        (projection.distance - self.offset[node], projection.normal)
    }

    /// Records an `impulse` for all mirror images of a node that it does not move.
    pub(super) fn record(&mut self, impulse: Impulse) {
        let normal = impulse.normal / self.multiplicity;
        self.swept.iter_mut().for_each(|swept| swept.push(Impulse { normal, ..impulse }));
    }

    /// The impactor's surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Reduces the skin of the neighbour list by a relative motion of film and impactor of at most `distance` (m).
    pub(super) fn reduce_skin(&mut self, distance: f64) {
        self.neighbours.margin -= distance;
        self.neighbours.last_motion = distance;
    }

    /// Invalidates the neighbour list, after elements have failed.
    pub(super) fn invalidate_neighbours(&mut self) {
        self.neighbours.margin = -1.0;
    }

    /// Rebuilds the neighbour list where that is due, before the nodes move. Returns where they record their
    /// velocities.
    pub(super) fn prepare(&mut self, films: &[Film], nodes: &Nodes, body: &RigidBody) -> VelocityRecord<'_> {
        // Nodes are projected from where they are at the end of the step, so one more step has to fit in the skin.
        if self.neighbours.margin.is_nan() || self.neighbours.margin <= self.neighbours.last_motion {
            self.list_neighbours(films, nodes, &body.pose);
        }
        VelocityRecord {
            nodes: &self.neighbours.impulse_nodes,
            velocity: self.previous_velocity.axes_mut().map(Disjoint::new),
        }
    }

    /// Corrects the velocities of nodes and body and the positions of nodes so that no node penetrates at the end of
    /// the step of `dt` (s), forces acting `over` (s). The nodes have their predicted positions, the body has not
    /// moved; `before` is its motion before the forces of this step, left out in further sweeps of the step; `between`
    /// is the contact between faces, which is resolved together with this one.
    pub(super) fn correct(
        &mut self,
        nodes: &mut Nodes,
        body: &mut RigidBody,
        before: Option<&RigidBody>,
        [over, dt]: [f64; 2],
        pool: &ThreadPool,
        between: Option<&mut FilmContact>,
    ) {
        // Most steps need the sums alone, which the corrector forms in lanes without a list.
        self.lists_impulses = between.is_some() || self.swept.is_some() || !self.neighbours.face_candidates.is_empty();
        self.contacts.resize_with(self.neighbours.ranges.len(), NodeContacts::default);
        self.predict(nodes, body, dt, pool);
        // Body and nodes are solved as one system (theory.md, equation 20), not one after the other: nodes follow the
        // body that has already felt them.
        let (corrected, guide) = self.corrected_body(body, before, over);
        self.correct_nodes(nodes, body, &corrected, dt, pool);
        let sums = self.impulse_sums();
        // The body gets the impulses that the nodes did get, not `corrected`: nodes that would have to be pulled got
        // none, and momentum is conserved to round-off.
        body.apply_impulse(&(-self.multiplicity * sums.impulse()), &(-self.multiplicity * sums.moment()));
        if let Some(impulse) = guide {
            body.velocity.z += impulse / body.mass;
        }
        // First sweep of a step; in further ones the guide has acted already, and impulses are added to the list.
        if before.is_some() {
            self.guide_impulse = guide;
            self.swept.iter_mut().for_each(Vec::clear);
        }
        self.resolve_faces(nodes, body, dt, pool, between, before.is_some());
        // Later sweeps change velocities, so work is summed in `account` with those at the end of the step.
        if let Some(swept) = &mut self.swept {
            self.contacts.iter_mut().for_each(|contacts| swept.append(&mut contacts.impulses));
        }
    }

    /// Adds the work of the step that ends with the velocities of `nodes` and `body`, which moved as `before`. Returns
    /// the largest speed of a node in contact, m/s.
    pub(super) fn account(&mut self, nodes: &Nodes, body: &RigidBody, before: &RigidBody) -> f64 {
        let Some(swept) = &self.swept else {
            let sums = self.impulse_sums();
            self.work.add(&sums, self.multiplicity, [before, body]);
            return self.contacts.iter().map(|contacts| contacts.largest_speed_squared).fold(0.0, f64::max).sqrt();
        };
        let (mut sums, mut fastest) = (ImpulseSums::default(), 0.0_f64);
        for impulse in swept {
            let after = nodes.velocity_of(impulse.node);
            fastest = fastest.max(after.norm_squared());
            sums.add(impulse, [&self.previous_velocity.value_at(impulse.node).into(), &after]);
        }
        self.work.add(&sums, self.multiplicity, [before, body]);
        fastest.sqrt()
    }

    /// Sums over the impulses of all ranges.
    fn impulse_sums(&self) -> ImpulseSums {
        self.contacts.iter().fold(ImpulseSums::default(), |sums, contacts| sums + contacts.sums)
    }

    /// Finds the nodes that would penetrate at the end of the step.
    fn predict(&mut self, nodes: &Nodes, body: &RigidBody, dt: f64, pool: &ThreadPool) {
        let list = &self.neighbours;
        let mut body = body.clone();
        // Nodes have their positions at the end of the step, so the body must have its pose there, too.
        body.pose = body.predicted(dt);
        let predictor = Predictor {
            surface: &self.surface,
            friction: self.friction,
            multiplicity: self.multiplicity,
            offset: &self.offset,
            normals: (!list.face_candidates.is_empty()).then(|| Disjoint::new(&mut self.normals)),
            nearest: (!self.nearest.is_empty()).then(|| Disjoint::new(&mut self.nearest)),
            nodes,
            body: &body,
            per_second: 1.0 / dt,
        };
        let contacts = Disjoint::new(&mut self.contacts);
        pool.each(list.ranges.len(), |part| {
            // SAFETY: every range comes up once.
            let contacts = unsafe { contacts.entry(part) };
            node_contact::predict(pool.width(), &predictor, &list.nodes[list.ranges[part].clone()], contacts);
        });
    }

    /// The body as it moves once all node contacts have acted on it (theory.md, equation 20), and its guide over `over`
    /// (s) after its motion `before`, with the guide's impulse (N s; equation 52).
    fn corrected_body(&self, body: &RigidBody, before: Option<&RigidBody>, over: f64) -> (RigidBody, Option<f64>) {
        let mut active = self.contacts.iter().filter(|contacts| contacts.is_active());
        let all = active
            .next()
            .map(|first| active.fold(first.coupled_film.clone(), |all, contacts| all.and(&contacts.coupled_film)));
        let mut corrected = all.as_ref().map_or_else(|| body.clone(), |all| body.after_contact(all));
        let guide = before.filter(|_| body.has_guide_friction()).map(|before| {
            // Film in contact is stopped with the body, so friction that stops the body at most has to stop both
            // (theory.md, equation 52).
            let mass = body.mass + all.as_ref().map_or(0.0, CoupledFilm::mass_along_z);
            let impulse = body.guide_impulse(before, corrected.velocity.z, mass, over);
            corrected.velocity.z += impulse / mass;
            impulse
        });
        (corrected, guide)
    }

    /// Gives the penetrating nodes the impulses with which they follow the `corrected` body, moves them on, and sums
    /// the impulses.
    fn correct_nodes(
        &mut self,
        nodes: &mut Nodes,
        body: &RigidBody,
        corrected: &RigidBody,
        dt: f64,
        pool: &ThreadPool,
    ) {
        let contacts = Disjoint::new(&mut self.contacts);
        let corrector = Corrector {
            friction: self.friction,
            previous_velocity: &self.previous_velocity,
            nodes: nodes.correction(),
            body,
            corrected,
            dt,
            lists_impulses: self.lists_impulses,
        };
        pool.each(self.neighbours.ranges.len(), |part| {
            // SAFETY: every range comes up once.
            node_contact::correct(pool.width(), &corrector, unsafe { contacts.entry(part) });
        });
    }

    /// Nodes that were in contact in the last step, themselves or as corners of an element.
    pub(super) fn nodes_in_contact(&self) -> impl Iterator<Item = usize> + '_ {
        let swept = self.swept.iter().flatten();
        let listed = self.contacts.iter().flat_map(|contacts| &contacts.impulses).chain(swept);
        let unlisted = self.contacts.iter().filter(|_| !self.lists_impulses);
        listed.map(|impulse| impulse.node).chain(unlisted.flat_map(NodeContacts::active_nodes))
    }
}
