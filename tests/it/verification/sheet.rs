//! Sheets of elements in rows, even or distorted, single distorted elements, and elastic film.

use droptower::engine::Nodes;
use droptower::material::{
    CompressibleNeoHookean, Elastic, Gent, Hyperelastic, HyperelasticLaw, Law, Material, Ogden, Polynomial,
    TensionField,
};
use droptower::mesh::Mesh;
use droptower::mesh::{Element, Meshing};
use droptower::model::Face;
use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

use super::random::Random;
use super::scene::set_positions;

/// Every kind of element.
pub const ELEMENTS: [Element; 3] = [Element::Quad4, Element::Quad4Full, Element::Tri3];

/// `cells` elements (pairs of triangles) along both parameters 0 to 1, each node where `place` puts its parameters;
/// offset by up to `uneven` of a cell, those of nodes on the rim along it, in a pattern of 3×3 cells that is the same
/// on every mesh.
pub fn sheet(cells: [usize; 2], element: Element, uneven: f64, place: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let [columns, rows] = cells;
    let mut random = Random::new(1);
    let pattern: [[[f64; 2]; 3]; 3] =
        [[(); 3]; 3].map(|row| row.map(|()| [(); 2].map(|()| random.between(-uneven, uneven))));
    let mut nodes = vec![];
    for row in 0..=rows {
        for column in 0..=columns {
            let off = pattern[row % 3][column % 3];
            let parameter = |at: usize, count: usize, off: f64| {
                let on_the_rim = at == 0 || at == count;
                (at as f64 + if on_the_rim { 0.0 } else { off }) / count as f64
            };
            let [x, y] = place([parameter(column, columns, off[0]), parameter(row, rows, off[1])]);
            nodes.push(Point3::new(x, y, 0.0));
        }
    }
    let node = |column: usize, row: usize| (row * (columns + 1) + column) as u32;
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let quads: Vec<[u32; 4]> =
        places.map(|(c, r)| [node(c, r), node(c + 1, r), node(c + 1, r + 1), node(c, r + 1)]).collect();
    match element {
        Element::Tri3 => {
            let tris = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
            Mesh { nodes, tris, ..Mesh::default() }
        }
        Element::Quad4 | Element::Quad4Full => Mesh { nodes, quads, ..Mesh::default() },
    }
}

/// Nodes of a sheet of `cells` whose column and row fulfil `which`.
pub fn nodes_where([columns, rows]: [usize; 2], which: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let all = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row)));
    all.enumerate().filter(|(_, (column, row))| which(*column, *row)).map(|(n, _)| n).collect()
}

/// Mean edge of a distorted element, m.
pub const EDGE: f64 = 0.01;

/// One element of random shape.
pub fn distorted_element(kind: Element, random: &mut Random) -> Mesh {
    let corners: &[[f64; 2]] = match kind {
        Element::Tri3 => &[[0.0, 0.0], [1.0, 0.0], [0.4, 0.9]],
        Element::Quad4 | Element::Quad4Full => &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
    };
    let mut off = || random.between(-0.2, 0.2);
    let nodes = corners.iter().map(|[x, y]| Point3::new(EDGE * (x + off()), EDGE * (y + off()), 0.0)).collect();
    match kind {
        Element::Tri3 => Mesh { nodes, tris: vec![[0, 1, 2]], ..Mesh::default() },
        Element::Quad4 | Element::Quad4Full => Mesh { nodes, quads: vec![[0, 1, 2, 3]], ..Mesh::default() },
    }
}

/// Random deformation: stretched or slack, sheared, rotated and warped.
pub fn deform(nodes: &mut Nodes, random: &mut Random) {
    let mut number = |from: f64, to: f64| random.between(from, to);
    let gradient =
        Matrix3::new(number(0.8, 1.8), number(-0.4, 0.4), 0.0, number(-0.4, 0.4), number(0.8, 1.8), 0.0, 0.0, 0.0, 1.0);
    let turn = Rotation3::from_euler_angles(number(-3.0, 3.0), number(-1.5, 1.5), number(-3.0, 3.0));
    set_positions(nodes, |_, x| {
        let warp = Vector3::from_fn(|_, _| EDGE * number(-0.1, 0.1));
        (turn * (gradient * Vector3::from(x)) + warp).into()
    });
}

/// A film of one material and kind of element, MD along x, as mounted with `prestrain`.
pub fn face(material: Material, element: Element, prestrain: [f64; 2]) -> Face {
    let meshing = Meshing { element, size: 1.0, grading: None };
    Face {
        height: 0.0,
        layers: 1,
        material,
        break_is_moved: false,
        unsourced_coupling: None,
        md_angle: 0.0,
        prestrain,
        meshing,
        settle: true,
        film: None,
    }
}

/// St. Venant–Kirchhoff film of LLDPE's density and thickness.
pub fn elastic(young: f64, poisson: f64) -> Material {
    let law = Law::Elastic(Elastic { young, poisson });
    Material::new(law, DENSITY, THICKNESS)
}

/// The same without compression.
pub fn wrinkling(young: f64, poisson: f64) -> Material {
    let law = Law::TensionField(TensionField(Elastic { young, poisson }));
    Material { law, ..elastic(young, poisson) }
}

/// Hyperelastic film, of the same density and thickness.
pub fn hyperelastic(law: HyperelasticLaw) -> Material {
    Material { law: Law::Hyperelastic(law), ..elastic(1.0, 0.0) }
}

/// Rubber-like films of every law with a shear modulus near 0.4 MPa, taut or wrinkling.
pub fn rubbers(wrinkling: bool) -> [(&'static str, Material); 6] {
    let polynomial = |energy| hyperelastic(HyperelasticLaw::Polynomial(Hyperelastic { energy, wrinkling }));
    let ogden = Ogden::new(&Ogden::TRELOAR);
    let gent = Gent { mu: 4e5, jm: 97.2 };
    let compressible = Hyperelastic { energy: CompressibleNeoHookean { young: 1e6, poisson: 0.3 }, wrinkling };
    [
        ("neo-Hookean", polynomial(Polynomial::neo_hookean(4e5))),
        ("Mooney–Rivlin", polynomial(Polynomial::mooney_rivlin(1.6e5, 4e4))),
        ("Yeoh", polynomial(Polynomial::yeoh([0.18e6, -0.002e6, 0.000_05e6]))),
        ("Gent", hyperelastic(HyperelasticLaw::Gent(Hyperelastic { energy: gent, wrinkling }))),
        ("Ogden", hyperelastic(HyperelasticLaw::Ogden(Hyperelastic { energy: ogden, wrinkling }))),
        ("compressible neo-Hookean", hyperelastic(HyperelasticLaw::CompressibleNeoHookean(compressible))),
    ]
}

/// kg/m³.
pub const DENSITY: f64 = 915.0;
/// m.
pub const THICKNESS: f64 = 12e-6;
