//! Tears against energy balances of Griffith's kind, on meshes of several sizes, and against closed forms.

mod mesh;
mod shapes;
mod starts;
mod strip;
mod trousers;

use nalgebra::Point3;

use crate::engine::{Film, Mesh, Nodes, Section};
use crate::material::{Criterion, Elastic, Law, Rupture};

/// Γ, J/m².
const FRACTURE_ENERGY: f64 = 1370.0;

/// Young's modulus, Pa.
const YOUNG: f64 = 2e8;

const POISSON: f64 = 0.3;

/// m.
const THICKNESS: f64 = 1e-4;

fn section() -> Section {
    let law = Law::Elastic(Elastic { young: YOUNG, poisson: POISSON });
    let rupture = Rupture { criterion: Criterion::Strain, limit: 0.5, fracture_energy: FRACTURE_ENERGY };
    Section { rupture: Some(rupture), ..Section::new(law, 1000.0, THICKNESS) }
}

/// Cells × cells of `size` (m), whose nodes lie where `place` puts those of their rows and columns.
fn cells(columns: u32, rows: u32, place: impl Fn(u32, u32) -> Point3<f64>) -> Mesh {
    let width = columns + 1;
    let nodes = (0..=rows).flat_map(|j| (0..width).map(move |i| (i, j))).map(|(i, j)| place(i, j)).collect();
    let quad = |i: u32, j: u32| [j * width + i, j * width + i + 1, (j + 1) * width + i + 1, (j + 1) * width + i];
    Mesh { nodes, quads: (0..rows).flat_map(|j| (0..columns).map(move |i| quad(i, j))).collect(), ..Mesh::default() }
}

#[test]
fn a_cut_with_a_bend_parts_film() {
    let mesh = cells(20, 20, |i, j| Point3::new(f64::from(i), f64::from(j), 0.0));
    let mut nodes = Nodes::default();
    let mut film = Film::mount(&mesh, &section(), 0.0, &mut nodes).unwrap();
    // From the lower edge to the middle, and from there to the right one.
    film.cut(&nodes, &[[9.7, 0.0], [9.7, 10.4], [20.0, 10.4]]);
    let mut reached = vec![false; nodes.mass.len()];
    reached[0] = true;
    loop {
        let mut grown = false;
        film.for_each_intact(|corners| {
            if corners.iter().any(|n| reached[*n as usize]) && !corners.iter().all(|n| reached[*n as usize]) {
                corners.iter().for_each(|n| reached[*n as usize] = true);
                grown = true;
            }
        });
        if !grown {
            break;
        }
    }
    assert!(!reached[20], "the lower right corner hangs together with the lower left one");
    assert!(reached[20 * 21] && reached[21 * 21 - 1]);
}
