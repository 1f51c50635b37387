//! Smooth solutions that are not uniform, on meshes each twice as fine as the one before: the error falls with the
//! square of the element's size, on even and on distorted meshes, for every kind of element.

use std::f64::consts::{FRAC_PI_2, PI};

use droptower::mesh::Element;

use super::axisymmetric;
use super::claims::Claims;
use super::scene::{mounted, positions, relaxed, set_positions};
use super::sheet::{DENSITY, ELEMENTS, THICKNESS, elastic, face, nodes_where, sheet};

const YOUNG: f64 = 50e6;
const POISSON: f64 = 0.44;
/// Order below which a method of second order must not fall between two meshes.
const ORDER: f64 = 1.9;
/// How far inner nodes of a distorted mesh are off, over the size of an element.
const UNEVEN: f64 = 0.2;

/// Side of the square, m.
const SIDE: f64 = 0.2;
const PRESTRAIN: f64 = 0.05;
/// Height over the side: slopes of 1e-3, whose squares are too small to change the tension.
const HEIGHT: f64 = 3e-4;

/// A harmonic function on the square, m.
fn harmonic([x, y, _]: [f64; 3]) -> f64 {
    let k = PI / SIDE;
    HEIGHT * SIDE * (k * x).sin() * (k * y).sinh() / (k * SIDE).sinh()
}

/// Errors of height (root of the mean square over that of the solution) and of energy of a film stretched evenly, whose
/// rim follows a harmonic function: its inside does then, with the energy ½N∮w ∂w/∂n, N = h S.
fn of_height(cells: usize, element: Element, uneven: f64) -> [f64; 2] {
    let cells = [cells; 2];
    let mesh = sheet(cells, element, uneven, |[u, v]| [SIDE * u, SIDE * v]);
    let (film, mut nodes) = mounted(&mesh, &face(elastic(YOUNG, POISSON), element, [PRESTRAIN; 2]));
    let flat = film.energy(&nodes.position);
    set_positions(&mut nodes, |_, x| [x[0], x[1], harmonic(x)]);
    let [columns, rows] = cells;
    nodes.hold(nodes_where(cells, |c, r| c == 0 || c == columns || r == 0 || r == rows), [true; 3]);
    let exact = positions(&nodes);
    let mass = nodes.mass.clone();

    let stretch = 1.0 + PRESTRAIN;
    let second = YOUNG / (1.0 - POISSON) * 0.5 * (stretch * stretch - 1.0);
    let frequency = stretch * (second / DENSITY).sqrt() * PI / SIDE * 2.0_f64.sqrt();
    let (rest, energies) = relaxed(film, nodes, 2.0 * frequency, 20.0 / frequency);

    let [mut off, mut all] = [0.0; 2];
    for ((x, exact), mass) in rest.iter().zip(&exact).zip(&mass) {
        off += mass * (x[2] - exact[2]).powi(2);
        all += mass * exact[2].powi(2);
    }
    let k = PI / SIDE;
    let whole = 0.5 * THICKNESS * second * (HEIGHT * SIDE).powi(2) * k / (k * SIDE).tanh() * 0.5 * SIDE;
    let gained = energies.stored + energies.hourglass - flat.stored - flat.hourglass;
    [(off / all).sqrt(), gained / whole - 1.0]
}

/// Radii of a ring of stress-free film, m, and the displaced positions of its edges: r and z.
const RING: [f64; 2] = [0.03, 0.1];
const EDGES: [[f64; 2]; 2] = [[0.034, -0.04], [0.11, 0.0]];

/// Errors of place (root of the mean square over the outer radius) and of energy of a quarter of the ring at large
/// strain.
fn of_ring(cells: usize, element: Element, uneven: f64, exact: &axisymmetric::Shape) -> [f64; 2] {
    let cells = [cells, 3 * cells / 2];
    let material = |[u, v]: [f64; 2]| {
        let (sin, cos) = (FRAC_PI_2 * v).sin_cos();
        let radius = RING[0] + u * (RING[1] - RING[0]);
        [radius * cos, radius * sin]
    };
    let mesh = sheet(cells, element, uneven, material);
    let (film, mut nodes) = mounted(&mesh, &face(elastic(YOUNG, POISSON), element, [0.0; 2]));
    set_positions(&mut nodes, |_, [x, y, _]| {
        let radius = x.hypot(y);
        let [r, z] = exact.at(radius);
        [x / radius * r, y / radius * r, z]
    });
    let solution = positions(&nodes);
    let mass = nodes.mass.clone();
    let [columns, rows] = cells;
    nodes.hold(nodes_where(cells, |_, r| r == 0), [false, true, false]);
    nodes.hold(nodes_where(cells, |_, r| r == rows), [true, false, false]);
    nodes.hold(nodes_where(cells, |c, _| c == 0 || c == columns), [true; 3]);
    // The slowest motion is across the film, at the wave speed that belongs to a strain of some tenths.
    let frequency = 0.4 * (YOUNG / DENSITY).sqrt() * PI / (RING[1] - RING[0]);
    let (rest, energies) = relaxed(film, nodes, 2.0 * frequency, 20.0 / frequency);
    let apart = |(x, y): (&[f64; 3], &[f64; 3])| (0..3).map(|i| (x[i] - y[i]).powi(2)).sum::<f64>();
    let squares = rest.iter().zip(&solution).map(apart).zip(&mass).map(|(square, mass)| square * mass);
    let off = squares.sum::<f64>() / mass.iter().sum::<f64>();
    [off.sqrt() / RING[1], 4.0 * (energies.stored + energies.hourglass) / exact.energy - 1.0]
}

#[test]
fn errors_fall_with_the_square_of_the_size() {
    let mut claims = Claims::of("convergence");
    let film = axisymmetric::Sheet { young: YOUNG, poisson: POISSON, thickness: THICKNESS, wrinkling: false };
    let ring = film.ring(RING, EDGES);
    let column = |errors: &[[f64; 2]], k: usize| errors.iter().map(|e| e[k]).collect::<Vec<_>>();
    for element in ELEMENTS {
        for uneven in [0.0, UNEVEN] {
            let what =
                |claim: &str| format!("{element:?}, {} mesh, {claim}", if uneven > 0.0 { "distorted" } else { "even" });
            let flat: Vec<_> = thorough::first(2, [9, 18, 36]).map(|cells| of_height(cells, element, uneven)).collect();
            claims.converges(&what("harmonic film, height"), &column(&flat, 0), ORDER);
            claims.converges(&what("harmonic film, energy"), &column(&flat, 1), ORDER);
            let strained: Vec<_> =
                thorough::first(2, [12, 24, 48]).map(|cells| of_ring(cells, element, uneven, &ring)).collect();
            claims.converges(&what("ring, place"), &column(&strained, 0), ORDER);
            claims.converges(&what("ring, energy"), &column(&strained, 1), ORDER);
        }
    }
}
