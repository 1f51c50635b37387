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

pub use inspection::Inspection;
pub use search::{Surface, SurfaceError};

use nalgebra::{Isometry3, Point3, Vector3};

use super::film::Film;
use super::nodes::Nodes;
use super::rigid_body::{Gathered, RigidBody};
use near::NearList;
use search::Touch;

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
    touching: Vec<Constraint>,
    impulses: Vec<Impulse>,
    /// Velocity that each node got from contact in this step, m/s.
    received: Vec<[f64; 3]>,
    /// Sums since the start, J.
    pub work: Work,
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

/// How the velocities before contact came about.
pub struct Kicked<'a> {
    /// The body half a step earlier.
    pub before: &'a RigidBody,
    /// Factor on the nodes' earlier velocities.
    pub keep: f64,
    /// Factor on their accelerations, s.
    pub gain: f64,
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
        let normals = vec![Vector3::zeros(); offset.len()];
        Contact {
            surface,
            friction,
            multiplicity,
            received: vec![[0.0; 3]; offset.len()],
            offset,
            near: NearList::default(),
            normals,
            touching: vec![],
            impulses: vec![],
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

    /// Corrects the velocities of nodes and body so that no node is inside at the end of the step of `dt` s.
    /// `kicked` tells what forces have just done.
    pub fn meet(&mut self, films: &[Film], nodes: &mut Nodes, body: &mut RigidBody, kicked: &Kicked, dt: f64) {
        // Nodes are looked at where they will be at the end of the step, so one more step has to fit in the skin.
        if self.near.margin.is_nan() || self.near.margin <= self.near.pace {
            self.list_neighbours(films, nodes, &body.pose);
        }
        self.impulses.clear();
        let pose = body.predicted(dt);
        self.find_touching(nodes, body, &pose, dt);
        let ahead = self.body_ahead(nodes, body);
        let friction = self.friction;
        let met = self.touching.iter().filter_map(|c| node_impulse(c, nodes, &ahead, body, friction));
        self.impulses.extend(met);
        for impulse in &self.impulses {
            give(nodes, impulse);
            body.push(&(-self.multiplicity * (impulse.normal + impulse.tangential)), &impulse.arm);
        }
        self.meet_faces(nodes, body, dt);
        self.account(nodes, body, kicked);
    }

    /// Nodes whose position at the end of the step lies inside.
    fn find_touching(&mut self, nodes: &Nodes, body: &RigidBody, pose: &Isometry3<f64>, dt: f64) {
        self.touching.clear();
        let centre = Point3::from(pose.translation.vector);
        for &n in &self.near.nodes {
            let n = n as usize;
            let (x, v) = (nodes.position[n], nodes.velocity[n]);
            let point = Point3::new(x[0] + v[0] * dt, x[1] + v[1] * dt, x[2] + v[2] * dt);
            let reach = self.surface.reach() + self.offset[n];
            if nalgebra::distance_squared(&point, &centre) > reach * reach {
                continue;
            }
            let Touch { gap, normal } = self.surface.touch(pose, &point);
            self.normals[n] = normal;
            let gap = gap - self.offset[n];
            if gap < 0.0 && !nodes.is_held(n) {
                let arm = point - centre;
                let relative = nodes.velocity_of(n) - body.velocity_at(&arm);
                let slip = relative - normal * relative.dot(&normal);
                self.touching.push(Constraint { node: n, normal, lack: -gap / dt, arm, slip });
            }
        }
    }

    /// The body as it will move once all touching nodes have taken their momentum.
    fn body_ahead(&self, nodes: &Nodes, body: &RigidBody) -> RigidBody {
        if self.touching.is_empty() {
            return body.clone();
        }
        let mut gathered = Gathered::default();
        for c in &self.touching {
            let mass = self.multiplicity * nodes.mass[c.node];
            let (tangential, sticks) = stopping(&c.slip, self.friction * c.lack);
            let along = if sticks { None } else { Some(&c.normal) };
            body.gather(&mut gathered, &c.arm, mass, along, &((c.normal * c.lack + tangential) * mass));
        }
        body.after(&gathered)
    }

    /// Work of this step's impulses with the mean of the velocities before and after it (theory.md, equation 22).
    fn account(&mut self, nodes: &Nodes, body: &RigidBody, kicked: &Kicked) {
        for impulse in &self.impulses {
            self.received[impulse.node] = [0.0; 3];
        }
        let before = self.work.given;
        for impulse in &self.impulses {
            let gained = velocity_change(nodes, impulse);
            (0..3).for_each(|i| self.received[impulse.node][i] += gained[i]);
        }
        for impulse in &self.impulses {
            let after = nodes.velocity_of(impulse.node);
            let acceleration =
                Vector3::from_fn(|i, _| nodes.force[impulse.node][i] * nodes.inverse_mass[impulse.node][i]);
            let unmet = after - Vector3::from(self.received[impulse.node]);
            let earlier = (unmet - acceleration * kicked.gain) / kicked.keep;
            let film = 0.5 * (after + earlier);
            let surface = 0.5 * (body.velocity_at(&impulse.arm) + kicked.before.velocity_at(&impulse.arm));
            let relative = film - surface;
            self.work.impulse -= self.multiplicity * (impulse.normal.z + impulse.tangential.z);
            self.work.given += self.multiplicity * (impulse.normal + impulse.tangential).dot(&surface);
            self.work.impact_loss -= self.multiplicity * impulse.normal.dot(&relative);
            self.work.friction_loss -= self.multiplicity * impulse.tangential.dot(&relative);
        }
        self.work.ahead = 0.5 * (self.work.given - before);
    }

    /// Nodes that the impactor touched in the last step.
    pub fn touched(&self) -> impl Iterator<Item = usize> + '_ {
        self.impulses.iter().map(|i| i.node)
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

fn velocity_change(nodes: &Nodes, impulse: &Impulse) -> [f64; 3] {
    let w = nodes.inverse_mass[impulse.node];
    std::array::from_fn(|i| (impulse.normal[i] + impulse.tangential[i]) * w[i])
}

fn give(nodes: &mut Nodes, impulse: &Impulse) {
    let change = velocity_change(nodes, impulse);
    (0..3).for_each(|i| nodes.velocity[impulse.node][i] += change[i]);
}
