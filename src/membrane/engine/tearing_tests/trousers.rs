//! Trousers: a tear out of the plane of film.

use nalgebra::Point3;

use super::mesh::Shape;
use super::section;
use crate::engine::{Engine, Film, Jaw, Loads, Nodes, Section, Unobserved};
use crate::material::{Criterion, Hyperelastic, HyperelasticLaw, Law, Polynomial, Rupture};

/// What trousers show while their tear grows from 10 to 40 mm, in jerks of an element each.
#[derive(Clone, Copy, Debug)]
struct Torn {
    /// Largest mean force on the legs over 10 ms, N: that at which the tear goes on.
    force: f64,
    /// Work of the jaws less what film stores more, for the length of the tear, J/m.
    released: f64,
    /// Energy that the tear took for its area, J/m².
    spent: f64,
    /// Largest error of the energy balance.
    imbalance: f64,
}

/// Pulls trousers that are bent, not strained: their uncut part hangs down and each leg runs along x to its jaw, which moves
/// at half of `speed` (m/s). What they show, and the mean cross-section of both legs, m².
fn trousers(section: &Section, shape: Shape, [width, leg, body]: [f64; 3], speed: f64) -> (Torn, f64) {
    let mut mesh = shape.mesh([body + leg, width], 0.0);
    mesh.nodes.iter_mut().for_each(|node| node.x -= body);
    let mut nodes = Nodes::default();
    let mut film = Film::mount(&mesh, section, 0.0, &mut nodes).unwrap();
    let [size, _] = shape.edges;
    // Somewhat beyond the legs: no element lies on both of them.
    film.cut(&nodes, &[[leg + size, 1e-6], [-1.5 * size, 1e-6]]);
    let mut of_legs = 0.0;
    film.for_each_intact(|corners| of_legs += area_within(corners, &mesh.nodes, [0.0, leg]));
    let mut jaws = [-1.0, 1.0].map(|side| Jaw { nodes: vec![], velocity: 0.5 * side * speed });
    for n in 0..nodes.mass.len() {
        let [x, y, _] = nodes.position.value_at(n);
        let (jaw, side) = if y > 1e-6 { (1, 1.0) } else { (0, -1.0) };
        nodes.position.set(n, if x < 0.0 { [0.0, y, x] } else { [side * x, y, 0.0] });
        if x > leg - size {
            jaws[jaw].nodes.push(n as u32);
        }
    }
    for jaw in &jaws {
        nodes.hold(jaw.nodes.iter().map(|n| *n as usize), [true; 3]);
        jaw.nodes.iter().for_each(|n| nodes.velocity.set(*n as usize, [jaw.velocity, 0.0, 0.0]));
    }
    let loads = Loads { jaws: jaws.into(), damping: 20.0, ..Loads::default() };
    let mut engine = Engine::new(vec![film], nodes, [], loads);
    let read =
        |engine: &mut Engine| engine.read_step(|view| (view.time, view.energies(), view.torn().unwrap())).unwrap();
    let (_, start, _) = read(&mut engine);
    let (mut from, mut last, mut force, mut imbalance) = (None, (0.0, start), 0.0_f64, 0.0_f64);
    loop {
        (0..20).for_each(|_| assert!(engine.step(&mut Unobserved).is_ok()));
        let (time, energies, torn) = read(&mut engine);
        imbalance = imbalance.max((energies.total() - start.total()).abs() / energies.exchanged(&start));
        let (before, energies_before) = last;
        if time > before + 0.01 {
            let mean = (energies_before.external - energies.external) / (speed * (time - before));
            force = if torn.length > 10e-3 { force.max(mean) } else { 0.0 };
            last = (time, energies);
        }
        let given = -energies.external - energies.stored;
        if torn.length > 10e-3 && from.is_none() {
            from = Some((torn.length, given));
        }
        if let Some((length, given_before)) = from.filter(|_| torn.length > 40e-3) {
            let released = (given - given_before) / (torn.length - length);
            let torn = Torn { force, released, spent: torn.energy / torn.area, imbalance };
            return (torn, of_legs / leg * section.thickness);
        }
        assert!(time < 1.0, "{shape:?}: no tear");
    }
}

/// Area (m²) of an element, where its middle lies within these along x.
fn area_within(corners: &[u32], places: &[Point3<f64>], [from, to]: [f64; 2]) -> f64 {
    let at = |k: usize| places[corners[k % corners.len()] as usize];
    let middle = (0..corners.len()).map(|k| at(k).x).sum::<f64>() / corners.len() as f64;
    let twice: f64 = (0..corners.len()).map(|k| at(k).x * at(k + 1).y - at(k + 1).x * at(k).y).sum();
    if (from..to).contains(&middle) { 0.5 * twice } else { 0.0 }
}

/// Force (N) on neo-Hookean legs of the shear modulus `mu` (Pa) and the cross-section `area` (m²) each, in which a tear
/// takes `energy` for its length (J/m): 2 F λ − 2 A W(λ) = Γ h, with F = A μ (λ − λ⁻²) (theory.md, equation 306).
fn trouser_force(mu: f64, area: f64, energy: f64) -> f64 {
    let force = |stretch: f64| area * mu * (stretch - stretch.powi(-2));
    let density = |stretch: f64| 0.5 * mu * (stretch * stretch + 2.0 / stretch - 3.0);
    let (mut low, mut high) = (1.0, 10.0);
    for _ in 0..60 {
        let stretch = 0.5 * (low + high);
        let released = 2.0 * (force(stretch) * stretch - area * density(stretch));
        if released < energy { low = stretch } else { high = stretch }
    }
    force(low)
}

/// Shear modulus (Pa) and Γ (J/m²) of the rubber.
const RUBBER: [f64; 2] = [4e5, 1e4];

/// Width of the trousers, length of a leg and of what is not cut, m.
const LENGTHS: [f64; 3] = [60e-3, 90e-3, 100e-3];

/// Compares the force on trousers of rubber, the work that they release and the energy that the tear takes with (306), within
/// these shares.
fn the_force_on_torn_trousers_is_that_of_the_fracture_energy(shape: Shape, [of_force, of_work]: [f64; 2]) {
    let ([mu, energy], thickness) = (RUBBER, 5e-4);
    let law = HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::neo_hookean(mu), wrinkling: true });
    let rubber = Section {
        law: Law::Hyperelastic(law),
        rupture: Some(Rupture { criterion: Criterion::Strain, limit: 6.0, fracture_energy: energy }),
        thickness,
        density: 930.0,
        ..section()
    };
    let (torn, cross_section) = trousers(&rubber, shape, LENGTHS, 0.5);
    let expected = trouser_force(mu, 0.5 * cross_section, energy * thickness);
    let [force, released, spent] =
        [torn.force / expected, torn.released / (energy * thickness), torn.spent / energy].map(|ratio| ratio - 1.0);
    println!("{shape:?}: force {force:.3}, released {released:.3}, spent {spent:.4}; {torn:?} for {expected:.3} N");
    assert!(force.abs() < of_force && released.abs() < of_work, "{shape:?}: {force}, {released}");
    assert!(spent.abs() < 0.05 && torn.imbalance < 0.01, "{shape:?}: {torn:?}");
}

/// Width of elements in trousers with so many columns of them.
const fn columns(count: f64) -> Shape {
    Shape::even([LENGTHS[0] / count; 2], 0.0)
}

const fn turned(turned: f64) -> Shape {
    Shape::even([5e-3; 2], turned)
}

const fn triangles(shape: Shape) -> Shape {
    Shape { triangles: true, ..shape }
}

const fn uneven(shape: Shape) -> Shape {
    Shape { uneven: 0.2, ..shape }
}

// Of uneven triangles along one diagonal the tear forks.
thorough::cases!(the_force_on_torn_trousers_is_that_of_the_fracture_energy {
    squares: columns(13.0), [0.05; 2];
} thorough {
    triangles_turned: triangles(turned(22.5)), [0.1; 2];
    small_squares: columns(25.0), [0.05; 2];
    squares_of_5_mm: turned(0.0), [0.1; 2];
    of_triangles: triangles(turned(0.0)), [0.1; 2];
    of_uneven: uneven(turned(0.0)), [0.1; 2];
    uneven_triangles: uneven(triangles(turned(0.0))), [0.12, 0.1];
    squares_turned: turned(22.5), [0.1; 2];
    uneven_turned: uneven(turned(22.5)), [0.1; 2];
    uneven_triangles_turned: uneven(triangles(turned(22.5))), [0.12, 0.1];
    squares_along_diagonals: turned(45.0), [0.1; 2];
    triangles_along_diagonals: triangles(turned(45.0)), [0.1; 2];
    uneven_along_diagonals: uneven(turned(45.0)), [0.1; 2];
    uneven_triangles_along_diagonals: uneven(triangles(turned(45.0))), [0.12, 0.1];
    squares_turned_back: turned(-22.5), [0.1; 2];
    triangles_turned_back: triangles(turned(-22.5)), [0.1; 2];
    uneven_turned_back: uneven(turned(-22.5)), [0.1; 2];
    uneven_triangles_turned_back: uneven(triangles(turned(-22.5))), [0.12, 0.1];
    squares_along_other_diagonals: turned(-45.0), [0.1; 2];
    triangles_along_other_diagonals: triangles(turned(-45.0)), [0.1; 2];
    uneven_along_other_diagonals: uneven(turned(-45.0)), [0.1; 2];
    uneven_triangles_along_other_diagonals: uneven(triangles(turned(-45.0))), [0.12, 0.1];
});
