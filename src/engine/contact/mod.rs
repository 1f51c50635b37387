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

pub use search::{Surface, SurfaceError, Touch};

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use super::film::Film;
use super::nodes::Nodes;
use super::rigid_body::{Gathered, RigidBody};

/// Penetration of a face between its nodes that is left alone, over the impactor's size: half of the 1 % that is warned of.
const FACE_BOUND: f64 = 0.005;

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
    arm: Vector3<f64>,
}

/// What one node got from the impactor in this step, N s.
struct Impulse {
    node: usize,
    point: Point3<f64>,
    normal: Vector3<f64>,
    tangential: Vector3<f64>,
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
        self.find_touching(nodes, &pose, dt);
        let ahead = self.body_ahead(nodes, body);
        let start = self.impulses.len();
        for constraint in &self.touching {
            let point = pose * (body.pose.inverse() * (body.centre() + constraint.arm));
            if let Some(impulse) = node_impulse(constraint, point, nodes, &ahead, body, self.friction) {
                self.impulses.push(impulse);
            }
        }
        for impulse in &self.impulses[start..] {
            give(nodes, impulse);
        }
        for impulse in &self.impulses {
            body.push(-(impulse.normal + impulse.tangential) * self.multiplicity, &impulse.point);
        }
        self.meet_faces(nodes, body, dt);
        self.account(nodes, body, before, kick);
    }

    /// Nodes whose position at the end of the step lies inside.
    fn find_touching(&mut self, nodes: &Nodes, pose: &Isometry3<f64>, dt: f64) {
        self.touching.clear();
        let centre = Point3::from(pose.translation.vector);
        for &n in &self.near.nodes {
            let n = n as usize;
            let (x, v) = (nodes.position[n], nodes.velocity[n]);
            let point = Point3::new(x[0] + v[0] * dt, x[1] + v[1] * dt, x[2] + v[2] * dt);
            let Touch { gap, normal } = self.surface.touch(pose, &point);
            let gap = gap - self.offset[n];
            if gap < 0.0 && nodes.inverse_mass[n][2] > 0.0 {
                self.touching.push(Constraint { node: n, normal, lack: -gap / dt, arm: point - centre });
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
            let along = c.normal * c.normal.transpose();
            let slip = slip(c, nodes, body);
            let bound = self.friction * c.lack;
            let sticks = slip.norm() <= bound;
            let tangential = if sticks { -slip } else { -slip * (bound / slip.norm()) };
            let follows = if sticks { Matrix3::identity() } else { along };
            gathered.add(c.arm, &(follows * mass), (c.normal * c.lack + tangential) * mass);
        }
        body.after(&gathered)
    }

    /// The deepest point of each listed triangle, one after the other on the velocities as they come.
    fn meet_faces(&mut self, nodes: &mut Nodes, body: &mut RigidBody, dt: f64) {
        if self.near.faces.is_empty() {
            return;
        }
        let allowed = FACE_BOUND * self.surface.size();
        for f in 0..self.near.faces.len() {
            let face = self.near.faces[f].map(|n| n as usize);
            let pose = body.predicted(dt);
            let corners = face.map(|n| Point3::from(nodes.position[n]) + nodes.velocity_of(n) * dt);
            let offset = self.offset[face[0]] - allowed;
            let Some(found) = self.surface.deepest(&pose, &corners, offset) else { continue };
            let (touch, weights) = (found.touch, found.weights);
            let point = Point3::from((0..3).map(|a| corners[a].coords * weights[a]).sum::<Vector3<f64>>());
            let compliance: f64 = (0..3)
                .map(|a| {
                    let w = nodes.inverse_mass[face[a]];
                    weights[a] * weights[a] * (0..3).map(|i| touch.normal[i].powi(2) * w[i]).sum::<f64>()
                })
                .sum::<f64>()
                + self.multiplicity * body.mobility(&touch.normal, &point);
            let size = (offset - touch.gap) / (dt * compliance);
            let film: Vector3<f64> = (0..3).map(|a| nodes.velocity_of(face[a]) * weights[a]).sum();
            let relative = film - body.velocity_at(&point);
            let slip = relative - touch.normal * relative.dot(&touch.normal);
            let stick = slip.norm() / compliance;
            let tangential = if stick > 0.0 { -slip / slip.norm() * stick.min(self.friction * size) } else { slip };
            for a in 0..3 {
                let normal = touch.normal * size * weights[a];
                let impulse = Impulse { node: face[a], point, normal, tangential: tangential * weights[a] };
                give(nodes, &impulse);
                body.push(-(impulse.normal + impulse.tangential) * self.multiplicity, &point);
                self.impulses.push(impulse);
            }
        }
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
            let surface = 0.5 * (body.velocity_at(&impulse.point) + before.velocity_at(&impulse.point));
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
                let longest = longest_edge(corners, nodes);
                let fine = longest * longest < 8.0 * 0.8 * FACE_BOUND * self.surface.size() * self.surface.size();
                if self.surface.is_sphere() && fine {
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

/// Tangential velocity of a node over the body's surface.
fn slip(c: &Constraint, nodes: &Nodes, body: &RigidBody) -> Vector3<f64> {
    let relative = nodes.velocity_of(c.node) - body.velocity - body.spin.cross(&c.arm);
    relative - c.normal * relative.dot(&c.normal)
}

/// What a touching node gets when the body moves on as `ahead`; `None` where the body leaves it.
fn node_impulse(
    c: &Constraint,
    point: Point3<f64>,
    nodes: &Nodes,
    ahead: &RigidBody,
    body: &RigidBody,
    friction: f64,
) -> Option<Impulse> {
    let change = ahead.velocity - body.velocity + (ahead.spin - body.spin).cross(&c.arm);
    let lack = c.lack + c.normal.dot(&change);
    if lack <= 0.0 {
        return None;
    }
    let mass = nodes.mass[c.node];
    let slip = slip(c, nodes, ahead);
    let bound = friction * lack;
    let tangential = if slip.norm() <= bound { -slip } else { -slip * (bound / slip.norm()) };
    Some(Impulse { node: c.node, point, normal: c.normal * lack * mass, tangential: tangential * mass })
}

fn velocity_change(nodes: &Nodes, impulse: &Impulse) -> [f64; 3] {
    let w = nodes.inverse_mass[impulse.node];
    std::array::from_fn(|i| (impulse.normal[i] + impulse.tangential[i]) * w[i])
}

fn give(nodes: &mut Nodes, impulse: &Impulse) {
    let change = velocity_change(nodes, impulse);
    (0..3).for_each(|i| nodes.velocity[impulse.node][i] += change[i]);
}

fn longest_edge(corners: &[u32], nodes: &Nodes) -> f64 {
    let at = |n: u32| Point3::from(nodes.position[n as usize]);
    let edge = |k: usize| nalgebra::distance_squared(&at(corners[k]), &at(corners[(k + 1) % corners.len()]));
    (0..corners.len()).map(edge).fold(0.0, f64::max).sqrt()
}
