//! Film that is mounted out of balance, brought to equilibrium before the test.

use droptower::simulate::Outcome;

use super::claims::Claims;
use super::solve::zero;
use super::tower::{channel, codes, run, written};

const THICKNESS: f64 = 12e-6;
const DENSITY: f64 = 915.0;
const MODULUS: f64 = 100e6;
const GRAVITY: f64 = 9.81;

/// Two layers with different angle and pre-strain, held on two sides, and a small ball at `x` (m).
fn two_layers(x: f64, guide: &str, settle: bool) -> Outcome {
    let fabric = "density = 915, thickness = 12e-6, fabric.md = { yield = [[0.26, 8.4e6], [0.84, 20e6]], break = [1.39, 29e6] }, \
                  fabric.td = { yield = [[0.33, 8e6], [0.69, 10e6]], break = [7.0, 16e6] }, \
                  fabric.shear.curve = [[0.3, 4e6], [1.5, 8e6]], fabric.absorption = 0.8896";
    let size = thorough::choose(0.006, 0.004);
    run(&written(&format!(
        "specimen.shape.rectangle = [0.06, 0.1]
         specimen.mesh.size = {size}
         specimen.material = {{ {fabric} }}
         frame.hold = [\"y-\", \"y+\"]
         impactor = {{ shape.sphere.radius = 0.01, mass = 0.05, friction = 0.2, guide = \"{guide}\", position = [{x}, 0.0] }}
         loading.impact = {{ velocity = 2.0, duration = 0.015 }}
         output.frames = 2
         [[layer]]
         count = 4
         settle = {settle}
         prestrain = {{ md = 0.05, td = 0.05 }}
         [[layer]]
         count = 4
         settle = {settle}
         height = -0.001
         md_angle = 0.5236
         prestrain = {{ md = 0.03, td = 0.0 }}"
    )))
}

/// What is reported of a fabric that hangs in equilibrium, strained in both directions by its weight and pre-strain.
const AT_REST: [&str; 3] = ["settled", "no-contact", "uncoupled-biaxial"];

#[test]
fn film_in_equilibrium_rests_until_it_is_hit() {
    let mut claims = Claims::of("equilibrium");
    let missed = two_layers(0.2, "z", true);
    let apart = |name: &str| {
        let values = channel(&missed.signals, name);
        let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
        (high - low) / high
    };
    for name in ["max_strain_md", "max_strain_td", "frame_force_y_N"] {
        claims.at_most(&format!("range of {name} of two layers at rest, over its value"), apart(name), 1e-3);
    }
    claims.at_most("residual", missed.relaxation.expect("held film").residual, 1e-6);
    claims.holds("a ball beside the film", &codes(&missed).join(", "), codes(&missed) == AT_REST);
    let free = two_layers(0.2, "free", true);
    claims.holds("the same without guide", &codes(&free).join(", "), codes(&free) == AT_REST);
    claims.at_most("energy balance of a miss, guided", missed.energy_balance_error, 1e-4);
    claims.at_most("energy balance of a miss, free", free.energy_balance_error, 1e-4);
    claims.at_most("energy balance of a hit", two_layers(0.0, "free", true).energy_balance_error, 1e-3);
}

#[test]
fn film_that_is_not_settled_moves_and_has_a_warning() {
    let mut claims = Claims::of("equilibrium, left out");
    let outcome = two_layers(0.2, "z", false);
    let found = codes(&outcome);
    claims.holds("as mounted", &found.join(", "), found.starts_with(&["not-in-equilibrium", "no-contact"]));
    let strains = channel(&outcome.signals, "max_strain_td");
    claims.holds("and the film moves", "", strains[10] > 1.2 * strains[0]);
}

/// Sag of a strip of unit width between two supports `span` (m) apart, with the pre-strain `strain`: the parabola whose
/// tension is that of its length, `ε = ε₀ + (8/3)(w/L)²` (of first order in `(w/L)²`).
fn sag(span: f64, strain: f64) -> f64 {
    let load = DENSITY * THICKNESS * GRAVITY / (1.0 + strain);
    let tension = |w: f64| MODULUS * THICKNESS * (strain + 8.0 / 3.0 * (w / span).powi(2));
    zero(0.0, 0.1 * span, |w| 8.0 * tension(w) * w / (span * span) - load)
}

#[test]
fn film_sags_under_its_weight() {
    let mut claims = Claims::of("equilibrium under the weight");
    for element in ["quad4", "quad4-full", "tri3"] {
        for strain in [0.0, 1e-4, 1e-3] {
            let outcome = run(&written(&format!(
                "specimen.shape.rectangle = [0.4, 0.1]
                 specimen.mesh = {{ element = \"{element}\", size = 0.01 }}
                 specimen.material = {{ density = {DENSITY}, thickness = {THICKNESS}, elastic = {{ young = {MODULUS}, poisson = 0.0 }} }}
                 layers.prestrain.md = {strain}
                 frame.hold = [\"x-\", \"x+\"]
                 impactor = {{ shape.sphere.radius = 0.01, mass = 0.05, friction = 0.2, position = [1.0, 0.0] }}
                 loading.impact = {{ velocity = 1.0, gravity = {GRAVITY}, duration = 0.002 }}
                 output.frames = 2"
            )));
            let relaxation = outcome.relaxation.expect("held film");
            let expected = sag(0.4, strain);
            let claim = format!("sag with pre-strain {strain}, {element}, m");
            claims.near(&claim, relaxation.displacement, expected, 5e-3);
            claims.at_most(&format!("{element}, {strain}: residual"), relaxation.residual, 1e-6);
        }
    }
}

#[test]
fn film_mounted_in_equilibrium_is_left_as_it_is() {
    let mut claims = Claims::of("equilibrium as mounted");
    let whole = |settle: bool| {
        run(&written(&format!(
            "specimen.shape.rectangle = [0.2, 0.2]
             specimen.mesh.size = 0.01
             specimen.material = {{ density = {DENSITY}, thickness = {THICKNESS}, elastic = {{ young = {MODULUS}, poisson = 0.3 }} }}
             layers = {{ prestrain.md = 0.05, settle = {settle} }}
             impactor = {{ shape.sphere.radius = 0.03, mass = 0.05, friction = 0.2 }}
             loading.impact = {{ velocity = 1.0, gravity = {GRAVITY}, duration = 0.005 }}
             output.frames = 2"
        )))
    };
    let [settled, mounted] = [true, false].map(whole);
    claims.holds("no steps", "", settled.relaxation.is_some_and(|relaxation| relaxation.steps == 0));
    let claim = "residual of uniform pre-strain under its weight";
    claims.at_most(claim, settled.relaxation.map_or(1.0, |r| r.mounted), 1e-3);
    claims.holds("the same bits", "", settled.signals == mounted.signals);
}

/// Modes of as few steps a period as the step bound allows end as the slow ones do: with elements of 5 mm, kinetic damping
/// that stops a step late takes 200 000 steps here.
#[test]
fn wrinkled_film_with_free_edges_settles_on_any_mesh() {
    let mut claims = Claims::of("equilibrium of wrinkled film with free edges");
    for size in [0.005, 0.006] {
        let outcome = run(&written(&format!(
            "specimen.shape.rectangle = [0.4, 0.4]
             specimen.mesh.size = {size}
             specimen.symmetry = \"quarter\"
             specimen.material = {{ density = 950, thickness = 0.5e-3, hyperelastic = {{ law = \"ogden\", mu = [0.63e6, 1200, -1e4], alpha = [1.3, 5.0, -2.0], wrinkling = true }} }}
             layers = {{ count = 8, prestrain.md = 0.1 }}
             frame.hold = [\"x-\", \"x+\"]
             impactor = {{ shape.sphere.radius = 0.12, mass = 10.72, friction = 0.4 }}
             loading.impact = {{ velocity = 4.0, gravity = {GRAVITY}, duration = 0.001 }}
             output.frames = 2"
        )));
        let relaxation = outcome.relaxation.expect("held film");
        claims.at_most(&format!("residual, {size} m"), relaxation.residual, 1e-6);
        claims.at_most(&format!("steps, {size} m"), relaxation.steps as f64, 4000.0);
    }
}
