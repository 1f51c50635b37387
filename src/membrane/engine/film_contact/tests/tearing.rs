//! Faces that a sphere presses on each other while they tear.

use super::*;
use crate::engine::Torn;
use crate::material::{Criterion, Limit};

/// Γ, J/m².
const FRACTURE_ENERGY: f64 = 1e4;

/// A sphere at 6 m/s on two clamped squares with meshes that do not fit, 10 mm apart, of which those marked may tear.
/// Central differences err by the square of the step where elements lose their forces in a few steps: with the whole step
/// the largest error of the balance is 0.0056 of the energy exchanged.
fn check(may_tear: [bool; 2], step_factor: f64) {
    let films = [(square(0.2, 20, 0.0), 0.01, [0.0; 3]), (square(0.2, 20, 0.3), 0.0, [0.0; 3])];
    let rupture = Rupture { criterion: Criterion::Strain, limit: Limit::One(0.05), fracture_energy: FRACTURE_ENERGY };
    let scene = Scene {
        prestrain: 0.02,
        is_clamped: true,
        friction: 0.3,
        rupture: may_tear.map(|may| may.then(|| rupture.clone())).to_vec(),
        sphere: Some((0.03, 6.0, 0.5)),
        loads: Loads { step_factor, ..Loads::default() },
        ..Scene::default()
    };
    let mut run = scene.with(&films);
    let start = run.after(1);
    let (mut error, mut lowest) = (0.0_f64, f64::INFINITY);
    while run.engine.time() < 0.025 {
        let now = run.after(25);
        assert_eq!(now.crossings, 0, "at {} s: {:?}", run.engine.time(), now.contact);
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

#[test]
fn two_faces_that_tear_do_not_cross() {
    // With half the step two torn edges pass each other (docs/limits.md).
    check([true, true], 0.9);
}

#[test]
#[ignore = "x"]
fn measure_tearing() {
    for factor in [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.25] {
        let films = [(square(0.2, 20, 0.0), 0.01, [0.0; 3]), (square(0.2, 20, 0.3), 0.0, [0.0; 3])];
        let rupture =
            Rupture { criterion: Criterion::Strain, limit: Limit::One(0.05), fracture_energy: FRACTURE_ENERGY };
        let scene = Scene {
            prestrain: 0.02,
            is_clamped: true,
            friction: 0.3,
            rupture: vec![Some(rupture)],
            sphere: Some((0.03, 6.0, 0.5)),
            loads: Loads { step_factor: factor, ..Loads::default() },
            ..Scene::default()
        };
        let mut run = scene.with(&films);
        let start = run.after(1);
        let (mut error, mut distance, mut crossings, mut lost, mut first) = (0.0_f64, f64::INFINITY, 0, 0, None);
        while run.engine.time() < 0.025 {
            let now = run.after(25);
            crossings = crossings.max(now.crossings);
            if now.crossings > 0 && first.is_none() {
                first = Some((run.engine.time(), now.contact));
            }
            distance = distance.min(now.contact.distance);
            lost = now.contact.lost;
            error = error.max(now.balance_error(&start));
        }
        println!(
            "TEARING {factor}: crossings {crossings} lost {lost} distance/h {} error {error:e} first {first:?}",
            distance / THICKNESS
        );
    }
}

#[test]
fn a_face_that_tears_does_not_cross_the_one_below() {
    check([true, false], 0.5);
}

#[test]
fn a_face_that_tears_does_not_cross_the_one_above() {
    check([false, true], 0.5);
}
