//! Drops compared with equivalent ones: symmetry, element, orientation, mesh; and their energy balance.

use droptower::signal::Recording;

use super::claims::Claims;
use super::tower::{channel, impact, loading_of_1008, measured, peaks, run, shipped};

/// Both peaks of 1008 under `changes`.
fn peaks_under(changes: &[&str]) -> [f64; 2] {
    peaks(&impact(&loading_of_1008(changes)))
}

/// Compares both peaks of 1008 under `changes` with those under `reference`.
fn compare(claims: &mut Claims, what: &str, reference: &[&str], changes: &[&str], share: f64) {
    compare_with(claims, what, peaks_under(reference), changes, share);
}

/// Compares both peaks of 1008 under `changes` with these.
fn compare_with(claims: &mut Claims, what: &str, reference: [f64; 2], changes: &[&str], share: f64) {
    let found = peaks_under(changes);
    claims.near(&format!("{what}, peak displacement"), found[0], reference[0], share);
    claims.near(&format!("{what}, peak acceleration"), found[1], reference[1], share);
}

#[test]
fn symmetry_does_not_change_the_peaks() {
    let mut claims = Claims::of("symmetry");
    let size = thorough::choose("specimen.mesh.size=40mm", "specimen.mesh.size=10mm");
    let whole = peaks_under(&[size, "specimen.symmetry=none"]);
    for part in ["half-x", "half-y", "quarter"] {
        compare_with(&mut claims, part, whole, &[size, &format!("specimen.symmetry={part}")], 5e-3);
    }
}

#[test]
fn elements_agree() {
    let mut claims = Claims::of("elements");
    let size = thorough::choose("specimen.mesh.size=20mm", "specimen.mesh.size=10mm");
    let quads = peaks_under(&[size]);
    for (element, share) in [("quad4-full", 1e-2), ("tri3", 3e-2)] {
        compare_with(&mut claims, element, quads, &[size, &format!("specimen.mesh.element={element}")], share);
    }
}

#[test]
fn rotated_and_relabelled_films_have_the_same_peaks() {
    let mut claims = Claims::of("directions");
    let size = thorough::choose("specimen.mesh.size=20mm", "specimen.mesh.size=10mm");
    let long = r#"specimen.shape={ rectangle = ["400 mm", "320 mm"] }"#;
    let rotated = r#"specimen.shape={ rectangle = ["320 mm", "400 mm"] }"#;
    let peaks = peaks_under(&[size, long]);
    let changes = [size, rotated, "specimen.md_angle=90deg"];
    compare_with(&mut claims, "film and frame rotated", peaks, &changes, 1e-4);
    let swapped = [
        size,
        long,
        "specimen.md_angle=90deg",
        r#"specimen.material.fabric.md={ yield = [[0.33, "8 MPa"], [0.69, "10 MPa"]], break = [7.01, "16.2 MPa"] }"#,
        r#"specimen.material.fabric.td={ yield = [[0.26, "8.4 MPa"], [0.84, "20 MPa"]], break = [1.39, "29.3 MPa"] }"#,
        "layers.prestrain={ md = 0.0, td = 0.10 }",
    ];
    compare_with(&mut claims, "MD and TD swapped", peaks, &swapped, 1e-4);
}

#[test]
fn peaks_change_little_on_a_mesh_of_half_the_size() {
    let mut claims = Claims::of("mesh");
    compare(&mut claims, "10 mm against 20 mm", &["specimen.mesh.size=20mm"], &[], 2e-2);
    if thorough::thorough() {
        let short = ["output.frames=1", "loading.impact.duration=65ms"];
        let fine = [&short[..], &["specimen.mesh.size=5mm"]].concat();
        compare(&mut claims, "shipped 10 mm against 5 mm", &fine, &short, 2e-2);
    }
}

/// Energy is balanced, and D of the summary is that of the columns of energy.
#[test]
fn energy_is_balanced() {
    let mut claims = Claims::of("energy");
    for test in ["1008", "1509"] {
        let model = shipped(&format!("drop/{test}.toml"), &["specimen.mesh.size=20mm"]);
        let outcome = run(&model);
        claims.at_most(&format!("{test}, balance error"), outcome.energy_balance_error, 1e-3);
        let total = channel(&outcome.signals, "total_energy_J");
        let drift = total.iter().map(|e| (e / total[0] - 1.0).abs()).fold(0.0, f64::max);
        claims.at_most(&format!("{test}, drift of E_kp + work"), drift, 1e-3);
        let absorption = measured(&model, &outcome).first().energy_absorption.expect("a share");
        claims.near(&format!("{test}, D"), absorption, absorption_by_columns(&outcome.signals), 1e-9);
    }
}

/// D = 1 − ΔE_u/ΔE_l, from the columns of kinetic and potential energy before and after the lowest point.
fn absorption_by_columns(signals: &Recording) -> f64 {
    let [kinetic, potential, displacement] =
        ["kinetic_energy_J", "potential_energy_J", "displacement_m"].map(|name| channel(signals, name));
    let lowest = displacement.iter().copied().fold(f64::INFINITY, f64::min);
    let lowest_sample = displacement.iter().position(|d| *d == lowest).expect("a lowest point");
    let [mut fall, mut rise] = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for (sample, energy) in kinetic.iter().zip(potential).map(|(k, p)| k + p).enumerate() {
        let widen = |[least, most]: [f64; 2]| [least.min(energy), most.max(energy)];
        if sample <= lowest_sample {
            fall = widen(fall);
        }
        if sample >= lowest_sample {
            rise = widen(rise);
        }
    }
    1.0 - (rise[1] - rise[0]) / (fall[1] - fall[0])
}
