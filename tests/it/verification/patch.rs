//! Patch tests: distorted elements under a uniform deformation, and film that only moves as a whole.

use droptower::engine::{Drive, Engine, Film, Nodes};
use droptower::material::{Elastic, Law, Material};
use droptower::mesh::Mesh;
use droptower::model::{Element, Face, Meshing};
use nalgebra::{Point3, Rotation3, Vector3};

use super::claims::Claims;
use super::scene::{mounted, watch};
use super::tower::shipped;

const ELEMENTS: [Element; 3] = [Element::Quad4, Element::Quad4Full, Element::Tri3];
const YOUNG: f64 = 50e6;
const POISSON: f64 = 0.44;
const THICKNESS: f64 = 12e-6;
/// Side of the patch, m.
const SIDE: f64 = 0.03;
/// Where the four inner nodes of 3×3 elements stand off their places, over the edge of an element.
const OFF: [[f64; 2]; 4] = [[0.25, -0.2], [-0.15, 0.3], [0.1, 0.25], [-0.3, -0.1]];
/// Nodes that are not on the rim.
const INNER: [usize; 4] = [5, 6, 9, 10];
/// Images of the unit vectors along x and y: stretched, sheared, turned out of the plane.
const UNIFORM: [[f64; 3]; 2] = [[1.12, 0.05, 0.3], [0.08, 1.2, -0.2]];

fn patch(element: Element) -> Mesh {
    let edge = SIDE / 3.0;
    let mut nodes: Vec<Point3<f64>> =
        (0..16).map(|n| Point3::new(edge * f64::from(n % 4), edge * f64::from(n / 4), 0.0)).collect();
    for (n, [x, y]) in INNER.iter().zip(OFF) {
        nodes[*n] += edge * Vector3::new(x, y, 0.0);
    }
    let quads: Vec<[u32; 4]> =
        (0..9).map(|e| e / 3 * 4 + e % 3).map(|corner| [corner, corner + 1, corner + 5, corner + 4]).collect();
    let halves = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    match element {
        Element::Tri3 => Mesh { nodes, tris: halves.collect(), ..Mesh::default() },
        Element::Quad4 | Element::Quad4Full => Mesh { nodes, quads, ..Mesh::default() },
    }
}

fn face(material: Material, element: Element) -> Face {
    let meshing = Meshing { element, size: SIDE / 3.0 };
    Face { height: 0.0, layers: 1, material, md_angle: 0.3, prestrain: [0.0; 2], meshing, film: None }
}

fn elastic() -> Material {
    let law = Law::Elastic(Elastic { young: YOUNG, poisson: POISSON });
    Material { density: 915.0, thickness: THICKNESS, law, measured_rates: None }
}

/// The shipped film: two fibre sets and shear.
fn fabric() -> Material {
    shipped("stretch/md-0.02.toml", &[]).faces[0].material.clone()
}

fn image(f: &[[f64; 3]; 2], at: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| f[0][i] * at[0] + f[1][i] * at[1])
}

fn forces(film: &mut Film, nodes: &Nodes) -> Vec<Vector3<f64>> {
    let mut nodes = nodes.clone();
    film.add_forces(&mut nodes);
    nodes.force.iter().map(Vector3::from).collect()
}

/// Moves every node to the image of its place.
fn deform(nodes: &mut Nodes, image: impl Fn(&[f64; 3]) -> [f64; 3]) {
    (0..nodes.position.len()).for_each(|n| nodes.position.set(n, image(&nodes.position.at(n))));
}

/// −Σ f ⊗ X over the volume: the first Piola–Kirchhoff stress along x and y that the nodal forces stand for, Pa.
fn mean_stress(force: &[Vector3<f64>], places: &[[f64; 3]]) -> [Vector3<f64>; 2] {
    let volume = SIDE * SIDE * THICKNESS;
    [0, 1].map(|axis| -force.iter().zip(places).map(|(f, x)| f * x[axis]).sum::<Vector3<f64>>() / volume)
}

/// St. Venant–Kirchhoff in plane stress, by hand.
fn elastic_stress(f: &[[f64; 3]; 2]) -> [Vector3<f64>; 2] {
    let [a, b] = f.map(Vector3::from);
    let [xx, yy, xy] = [0.5 * (a.norm_squared() - 1.0), 0.5 * (b.norm_squared() - 1.0), 0.5 * a.dot(&b)];
    let plane = YOUNG / (1.0 - POISSON * POISSON);
    let shear = YOUNG / (1.0 + POISSON) * xy;
    [a * plane * (xx + POISSON * yy) + b * shear, b * plane * (yy + POISSON * xx) + a * shear]
}

fn largest(vectors: impl IntoIterator<Item = Vector3<f64>>) -> f64 {
    vectors.into_iter().map(|v| v.norm()).fold(0.0, f64::max)
}

#[test]
fn a_uniform_stretch_is_uniform_in_distorted_elements() {
    let mut claims = Claims::of("patch");
    let mut of_fabric = vec![];
    for (name, material) in [("elastic", elastic()), ("fabric", fabric())] {
        for element in ELEMENTS {
            let what = |claim: &str| format!("{name} {element:?}, {claim}");
            let (mut film, mut nodes) = mounted(&patch(element), &face(material.clone(), element));
            let places: Vec<_> = nodes.position.iter().collect();
            deform(&mut nodes, |x| image(&UNIFORM, x));
            let force = forces(&mut film, &nodes);
            let strains = film.strains(&nodes.position);
            let spread = strains.iter().flat_map(|s| (0..3).map(|i| (s.strain[i] - strains[0].strain[i]).abs()));
            claims.at_most(&what("difference of strains"), spread.fold(0.0, f64::max), 1e-12);
            let rim = largest(force.iter().copied());
            let inner = largest(INNER.map(|n| force[n]));
            claims.at_most(&what("inner forces over rim forces"), inner / rim, 1e-12);
            let stress = mean_stress(&force, &places);
            match name {
                "elastic" => {
                    let [x, y] = elastic_stress(&UNIFORM);
                    let off = largest([stress[0] - x, stress[1] - y]) / x.norm();
                    claims.at_most(&what("stress off the closed form"), off, 1e-12);
                }
                _ => of_fabric.push(stress),
            }
        }
    }
    for other in &of_fabric[1..] {
        let off = largest([other[0] - of_fabric[0][0], other[1] - of_fabric[0][1]]) / other[0].norm();
        claims.at_most("fabric, stress of one element off another's", off, 1e-12);
    }
    claims.judge();
}

/// The same, found by the engine: only the rim is put in place, damped inner nodes find theirs.
#[test]
fn inner_nodes_find_the_uniform_stretch() {
    let mut claims = Claims::of("patch, relaxed");
    for element in ELEMENTS {
        let (film, mut nodes) = mounted(&patch(element), &face(elastic(), element));
        let uniform: Vec<[f64; 3]> = nodes.position.iter().map(|x| image(&UNIFORM, &x)).collect();
        deform(&mut nodes, |x| image(&UNIFORM, x));
        for n in INNER {
            nodes.position.add(n, [1.0, -0.6, 0.8].map(|off| 0.05 * SIDE * off));
        }
        nodes.hold((0..16).filter(|n| !INNER.contains(n)), [true; 3]);
        let drive = Drive { damping: 2e4, multiplicity: 1.0, ..Drive::default() };
        let mut engine = Engine::new(vec![film], nodes, None, drive);
        let mut off = f64::INFINITY;
        for _ in 0..4000 {
            off = watch(&mut engine, |view| {
                let apart = |n: usize| Vector3::from(view.nodes.position.at(n)) - Vector3::from(uniform[n]);
                largest(INNER.map(apart)) / SIDE
            });
        }
        claims.at_most(&format!("{element:?}, inner nodes off the uniform field over the side"), off, 1e-9);
    }
    claims.judge();
}

#[test]
fn motion_as_a_whole_costs_no_force() {
    let mut claims = Claims::of("rigid motion");
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    for (name, material) in [("elastic", elastic()), ("fabric", fabric())] {
        for element in ELEMENTS {
            let (mut film, mut nodes) = mounted(&patch(element), &face(material.clone(), element));
            deform(&mut nodes, |x| (turn * Vector3::from(*x) + Vector3::new(0.3, -0.2, 0.5)).into());
            let scale = YOUNG * THICKNESS * SIDE;
            let force = largest(forces(&mut film, &nodes));
            claims.at_most(&format!("{name} {element:?}, force over E h L"), force / scale, 1e-13);
        }
    }
    claims.judge();
}
