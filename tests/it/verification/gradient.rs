//! Forces are the gradient of the energy that the audit counts, for every law and kind of element.

use droptower::engine::{Film, Nodes};
use droptower::material::Material;
use droptower::mesh::Element;

use super::claims::Claims;
use super::random::Random;
use super::scene::{forces, mounted, set_positions};
use super::sheet::{self, EDGE, ELEMENTS, deform, distorted_element, elastic, face, wrinkling};
use super::tower::shipped;

/// Number of elements of each kind and law.
const COUNT: usize = 100;

/// Force below which film counts as slack, N: 1/400 of the modulus times the section of the shipped fabric. Differences
/// of the energy have an error of 1e-10 N.
const SLACK: f64 = 1e-2;

/// Stored energy, J.
fn energy(film: &Film, nodes: &Nodes) -> f64 {
    let energy = film.energy(&nodes.position);
    energy.stored + energy.hourglass
}

/// Largest difference of a random element's forces from the central differences of its energy, over the largest force,
/// or [`SLACK`] where that is smaller.
fn off(material: &Material, kind: Element, unloading: bool, random: &mut Random) -> f64 {
    let (mut film, mut nodes) = mounted(&distorted_element(kind, random), &face(material.clone(), kind, [0.0; 2]));
    deform(&mut nodes, random);
    if unloading {
        let mut loaded = nodes.clone();
        set_positions(&mut loaded, |_, x| x.map(|x| 1.05 * x));
        forces(&mut film, &loaded);
    }
    let force = forces(&mut film.clone(), &nodes);
    let step = 1e-6 * EDGE;
    let (mut off, mut largest) = (0.0_f64, 0.0_f64);
    for (node, force) in force.iter().enumerate() {
        for axis in 0..3 {
            let at = |way: f64| {
                let mut moved = nodes.clone();
                set_positions(&mut moved, |n, mut x| {
                    x[axis] += if n == node { way * step } else { 0.0 };
                    x
                });
                energy(&film, &moved)
            };
            off = off.max((force[axis] + (at(1.0) - at(-1.0)) / (2.0 * step)).abs());
            largest = largest.max(force[axis].abs());
        }
    }
    off / largest.max(SLACK)
}

#[test]
fn forces_are_the_gradient_of_the_energy() {
    let mut claims = Claims::of("forces");
    let fabric = |absorption: f64, more: &str| {
        let set = format!("specimen.material.fabric.absorption={absorption}");
        shipped("stretch/md-0.02.toml", &[&set, &format!("specimen.material.fabric.{more}")]).faces[0].material.clone()
    };
    let laws = [
        ("elastic", elastic(50e6, 0.44), false),
        ("wrinkling", wrinkling(50e6, 0.44), false),
        ("fabric without absorption", fabric(0.0, "biaxial=0"), false),
        ("fabric on unloading, D 0.89", fabric(0.8896, "biaxial=0"), true),
        ("fabric with biaxial coupling, without absorption", fabric(0.0, "biaxial=0.79"), false),
        ("fabric with biaxial coupling on unloading, D 0.89", fabric(0.8896, "biaxial=0.79"), true),
    ];
    let rubber = sheet::rubbers(false).into_iter().map(|(name, material)| (name.to_owned(), material, false));
    let wrinkling =
        sheet::rubbers(true).into_iter().map(|(name, material)| (format!("{name}, wrinkling"), material, false));
    let laws = laws.map(|(name, material, unloading)| (name.to_owned(), material, unloading));
    for (name, material, unloading) in laws.into_iter().chain(rubber).chain(wrinkling) {
        for kind in ELEMENTS {
            let mut random = Random::new(11);
            let most = (0..COUNT).map(|_| off(&material, kind, unloading, &mut random)).fold(0.0, f64::max);
            claims.at_most(&format!("{name}, {kind:?}, forces off differences of the energy"), most, 1e-7);
        }
    }
}
