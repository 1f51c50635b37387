//! Bending film at rest: a strip that hangs from a table against the elastica, the drape of a disc over a smaller one, the
//! wrinkles of a sheet that is stretched between clamps.
//!
//! The full forms are `cargo test --release -p droptower-membrane bending_equilibria -- --include-ignored --nocapture`.

use std::f64::consts::{PI, TAU};

use nalgebra::Point3;

use super::bending_tests::{Kind, edges, rectangle};
use super::{Engine, Film, Loads, Mesh, Nodes, Relaxation, Section};
use crate::material::{Elastic, Law};

const GRAVITY: f64 = 9.81;

fn section(young: f64, poisson: f64, thickness: f64, density: f64) -> Section {
    Section::new(Law::Elastic(Elastic { young, poisson }), density, thickness)
}

/// Film of `mesh`, built in at the edges whose nodes are `held`, at rest under `gravity` (m/s²) from where `start` puts its
/// nodes.
fn at_rest(
    mesh: &Mesh,
    section: &Section,
    gravity: f64,
    held: impl Fn(&Point3<f64>) -> bool,
    start: impl Fn(&Point3<f64>) -> [f64; 3],
) -> (Engine, Relaxation) {
    let mut nodes = Nodes::default();
    let mut film = Film::mount(mesh, section, 0.0, &mut nodes).expect("a film");
    film.bend(&nodes, mesh, section, 1, &edges(mesh, &held)).expect("flat film");
    nodes.hold((0..mesh.nodes.len()).filter(|n| held(&mesh.nodes[*n])), [true; 3]);
    for (n, place) in mesh.nodes.iter().enumerate() {
        nodes.position.set(n, start(place));
    }
    let mut engine = Engine::new(vec![film], nodes, [], Loads { gravity, ..Loads::default() });
    let relaxation = engine.relax(&[true], |_| true).expect("film at rest");
    (engine, relaxation)
}

/// Drop and reach of the tip of an inextensible strip of unit length that leaves a table horizontally, of the weight
/// `load` = q L³/(E I): the roots of E I θ″ = −q (L − s) cos θ by shooting, steps of Runge and Kutta.
fn elastica(load: f64) -> [f64; 2] {
    let shot = |slope: f64| {
        let steps = 4000;
        let h = 1.0 / f64::from(steps);
        let rate =
            |s: f64, [angle, bend, ..]: [f64; 4]| [bend, -load * (1.0 - s) * angle.cos(), angle.cos(), angle.sin()];
        let mut y = [0.0, slope, 0.0, 0.0];
        let along = |y: [f64; 4], k: [f64; 4], h: f64| [0, 1, 2, 3].map(|i| y[i] + h * k[i]);
        for step in 0..steps {
            let s = f64::from(step) * h;
            let a = rate(s, y);
            let b = rate(s + 0.5 * h, along(y, a, 0.5 * h));
            let c = rate(s + 0.5 * h, along(y, b, 0.5 * h));
            let d = rate(s + h, along(y, c, h));
            y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        y
    };
    // The curvature at the end grows with that at the root.
    let (mut low, mut high) = (0.0, load);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if shot(middle)[1] > 0.0 { high = middle } else { low = middle }
    }
    let [.., reach, drop] = shot(0.5 * (low + high));
    [drop, reach]
}

/// A strip with a root that is built in: drop and reach of its tip.
fn hanging(kind: Kind, irregular: f64, load: f64, cells: [u32; 2]) -> [f64; 2] {
    let (length, thickness, young): (f64, f64, f64) = (0.05, 1e-3, 1e6);
    let density = load * young * thickness.powi(2) / 12.0 / (GRAVITY * length.powi(3));
    let width = length * f64::from(cells[1]) / f64::from(cells[0]);
    let mesh = rectangle(kind, [length, width], cells, irregular);
    let section = section(young, 0.0, thickness, density);
    let (engine, relaxation) = at_rest(&mesh, &section, GRAVITY, |p| p.x == 0.0, |p| [p.x, p.y, p.z]);
    assert!(relaxation.residual < 1e-5, "{relaxation:?}");
    let tip: Vec<usize> = (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n].x == length).collect();
    let mean = |axis: usize| {
        tip.iter().map(|n| engine.nodes.position.value_at(*n)[axis]).sum::<f64>() / tip.len() as f64 / length
    };
    let (film, nodes) = (&engine.films[0], &engine.nodes);
    let (bending, membrane) = (film.bending_energy(&nodes.position), film.energy(&nodes.position).stored);
    println!(
        "{kind:?} {irregular}, load {load}, {cells:?}: {} steps, membrane {:.1e} of the bending energy",
        relaxation.steps,
        membrane / bending
    );
    [-mean(2), mean(0)]
}

/// The closed form itself: q L⁴/(8 E I) of small loads.
#[test]
fn the_elastica_is_a_beam_under_small_loads() {
    let [drop, reach] = elastica(1e-3);
    assert!((drop / 1e-3 * 8.0 - 1.0).abs() < 1e-5 && (reach - 1.0).abs() < 1e-6, "{drop} {reach}");
    // The cantilever test of ASTM D1388 is defined so: the chord of an overhang of twice the bending length falls by 41.5°.
    let [drop, reach] = elastica(8.0);
    let angle = drop.atan2(reach).to_degrees();
    assert!((angle - 41.5).abs() < 1.0, "{angle}");
}

#[test]
fn a_strip_hangs_as_the_elastica() {
    for load in [3.0, 20.0] {
        let expected = elastica(load);
        for (kind, irregular) in [(Kind::Quads, 0.0), (Kind::Tris, 0.0)] {
            let errors = [[8, 2], [16, 4]].map(|cells| {
                let found = hanging(kind, irregular, load, cells);
                [0, 1].map(|k| found[k] - expected[k])
            });
            println!("{kind:?}, load {load}: {expected:.4?}, off by {errors:.4?} of the length");
            assert!(errors[1].iter().all(|error| error.abs() < 0.01), "{kind:?} {load}: {errors:?}");
            let size = |[a, b]: [f64; 2]| (a * a + b * b).sqrt();
            assert!(size(errors[1]) < 0.4 * size(errors[0]), "{kind:?} {load}: {errors:?}");
        }
    }
}

/// Finer meshes, those whose nodes are moved, and crossed diagonals.
#[test]
#[ignore = "takes a minute"]
fn a_strip_hangs_as_the_elastica_on_all_meshes() {
    for load in [3.0, 20.0, 60.0] {
        let expected = elastica(load);
        for kind in [Kind::Quads, Kind::Tris, Kind::Crossed] {
            for irregular in [0.0, 0.3] {
                let errors = [[8, 2], [16, 4], [32, 8]].map(|cells| {
                    let found = hanging(kind, irregular, load, cells);
                    [0, 1].map(|k| found[k] - expected[k])
                });
                println!("{kind:?} {irregular}, load {load}: {expected:.4?}, off by {errors:.4?} of the length");
                assert!(errors[2].iter().all(|error| error.abs() < 0.02), "{kind:?} {load}: {errors:?}");
            }
        }
    }
}

/// A ring of quads or triangles between two radii.
fn ring(kind: Kind, [inner, outer]: [f64; 2], [radial, around]: [u32; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..around {
        for i in 0..=radial {
            let radius = inner + (outer - inner) * f64::from(i) / f64::from(radial);
            let (sin, cos) = (TAU * f64::from(j) / f64::from(around)).sin_cos();
            mesh.nodes.push(Point3::new(radius * cos, radius * sin, 0.0));
        }
    }
    let at = |i: u32, j: u32| (j % around) * (radial + 1) + i;
    for j in 0..around {
        for i in 0..radial {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            match kind {
                Kind::Quads => mesh.quads.push([a, b, c, d]),
                Kind::Tris | Kind::Crossed => mesh.tris.extend([[a, b, c], [a, c, d]]),
            }
        }
    }
    mesh
}

/// Drape coefficient and number of folds of a disc of 300 mm on one of 180 mm, of the bending length (m).
fn drape(kind: Kind, bending_length: f64, strain: f64, cells: [u32; 2]) -> (f64, usize) {
    // Bending length³ = D/q. Stiffness along the film follows from the strain that its weight over the disc would give:
    // what is hardly stretched is as good as inextensible.
    let (inner, outer, density, poisson) = (0.09, 0.15, 1000.0, 0.3);
    let per_area = 0.2;
    let stiffness = per_area * GRAVITY * bending_length.powi(3);
    let membrane = per_area * GRAVITY * outer / strain;
    // D = E h³/(12 (1 − ν²)), with E h = membrane.
    let thickness = (12.0 * (1.0 - poisson * poisson) * stiffness / membrane).sqrt();
    let section = section(membrane / thickness, poisson, thickness, density * per_area / (density * thickness));
    let mesh = ring(kind, [inner, outer], cells);
    // A start without symmetry: film without folds is in equilibrium, too.
    let start = |p: &Point3<f64>| {
        let (radius, angle) = (p.x.hypot(p.y), p.y.atan2(p.x));
        let share = ((radius - inner) / (outer - inner)).powi(2);
        let waves: f64 = (2..12).map(|n| (f64::from(n) * angle + f64::from(n * n)).cos()).sum();
        [p.x, p.y, 1e-3 * share * waves]
    };
    let (engine, relaxation) = at_rest(&mesh, &section, GRAVITY, |p| p.x.hypot(p.y) < inner + 1e-9, start);
    let edge: Vec<[f64; 3]> =
        (0..cells[1]).map(|j| engine.nodes.position.value_at((j * (cells[0] + 1) + cells[0]) as usize)).collect();
    let next = |k: usize| edge[(k + 1) % edge.len()];
    let shadow = 0.5 * (0..edge.len()).map(|k| edge[k][0] * next(k)[1] - next(k)[0] * edge[k][1]).sum::<f64>();
    let of = |radius: f64| PI * radius * radius;
    let coefficient = (shadow - of(inner)) / (of(outer) - of(inner));
    let radius: Vec<f64> = edge.iter().map(|[x, y, _]| x.hypot(*y)).collect();
    let count = radius.len();
    // Folds: maxima of the shadow's radius over a window of its neighbours.
    let window = count / 40 + 1;
    let is_peak = |k: usize| {
        (1..=window).all(|d| radius[k] > radius[(k + d) % count] && radius[k] >= radius[(k + count - d) % count])
    };
    let folds = (0..count).filter(|k| is_peak(*k)).count();
    println!(
        "{kind:?}, bending length {:.0} mm, strain {strain:.0e}, {cells:?}: drape coefficient {:.1} %, {folds} folds; \
         {} steps, residual {:.1e}, thickness {:.2} mm",
        1e3 * bending_length,
        1e2 * coefficient,
        relaxation.steps,
        relaxation.residual,
        1e3 * thickness
    );
    (coefficient, folds)
}

/// A stiff disc stays flat, a soft one hangs in folds, and what is softer has more of them and a smaller shadow.
#[test]
fn a_disc_drapes_in_folds() {
    let coarse = [6, 60];
    let (stiff, _) = drape(Kind::Quads, 0.12, 1e-2, coarse);
    assert!(stiff > 0.99, "{stiff}");
    let (middle, few) = drape(Kind::Quads, 0.03, 1e-2, coarse);
    let (soft, many) = drape(Kind::Quads, 0.02, 1e-2, coarse);
    assert!((0.78..0.88).contains(&middle) && (0.54..0.66).contains(&soft), "{middle} {soft}");
    assert!((5..=8).contains(&few) && (7..=10).contains(&many), "{few} {many}");
}

#[test]
#[ignore = "takes minutes"]
fn drape_over_the_bending_length() {
    for bending_length in [0.015, 0.02, 0.03, 0.04] {
        for (kind, cells) in [(Kind::Quads, [8, 96]), (Kind::Tris, [8, 96]), (Kind::Quads, [12, 144])] {
            drape(kind, bending_length, 1e-2, cells);
        }
    }
}

/// Distance between wrinkles of a sheet between two clamps in its middle, m, over λ = 2 √π (B/T)^¼ L^½ (Cerda and Mahadevan,
/// Phys. Rev. Lett. 90, 074302, 2003), and their amplitude, m.
fn wrinkles(kind: Kind, strain: f64, thickness: f64, [length, width]: [f64; 2], size: f64) -> [f64; 2] {
    let (young, poisson) = (1e9, 0.45);
    let cells = [(length / size).round() as u32, (width / size).round() as u32];
    let mesh = rectangle(kind, [length, width], cells, 0.0);
    let section = section(young, poisson, thickness, 1000.0);
    let start = |p: &Point3<f64>| {
        // Waves of many lengths across, none of which is preferred, along the sheet as its lowest one.
        let waves: f64 = (1..24).map(|n| (PI * f64::from(n) * p.y / width + f64::from(n * n)).cos()).sum();
        [(1.0 + strain) * p.x, p.y, 0.05 * thickness * waves * (PI * p.x / length).sin()]
    };
    let held = |p: &Point3<f64>| p.x == 0.0 || p.x == length;
    let (engine, relaxation) = at_rest(&mesh, &section, 0.0, held, start);
    let middle: Vec<f64> = (0..mesh.nodes.len())
        .filter(|n| (mesh.nodes[*n].x - length * f64::from(cells[0] / 2) / f64::from(cells[0])).abs() < 1e-9)
        .map(|n| engine.nodes.position.value_at(n)[2])
        .collect();
    let heights = &middle[middle.len() / 6..middle.len() - middle.len() / 6];
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let crossings: Vec<f64> = (1..heights.len())
        .filter(|k| (heights[k - 1] - mean) * (heights[*k] - mean) < 0.0)
        .map(|k| k as f64 - (heights[k] - mean) / (heights[k] - heights[k - 1]))
        .collect();
    let amplitude = heights.iter().map(|z| (z - mean).abs()).fold(0.0, f64::max);
    let apart = crossings.last().zip(crossings.first()).map_or(f64::NAN, |(last, first)| last - first);
    let found = 2.0 * size * apart / (crossings.len().max(2) - 1) as f64;
    let stiffness = young * thickness.powi(3) / 12.0 / (1.0 - poisson * poisson);
    // As the theory has it: the tension of the strain in a strip that is free to contract.
    let tension = young * thickness * strain;
    let expected = 2.0 * PI.sqrt() * (stiffness / tension).powf(0.25) * length.sqrt();
    println!(
        "{kind:?}, strain {strain}, {cells:?}: wrinkles {:.1} mm apart, {:.1} mm by Cerda and Mahadevan ({:.2}), \
         amplitude {:.2} mm, {} crossings; {} steps, residual {:.1e}",
        1e3 * found,
        1e3 * expected,
        found / expected,
        1e3 * amplitude,
        crossings.len(),
        relaxation.steps,
        relaxation.residual
    );
    [found / expected, amplitude]
}

#[test]
fn a_stretched_sheet_wrinkles_at_the_length_of_its_stiffness() {
    let [ratio, amplitude] = wrinkles(Kind::Quads, 0.05, 1e-4, [0.25, 0.1], 2.5e-3);
    assert!((0.75..1.25).contains(&ratio) && amplitude > 1e-4, "{ratio} {amplitude}");
}

#[test]
#[ignore = "takes minutes"]
fn wrinkles_over_strain_and_thickness() {
    for (kind, strain, thickness, size) in [
        (Kind::Quads, 0.05, 1e-4, 2.5e-3),
        (Kind::Quads, 0.05, 1e-4, 1.67e-3),
        (Kind::Tris, 0.05, 1e-4, 2.5e-3),
        (Kind::Quads, 0.1, 1e-4, 2e-3),
        (Kind::Quads, 0.05, 5e-5, 1.67e-3),
        (Kind::Quads, 0.1, 5e-5, 1.25e-3),
    ] {
        let [ratio, amplitude] = wrinkles(kind, strain, thickness, [0.25, 0.1], size);
        assert!((0.7..1.25).contains(&ratio) && amplitude > 1e-4, "{ratio} {amplitude}");
    }
}
