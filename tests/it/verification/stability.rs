//! The bound that limits the time step against the fastest motion of an element itself.

use droptower::engine::{Film, Nodes};
use droptower::material::Material;
use droptower::mesh::{Element, Meshing};
use droptower::model::Face;
use nalgebra::DMatrix;

use super::claims::Claims;
use super::random::Random;
use super::scene::{forces, mounted, set_positions};
use super::sheet::{EDGE, ELEMENTS, deform, distorted_element, elastic, face, sheet, wrinkling};
use super::tower::{impact, peaks, shipped};

/// Number of elements of each kind and law.
const COUNT: usize = 400;
/// −∂F/∂x by differences, on the side of `sign`, from the history variables of the film; over the square roots of the
/// masses.
fn hessian(film: &Film, nodes: &Nodes, sign: f64) -> DMatrix<f64> {
    let step = sign * 1e-7 * EDGE;
    let count = 3 * nodes.mass.len();
    let rest = forces(&mut film.clone(), nodes);
    let mut matrix = DMatrix::zeros(count, count);
    for column in 0..count {
        let mut moved = nodes.clone();
        set_positions(&mut moved, |n, x| std::array::from_fn(|i| x[i] + if 3 * n + i == column { step } else { 0.0 }));
        let changed = forces(&mut film.clone(), &moved);
        for row in 0..count {
            let change = -(changed[row / 3][row % 3] - rest[row / 3][row % 3]) / step;
            matrix[(row, column)] = change / (nodes.mass[row / 3] * nodes.mass[column / 3]).sqrt();
        }
    }
    0.5 * (&matrix + matrix.transpose())
}

/// Loading of the film before the frequency is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum History {
    Loading,
    Unloading,
}

/// Largest ω² over its bound, of one random element.
fn share(material: &Material, kind: Element, history: History, random: &mut Random) -> f64 {
    let (mut film, mut nodes) = mounted(&distorted_element(kind, random), &face(material.clone(), kind, [0.0; 2]));
    deform(&mut nodes, random);
    if history == History::Unloading {
        let further = 1.0 + random.between(0.005, 0.05);
        let mut loaded = nodes.clone();
        set_positions(&mut loaded, |_, x| x.map(|x| further * x));
        forces(&mut film, &loaded);
    }
    forces(&mut film, &nodes);
    let bound = film.frequency_bound(&nodes.position);
    let fastest = [1.0, -1.0].map(|sign| hessian(&film, &nodes, sign).symmetric_eigenvalues().max());
    fastest[0].max(fastest[1]) / bound
}

#[test]
fn the_frequency_of_random_elements_is_below_its_bound() {
    let mut claims = Claims::of("bound of the time step");
    let fabric = |absorption: f64, more: &str| {
        let set = format!("specimen.material.fabric.absorption={absorption}");
        shipped("stretch/md-0.02.toml", &[&set, &format!("specimen.material.fabric.{more}")]).faces[0].material.clone()
    };
    let laws = [
        ("elastic", elastic(50e6, 0.44), History::Loading),
        ("elastic, ν −0.3", elastic(50e6, -0.3), History::Loading),
        ("wrinkling", wrinkling(50e6, 0.44), History::Loading),
        ("wrinkling, ν −0.3", wrinkling(50e6, -0.3), History::Loading),
        ("fabric without absorption", fabric(0.0, "biaxial=0"), History::Loading),
        ("fabric, D 0.89, unloading", fabric(0.8896, "biaxial=0"), History::Unloading),
        ("fabric with biaxial coupling", fabric(0.0, "biaxial=0.79"), History::Loading),
        ("fabric with biaxial coupling, D 0.89, unloading", fabric(0.8896, "biaxial=0.79"), History::Unloading),
    ];
    for (name, material, history) in laws {
        for kind in ELEMENTS {
            let mut random = Random::new(7);
            let mut shares: Vec<f64> = (0..COUNT).map(|_| share(&material, kind, history, &mut random)).collect();
            shares.sort_by(f64::total_cmp);
            let [middle, most] = [shares[COUNT / 2], shares[COUNT - 1]];
            claims.at_most(&format!("{name}, {kind:?}, ω² over its bound, median {middle:.2}"), most, 1.0);
        }
    }
}

/// The same for the elements of the shipped drop tests. The bound of the mounted film holds for strains within half a
/// percent, so the element is stretched by as much and slightly unloaded.
#[test]
fn the_frequency_of_shipped_elements_is_below_its_bound() {
    let mut claims = Claims::of("bound of the time step");
    for kind in ELEMENTS {
        let model = shipped("drop/1008.toml", &[]);
        let face =
            Face { meshing: Meshing { element: kind, ..model.faces[0].meshing.clone() }, ..model.faces[0].clone() };
        let mesh = sheet([1, 1], kind, 0.0, |[u, v]| [u, v].map(|at| at * face.meshing.size));
        let (mut film, nodes) = mounted(&mesh, &face);
        forces(&mut film, &nodes);
        let bound = film.frequency_bound(&nodes.position);
        let mut stretched = |factor: f64| {
            let mut stretched = nodes.clone();
            set_positions(&mut stretched, |_, [x, y, z]| [factor * x, factor * y, z]);
            forces(&mut film, &stretched);
            stretched
        };
        stretched(1.005);
        let released = stretched(1.0045);
        let fastest = [1.0, -1.0].map(|sign| hessian(&film, &released, sign).symmetric_eigenvalues().max());
        claims.at_most(&format!("1008, {kind:?}, ω² over its bound"), fastest[0].max(fastest[1]) / bound, 1.0);
    }
}

#[test]
fn peaks_do_not_depend_on_the_time_step() {
    let mut claims = Claims::of("step halved");
    for test in thorough::first(1, ["1008", "1009", "1010", "1509", "1510"]) {
        let [whole, half] = ["1", "0.5"].map(|factor| {
            let size = thorough::choose("specimen.mesh.size=20mm", "specimen.mesh.size=10mm");
            let factor = format!("solver.step_factor={factor}");
            let changes = ["loading.impact.duration=70ms", "output.frames=1", size, &factor];
            peaks(&impact(&shipped(&format!("drop/{test}.toml"), &changes)))
        });
        claims.near(&format!("{test}, peak displacement"), half[0], whole[0], 1e-3);
        claims.near(&format!("{test}, peak acceleration"), half[1], whole[1], 1e-3);
    }
}
