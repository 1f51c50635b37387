//! Patch tests: distorted elements under a uniform deformation, and film that only moves as a whole.

use droptower::material::Material;
use droptower::mesh::Mesh;
use droptower::mesh::{Element, Meshing};
use droptower::model::Face;
use nalgebra::{Matrix2, Point3, Rotation3, Vector3};

use super::claims::Claims;
use super::scene::{forces, mounted, positions, relaxed, set_positions};
use super::sheet::{self, ELEMENTS};
use super::tower::shipped;

const YOUNG: f64 = 50e6;
const POISSON: f64 = 0.44;
const THICKNESS: f64 = 12e-6;
/// Side of the patch, m.
const SIDE: f64 = 0.03;
/// Offsets of the four inner nodes of 3×3 elements from even positions, over the edge of an element.
const OFF: [[f64; 2]; 4] = [[0.25, -0.2], [-0.15, 0.3], [0.1, 0.25], [-0.3, -0.1]];
/// Nodes that are not on the rim.
const INNER: [usize; 4] = [5, 6, 9, 10];
/// Images of the unit vectors along x and y.
type Gradient = [[f64; 3]; 2];
/// Deformations of the whole patch. The last two leave the plane.
const UNIFORM: [(&str, Gradient); 7] = [
    ("uniaxial", [[1.3, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    ("biaxial", [[1.2, 0.0, 0.0], [0.0, 1.35, 0.0]]),
    ("simple shear", [[1.0, 0.0, 0.0], [0.3, 1.0, 0.0]]),
    ("pure shear", [[1.25, 0.0, 0.0], [0.0, 0.8, 0.0]]),
    ("stretch and shear", [[1.2, 0.1, 0.0], [0.15, 1.25, 0.0]]),
    ("general", [[1.12, 0.05, 0.3], [0.08, 1.2, -0.2]]),
    ("finite stretch", [[2.1, 0.3, 0.5], [-0.2, 1.8, -0.4]]),
];
/// Those under which an elastic patch is taut, so that the positions of its inner nodes are unique.
const TAUT: [usize; 5] = [0, 1, 4, 5, 6];

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
    let meshing = Meshing { element, size: SIDE / 3.0, grading: None };
    Face { meshing, md_angle: 0.3, ..sheet::face(material, element, [0.0; 2]) }
}

fn elastic() -> Material {
    sheet::elastic(YOUNG, POISSON)
}

fn wrinkling() -> Material {
    sheet::wrinkling(YOUNG, POISSON)
}

/// The shipped film: two fibre sets and shear.
fn fabric() -> Material {
    shipped("stretch/md-0.02.toml", &[]).faces[0].material.clone()
}

fn image(f: &Gradient, at: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| f[0][i] * at[0] + f[1][i] * at[1])
}

/// −Σ f ⊗ X over the volume: the first Piola–Kirchhoff stress along x and y that is equivalent to the nodal forces, Pa.
fn mean_stress(force: &[Vector3<f64>], places: &[[f64; 3]]) -> [Vector3<f64>; 2] {
    let volume = SIDE * SIDE * THICKNESS;
    [0, 1].map(|axis| -force.iter().zip(places).map(|(f, x)| f * x[axis]).sum::<Vector3<f64>>() / volume)
}

/// First Piola–Kirchhoff stress of St. Venant–Kirchhoff film in plane stress; of wrinkled film, whose second principal
/// stress is zero and the first one Y E.
fn stress_by_hand(f: &Gradient, wrinkles: bool) -> [Vector3<f64>; 2] {
    let [a, b] = f.map(Vector3::from);
    let green = Matrix2::new(a.norm_squared() - 1.0, a.dot(&b), a.dot(&b), b.norm_squared() - 1.0) * 0.5;
    let plane = YOUNG / (1.0 - POISSON * POISSON);
    let mut second = (green * (1.0 - POISSON) + Matrix2::identity() * POISSON * green.trace()) * plane;
    let principal = green.symmetric_eigen();
    let along = principal.eigenvalues.imax();
    let [most, least] = [principal.eigenvalues[along], principal.eigenvalues[1 - along]];
    if wrinkles && least + POISSON * most < 0.0 {
        let direction = principal.eigenvectors.column(along);
        second = direction * direction.transpose() * YOUNG * most;
    }
    [a * second.m11 + b * second.m12, b * second.m22 + a * second.m12]
}

fn largest(vectors: impl IntoIterator<Item = Vector3<f64>>) -> f64 {
    vectors.into_iter().map(|v| v.norm()).fold(0.0, f64::max)
}

#[test]
fn a_uniform_stretch_is_uniform_in_distorted_elements() {
    let mut claims = Claims::of("patch");
    for (shape, gradient) in UNIFORM {
        let mut of_fabric = vec![];
        for (name, material) in [("elastic", elastic()), ("wrinkling", wrinkling()), ("fabric", fabric())] {
            for element in ELEMENTS {
                let what = |claim: &str| format!("{shape}, {name} {element:?}, {claim}");
                let (mut film, mut nodes) = mounted(&patch(element), &face(material.clone(), element));
                let before = positions(&nodes);
                set_positions(&mut nodes, |_, x| image(&gradient, &x));
                let force = forces(&mut film, &nodes);
                let strains = film.strains(&nodes.position);
                let spread = strains.iter().flat_map(|s| (0..3).map(|i| (s.strain[i] - strains[0].strain[i]).abs()));
                claims.at_most(&what("difference of strains"), spread.fold(0.0, f64::max), 1e-12);
                let rim = largest(force.iter().copied());
                let inner = largest(INNER.map(|n| force[n]));
                claims.at_most(&what("inner forces over rim forces"), inner / rim, 1e-12);
                let stress = mean_stress(&force, &before);
                if name == "fabric" {
                    of_fabric.push(stress);
                } else {
                    let [x, y] = stress_by_hand(&gradient, name == "wrinkling");
                    let off = largest([stress[0] - x, stress[1] - y]) / largest([x, y]);
                    claims.at_most(&what("stress off the closed form"), off, 1e-12);
                }
            }
        }
        for other in &of_fabric[1..] {
            let off = largest([0, 1].map(|i| other[i] - of_fabric[0][i])) / largest(of_fabric[0]);
            claims.at_most(&format!("{shape}, fabric, stress of one element off another's"), off, 1e-12);
        }
    }
}

/// The equilibrium under a prescribed rim, by damped relaxation of the inner nodes.
#[test]
fn inner_nodes_relax_to_the_uniform_stretch() {
    let mut claims = Claims::of("patch, relaxed");
    for (shape, gradient) in TAUT.map(|place| UNIFORM[place]) {
        for element in ELEMENTS {
            let (film, mut nodes) = mounted(&patch(element), &face(elastic(), element));
            set_positions(&mut nodes, |_, x| image(&gradient, &x));
            let uniform = positions(&nodes);
            let offset = [1.0, -0.6, 0.8].map(|share| 0.05 * SIDE * share);
            set_positions(
                &mut nodes,
                |n, x| if INNER.contains(&n) { std::array::from_fn(|i| x[i] + offset[i]) } else { x },
            );
            nodes.hold((0..16).filter(|n| !INNER.contains(n)), [true; 3]);
            let (rest, _) = relaxed(film, nodes, 2e4, 0.02);
            let off = largest(INNER.map(|n| Vector3::from(rest[n]) - Vector3::from(uniform[n]))) / SIDE;
            let claim = format!("{shape}, {element:?}, inner nodes off the uniform field over the side");
            claims.at_most(&claim, off, 1e-9);
        }
    }
}

#[test]
fn rigid_motion_gives_no_force() {
    let mut claims = Claims::of("rigid motion");
    let rotation = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    for (name, material) in [("elastic", elastic()), ("wrinkling", wrinkling()), ("fabric", fabric())] {
        for element in ELEMENTS {
            let (mut film, mut nodes) = mounted(&patch(element), &face(material.clone(), element));
            set_positions(&mut nodes, |_, x| (rotation * Vector3::from(x) + Vector3::new(0.3, -0.2, 0.5)).into());
            let scale = YOUNG * THICKNESS * SIDE;
            let force = largest(forces(&mut film, &nodes));
            claims.at_most(&format!("{name} {element:?}, force over E h L"), force / scale, 1e-13);
        }
    }
}
