//! Contact between the impactor and the film, met kinematically.
//!
//! After the forces of a step have acted, every node whose position at the end of the step would lie inside the impactor
//! gets the momentum that puts it on the surface, and the impactor gives that momentum (theory.md, section 6). There is no
//! penalty stiffness to guess: nodes do not penetrate, and nothing is added to the frequency that limits the time step.
//! Friction is the tangential momentum that makes a node follow the surface, bounded by μ times the normal one, so a
//! node within the bound sticks without creep.
//!
//! Faces between nodes penetrate by the sagitta of their edges. Where that may exceed [`FACE_BOUND`] of the
//! impactor's size, or the impactor has edges of its own, the deepest point of each triangle is met in the same way.

mod search;

use search::{FaceTouch, Touch};
pub use search::{Surface, SurfaceError};

use nalgebra::{Isometry3, Point3, Vector3};

use super::film::Film;
use super::nodes::Nodes;
use super::rigid_body::{Gathered, RigidBody};

/// Penetration of a face between its nodes that is left alone, over the impactor's size: a little less than what is
/// warned of.
const FACE_BOUND: f64 = 0.008;

/// Share of a penetration beyond the bound that is taken back in one step: a face that comes to be listed while it is
/// too deep is eased out instead of thrown out.
const FACE_RECOVERY: f64 = 0.02;

/// Sweeps over the faces in a step.
const FACE_SWEEPS: usize = 8;

/// Share of [`FACE_BOUND`] from which the sagitta of an element on a sphere, (longest line)²/(8 R), has it listed.
const LISTED_FROM: f64 = 0.7;

/// Skin of the neighbour list over the impactor's size.
const SKIN: f64 = 0.04;

/// Contact of one impactor with all faces of film.
pub struct Contact {
    surface: Surface,
    friction: f64,
    /// How many mirror images of the film the impactor meets.
    multiplicity: f64,
    /// Distance of each node's mid-surface from the impactor when in touch, m: the film in between.
    offset: Vec<f64>,
    near: NearList,
    touching: Vec<Constraint>,
    impulses: Vec<Impulse>,
    /// Velocity that each node got from contact in this step, m/s.
    received: Vec<[f64; 3]>,
    /// Sums since the start, J.
    pub work: Work,
    /// Largest penetration that was seen by [`Contact::inspect`], m.
    pub deepest: f64,
}

/// Work done through contact since the start, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Given by the impactor.
    pub given: f64,
    /// Lost where nodes first meet the surface.
    pub impact_loss: f64,
    /// Lost by sliding.
    pub friction_loss: f64,
}

/// Nodes and triangles that could touch before the list is made again.
#[derive(Default)]
struct NearList {
    nodes: Vec<u32>,
    faces: Vec<[u32; 3]>,
    /// Relative motion that is left until then, m.
    margin: f64,
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

/// The deepest point of a triangle of film and what keeps it from going deeper.
struct FacePoint {
    nodes: [usize; 3],
    weights: [f64; 3],
    normal: Vector3<f64>,
    arm: Vector3<f64>,
    /// Normal velocity per impulse, 1/kg.
    compliance: f64,
    /// Least normal velocity, m/s.
    target: f64,
    /// Normal impulse so far, N s.
    pushed: f64,
}

impl FacePoint {
    fn relative_velocity(&self, nodes: &Nodes, body: &RigidBody) -> Vector3<f64> {
        let film: Vector3<f64> = (0..3).map(|a| nodes.velocity_of(self.nodes[a]) * self.weights[a]).sum();
        film - body.velocity_at(&self.arm)
    }

    /// Gives `impulse` (N s) to the film and takes it from the body.
    fn spread(&self, impulse: Vector3<f64>, nodes: &mut Nodes, body: &mut RigidBody, multiplicity: f64) {
        for (n, weight) in self.nodes.iter().zip(self.weights) {
            for axis in 0..3 {
                nodes.velocity[*n][axis] += weight * impulse[axis] * nodes.inverse_mass[*n][axis];
            }
        }
        body.push(&(-multiplicity * impulse), &self.arm);
    }
}

/// What a look at the present touch found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inspection {
    /// Deepest point of film in the impactor, m.
    pub penetration: f64,
    /// Longest edge of an element in touch, m.
    pub longest_edge: f64,
    /// Whether a node that is held lies inside.
    pub frame_hit: bool,
}

impl Contact {
    /// Contact of `surface` with film whose nodes keep `offset` (m) from it; `multiplicity` mirror images count.
    pub fn new(surface: Surface, friction: f64, multiplicity: f64, offset: Vec<f64>) -> Contact {
        Contact {
            surface,
            friction,
            multiplicity,
            received: vec![[0.0; 3]; offset.len()],
            offset,
            near: NearList::default(),
            touching: vec![],
            impulses: vec![],
            work: Work::default(),
            deepest: 0.0,
        }
    }

    /// The impactor's surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Tells that film and impactor moved towards each other by at most `distance` (m).
    pub fn moved(&mut self, distance: f64) {
        self.near.margin -= distance;
    }

    /// Forgets the neighbour list, as after elements have broken.
    pub fn forget(&mut self) {
        self.near.margin = -1.0;
    }

    /// Corrects the velocities of nodes and body so that no node is inside at the end of the step of `dt` s.
    /// `before` is the body half a step earlier, `kick` the time over which forces have just acted, s.
    pub fn meet(
        &mut self,
        films: &[Film],
        nodes: &mut Nodes,
        body: &mut RigidBody,
        before: &RigidBody,
        [dt, kick]: [f64; 2],
    ) {
        if self.near.margin <= 0.0 {
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
        self.account(nodes, body, before, kick);
    }

    /// Nodes whose position at the end of the step lies inside.
    fn find_touching(&mut self, nodes: &Nodes, body: &RigidBody, pose: &Isometry3<f64>, dt: f64) {
        self.touching.clear();
        let centre = Point3::from(pose.translation.vector);
        for &n in &self.near.nodes {
            let n = n as usize;
            let (x, v) = (nodes.position[n], nodes.velocity[n]);
            let point = Point3::new(x[0] + v[0] * dt, x[1] + v[1] * dt, x[2] + v[2] * dt);
            let Touch { gap, normal } = self.surface.touch(pose, &point);
            let gap = gap - self.offset[n];
            if gap < 0.0 && nodes.inverse_mass[n][2] > 0.0 {
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

    /// Lets no listed triangle reach deeper than [`FACE_BOUND`]: Gauss–Seidel sweeps over the deepest point of each, with
    /// impulses that may shrink again but not pull (theory.md, section 6).
    fn meet_faces(&mut self, nodes: &mut Nodes, body: &mut RigidBody, dt: f64) {
        if self.near.faces.is_empty() {
            return;
        }
        let pose = body.predicted(dt);
        let listed = self.near.faces.iter();
        let mut points: Vec<FacePoint> = listed.filter_map(|f| self.face_point(*f, nodes, body, &pose, dt)).collect();
        for _ in 0..FACE_SWEEPS {
            for point in &mut points {
                let lack = point.target - point.relative_velocity(nodes, body).dot(&point.normal);
                let pushed = (point.pushed + lack / point.compliance).max(0.0);
                let impulse = point.normal * (pushed - point.pushed);
                point.pushed = pushed;
                point.spread(impulse, nodes, body, self.multiplicity);
            }
        }
        for point in points.iter().filter(|p| p.pushed > 0.0) {
            let relative = point.relative_velocity(nodes, body);
            let slip = relative - point.normal * relative.dot(&point.normal);
            let stick = slip.norm() / point.compliance;
            let share = if stick > 0.0 { (self.friction * point.pushed / stick).min(1.0) } else { 0.0 };
            let tangential = -slip * (share / point.compliance);
            point.spread(tangential, nodes, body, self.multiplicity);
            for a in 0..3 {
                let normal = point.normal * (point.pushed * point.weights[a]);
                let tangential = tangential * point.weights[a];
                self.impulses.push(Impulse { node: point.nodes[a], arm: point.arm, normal, tangential });
            }
        }
    }

    /// The deepest point of a triangle, if it is near the bound.
    fn face_point(
        &self,
        face: [u32; 3],
        nodes: &Nodes,
        body: &RigidBody,
        pose: &Isometry3<f64>,
        dt: f64,
    ) -> Option<FacePoint> {
        let face = face.map(|n| n as usize);
        let allowed = FACE_BOUND * self.surface.size();
        let corners = face.map(|n| Point3::from(nodes.position[n]) + nodes.velocity_of(n) * dt);
        let bound = self.offset[face[0]] - allowed;
        let FaceTouch { touch, weights } = self.surface.deepest(pose, &corners, bound + allowed)?;
        let place: Vector3<f64> = (0..3).map(|a| corners[a].coords * weights[a]).sum();
        let arm = place - pose.translation.vector;
        let softness = |a: usize| {
            let w = nodes.inverse_mass[face[a]];
            weights[a] * weights[a] * (0..3).map(|i| touch.normal[i].powi(2) * w[i]).sum::<f64>()
        };
        let compliance = (0..3).map(softness).sum::<f64>() + self.multiplicity * body.mobility(&touch.normal, &arm);
        let mut point =
            FacePoint { nodes: face, weights, normal: touch.normal, arm, compliance, target: 0.0, pushed: 0.0 };
        let to_bound = point.relative_velocity(nodes, body).dot(&touch.normal) + (bound - touch.gap) / dt;
        point.target = if to_bound > 0.0 { FACE_RECOVERY * to_bound } else { to_bound };
        (compliance > 0.0).then_some(point)
    }

    /// Work of this step's impulses with the mean of the velocities before and after it (theory.md, equation 22).
    fn account(&mut self, nodes: &Nodes, body: &RigidBody, before: &RigidBody, kick: f64) {
        for impulse in &self.impulses {
            self.received[impulse.node] = [0.0; 3];
        }
        for impulse in &self.impulses {
            let gained = velocity_change(nodes, impulse);
            (0..3).for_each(|i| self.received[impulse.node][i] += gained[i]);
        }
        for impulse in &self.impulses {
            let after = nodes.velocity_of(impulse.node);
            let acceleration =
                Vector3::from_fn(|i, _| nodes.force[impulse.node][i] * nodes.inverse_mass[impulse.node][i]);
            let earlier = after - Vector3::from(self.received[impulse.node]) - acceleration * kick;
            let film = 0.5 * (after + earlier);
            let surface = 0.5 * (body.velocity_at(&impulse.arm) + before.velocity_at(&impulse.arm));
            let relative = film - surface;
            self.work.given += self.multiplicity * (impulse.normal + impulse.tangential).dot(&surface);
            self.work.impact_loss -= self.multiplicity * impulse.normal.dot(&relative);
            self.work.friction_loss -= self.multiplicity * impulse.tangential.dot(&relative);
        }
    }

    fn list_neighbours(&mut self, films: &[Film], nodes: &Nodes, pose: &Isometry3<f64>) {
        let skin = SKIN * self.surface.size();
        let centre = Point3::from(pose.translation.vector);
        let within = |n: usize, margin: f64| {
            let point = Point3::from(nodes.position[n]);
            let reach = self.surface.reach() + self.offset[n] + margin;
            nalgebra::distance_squared(&point, &centre) < reach * reach
                && self.surface.touch(pose, &point).gap < self.offset[n] + margin
        };
        let all = 0..nodes.position.len();
        self.near.nodes = all.filter(|&n| within(n, skin)).map(|n| n as u32).collect();
        self.near.faces.clear();
        for film in films {
            film.for_each_intact(|corners| {
                let longest = longest_line(corners, nodes);
                let size = self.surface.size();
                if self.surface.is_sphere() && longest * longest < 8.0 * LISTED_FROM * FACE_BOUND * size * size {
                    return;
                }
                if corners.iter().any(|&n| within(n as usize, skin + longest)) {
                    for k in 2..corners.len() {
                        self.near.faces.push([corners[0], corners[k - 1], corners[k]]);
                    }
                }
            });
        }
        self.near.margin = skin;
    }

    /// Looks at the whole touch as it is now.
    pub fn inspect(&mut self, films: &[Film], nodes: &Nodes, pose: &Isometry3<f64>) -> Inspection {
        let mut out = Inspection::default();
        let tolerance = 1e-4 * self.surface.size();
        for film in films {
            film.for_each_intact(|corners| {
                let gap = |n: u32| {
                    let offset = self.offset[n as usize];
                    self.surface.touch(pose, &Point3::from(nodes.position[n as usize])).gap - offset
                };
                let centre = Point3::from(pose.translation.vector);
                let longest = longest_edge(corners, nodes);
                let far = self.surface.reach() + longest + tolerance;
                if nalgebra::distance(&Point3::from(nodes.position[corners[0] as usize]), &centre) > far {
                    return;
                }
                let inside: Vec<u32> = corners.iter().copied().filter(|n| gap(*n) < tolerance).collect();
                if inside.is_empty() {
                    return;
                }
                let held = |n: &u32| gap(*n) < -tolerance && nodes.inverse_mass[*n as usize][2] == 0.0;
                out.frame_hit |= inside.iter().any(held);
                out.longest_edge = out.longest_edge.max(longest);
                for k in 2..corners.len() {
                    let triangle =
                        [corners[0], corners[k - 1], corners[k]].map(|n| Point3::from(nodes.position[n as usize]));
                    let offset = self.offset[corners[0] as usize];
                    if let Some(found) = self.surface.deepest(pose, &triangle, offset) {
                        out.penetration = out.penetration.max(offset - found.touch.gap);
                    }
                }
            });
        }
        self.deepest = self.deepest.max(out.penetration);
        out
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

/// Longest line between any two corners, m.
fn longest_line(corners: &[u32], nodes: &Nodes) -> f64 {
    let at = |n: u32| Point3::from(nodes.position[n as usize]);
    let pairs = corners.iter().enumerate().flat_map(|(k, a)| corners[k + 1..].iter().map(move |b| (*a, *b)));
    pairs.map(|(a, b)| nalgebra::distance_squared(&at(a), &at(b))).fold(0.0, f64::max).sqrt()
}

fn longest_edge(corners: &[u32], nodes: &Nodes) -> f64 {
    let at = |n: u32| Point3::from(nodes.position[n as usize]);
    let edge = |k: usize| nalgebra::distance_squared(&at(corners[k]), &at(corners[(k + 1) % corners.len()]));
    (0..corners.len()).map(edge).fold(0.0, f64::max).sqrt()
}
