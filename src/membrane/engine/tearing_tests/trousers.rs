//! Trousers: a tear out of the plane of film.

use nalgebra::Point3;

use super::{cells, section};
use crate::engine::{Engine, Film, Jaw, Loads, Nodes, Section, Unobserved};
use crate::material::{Criterion, Hyperelastic, HyperelasticLaw, Law, Limit, Polynomial, Rupture};

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
/// at half of `speed` (m/s).
fn trousers(section: &Section, size: f64, [width, leg, body]: [f64; 3], speed: f64) -> Torn {
    let columns = (width / size).round() as u32 | 1;
    let (legs, bodies) = ((leg / size).round() as u32, (body / size).round() as u32);
    let along = |j: u32| (f64::from(j) - f64::from(bodies)) * size;
    let across = |i: u32| (f64::from(i) / f64::from(columns) - 0.5) * width;
    let mesh = cells(columns, legs + bodies, |i, j| Point3::new(across(i), along(j), 0.0));
    let mut nodes = Nodes::default();
    let mut film = Film::mount(&mesh, section, 0.0, &mut nodes).unwrap();
    film.cut(&nodes, &[[0.0, leg + size], [0.0, 0.0]]);
    let mut jaws = [-1.0, 1.0].map(|side| Jaw { nodes: vec![], velocity: 0.5 * side * speed });
    for n in 0..nodes.mass.len() {
        let [y, x, _] = nodes.position.value_at(n);
        let (jaw, side) = if y > 0.0 { (1, 1.0) } else { (0, -1.0) };
        nodes.position.set(n, if x < 0.0 { [0.0, y, x] } else { [side * x, y, 0.0] });
        if x > leg - 0.5 * size {
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
            return Torn { force, released, spent: torn.energy / torn.area, imbalance };
        }
        assert!(time < 2.0, "no tear");
    }
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

#[test]
fn the_force_on_torn_trousers_is_that_of_the_fracture_energy() {
    let (mu, energy, thickness, width) = (4e5, 1e4, 5e-4, 60e-3);
    let law = HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::neo_hookean(mu), wrinkling: true });
    let rubber = Section {
        law: Law::Hyperelastic(law),
        rupture: Some(Rupture { criterion: Criterion::Strain, limit: Limit::One(6.0), fracture_energy: energy }),
        thickness,
        density: 930.0,
        ..section()
    };
    let expected = trouser_force(mu, 0.5 * width * thickness, energy * thickness);
    for size in [5e-3, 2.5e-3] {
        let torn = trousers(&rubber, size, [width, 90e-3, 100e-3], 0.5);
        println!("{size} m: {torn:?} for {expected:.3} N");
        assert!((torn.force / expected - 1.0).abs() < 0.05, "{size} m: {torn:?}");
        assert!((torn.released / (energy * thickness) - 1.0).abs() < 0.05, "{size} m: {torn:?}");
        assert!((torn.spent / energy - 1.0).abs() < 0.05 && torn.imbalance < 0.01, "{size} m: {torn:?}");
    }
}
