//! The published outcomes: which films rupture, and how much energy they absorb.

use super::claims::Claims;
use super::scene::{Scene, observe_step};
use super::tower::{channel, measured, run, shipped};

/// Mean of the paper's Table 7 over both drop heights.
const ABSORPTION: f64 = 0.8896;

/// The six scenarios as they are shipped.
#[test]
fn only_1508_ruptures() {
    let mut claims = Claims::of("outcomes");
    for (test, breaks) in
        [("1008", false), ("1009", false), ("1010", false), ("1508", true), ("1509", false), ("1510", false)]
    {
        let model = shipped(&format!("drop/{test}.toml"), &["output.frames=1"]);
        let outcome = run(&model);
        let impact = measured(&model, &outcome);
        let result = outcome.rupture_time.map_or("held".to_owned(), |t| format!("ruptured at {:.1} ms", 1e3 * t));
        claims.holds(&format!("{test}, outcome"), &result, outcome.rupture_time.is_some() == breaks);
        claims.at_most(&format!("{test}, balance error"), outcome.energy_balance_error, 1e-3);
        if !breaks {
            let absorbed = impact.energy_absorption.expect("a rebound");
            claims.at_most(&format!("{test}, D = {absorbed:.4}, off the mean"), (absorbed - ABSORPTION).abs(), 0.03);
        }
    }
    claims.judge();
}

/// A sheet that breaks between its jaws: no force, all mass, its energy in the balance.
#[test]
fn a_failed_element_has_mass_but_no_force() {
    let mut claims = Claims::of("failed element");
    let model = shipped("stretch/md-0.02.toml", &["loading.stretch.until=1.45"]);
    let mut scene = Scene::stretched(&model, 0.02);
    let start = observe_step(&mut scene.engine, |view| view.nodes.mass.iter().sum::<f64>());
    let mut broken = 0;
    while broken == 0 {
        broken = scene.step();
    }
    let before = observe_step(&mut scene.engine, |view| view.energies().rupture);
    let [mass, force, volume] = observe_step(&mut scene.engine, |view| {
        let force = view.nodes.force.iter().flatten().map(f64::abs).fold(0.0, f64::max);
        let volume = view.films[0].strains(&view.nodes.position).iter().map(|s| s.volume).sum::<f64>();
        [view.nodes.mass.iter().sum(), force, volume]
    });
    let density_volume = 915.0 * 12e-6 * 5e-3 * 10e-3;
    claims.near("mass, kg", mass, density_volume, 1e-12);
    claims.near("mass against the start", mass, start, 1e-15);
    claims.at_most("force, N", force, 0.0);
    claims.at_most("volume that carries", volume, 0.0);
    let outcome = run(&model);
    let held = channel(&outcome.energies, "rupture_J");
    claims.near("energy stored at the break, J", held[held.len() - 1], before, 1e-2);
    claims.judge();
}
