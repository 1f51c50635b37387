//! When film starts to tear, against closed forms: patches that are strained evenly.

use nalgebra::Point3;

use super::{THICKNESS, YOUNG, cells, section};
use crate::engine::{Engine, Film, Jaw, Loads, Nodes, Section, Unobserved, View};
use crate::material::{Criterion, Elastic, Law, Rupture};

/// Edge of a patch of 2×2 elements, m.
const SIZE: f64 = 0.02;

/// How a patch is strained.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Straining {
    /// Along x by jaws; its sides are free.
    Uniaxial,
    /// As much along y as along x; all of its edge is moved.
    Equibiaxial,
}

/// A patch of elastic film and its rupture.
struct Patch {
    poisson: f64,
    straining: Straining,
    /// Strain along x, per s.
    rate: f64,
    rupture: Rupture,
}

impl Patch {
    /// The patch before the first step, between jaws on the left and on the right.
    fn mounted(&self) -> Engine {
        let law = Law::Elastic(Elastic { young: YOUNG, poisson: self.poisson });
        let section = Section { law, rupture: Some(self.rupture), ..section() };
        let place = |i: u32, j: u32| Point3::new(f64::from(i) - 1.0, f64::from(j) - 1.0, 0.0) * (0.5 * SIZE);
        let mesh = cells(2, 2, place);
        let mut nodes = Nodes::default();
        let film = Film::mount(&mesh, &section, 0.0, &mut nodes).unwrap();
        let across = if self.straining == Straining::Equibiaxial { self.rate } else { 0.0 };
        for n in 0..nodes.mass.len() {
            let [x, y, _] = nodes.position.value_at(n);
            nodes.velocity.set(n, [self.rate * x, across * y, 0.0]);
            let (on_jaw, on_side) = (x != 0.0, y != 0.0 && self.straining == Straining::Equibiaxial);
            nodes.hold([n], [on_jaw, on_jaw || on_side, true]);
        }
        let jaw = |column: u32, side: f64| Jaw {
            nodes: (0..3).map(|j| 3 * j + column).collect(),
            velocity: 0.5 * side * self.rate * SIZE,
        };
        let loads = Loads { jaws: vec![jaw(0, -1.0), jaw(2, 1.0)], step_factor: 0.1, ..Loads::default() };
        Engine::new(vec![film], nodes, [], loads)
    }

    /// Strain along x at which the first energy is lost, and how much it is off: forces fall in the second step after
    /// the one in which the limit is reached, and what is lost counts in the one after.
    fn start(&self) -> [f64; 2] {
        let mut engine = self.mounted();
        loop {
            let read = |view: &View<'_>| (view.time, view.energies().rupture);
            let (time, lost) = engine.read_step(read).unwrap();
            if lost > 0.0 {
                return [self.rate * time, 3.0 * self.rate * engine.time_step()];
            }
            assert!(self.rate * time < 0.2, "no tear");
        }
    }

    /// Compares the strain at which it starts to tear with the one that is expected.
    fn check(&self, expected: f64) {
        let [start, within] = self.start();
        println!("{:?} {} 1/s: {start:.6} for {expected:.6}", self.straining, self.rate);
        assert!(start >= expected - 1e-9 && start <= expected + within, "{start} for {expected} + {within}");
    }
}

/// The value at which a rising function reaches `limit`, between 0 and 0.2.
fn reached(limit: f64, of: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 0.2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle) < limit { low = middle } else { high = middle }
    }
    high
}

fn rupture(criterion: Criterion, limit: f64) -> Rupture {
    Rupture { criterion, limit, fracture_energy: 1e4 }
}

/// Green's strain.
fn green(strain: f64) -> f64 {
    0.5 * ((1.0 + strain).powi(2) - 1.0)
}

/// P = λ S with S = Y E in a uniaxial patch without Poisson's ratio and Y/(1 − ν) E in an equibiaxial one, and the energies
/// ½ Y E² and Y/(1 − ν) E².
#[test]
fn limits_of_stress_and_energy() {
    for (straining, poisson, directions) in [(Straining::Uniaxial, 0.0, 1.0), (Straining::Equibiaxial, 0.3, 2.0)] {
        let modulus = YOUNG / (1.0 - poisson);
        let patch = |criterion: Criterion, limit: f64| Patch {
            poisson,
            straining,
            rate: 5.0,
            rupture: rupture(criterion, limit),
        };
        let stress = |strain: f64| (1.0 + strain) * modulus * green(strain);
        patch(Criterion::Stress, 1e7).check(reached(1e7, stress));
        let energy = |strain: f64| 0.5 * directions * modulus * green(strain).powi(2);
        patch(Criterion::Energy, 3e5).check(reached(3e5, energy));
    }
}

/// All elements fail in one step, and what they stored is lost.
#[test]
fn without_fracture_energy_film_fails_at_once() {
    let rupture = Rupture { criterion: Criterion::Strain, limit: 0.05, fracture_energy: 0.0 };
    let patch = Patch { poisson: 0.0, straining: Straining::Uniaxial, rate: 5.0, rupture };
    let mut engine = patch.mounted();
    let start = engine.read_step(|view| view.energies()).unwrap();
    let mut failed = 0;
    while failed == 0 && patch.rate * engine.time() < 0.2 {
        failed = engine.step(&mut Unobserved).unwrap();
    }
    let (time, energies, torn) = engine.read_step(|view| (view.time, view.energies(), view.torn().unwrap())).unwrap();
    let stored = |strain: f64| 0.5 * YOUNG * green(strain).powi(2) * SIZE * SIZE * THICKNESS;
    assert_eq!(failed, 4);
    assert!(energies.rupture >= stored(0.05) && energies.rupture <= stored(patch.rate * time), "{energies:?}");
    assert_eq!(energies.stored, 0.0);
    assert!((torn.energy / energies.rupture - 1.0).abs() < 1e-12 && (torn.length / (2.0 * SIZE) - 1.0).abs() < 1e-12);
    assert!((energies.total() - start.total()).abs() < 1e-7 * energies.exchanged(&start), "{energies:?}");
}
