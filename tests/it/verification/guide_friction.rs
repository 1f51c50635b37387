//! Friction of the guide: closed forms, energy, and what it does to the energy absorption.

use super::claims::Claims;
use super::tower::{channel, last, loading_of_1008, measured, off, run, written};

/// A taut disc under the flat end of a cylinder: a linear spring while the deflection is small.
const SPEED: f64 = 0.1;
const MASS: f64 = 5.0;

fn bounce(friction: &str) -> droptower::model::Model {
    written(&format!(
        "specimen.shape = {{ circle = {{ radius = 0.3 }} }}
         specimen.material = {{ density = 900, thickness = 50e-6, elastic = {{ young = 200e6, poisson = 0.4 }} }}
         specimen.mesh = {{ element = \"quad4\", size = \"20 mm\" }}
         specimen.symmetry = \"quarter\"
         layers.prestrain = {{ md = 0.05, td = 0.05 }}
         impactor = {{ shape = {{ cylinder = {{ radius = 0.1, length = 0.2 }} }}, mass = {MASS}, friction = 0.0{friction} }}
         loading.impact = {{ velocity = {SPEED}, gravity = 0, duration = \"250 ms\" }}
         output = {{ frames = 2, filter = \"none\" }}"
    ))
}

/// Depth at the turning point by the balance of energy: the film takes at a depth what it takes there without friction,
/// so that `F d` is the energy that the body has left at `d` then. The rim is met between the nodes, so that the
/// balance is that of a body with edges.
#[test]
fn a_guide_takes_its_force_over_the_path() {
    let mut claims = Claims::of("guide friction");
    let free = run(&bounce(""));
    let depth = |outcome: &droptower::simulate::Outcome| {
        -channel(&outcome.signals, "displacement_m").iter().copied().fold(f64::INFINITY, f64::min)
    };
    let (path, speed) = (channel(&free.signals, "displacement_m"), channel(&free.signals, "velocity_m_s"));
    // What is left over at each depth on the way down, for a guide of `force`.
    let turning = |force: f64| {
        let left = |k: usize| 0.5 * MASS * speed[k] * speed[k] + force * path[k];
        let k = (1..path.len()).find(|k| left(*k) < 0.0).expect("a turning point");
        let share = left(k - 1) / (left(k - 1) - left(k));
        -(path[k - 1] + share * (path[k] - path[k - 1]))
    };
    for force in [1.0, 2.0] {
        let model = bounce(&format!(", guide_friction = {{ constant = {force} }}"));
        let outcome = run(&model);
        claims.near(&format!("depth with {force} N, m"), depth(&outcome), turning(force), 1e-3);
        let place = channel(&outcome.signals, "displacement_m");
        let path: f64 = place.windows(2).map(|z| (z[1] - z[0]).abs()).sum();
        let taken = last(&outcome.energies, "guide_J");
        claims.near(&format!("energy of the guide with {force} N, J"), taken, force * path, 1e-3);
        claims.at_most(&format!("energy balance error with {force} N"), outcome.energy_balance_error, 3e-4);
        claims.at_most("energy balance error without", free.energy_balance_error, 3e-4);
        let impact = measured(&model, &outcome);
        let [all, film] =
            [impact.first().energy_absorption, impact.first().film_energy_absorption].map(|d| d.expect("a rebound"));
        let claim = "absorption with guide, of the film";
        claims.holds(claim, &format!("{all:.4}, {film:.4}"), film.abs() < 0.05 && all > film + 0.02);
    }
    assert!(channel(&free.energies, "guide_J").iter().all(|energy| *energy == 0.0));
}

/// A curve that is straight through c + k |v| is that friction, up to what contact at the rim makes of round-off.
#[test]
fn a_curve_of_the_friction_is_the_same_as_its_two_numbers() {
    let mut claims = Claims::of("guide friction");
    let two = run(&bounce(", guide_friction = { constant = 1, per_speed = 5 }"));
    let curve = run(&bounce(", guide_friction = { curve = [[0, 1], [0.05, 1.25], [0.2, 2]] }"));
    for (column, of) in [("displacement_m", true), ("guide_J", false)] {
        let [a, b] = [&two, &curve].map(|run| channel(if of { &run.signals } else { &run.energies }, column));
        claims.at_most(&format!("{column} with a curve off that with two numbers"), off(b, a), 1e-7);
    }
}

/// The friction holds an impactor whose weight and spring force are smaller than it.
#[test]
fn an_impactor_that_stops_is_held() {
    let mut claims = Claims::of("guide friction");
    let outcome = run(&bounce(", guide_friction = { constant = 400 }"));
    let place = channel(&outcome.signals, "displacement_m");
    let stopped = place[place.len() / 2];
    let moved = place[place.len() / 2..].iter().map(|z| (z - stopped).abs()).fold(0.0, f64::max);
    claims.at_most("motion after the stop over the depth", moved / stopped.abs(), 1e-9);
    claims.at_most("energy balance error", outcome.energy_balance_error, 1e-6);
}

/// Friction that is proportional to the speed, on the drop tower of 1008.
#[test]
fn the_energy_balance_holds_with_friction_of_the_speed() {
    let mut claims = Claims::of("guide friction");
    let changes = ["impactor.guide_friction.constant=8 N", "impactor.guide_friction.per_speed=1 N s/m"];
    let with = loading_of_1008(&[&changes[..], &["specimen.mesh.size=20mm"]].concat());
    let without = run(&loading_of_1008(&["specimen.mesh.size=20mm"]));
    let outcome = run(&with);
    let bound = without.energy_balance_error + 1e-6;
    claims.at_most("energy balance error, in excess of that without", outcome.energy_balance_error - bound, 0.0);
}
