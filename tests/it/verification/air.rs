//! Air between the faces of a drop test and with the film, and friction between faces.

use super::claims::Claims;
use super::tower::{channel, largest, run, shipped, written};

/// A drop test on a coarse mesh, up to its lowest point.
const COARSE: [&str; 3] = ["specimen.mesh.size=40mm", "output.frames=1", "loading.impact.duration=60ms"];

fn drop(changes: &[&str]) -> droptower::simulate::Outcome {
    run(&shipped("drop/1008.toml", &[&COARSE, changes].concat()))
}

/// Closed air presses on both faces and returns its work; through openings it leaves, through large ones without
/// resistance.
#[test]
fn air_between_the_faces_leaves_through_openings() {
    let mut claims = Claims::of("air between faces");
    let without = drop(&[]);
    let mut before = f64::INFINITY;
    for (vent, name) in [("0 m2", "closed"), ("20 cm2", "20 cm²"), ("400 cm2", "400 cm²"), ("40 m2", "open")] {
        let air = format!("air={{ cushion = \"adiabatic\", vent = \"{vent}\" }}");
        let outcome = drop(&[&air]);
        let pressure = largest(channel(&outcome.signals, "air_pressure_Pa"));
        claims.holds(&format!("{name}: largest pressure, Pa"), &format!("{pressure:.3}"), pressure < before);
        claims.at_most(&format!("{name}: balance error"), outcome.energy_balance_error, 1e-3);
        before = pressure;
        if name == "open" {
            let [with, without] = [&outcome, &without].map(|outcome| channel(&outcome.signals, "displacement_m"));
            let apart: Vec<f64> = with.iter().zip(without).map(|(a, b)| a - b).collect();
            claims.at_most("open: travel against that without air", largest(&apart) / largest(without), 1e-4);
        }
    }
}

/// Air that moves with the film has inertia, so that time steps are longer, and no weight, so that the film sags as
/// without it.
#[test]
fn added_mass_has_inertia_and_no_weight() {
    let mut claims = Claims::of("added mass");
    let slack = [
        "layers.faces=[\"0 mm\"]",
        "layers.prestrain.md=0.001",
        "layers.prestrain.td=0.001",
        "layers.count=1",
        "loading.impact.duration=1ms",
    ];
    // One layer of 12 um has 0.01098 kg/m².
    let outcomes = [&[][..], &["air.added_mass=0.03294"]].map(|air| drop(&[&slack[..], air].concat()));
    let [own, with] = &outcomes;
    claims.near("time step over that without air", with.time_step / own.time_step, 2.0, 0.02);
    let sag = |outcome: &droptower::simulate::Outcome| outcome.relaxation.as_ref().expect("held film").displacement;
    claims.near("sag, m", sag(with), sag(own), 1e-3);
}

/// Free faces fall each with the share of its own mass that is not air.
#[test]
fn each_face_falls_by_its_own_share_of_weight() {
    let mut claims = Claims::of("added mass of unequal faces");
    let layer = |height: f64, count: u32| format!("[[layer]]\nheight = {height}\ncount = {count}\n");
    let model = written(&format!(
        "specimen = {{ shape.rectangle = [0.2, 0.2], mesh.size = 0.02, material = {{ density = 1000, thickness = 10e-6, \
         elastic = {{ young = 1e8, poisson = 0.3 }} }} }}
         frame.hold = \"none\"
         air.added_mass = 0.1
         impactor = {{ shape.sphere.radius = 0.02, friction = 0.2, guide = \"fixed\", position = [0, 0, 1] }}
         loading.impact.duration = 0.02
         output = {{ frames = 2 }}
         {}{}",
        layer(0.0, 100),
        layer(-0.1, 5)
    ));
    let outcome = run(&model);
    let last = outcome.snapshots.last().expect("the end");
    for (film, (start, share)) in last.films.iter().zip([(0.0, 1.0 / 1.1), (-0.1, 0.05 / 0.15)]) {
        let fallen = start - f64::from(film.positions[0][2]);
        claims.near(&format!("face from {start} m: fall, m"), fallen, 0.5 * 9.81 * last.time * last.time * share, 1e-3);
    }
    claims.at_most("balance error", outcome.energy_balance_error, 1e-6);
}

/// Between faces the coefficient of the impactor applies unless another is given.
#[test]
fn faces_have_their_own_friction() {
    let mut claims = Claims::of("friction between faces");
    let [none, same, less] = [&[][..], &["contact.film_friction=0.4"], &["contact.film_friction=0.1"]]
        .map(|friction| channel(&drop(friction).signals, "displacement_m").to_vec());
    claims.holds("that of the impactor", "same bits", none == same);
    let deeper = largest(&less) / largest(&none) - 1.0;
    claims.holds("less friction lets the impactor travel farther", &format!("by {deeper:.2e}"), deeper > 0.0);
}
