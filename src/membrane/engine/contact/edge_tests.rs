//! Drops of bodies with edges, corners and tips on film: penetration found by dense samples, and the energy balance.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::shape::{Cone, Cuboid, Cylinder, SharedShape, TriMesh, TriMeshFlags};

use super::*;
use crate::engine::{
    Contact, Energies, Engine, Impact, Loads, Mesh, Nodes, RigidBody, Section, Surface, Unobserved, View,
};
use crate::material::{Elastic, Law};

const THICKNESS: f64 = 1e-4;

/// Side of the film, m.
const SIDE: f64 = 0.4;

/// A square of `cells` quadrilaterals along an edge, or of twice as many triangles each.
fn square(cells: u32, triangles: bool) -> Mesh {
    let at = |k: u32| SIDE * (f64::from(k) / f64::from(cells) - 0.5);
    let row = cells + 1;
    let nodes = (0..row).flat_map(|j| (0..row).map(move |i| Point3::new(at(i), at(j), 0.0))).collect();
    let quad = |i: u32, j: u32| [j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i];
    let quads: Vec<[u32; 4]> = (0..cells).flat_map(|j| (0..cells).map(move |i| quad(i, j))).collect();
    let rim = (0..row * row).filter(|n| [n % row, n / row].iter().any(|k| [0, cells].contains(k))).collect();
    if triangles {
        let tris = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        return Mesh { nodes, tris, rim, ..Mesh::default() };
    }
    Mesh { nodes, quads, rim, ..Mesh::default() }
}

/// A body with parry's shape of it, from which distances are measured.
struct Body {
    name: &'static str,
    surface: Surface,
    core: SharedShape,
    place: Pose,
    edge: f64,
}

impl Body {
    fn distance(&self, pose: &Isometry3<f64>, point: &Point3<f64>) -> f64 {
        let p = pose.inverse_transform_point(point);
        let found = self.core.project_point(&self.place, Vector::new(p.x, p.y, p.z), false);
        let arm = Vector::new(p.x, p.y, p.z) - found.point;
        (if found.is_inside { -arm.length() } else { arm.length() }) - self.edge
    }
}

fn cylinder(name: &'static str, radius: f64, length: f64, edge: f64) -> Body {
    let upright = Pose::from_parts(Vector::ZERO, Rotation::from_rotation_arc(Vector::Y, Vector::Z));
    let core = SharedShape::new(Cylinder::new(0.5 * length - edge, radius - edge));
    Body { name, surface: Surface::cylinder(radius, length, edge).unwrap(), core, place: upright, edge }
}

fn cuboid(name: &'static str, size: [f64; 3], edge: f64) -> Body {
    let half = size.map(|s| 0.5 * s - edge);
    let core = SharedShape::new(Cuboid::new(Vector::new(half[0], half[1], half[2])));
    Body { name, surface: Surface::cuboid(size, edge).unwrap(), core, place: Pose::IDENTITY, edge }
}

fn cone(name: &'static str, radius: f64, length: f64) -> Body {
    let down = Rotation::from_rotation_arc(Vector::Y, Vector::NEG_Z);
    // The centre of mass is a quarter of the length from the flat end.
    let place = Pose::from_parts(Vector::new(0.0, 0.0, -0.25 * length), down);
    let core = SharedShape::new(Cone::new(0.5 * length, radius));
    Body { name, surface: Surface::cone(radius, length, 0.0).unwrap(), core, place, edge: 0.0 }
}

fn mesh(name: &'static str, vertices: Vec<Point3<f64>>, triangles: Vec<[u32; 3]>) -> Body {
    let surface = Surface::closed_mesh((vertices.clone(), triangles.clone())).unwrap();
    let centre = surface.centre();
    let moved = vertices.iter().map(|p| p - centre).map(|p| Vector::new(p.x, p.y, p.z)).collect();
    let flags = TriMeshFlags::ORIENTED | TriMeshFlags::MERGE_DUPLICATE_VERTICES;
    let core = SharedShape::new(TriMesh::with_flags(moved, triangles, flags).unwrap());
    Body { name, surface, core, place: Pose::IDENTITY, edge: 0.0 }
}

/// A box as twelve triangles.
fn box_mesh(name: &'static str, size: [f64; 3]) -> Body {
    let (corners, triangles) = Cuboid::new(Vector::new(0.5 * size[0], 0.5 * size[1], 0.5 * size[2])).to_trimesh();
    mesh(name, corners.iter().map(|v| Point3::new(v.x, v.y, v.z)).collect(), triangles)
}

/// The icosahedron of `radius`, every triangle cut in four `times` over.
fn icosphere(name: &'static str, radius: f64, times: usize) -> Body {
    let triangles = thorough::sphere_of_triangles(times);
    let vertices = triangles.iter().flatten().map(|corner| Point3::from(corner.map(|x| x * radius))).collect();
    mesh(name, vertices, (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
}

/// How a body falls on the film.
struct Drop {
    body: Body,
    cells: u32,
    triangles: bool,
    turn: UnitQuaternion<f64>,
    at: [f64; 2],
    velocity: f64,
    mass: f64,
    is_free: bool,
    friction: f64,
    /// s.
    time: f64,
}

impl Drop {
    fn new(body: Body) -> Drop {
        let turn = UnitQuaternion::identity();
        Drop {
            body,
            cells: 40,
            triangles: false,
            turn,
            at: [0.003, -0.0017],
            velocity: 2.0,
            mass: 1.0,
            is_free: false,
            friction: 0.3,
            time: thorough::choose(0.02, 0.03),
        }
    }

    fn engine(&self) -> Engine {
        let section = Section {
            prestrain: [0.01; 2],
            ..Section::new(Law::Elastic(Elastic { young: 2e8, poisson: 0.3 }), 1000.0, THICKNESS)
        };
        let mut nodes = Nodes::default();
        let mesh = square(self.cells, self.triangles);
        let film = Film::mount(&mesh, &section, 0.0, &mut nodes).unwrap();
        nodes.hold(mesh.rim.iter().map(|n| *n as usize), [true; 3]);
        let surface = &self.body.surface;
        let height = 0.5 * THICKNESS - surface.lowest(&self.turn);
        let pose = Isometry3::from_parts(Vector3::new(self.at[0], self.at[1], height).into(), self.turn);
        let body = if self.is_free {
            let inertia = surface.inertia_per_mass() * self.mass;
            RigidBody::free(pose, Vector3::new(0.0, 0.0, -self.velocity), self.mass, inertia)
        } else {
            RigidBody::guided(pose, -self.velocity, self.mass)
        };
        let contact = Contact::new(surface.clone(), self.friction, 1.0, vec![0.5 * THICKNESS; nodes.mass.len()]);
        let impact = Impact::new(body, contact).starting_in_contact(true);
        Engine::new(vec![film], nodes, [impact], Loads::default())
    }
}

/// Samples along an edge of an element.
const SAMPLES: usize = 24;

/// Deepest of many points of the elements, m, and what the contact says of it.
fn penetration(view: &View<'_>, body: &Body) -> [f64; 2] {
    let pose = &view.bodies().next().unwrap().pose;
    let mut deepest = 0.0_f64;
    view.films[0].for_each_intact(|corners| {
        let at: Vec<Vector3<f64>> =
            corners.iter().map(|n| Vector3::from(view.nodes.position.value_at(*n as usize))).collect();
        let mean = at.iter().sum::<Vector3<f64>>() / at.len() as f64;
        let longest = at.iter().map(|c| (c - mean).norm()).fold(0.0, f64::max);
        if body.distance(pose, &mean.into()) > longest + THICKNESS {
            return;
        }
        // Quadrilaterals are the four triangles between their edges and the mean of their corners.
        for a in 0..at.len() {
            let [p, q] = [at[a], at[(a + 1) % at.len()]];
            for i in 0..=SAMPLES {
                for j in 0..=SAMPLES - i {
                    let [u, v] = [i, j].map(|k| k as f64 / SAMPLES as f64);
                    let point = mean + (p - mean) * u + (q - mean) * v;
                    deepest = deepest.max(0.5 * THICKNESS - body.distance(pose, &point.into()));
                }
            }
        }
    });
    [deepest, view.contact_states().next().unwrap().0.penetration]
}

/// Result of a drop.
#[derive(Debug)]
struct Found {
    /// Deepest point, by samples and by the contact's own account, m.
    deepest: [f64; 2],
    /// Energy gained by losses and drift of the total over the impact energy.
    balance: f64,
    /// Largest loss where film comes into contact over the impact energy.
    loss: f64,
    travel: f64,
}

impl Drop {
    fn run(&self) -> Found {
        let mut engine = self.engine();
        let impact = 0.5 * self.mass * self.velocity * self.velocity;
        let mut start: Option<Energies> = None;
        let mut most = [0.0_f64; 2];
        let mut found = Found { deepest: [0.0; 2], balance: 0.0, loss: 0.0, travel: 0.0 };
        let mut count = 0;
        let mut first = None;
        while engine.time() < self.time {
            count += 1;
            if count % 25 != 1 {
                engine.step(&mut Unobserved).unwrap();
                continue;
            }
            let read = |view: &View<'_>| {
                let body = view.bodies().next().unwrap();
                (view.energies(), penetration(view, &self.body), body.pose.translation.z)
            };
            let (energies, depth, z) = engine.read_step(read).unwrap();
            let start = *start.get_or_insert(energies);
            let losses = [energies.contact, energies.friction];
            most = [0, 1].map(|k| most[k].max(losses[k]));
            let gained: f64 = (0..2).map(|k| most[k] - losses[k]).sum();
            let error = ((energies.total() - start.total()).abs() + gained) / impact;
            found.balance = found.balance.max(error);
            found.loss = found.loss.max(energies.contact / impact);
            found.deepest = [0, 1].map(|k| found.deepest[k].max(depth[k]));
            let first = *first.get_or_insert(z);
            found.travel = found.travel.max(first - z);
        }
        found
    }
}

fn tilted(axis: [f64; 3], degrees: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(Vector3::from(axis).normalize() * degrees.to_radians())
}

/// Lets bodies fall and judges penetration over an element, or over the radius that a mesh stands for, and the balance.
fn judge(drops: Vec<Drop>) {
    for drop in drops {
        let found = drop.run();
        let element = SIDE / f64::from(drop.cells);
        let name = drop.body.name;
        let [deepest, said] = found.deepest.map(|depth| depth / element.max(drop.body.surface.edge_radius()));
        println!(
            "{name}: penetration {deepest:.1e} by samples, {said:.1e} by its own account, balance {:.1e}, loss {:.1e}",
            found.balance, found.loss
        );
        assert!(deepest < 1e-2, "{name}: {deepest}");
        assert!(said > 0.99 * deepest && said < 1e-2, "{name}: {said} for {deepest}");
        assert!(found.balance < 1e-3, "{name}: {}", found.balance);
        assert!(found.travel > 0.02, "{name}: {}", found.travel);
    }
}

fn corner_down() -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::new(1.0, 1.0, 1.0), &-Vector3::z()).unwrap()
}

#[test]
fn rims_of_cylinders() {
    let cylinder = |name, edge| Drop { cells: 20, ..Drop::new(cylinder(name, 0.06, 0.12, edge)) };
    let drops = [
        Drop { cells: 8, ..cylinder("cylinder, 50 mm", 0.0) },
        cylinder("cylinder with edges of 5 mm, 20 mm", 0.005),
        Drop { turn: tilted([0.3, 1.0, 0.0], 20.0), is_free: true, ..cylinder("free tilted cylinder, 20 mm", 0.0) },
        Drop { triangles: true, ..cylinder("cylinder, triangles of 20 mm", 0.0) },
        cylinder("cylinder, 20 mm", 0.0),
        Drop { cells: 40, time: 0.024, ..cylinder("cylinder, 10 mm", 0.0) },
    ];
    judge(thorough::first(4, drops).collect());
}

#[test]
fn corners_edges_and_tips() {
    let flat = Drop { cells: 20, ..Drop::new(cuboid("box, 20 mm", [0.1, 0.08, 0.12], 0.0)) };
    let edge = Drop::new(cuboid("free box on an edge, 10 mm", [0.1, 0.08, 0.12], 0.0));
    let corner = Drop::new(cuboid("free box on a corner, 10 mm", [0.1, 0.1, 0.1], 0.0));
    judge(vec![
        flat,
        Drop { turn: corner_down(), is_free: true, ..corner },
        Drop { turn: tilted([0.2, 1.0, 0.1], 40.0), is_free: true, ..edge },
        Drop::new(cone("cone, 10 mm", 0.06, 0.08)),
    ]);
}

#[test]
fn meshes_with_facets() {
    let turn = || tilted([0.2, 1.0, 0.1], 10.0);
    let edge = Drop::new(box_mesh("free box of triangles on an edge, 10 mm", [0.1, 0.08, 0.12]));
    let corner = Drop::new(box_mesh("free box of triangles on a corner, 10 mm", [0.1; 3]));
    let drops = [
        Drop { turn: turn(), cells: 20, ..Drop::new(icosphere("icosahedron, 20 mm", 0.08, 0)) },
        Drop { turn: corner_down(), is_free: true, ..corner },
        Drop { turn: turn(), cells: 20, ..Drop::new(icosphere("1280 triangles, 20 mm", 0.08, 3)) },
        Drop { turn: tilted([0.2, 1.0, 0.1], 40.0), is_free: true, ..edge },
        Drop { turn: turn(), cells: 20, ..Drop::new(icosphere("80 triangles, 20 mm", 0.08, 1)) },
    ];
    judge(thorough::first(2, drops).collect());
}

/// A body stops on film whose nodes are all held, without passing through; what it loses is the loss of contact.
#[test]
fn held_elements_push_the_body_alone() {
    let bodies = [
        Body { edge: 0.0, core: SharedShape::ball(0.08), ..plain("sphere", Surface::sphere(0.08).unwrap()) },
        cylinder("cylinder", 0.06, 0.12, 0.0),
        cone("cone", 0.06, 0.08),
        box_mesh("box of triangles", [0.1; 3]),
    ];
    for body in bodies {
        let bound = 0.01 * (SIDE / 40.0).max(body.surface.edge_radius());
        let drop = Drop { mass: 2.0, ..Drop::new(body) };
        let mut engine = drop.engine();
        let all = 0..engine.nodes.mass.len();
        engine.nodes.hold(all, [true; 3]);
        let (mut depth, mut velocity) = (0.0_f64, f64::INFINITY);
        for step in 0..400 {
            // A body at rest is looked at now and then.
            let is_sampled = velocity.abs() > 1e-9 || step % 50 == 49;
            let read = |view: &View<'_>| {
                let sampled = is_sampled.then(|| penetration(view, &drop.body)[0]);
                (sampled, view.bodies().next().unwrap().velocity.z, view.energies().contact)
            };
            let loss;
            let sampled;
            (sampled, velocity, loss) = engine.read_step(read).unwrap();
            depth = depth.max(sampled.unwrap_or(0.0));
            if velocity.abs() < 1e-9 {
                assert!((loss - 4.0).abs() < 1e-6, "{}: {loss} J of 4", drop.body.name);
            }
        }
        let velocity = engine.impacts[0].body.velocity.z;
        assert!(depth < bound && velocity.abs() < 1e-3, "{}: {depth} m, {velocity} m/s", drop.body.name);
    }
}

/// Sum along z of the forces on film from which its elements start the next step, N.
fn remembered(engine: &Engine) -> f64 {
    engine.impacts[0].contact.neighbours.followed.iter().flatten().map(|point| point.force[2]).sum()
}

/// Film bears the weight of a box and of a ball on it, which take several sweeps of a step, and nothing once the box is gone.
#[test]
fn remembered_forces_are_those_of_the_last_step() {
    let drop = Drop { cells: 10, velocity: 0.0, mass: 2.0, ..Drop::new(cuboid("box", [0.1, 0.08, 0.12], 0.0)) };
    let mut engine = drop.engine();
    engine.loads.gravity = 9.81;
    let (ball, film) = (Surface::sphere(0.03).unwrap(), vec![0.5 * THICKNESS; engine.nodes.mass.len()]);
    let pose = Isometry3::translation(0.003, -0.0017, 0.15 + 0.5 * THICKNESS);
    let ball = Impact::new(RigidBody::guided(pose, 0.0, 0.5), Contact::new(ball, 0.0, 1.0, film));
    engine.impacts = engine.impacts.into_iter().chain([ball]).map(Impact::beside_others).collect();
    let all = 0..engine.nodes.mass.len();
    engine.nodes.hold(all, [true; 3]);
    while engine.time() < 0.01 {
        engine.step(&mut Unobserved).unwrap();
    }
    let weight = 2.5 * 9.81;
    let force = remembered(&engine);
    assert!((force + weight).abs() < 1e-3 * weight, "{force} N for {weight}");
    engine.impacts.iter_mut().for_each(|impact| impact.body.velocity.z = 1.0);
    while engine.impacts[0].body.pose.translation.z < 0.065 {
        engine.step(&mut Unobserved).unwrap();
    }
    assert_eq!(remembered(&engine), 0.0);
}

fn plain(name: &'static str, surface: Surface) -> Body {
    Body { name, surface, core: SharedShape::ball(1.0), place: Pose::IDENTITY, edge: 0.0 }
}
