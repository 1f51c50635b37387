//! Contact between the impactor and the film, met kinematically.
//!
//! After the forces of a step have acted, every node whose position at the end of the step would lie inside the impactor
//! gets the momentum that puts it on the surface, and the impactor gives that momentum (theory.md, section 6). There is no
//! penalty stiffness to guess: nodes do not penetrate, and nothing is added to the frequency that limits the time step.
//! Friction is the tangential momentum that makes a node follow the surface, bounded by μ times the normal one, so a
//! node within the bound sticks without creep.
//!
//! Faces between nodes penetrate by the sagitta of their edges. Where that may exceed `FACE_BOUND` of the
//! impactor's size, or the impactor has edges of its own, the deepest point of each triangle is met in the same way.

mod faces;
mod inspection;
mod near;
mod search;
mod tally;

pub use inspection::Inspection;
pub use search::{Surface, SurfaceError};

use nalgebra::{Isometry3, Point3, Vector3};

use super::film::Film;
use super::nodes::{Moved, Nodes};
use super::rigid_body::{Gathered, RigidBody};
use super::team::{Disjoint, Team};
use near::NearList;
use search::Touch;
use tally::Tally;

/// Contact of one impactor with all faces of film.
pub struct Contact {
    surface: Surface,
    friction: f64,
    /// How many mirror images of the film the impactor meets.
    multiplicity: f64,
    /// Distance of each node's mid-surface from the impactor when in touch, m: the film in between.
    offset: Vec<f64>,
    near: NearList,
    /// The surface's normal at each node near it, zero elsewhere.
    normals: Vec<Vector3<f64>>,
    /// Velocity of the nodes near it half a step earlier, m/s.
    earlier: Vec<Vector3<f64>>,
    /// Velocity that each node got from contact in this step, m/s.
    received: Vec<Vector3<f64>>,
    pieces: Vec<Piece>,
    /// Sums since the start, J.
    pub work: Work,
}

/// Nodes near the impactor that one thread looks at together.
const PIECE: usize = 256;

/// What was found at the nodes of one piece of the neighbour list.
#[derive(Default)]
struct Piece {
    touching: Vec<Constraint>,
    impulses: Vec<Impulse>,
    tally: Tally,
    moved: Moved,
}

/// What went through contact since the start, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Given by the impactor.
    pub given: f64,
    /// Lost where nodes first meet the surface.
    pub impact_loss: f64,
    /// Lost by sliding.
    pub friction_loss: f64,
    /// Momentum given to the impactor along z, N s.
    pub impulse: f64,
    /// Half of what was given in the last step: it belongs to the half step after the full one.
    pub ahead: f64,
}

/// A node that would be inside.
struct Constraint {
    node: usize,
    normal: Vector3<f64>,
    /// Normal velocity that it lacks, m/s.
    lack: f64,
    /// From the body's centre of mass, m.
    arm: Vector3<f64>,
    /// Tangential velocity over the surface, m/s.
    slip: Vector3<f64>,
}

/// What one node got from the impactor in this step, N s.
struct Impulse {
    node: usize,
    arm: Vector3<f64>,
    normal: Vector3<f64>,
    tangential: Vector3<f64>,
}

impl Contact {
    /// Contact of `surface` with film whose nodes keep `offset` (m) from it; `multiplicity` mirror images count.
    pub fn new(surface: Surface, friction: f64, multiplicity: f64, offset: Vec<f64>) -> Contact {
        let zero = vec![Vector3::zeros(); offset.len()];
        Contact {
            surface,
            friction,
            multiplicity,
            offset,
            near: NearList::default(),
            normals: zero.clone(),
            earlier: zero.clone(),
            received: zero,
            pieces: vec![],
            work: Work::default(),
        }
    }

    /// The impactor's surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Tells that film and impactor moved towards each other by at most `distance` (m).
    pub fn moved(&mut self, distance: f64) {
        self.near.margin -= distance;
        self.near.pace = distance;
    }

    /// Forgets the neighbour list, as after elements have broken.
    pub fn forget(&mut self) {
        self.near.margin = -1.0;
    }

    /// Looks around before the nodes move: lists neighbours where that is due and remembers their velocities.
    pub fn prepare(&mut self, films: &[Film], nodes: &Nodes, body: &RigidBody) {
        // Nodes are looked at where they will be at the end of the step, so one more step has to fit in the skin.
        if self.near.margin.is_nan() || self.near.margin <= self.near.pace {
            self.list_neighbours(films, nodes, &body.pose);
        }
        let corners = self.near.watched.iter().flat_map(|element| &element.corners);
        for n in self.near.nodes.iter().chain(corners).map(|n| *n as usize) {
            self.earlier[n] = nodes.velocity_of(n);
        }
    }

    /// Corrects the velocities of nodes and body, and the places of nodes, so that no node is inside at the end of the step
    /// of `dt` s. The nodes stand there already, the body stands where it was; `before` is its motion before the forces of
    /// this step. Returns what is to be known of the nodes that were met, on top of what was known.
    pub(super) fn meet(
        &mut self,
        nodes: &mut Nodes,
        body: &mut RigidBody,
        before: &RigidBody,
        dt: f64,
        team: &Team,
    ) -> Moved {
        self.pieces.resize_with(self.near.nodes.len().div_ceil(PIECE), Piece::default);
        let pose = body.predicted(dt);
        self.find_touching(nodes, body, &pose, dt, team);
        let ahead = self.body_ahead(nodes, body);
        self.give(nodes, body, &ahead, team);
        self.meet_faces(nodes, body, dt);
        self.settle(nodes, dt, team);
        let total = self.pieces.iter().fold(Tally::default(), |sum, piece| sum + piece.tally);
        self.work.add(&total, self.multiplicity, body, before);
        self.pieces.iter().fold(Moved::default(), |all, piece| all.and(&piece.moved))
    }

    /// Nodes that lie inside.
    fn find_touching(&mut self, nodes: &Nodes, body: &RigidBody, pose: &Isometry3<f64>, dt: f64, team: &Team) {
        let centre = Point3::from(pose.translation.vector);
        let (surface, offset, near) = (&self.surface, &self.offset, &self.near.nodes);
        let (pieces, normals) = (Disjoint::new(&mut self.pieces), Disjoint::new(&mut self.normals));
        team.each(near.len().div_ceil(PIECE), |part| {
            // SAFETY: every piece comes up once.
            let piece = unsafe { pieces.at(part) };
            piece.touching.clear();
            for &n in &near[part * PIECE..near.len().min((part + 1) * PIECE)] {
                let n = n as usize;
                let point = nodes.place(n);
                let reach = surface.reach() + offset[n];
                if nalgebra::distance_squared(&point, &centre) > reach * reach {
                    continue;
                }
                let Touch { gap, normal } = surface.touch(pose, &point);
                // SAFETY: a node is listed once.
                unsafe { *normals.at(n) = normal };
                let gap = gap - offset[n];
                if gap < 0.0 && !nodes.is_held(n) {
                    let arm = point - centre;
                    let relative = nodes.velocity_of(n) - body.velocity_at(&arm);
                    let slip = relative - normal * relative.dot(&normal);
                    piece.touching.push(Constraint { node: n, normal, lack: -gap / dt, arm, slip });
                }
            }
        });
    }

    /// The body as it will move once all touching nodes have taken their momentum.
    fn body_ahead(&self, nodes: &Nodes, body: &RigidBody) -> RigidBody {
        if self.pieces.iter().all(|piece| piece.touching.is_empty()) {
            return body.clone();
        }
        let mut gathered = Gathered::default();
        for c in self.pieces.iter().flat_map(|piece| &piece.touching) {
            let mass = self.multiplicity * nodes.mass[c.node];
            let (tangential, sticks) = stopping(&c.slip, self.friction * c.lack);
            let along = if sticks { None } else { Some(&c.normal) };
            body.gather(&mut gathered, &c.arm, mass, along, &((c.normal * c.lack + tangential) * mass));
        }
        body.after(&gathered)
    }

    /// Gives the touching nodes their momentum and takes it from the body.
    fn give(&mut self, nodes: &mut Nodes, body: &mut RigidBody, ahead: &RigidBody, team: &Team) {
        let friction = self.friction;
        let (pieces, received) = (Disjoint::new(&mut self.pieces), Disjoint::new(&mut self.received));
        let still = &*nodes;
        team.each(self.near.nodes.len().div_ceil(PIECE), |part| {
            // SAFETY: every piece comes up once.
            let Piece { touching, impulses, .. } = unsafe { pieces.at(part) };
            impulses.clear();
            impulses.extend(touching.iter().filter_map(|c| node_impulse(c, still, ahead, body, friction)));
            for impulse in impulses {
                // SAFETY: a node is listed once.
                unsafe { *received.at(impulse.node) = velocity_change(still, impulse) };
            }
        });
        for impulse in self.pieces.iter().flat_map(|piece| &piece.impulses) {
            nodes.velocity.add(impulse.node, self.received[impulse.node].into());
            body.push(&(-self.multiplicity * (impulse.normal + impulse.tangential)), &impulse.arm);
        }
    }

    /// Moves the nodes that were met on from where they stood without contact, and adds up what went through them.
    fn settle(&mut self, nodes: &mut Nodes, dt: f64, team: &Team) {
        let (received, earlier) = (Disjoint::new(&mut self.received), &self.earlier);
        let pieces = Disjoint::new(&mut self.pieces);
        let count = self.near.nodes.len().div_ceil(PIECE);
        let (mut places, velocity, masses) = nodes.in_motion();
        let places = places.each_mut().map(|axis| Disjoint::new(axis));
        team.each(count, |part| {
            // SAFETY: every piece comes up once.
            let Piece { impulses, tally, moved, .. } = unsafe { pieces.at(part) };
            (*tally, *moved) = (Tally::default(), Moved::default());
            for impulse in &*impulses {
                let after = Vector3::from(velocity.at(impulse.node));
                tally.add(impulse, &(0.5 * (after + earlier[impulse.node])));
                // SAFETY: a node is in one piece only, or all are in the first.
                let change = std::mem::take(unsafe { received.at(impulse.node) });
                // Damping acted as if there were no contact, over the way that the node goes with it.
                let alone = 0.5 * (after - change + earlier[impulse.node]);
                let damped = 0.5 * masses[impulse.node] * change.dot(&alone);
                *moved = moved.and(&Moved { fastest: after.norm_squared(), damped });
                for axis in 0..3 {
                    // SAFETY: as above.
                    unsafe { *places[axis].at(impulse.node) += change[axis] * dt };
                }
            }
        });
    }

    /// Nodes that the impactor touched in the last step.
    pub fn touched(&self) -> impl Iterator<Item = usize> + '_ {
        self.pieces.iter().flat_map(|piece| &piece.impulses).map(|impulse| impulse.node)
    }
}

/// The change of tangential velocity by which friction stops `slip`, as far as `bound` (m/s) allows, and whether it does.
fn stopping(slip: &Vector3<f64>, bound: f64) -> (Vector3<f64>, bool) {
    let speed = slip.norm();
    if speed <= bound { (-slip, true) } else { (-slip * (bound / speed), false) }
}

/// What a touching node gets when the body moves on as `ahead`; `None` where the body leaves it.
fn node_impulse(c: &Constraint, nodes: &Nodes, ahead: &RigidBody, body: &RigidBody, friction: f64) -> Option<Impulse> {
    let change = ahead.velocity_at(&c.arm) - body.velocity_at(&c.arm);
    let away = c.normal.dot(&change);
    let lack = c.lack + away;
    if lack <= 0.0 {
        return None;
    }
    let mass = nodes.mass[c.node];
    let (tangential, _) = stopping(&(c.slip - change + c.normal * away), friction * lack);
    Some(Impulse { node: c.node, arm: c.arm, normal: c.normal * (lack * mass), tangential: tangential * mass })
}

fn velocity_change(nodes: &Nodes, impulse: &Impulse) -> Vector3<f64> {
    (impulse.normal + impulse.tangential).component_mul(&Vector3::from(nodes.mobility(impulse.node)))
}
