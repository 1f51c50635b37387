//! Faces that a sphere presses on each other while they tear.

use super::*;
use crate::engine::Torn;
use crate::material::Criterion;

/// Γ, J/m².
const FRACTURE_ENERGY: f64 = 1e4;

/// A sphere at 6 m/s on two clamped squares with meshes that do not fit, 10 mm apart, of which those marked may tear.
fn tear(may_tear: [bool; 2], step_factor: f64) -> Run {
    let films = [(square(0.2, 20, 0.0), 0.01, [0.0; 3]), (square(0.2, 20, 0.3), 0.0, [0.0; 3])];
    let rupture = Rupture { criterion: Criterion::Strain, limit: 0.05, fracture_energy: FRACTURE_ENERGY };
    let scene = Scene {
        prestrain: 0.02,
        is_clamped: true,
        friction: 0.3,
        rupture: may_tear.map(|may| may.then_some(rupture)).to_vec(),
        sphere: Some((0.03, 6.0, 0.5)),
        loads: Loads { step_factor, ..Loads::default() },
        ..Scene::default()
    };
    scene.with(&films)
}

/// Each face that tears takes its energy. Central differences err by the square of the step where elements lose their forces in a few steps.
fn a_face_that_tears_does_not_cross_the_other(may_tear: [bool; 2], step_factor: f64) {
    let mut run = tear(may_tear, step_factor);
    let start = run.after(1);
    let (mut error, mut lowest) = (0.0_f64, f64::INFINITY);
    let end = thorough::choose(0.018, 0.025);
    while run.engine.time() < end {
        let now = run.after(25);
        assert!(now.crossings == 0, "{} at {} s: {:?}", now.crossings, run.engine.time(), now.contact);
        assert!(now.contact.distance > 0.7 * THICKNESS, "{:?}", now.contact);
        error = error.max(now.balance_error(&start));
        lowest = lowest.min(run.observe(|view| view.bodies().map(|body| body.centre().z).sum()));
    }
    let (torn, rupture) = run.observe(|view| {
        let torn: Vec<Torn> = view.films.iter().map(Film::torn).collect();
        (torn, view.energies().rupture)
    });
    println!("{may_tear:?}: balance {error:.1e}, sphere down to {lowest:.4} m, {rupture:.4} J, {torn:?}");
    assert!(error < 5e-3, "balance {error}");
    assert!(lowest < 0.0, "the sphere came below the second face as mounted: {lowest}");
    for (torn, may) in torn.iter().zip(may_tear) {
        assert_eq!(torn.length > 0.1, may, "{torn:?}");
        // An element takes the rest of its energy, up to a hundredth, with it.
        assert!((torn.energy - FRACTURE_ENERGY * torn.area).abs() <= 0.03 * torn.energy, "{torn:?}");
    }
    let taken: f64 = torn.iter().map(|torn| torn.energy).sum();
    assert!((taken / rupture - 1.0).abs() < 1e-9, "{taken} J for {rupture} J");
}

/// Largest number of pairs of triangles of two faces that tear which cross at a time, and how often contact was lost.
fn crossed(step_factor: f64) -> (usize, u64) {
    let mut run = tear([true, true], step_factor);
    let (mut most, mut lost) = (0, 0);
    while run.engine.time() < 0.025 {
        let now = run.after(25);
        (most, lost) = (now.crossings.max(most), now.contact.lost);
    }
    println!("steps {step_factor}: {most} cross, lost {lost} times");
    (most, lost)
}

/// A known limit: with some steps, torn edges of two faces that meet edge to edge pass each other, of which the run knows
/// only that contact was lost. With which ones depends on round-off: where none pass here, nothing has to be lost.
#[test]
fn torn_edges_pass_each_other_with_some_steps_and_are_reported_as_lost() {
    let mut count = 0;
    for step_factor in thorough::first(0, [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.25]) {
        let (most, lost) = crossed(step_factor);
        assert!(most <= 12 && (most == 0 || lost > 0), "{step_factor}: {most} {lost}");
        count += usize::from(most > 0);
    }
    // Which ones, and whether five or six, changes with the round-off.
    assert!(count <= 6, "{count} of nine cross");
}

// With a step in which torn edges of two faces do not pass each other.
thorough::cases!(a_face_that_tears_does_not_cross_the_other {
    both: [true, true], 0.95;
} thorough {
    upper: [true, false], 0.5;
    lower: [false, true], 0.5;
});
