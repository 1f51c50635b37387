//! Loading and unloading by the inertia of the film: the share 1 − D of the energy is returned.

use droptower::engine::{Engine, Loads};
use droptower::material::{Curve, Fabric, Law, Material};
use droptower::mesh::Element;
use droptower::mesh::Mesh;
use nalgebra::Point3;

use super::claims::Claims;
use super::scene::{mounted, observe_step};
use super::sheet::{DENSITY, ELEMENTS, THICKNESS, face};

const SIDE: f64 = 0.01;
/// Factor on the stable time step, on whose square the error depends.
const STEP: f64 = 0.02;
/// Initial speed of the free edge, m/s.
const SPEED: f64 = 120.0;

fn film(absorption: f64) -> Material {
    let curve = |points: [[f64; 2]; 3]| Curve::new(points.to_vec()).expect("a curve");
    let md = curve([[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]);
    let td = curve([[0.33, 8e6], [0.69, 10e6], [7.01, 16.2e6]]);
    let shear = curve([[0.27, 4.7e6], [0.8, 8.7e6], [1.4, 9.5e6]]);
    let law = Law::Fabric(Fabric::new(md, td, shear, absorption));
    Material::new(law, DENSITY, THICKNESS)
}

/// One element with an edge across `fibre`, and opposite to it another, or the tip of a triangle.
fn one(element: Element, fibre: usize) -> Mesh {
    let along_md: &[[f64; 2]] = match element {
        Element::Tri3 => &[[0.0, 0.0], [1.0, 0.5], [0.0, 1.0]],
        Element::Quad4 | Element::Quad4Full => &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
    };
    // A rotation by 90° does not change the orientation.
    let turned = |[x, y]: &[f64; 2]| if fibre == 0 { [*x, *y] } else { [-y, *x] };
    let nodes = along_md.iter().map(turned).map(|[x, y]| Point3::new(SIDE * x, SIDE * y, 0.0)).collect();
    match element {
        Element::Tri3 => Mesh { nodes, tris: vec![[0, 1, 2]], ..Mesh::default() },
        Element::Quad4 | Element::Quad4Full => Mesh { nodes, quads: vec![[0, 1, 2, 3]], ..Mesh::default() },
    }
}

/// Returned over initial kinetic energy, the absorbed share, and the largest strain of an element whose one edge is
/// held while the other moves along MD (0) or TD (1), rebounds, and passes the first as slack film.
fn cycle(element: Element, absorption: f64, fibre: usize) -> [f64; 3] {
    let mesh = one(element, fibre);
    let (film, mut nodes) = mounted(&mesh, &face(film(absorption), element, [0.0; 2]));
    let free = |n: &usize| mesh.nodes[*n][fibre] > 0.0;
    nodes.hold(0..mesh.nodes.len(), [fibre == 1, fibre == 0, true]);
    nodes.hold((0..mesh.nodes.len()).filter(|n| !free(n)), [true; 3]);
    for n in (0..mesh.nodes.len()).filter(free) {
        nodes.velocity.set(n, [0, 1, 2].map(|axis| if axis == fibre { SPEED } else { 0.0 }));
    }
    let loads = Loads { step_factor: STEP, ..Loads::default() };
    let mut engine = Engine::new(vec![film], nodes, [], loads);
    let (mut largest, mut start) = (0.0_f64, None);
    loop {
        let (strain, energies) = observe_step(&mut engine, |view| {
            let strain = view.films[0].strains(&view.nodes.position)[0];
            (strain.strain[fibre], view.energies())
        });
        let initial = start.get_or_insert(energies).kinetic_film;
        largest = largest.max(strain);
        if largest > 0.1 && strain < -0.01 {
            return [energies.kinetic_film / initial, energies.absorbed / initial, largest];
        }
    }
}

#[test]
fn unloading_returns_one_minus_d() {
    let mut claims = Claims::of("absorption");
    for element in ELEMENTS {
        for (fibre, name) in ["MD", "TD"].into_iter().enumerate() {
            for absorption in [0.0, 0.3, 0.8896] {
                let what = |claim: &str| format!("{element:?}, {name}, D {absorption}, {claim}");
                let [returned, absorbed, strain] = cycle(element, absorption, fibre);
                claims.near(&what("returned over initial kinetic energy"), returned, 1.0 - absorption, 5e-4);
                claims.at_most(&what("absorbed share off D"), (absorbed - absorption).abs(), 1e-4);
                claims.holds(&what("past the first yield point"), &format!("{strain:.3}"), strain > 0.35);
            }
        }
    }
}
