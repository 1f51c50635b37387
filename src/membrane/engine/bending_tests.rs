//! Bending film against plates and beams in closed form, and what must hold of any discretisation: forces are the gradient
//! of an energy without net force or moment, and the step bounds their frequency.

use std::f64::consts::PI;

use nalgebra::{Point3, Rotation3, Vector3};

use super::{Engine, Film, Jaw, Loads, Mesh, Nodes, Section, ThreadPool, Unobserved};
use crate::lane::Width;
use crate::material::{Curve, Elastic, Fabric, Law};

const YOUNG: f64 = 2e9;
const POISSON: f64 = 0.3;
const THICKNESS: f64 = 2e-4;

/// Kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Quads,
    /// Diagonals of one direction.
    Tris,
    /// Diagonals that alternate: every other inner node has four neighbours.
    Crossed,
}

/// A rectangle from the origin, its cells moved by a share of their size at random within it.
pub(super) fn rectangle(kind: Kind, [x, y]: [f64; 2], [nx, ny]: [u32; 2], irregular: f64) -> Mesh {
    let at = |i: u32, j: u32| j * (nx + 1) + i;
    let mut mesh = Mesh::default();
    let mut seed = 12345_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    for j in 0..=ny {
        for i in 0..=nx {
            let inner = |k: u32, n: u32| if k == 0 || k == n { 0.0 } else { irregular };
            let (dx, dy) = (inner(i, nx) * random(), inner(j, ny) * random());
            let place = |k: u32, d: f64, n: u32| (f64::from(k) + d) / f64::from(n);
            mesh.nodes.push(Point3::new(place(i, dx, nx) * x, place(j, dy, ny) * y, 0.0));
        }
    }
    for j in 0..ny {
        for i in 0..nx {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            match kind {
                Kind::Quads => mesh.quads.push([a, b, c, d]),
                Kind::Crossed if (i + j) % 2 == 1 => mesh.tris.extend([[a, b, d], [b, c, d]]),
                Kind::Tris | Kind::Crossed => mesh.tris.extend([[a, b, c], [a, c, d]]),
            }
        }
    }
    mesh
}

fn section() -> Section {
    Section::new(Law::Elastic(Elastic { young: YOUNG, poisson: POISSON }), 900.0, THICKNESS)
}

/// Edges between successive nodes of the mesh for which `wanted`.
pub(super) fn edges(mesh: &Mesh, wanted: impl Fn(&Point3<f64>) -> bool) -> Vec<[u32; 2]> {
    let corners = mesh.quads.iter().map(|q| q.to_vec()).chain(mesh.tris.iter().map(|t| t.to_vec()));
    let sides = corners.flat_map(|c| (0..c.len()).map(move |k| [c[k], c[(k + 1) % c.len()]]).collect::<Vec<_>>());
    sides.filter(|edge| edge.iter().all(|node| wanted(&mesh.nodes[*node as usize]))).collect()
}

fn film(mesh: &Mesh, section: &Section, layers: u32, built_in: &[[u32; 2]]) -> (Film, Nodes) {
    let mut nodes = Nodes::default();
    let mut film = Film::mount(mesh, section, 0.0, &mut nodes).expect("a film");
    film.bend(&nodes, mesh, section, layers, built_in).expect("flat film");
    (film, nodes)
}

/// Forces of bending alone, N.
fn bending_forces(film: &Film, nodes: &Nodes) -> Vec<Vector3<f64>> {
    let mut with = nodes.clone();
    let mut without = nodes.clone();
    let mut whole = film.clone();
    let mut membrane = film.clone();
    membrane.bending = None;
    whole.add_forces(&mut with, 0.0);
    membrane.add_forces(&mut without, 0.0);
    with.force.iter().zip(without.force.iter()).map(|(a, b)| Vector3::from(a) - Vector3::from(b)).collect()
}

/// Deflections in equilibrium with vertical `loads` (N) on the nodes that are not `held`, by conjugate gradients. Flat
/// film without strain has no other vertical stiffness.
fn deflected(film: &Film, nodes: &Nodes, held: &[bool], loads: &[f64]) -> Vec<f64> {
    let bending = film.bending().expect("bending");
    let n = loads.len();
    let zero = vec![0.0; n];
    let product = |w: &[f64]| {
        let force = bending.product(&[&zero, &zero, w]);
        (0..n).map(|k| if held[k] { 0.0 } else { force.value_at(k)[2] }).collect::<Vec<f64>>()
    };
    let free = |v: &[f64]| (0..n).map(|k| if held[k] { 0.0 } else { v[k] }).collect::<Vec<f64>>();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    assert_eq!(nodes.mass.len(), n);
    let (mut w, mut r) = (vec![0.0; n], free(loads));
    let (mut p, mut square) = (r.clone(), dot(&r, &r));
    let first = square;
    for _ in 0..60 * n {
        let q = product(&p);
        let step = square / dot(&p, &q);
        (0..n).for_each(|k| w[k] += step * p[k]);
        (0..n).for_each(|k| r[k] -= step * q[k]);
        let next = dot(&r, &r);
        if next < 1e-20 * first {
            return w;
        }
        p = (0..n).map(|k| r[k] + next / square * p[k]).collect();
        square = next;
    }
    panic!("no equilibrium: {:.1e} is left", (square / first).sqrt())
}

/// Weight over the film, of `pressure` (Pa) on its area.
fn weights(nodes: &Nodes, pressure: f64) -> Vec<f64> {
    nodes.mass.iter().map(|mass| pressure * mass / (900.0 * THICKNESS)).collect()
}

const ALL: [(Kind, f64); 6] = [
    (Kind::Quads, 0.0),
    (Kind::Tris, 0.0),
    (Kind::Crossed, 0.0),
    (Kind::Quads, 0.4),
    (Kind::Tris, 0.4),
    (Kind::Crossed, 0.4),
];

/// A bent and stretched state of a film, without any symmetry.
fn crumpled(nodes: &Nodes) -> Nodes {
    let mut out = nodes.clone();
    for n in 0..nodes.mass.len() {
        let [x, y, _] = nodes.position.value_at(n);
        let wave = [0.1 * (40.0 * x).sin() * y, 0.05 * (70.0 * y + 3.0 * x).cos() * x, 0.03 * (60.0 * x).sin() + y * y];
        out.position.set(n, [1.1 * x + wave[0], 0.95 * y + wave[1], wave[2]]);
    }
    out
}

#[test]
fn forces_are_the_gradient_of_the_energy() {
    for (kind, irregular) in ALL {
        let mesh = rectangle(kind, [0.1, 0.06], [7, 5], irregular);
        let built_in = edges(&mesh, |p| p.x == 0.0);
        let (film, nodes) = film(&mesh, &section(), 1, &built_in);
        let mut nodes = crumpled(&nodes);
        let forces = bending_forces(&film, &nodes);
        let largest = forces.iter().map(|f| f.norm()).fold(0.0, f64::max);
        for n in 0..nodes.mass.len() {
            for axis in 0..3 {
                let at = nodes.position.value_at(n);
                let mut energy = |change: f64| {
                    let mut moved = at;
                    moved[axis] += change;
                    nodes.position.set(n, moved);
                    film.bending_energy(&nodes.position)
                };
                let slope = (energy(1e-4) - energy(-1e-4)) / 2e-4;
                nodes.position.set(n, at);
                assert!((forces[n][axis] + slope).abs() < 1e-6 * largest, "{kind:?} {n} {axis}");
            }
        }
    }
}

#[test]
fn neither_force_nor_moment_acts_on_free_film_and_rotations_store_nothing() {
    for (kind, irregular) in ALL {
        let mesh = rectangle(kind, [0.1, 0.06], [7, 5], irregular);
        let mut section = section();
        (section.md_angle, section.prestrain) = (0.4, [0.1, 0.02]);
        let (film, nodes) = film(&mesh, &section, 1, &[]);
        let bent = crumpled(&nodes);
        let forces = bending_forces(&film, &bent);
        let sizes: f64 = forces.iter().map(|f| f.norm()).sum();
        let net: Vector3<f64> = forces.iter().sum();
        let moment: Vector3<f64> = forces.iter().enumerate().map(|(n, f)| bent.position_of(n).coords.cross(f)).sum();
        assert!(net.norm() < 1e-11 * sizes, "{kind:?}: {net}");
        assert!(moment.norm() < 1e-12 * sizes, "{kind:?}: {moment}");
        let rotation = Rotation3::from_euler_angles(0.7, -1.9, 2.4);
        let turned = |nodes: &Nodes| {
            let mut out = nodes.clone();
            (0..nodes.mass.len()).for_each(|n| {
                let at = rotation * nodes.position_of(n) + Vector3::new(0.3, -0.2, 5.0);
                out.position.set(n, at.coords.into());
            });
            out
        };
        let (flat, energy) = (film.bending_energy(&turned(&nodes).position), film.bending_energy(&bent.position));
        assert!(film.bending_energy(&nodes.position) == 0.0, "{kind:?}: mounted film stores nothing");
        // Rigid motions of metres against bends of centimetres, squared.
        assert!(flat.abs() < 1e-9 * energy, "{kind:?}: {flat} of {energy}");
        let again = film.bending_energy(&turned(&bent).position);
        assert!((again / energy - 1.0).abs() < 1e-9, "{kind:?}: {again} for {energy}");
    }
}

/// Deflection of a strip that is built in at one end, under its weight: q L⁴/(8 E I), narrow, so that its edges are free to
/// curve; of two layers of each that slide.
#[test]
fn strips_deflect_as_beams() {
    let [length, width] = [0.1, 0.02];
    for (kind, irregular) in ALL {
        let mut errors = vec![];
        for fine in [1, 2, 4] {
            let mesh = rectangle(kind, [length, width], [10 * fine, 2 * fine], irregular);
            let built_in = edges(&mesh, |p| p.x == 0.0);
            // Without contraction, which the root would hold.
            let section = Section { law: Law::Elastic(Elastic { young: YOUNG, poisson: 0.0 }), ..section() };
            let (film, nodes) = film(&mesh, &section, 2, &built_in);
            let held: Vec<bool> = mesh.nodes.iter().map(|p| p.x == 0.0).collect();
            let deflection = deflected(&film, &nodes, &held, &weights(&nodes, 1.0));
            let tip = mesh.nodes.iter().zip(&deflection).filter(|(p, _)| p.x == length).map(|(_, w)| *w);
            let tip = tip.sum::<f64>() / f64::from(2 * fine + 1);
            let stiffness = YOUNG * THICKNESS.powi(3) / 12.0 / 4.0;
            errors.push(tip * 8.0 * stiffness / length.powi(4) - 1.0);
        }
        println!("{kind:?} {irregular}: tip off by {errors:.4?}");
        assert!(errors[2].abs() < 0.02, "{kind:?} {irregular}: {errors:?}");
    }
}

/// The same of a fabric without lateral contraction, along MD and along TD, mounted without and with a pre-strain: of the
/// stretches λ₁ along and λ₂ across the strip, curvatures are λ₁² times as large in stress-free coordinates, and areas λ₁ λ₂
/// times smaller, so that under the weight of its own mass its tip sinks by q L⁴/(8 E I λ₁⁴).
#[test]
fn strips_of_fabric_deflect_by_the_stiffness_along_them() {
    let [length, width] = [0.1, 0.02];
    let line = |slope: f64| Curve::new(vec![[1.0, slope]]).expect("a curve");
    let slopes = [YOUNG, 0.3 * YOUNG];
    let cases = [([0.0, 0.0], 0.0), ([0.0, 0.0], 0.5 * PI), ([0.1, -0.05], 0.0), ([0.1, -0.05], 0.5 * PI)];
    for (kind, irregular) in ALL {
        for (prestrain, md_angle) in cases {
            let law = Law::Fabric(Fabric::new(line(slopes[0]), line(slopes[1]), line(0.2 * YOUNG), 0.0));
            let section = Section { law, md_angle, prestrain, ..section() };
            let mesh = rectangle(kind, [length, width], [40, 8], irregular);
            let (film, nodes) = film(&mesh, &section, 1, &edges(&mesh, |p| p.x == 0.0));
            let held: Vec<bool> = mesh.nodes.iter().map(|p| p.x == 0.0).collect();
            let deflection = deflected(&film, &nodes, &held, &weights(&nodes, 1.0));
            let tip = mesh.nodes.iter().zip(&deflection).filter(|(p, _)| p.x == length).map(|(_, w)| *w);
            let tip = tip.sum::<f64>() / 9.0;
            let along = usize::from(md_angle > 0.0);
            let stiffness = slopes[along] * THICKNESS.powi(3) / 12.0 * (1.0 + prestrain[along]).powi(4);
            let error = tip * 8.0 * stiffness / length.powi(4) - 1.0;
            assert!(error.abs() < 0.02, "{kind:?} {irregular} {prestrain:?} {md_angle}: tip off by {error:.4}");
        }
    }
}

/// Middle of a built-in square under pressure, 0.00126532 q a⁴/D (Timoshenko and Woinowsky-Krieger, table 35), and of a
/// simply supported one, 0.00406235 q a⁴/D, with the order of convergence.
#[test]
fn square_plates_deflect_as_in_closed_form() {
    let side = 0.1;
    let plate = YOUNG * THICKNESS.powi(3) / 12.0 / (1.0 - POISSON * POISSON);
    for (is_built_in, expected) in [(true, 0.001_265_32), (false, 0.004_062_35)] {
        for (kind, irregular) in ALL {
            let mut errors = vec![];
            for cells in [8, 16, 32] {
                let mesh = rectangle(kind, [side, side], [cells, cells], irregular);
                let on_edge = |p: &Point3<f64>| p.x == 0.0 || p.y == 0.0 || p.x == side || p.y == side;
                let built_in = if is_built_in { edges(&mesh, on_edge) } else { vec![] };
                let (film, nodes) = film(&mesh, &section(), 1, &built_in);
                let held: Vec<bool> = mesh.nodes.iter().map(on_edge).collect();
                let deflection = deflected(&film, &nodes, &held, &weights(&nodes, 1.0));
                let most = deflection.iter().copied().fold(0.0, f64::max);
                errors.push(most * plate / side.powi(4) / expected - 1.0);
            }
            println!("built in {is_built_in} {kind:?} {irregular}: middle off by {errors:.4?}");
            // Nodes whose surroundings differ by chance are softer by a share that stays.
            let most = if irregular > 0.0 { 0.03 } else { 0.015 };
            assert!(errors[2].abs() < most, "{kind:?} {irregular}: {errors:?}");
            if irregular == 0.0 {
                assert!((1.7..2.2).contains(&(errors[1] / errors[2]).log2()), "{kind:?}: order of {errors:?}");
            }
        }
    }
}

/// Free strip of film in flight: its lowest frequency is that of a beam without supports, (4.73004/L)² √(EI/µ).
#[test]
fn a_free_strip_vibrates_as_a_beam() {
    for kind in [Kind::Quads, Kind::Tris] {
        let [length, width] = [0.05, 0.005];
        let section = Section { law: Law::Elastic(Elastic { young: YOUNG, poisson: 0.0 }), ..section() };
        let mesh = rectangle(kind, [length, width], [40, 4], 0.0);
        let (film, mut nodes) = film(&mesh, &section, 1, &[]);
        let k = 4.730_04 / length;
        let ratio = (k * length).cosh() - (k * length).cos();
        let ratio = ratio / ((k * length).sinh() - (k * length).sin());
        let shape = |x: f64| (k * x).cosh() + (k * x).cos() - ratio * ((k * x).sinh() + (k * x).sin());
        let omega = k * k * (YOUNG * THICKNESS.powi(2) / 12.0 / 900.0).sqrt();
        for n in 0..nodes.mass.len() {
            let [x, ..] = nodes.position.value_at(n);
            nodes.velocity.set(n, [0.0, 0.0, 1e-6 * omega * shape(x)]);
        }
        let middle =
            (0..nodes.mass.len()).find(|n| (nodes.position_of(*n).x - 0.5 * length).abs() < 1e-9).expect("a node");
        let loads = Loads { multiplicity: 1.0, step_factor: 1.0, ..Loads::default() };
        let mut engine = Engine::new(vec![film], nodes, [], loads);
        let (mut crossings, mut before) = (vec![], (0.0, 0.0));
        let (mut energies, mut bending) = (vec![], 0.0_f64);
        while engine.time() < 3.3 * 2.0 * PI / omega {
            let (time, height, energy) = engine
                .read_step(|view| (view.time, view.nodes.position.value_at(middle)[2], view.energies()))
                .expect("a step");
            if before.1 < 0.0 && height >= 0.0 {
                crossings.push(before.0 - before.1 * (time - before.0) / (height - before.1));
            }
            before = (time, height);
            bending = bending.max(energy.bending);
            energies.push(energy.total());
        }
        let period = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
        println!("{kind:?}: frequency off by {:.4}", 2.0 * PI / omega / period - 1.0);
        assert!((2.0 * PI / omega / period - 1.0).abs() < 1e-2, "{kind:?}");
        let gap = energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max);
        assert!(gap < 1e-3 * energies[0] && bending > 0.9 * energies[0], "{kind:?}: {gap} of {}", energies[0]);
    }
}

/// The largest eigenvalue of stiffness over mass, by power iteration, is below the bound and near it.
#[test]
fn the_step_bounds_the_frequency() {
    for (kind, irregular) in ALL {
        let mesh = rectangle(kind, [0.1, 0.06], [9, 7], irregular);
        let built_in = edges(&mesh, |p| p.x == 0.0);
        let (film, nodes) = film(&mesh, &section(), 1, &built_in);
        let bending = film.bending().expect("bending");
        let n = nodes.mass.len();
        let zero = vec![0.0; n];
        let mut w: Vec<f64> = (0..n).map(|k| ((k * 7919) % 13) as f64 - 6.0).collect();
        let mut largest = 0.0;
        for _ in 0..2000 {
            let force = bending.product(&[&zero, &zero, &w]);
            let next: Vec<f64> = (0..n).map(|k| force.value_at(k)[2] / nodes.mass[k]).collect();
            largest = next.iter().map(|v| v * v).sum::<f64>().sqrt() / w.iter().map(|v| v * v).sum::<f64>().sqrt();
            let size = next.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            w = next.iter().map(|v| v / size).collect();
        }
        let bound = bending.squared_frequency();
        println!("{kind:?} {irregular}: bound over the largest eigenvalue {:.3}", bound / largest);
        assert!(bound >= largest * (1.0 - 1e-9) && bound < 2.5 * largest, "{kind:?}: {bound} of {largest}");
    }
}

/// Thick film on small elements, where bending decides the step, stays stable.
#[test]
fn stiff_film_is_stable() {
    for kind in [Kind::Quads, Kind::Tris] {
        let section = Section { thickness: 1e-2, ..section() };
        let mesh = rectangle(kind, [0.02, 0.02], [10, 10], 0.3);
        let (film, mut nodes) = film(&mesh, &section, 1, &edges(&mesh, |p| p.x == 0.0));
        nodes.hold((0..nodes.mass.len()).filter(|n| mesh.nodes[*n].x == 0.0), [true; 3]);
        let free: Vec<usize> = (0..nodes.mass.len()).filter(|n| !nodes.is_held(*n)).collect();
        free.iter().for_each(|n| nodes.velocity.set(*n, [0.0, 0.0, ((n * 31) % 17) as f64 * 1e-2]));
        let bound = film.bending().expect("bending").squared_frequency();
        assert!(bound > 0.7 * film.frequency_bound(&nodes.position), "bending decides");
        let loads = Loads { multiplicity: 1.0, step_factor: 1.0, ..Loads::default() };
        let mut engine = Engine::new(vec![film], nodes, [], loads);
        let first = engine.read_step(|view| view.energies().total()).expect("a step");
        for _ in 0..4000 {
            engine.step(&mut Unobserved).expect("a step");
        }
        let last = engine.read_step(|view| view.energies().total()).expect("a step");
        assert!((last / first - 1.0).abs() < 2e-2, "{kind:?}: {last} from {first}");
    }
}

/// A part between mirror planes has the forces and the energy of the whole.
#[test]
fn parts_have_the_forces_of_the_whole() {
    for kind in [Kind::Quads, Kind::Crossed] {
        let (side, cells) = (0.05, 6);
        let mut part = rectangle(kind, [side, side], [cells, cells], 0.0);
        let on = |axis: usize| {
            let nodes = part.nodes.iter().enumerate().filter(|(_, p)| p[axis] == 0.0);
            nodes.map(|(n, _)| n as u32).collect::<Vec<u32>>()
        };
        part.mirrors = [on(0), on(1)];
        // The whole, reflected element by element.
        let mut whole = Mesh::default();
        let mut number = std::collections::BTreeMap::new();
        let key = |p: &Point3<f64>| [(p.x * 1e9).round() as i64, (p.y * 1e9).round() as i64];
        for signs in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
            let mut image = |node: &u32| {
                let p = part.nodes[*node as usize];
                let p = Point3::new(p.x * signs[0], p.y * signs[1], 0.0);
                *number.entry(key(&p)).or_insert_with(|| {
                    whole.nodes.push(p);
                    whole.nodes.len() as u32 - 1
                })
            };
            let reversed = signs[0] * signs[1] < 0.0;
            let turn = |mut corners: Vec<u32>| {
                if reversed {
                    corners.reverse();
                }
                corners
            };
            let quads: Vec<Vec<u32>> = part.quads.iter().map(|q| turn(q.iter().map(&mut image).collect())).collect();
            let tris: Vec<Vec<u32>> = part.tris.iter().map(|t| turn(t.iter().map(&mut image).collect())).collect();
            whole.quads.extend(quads.iter().map(|q| <[u32; 4]>::try_from(q.as_slice()).expect("four")));
            whole.tris.extend(tris.iter().map(|t| <[u32; 3]>::try_from(t.as_slice()).expect("three")));
        }
        let section = Section { prestrain: [0.05, 0.02], ..section() };
        let bend = |nodes: &Nodes| {
            let mut out = nodes.clone();
            for n in 0..nodes.mass.len() {
                let [x, y, _] = nodes.position.value_at(n);
                let z = 0.01 * (60.0 * x).cos() * (45.0 * y).cos();
                out.position.set(n, [x + 0.1 * (50.0 * x).sin() * z, y - 0.2 * (30.0 * y).sin() * z, z]);
            }
            out
        };
        let held = |mesh: &Mesh| edges(mesh, |p| p.x.abs() == side);
        let (part_film, part_nodes) = film(&part, &section, 1, &held(&part));
        let (whole_film, whole_nodes) = film(&whole, &section, 1, &held(&whole));
        let (part_nodes, whole_nodes) = (bend(&part_nodes), bend(&whole_nodes));
        let energies = [&part_film, &whole_film].map(|film| {
            let nodes = if film.elements() == part_film.elements() { &part_nodes } else { &whole_nodes };
            film.bending_energy(&nodes.position)
        });
        assert!((4.0 * energies[0] / energies[1] - 1.0).abs() < 1e-9, "{kind:?}: {energies:?}");
        let (ours, all) = (bending_forces(&part_film, &part_nodes), bending_forces(&whole_film, &whole_nodes));
        let largest = all.iter().map(|f| f.norm()).fold(0.0, f64::max);
        for (n, p) in part.nodes.iter().enumerate() {
            let shares = [0, 1].map(|axis| if p[axis] == 0.0 { 0.5 } else { 1.0 });
            let mut expected = all[number[&key(p)] as usize] * shares[0] * shares[1];
            // Across a mirror plane both halves pull, and the node is held.
            for axis in 0..2 {
                if p[axis] == 0.0 {
                    expected[axis] = ours[n][axis];
                }
            }
            assert!((ours[n] - expected).norm() < 1e-9 * largest, "{kind:?} {p}: {} for {expected}", ours[n]);
        }
    }
}

/// Bits depend neither on the threads nor on the vector instructions, nor on a restart.
#[test]
fn bits_depend_on_neither_threads_nor_width() {
    let run = |threads: usize, width: Width, restarts: bool| {
        let section = Section { thickness: 1e-3, ..section() };
        let mesh = rectangle(Kind::Quads, [0.3, 0.2], [61, 37], 0.3);
        let build = || {
            let (film, mut nodes) = film(&mesh, &section, 1, &edges(&mesh, |p| p.x == 0.0));
            nodes.hold((0..nodes.mass.len()).filter(|n| mesh.nodes[*n].x == 0.0), [true; 3]);
            let nodes = crumpled(&nodes);
            let loads = Loads { multiplicity: 1.0, step_factor: 1.0, ..Loads::default() };
            Engine::new(vec![film], nodes, [], loads).with_pool(ThreadPool::new(threads).at_width(width))
        };
        let mut engine = build();
        for step in 0..60 {
            if restarts && step == 30 {
                let state = engine.state();
                engine = build();
                engine.restore(state).expect("a state");
            }
            engine.step(&mut Unobserved).expect("a step");
        }
        engine.nodes.position.iter().flatten().map(f64::to_bits).collect::<Vec<u64>>()
    };
    let expected = run(1, Width::Baseline, false);
    for width in Width::available() {
        for threads in [1, 3] {
            assert!(run(threads, width, true) == expected, "{threads} threads, {width:?}");
        }
    }
}

/// Film whose elements are deleted one after another: what bending stored there goes into `rupture`, and a restored engine
/// stores what is left, to the bit.
#[test]
fn torn_film_bends_no_more_where_it_tore() {
    use crate::material::{Criterion, Limit, Rupture};

    let rupture = Rupture { criterion: Criterion::Strain, limit: Limit::One(0.05), fracture_energy: 0.0 };
    let section = Section { rupture: Some(rupture), thickness: 1e-3, ..section() };
    let mesh = rectangle(Kind::Quads, [0.1, 0.06], [10, 6], 0.0);
    let build = || {
        let (film, mut nodes) = film(&mesh, &section, 1, &edges(&mesh, |p| p.x == 0.0));
        nodes.hold((0..nodes.mass.len()).filter(|n| mesh.nodes[*n].x == 0.0 || mesh.nodes[*n].x == 0.1), [true; 3]);
        for n in 0..nodes.mass.len() {
            let [x, y, _] = nodes.position.value_at(n);
            nodes.position.set(n, [x, y, 2e-3 * (60.0 * x).sin()]);
            let pulled = if x == 0.1 { 8.0 } else { 80.0 * x };
            nodes.velocity.set(n, [pulled, 0.0, 0.0]);
        }
        let right = (0..nodes.mass.len() as u32).filter(|n| mesh.nodes[*n as usize].x == 0.1).collect();
        let jaws = vec![Jaw { nodes: right, velocity: 8.0 }];
        Engine::new(vec![film], nodes, [], Loads { jaws, ..Loads::default() })
    };
    let mut engine = build();
    assert!(engine.films[0].bending_energy(&engine.nodes.position) > 0.0);
    let (mut failed, mut totals) = (0, vec![]);
    while failed < 6 && engine.time() < 2e-3 {
        totals.push(engine.read_step(|view| view.energies()).expect("a step"));
        let film = &engine.films[0];
        failed = film.elements() - film.intact().len();
    }
    assert!(failed >= 6, "{failed} elements tore");
    let (first, last) = (totals[0], totals[totals.len() - 1]);
    let gap = totals.iter().map(|e| (e.total() - first.total()).abs()).fold(0.0, f64::max);
    let exchanged = last.exchanged(&first);
    println!("{failed} elements tore; energy off by {:.1e}", gap / exchanged);
    assert!(gap < 1e-2 * exchanged && last.rupture > 0.0, "{gap} of {exchanged}");
    let film = &engine.films[0];
    let mut again = build();
    again.restore(engine.state()).expect("a state");
    let energies = [film, &again.films[0], &build().films[0]].map(|film| film.bending_energy(&engine.nodes.position));
    let [found, restored, whole] = energies;
    assert!(found.to_bits() == restored.to_bits() && found < whole, "{energies:?}");
}
