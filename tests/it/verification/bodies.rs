//! Bodies of any shape that start in any direction: closed forms, and the same run said in two ways.

use std::fs;

use super::claims::Claims;
use super::tower::{self, channel, last, run, written};
use droptower::simulate::Outcome;

const GRAVITY: f64 = 9.81;

/// A square film, pre-strained, under an impactor.
fn scene(impactor: &str, duration: &str, more: &str) -> Outcome {
    let impactor = impactor.replace('\n', " ");
    run(&written(&format!(
        "specimen.shape = {{ rectangle = [0.4, 0.4] }}
         specimen.material = {{ density = 915, thickness = 96e-6, elastic = {{ young = 50e6, poisson = 0.4, wrinkling = true }} }}
         specimen.mesh = {{ element = \"quad4\", size = \"10 mm\" }}
         {more}
         impactor = {{ friction = 0.3, {impactor} }}
         loading.impact = {{ {duration}, gravity = {GRAVITY} }}
         output = {{ frames = 2, filter = \"none\" }}"
    )))
}

const TAUT: &str = "layers.prestrain = { md = 0.02, td = 0.02 }";
const BALL: &str = "shape = { sphere = { radius = 0.08 } }, mass = 4.5";

/// Largest difference of a channel of two runs, over the largest value of the second.
fn off(name: &str, runs: [&Outcome; 2]) -> f64 {
    let [one, other] = runs.map(|outcome| channel(&outcome.signals, name));
    tower::off(one, other)
}

#[test]
fn the_same_run_said_in_two_ways() {
    let mut claims = Claims::of("bodies");
    let down = |impactor: &str| scene(impactor, "velocity = 3, duration = 0.03", TAUT);
    let reference = down(BALL);
    let cases = [
        ("velocity as a vector", scene(&format!("{BALL}, velocity = [0, 0, -3]"), "duration = 0.03", TAUT)),
        ("a line along z", down(&format!("{BALL}, guide = {{ line = [0, 0, 2] }}"))),
        ("a hinge far away", {
            let hinge = "guide = { hinge = { axis = [0, 1, 0], at = [-3e4, 0, 0] } }, spin = [0, 1e-4, 0]";
            scene(&format!("{BALL}, {hinge}"), "duration = 0.03", TAUT)
        }),
        (
            "a compound of one part",
            down("shape = { compound = [{ shape = { sphere = { radius = 0.08 } }, at = [1, 2, 3] }] }, mass = 4.5"),
        ),
    ];
    for (name, outcome) in &cases {
        // The path of the hinge is a circle: its sagitta over 3e4 m is below 1e-6 of the depth.
        let bound = if name.starts_with("a hinge") { 1e-4 } else { 1e-9 };
        for column in ["displacement_m", "contact_force_N"] {
            let claim = format!("{name}, {column} off that of `guide = \"z\"`");
            claims.at_most(&claim, off(column, [outcome, &reference]), bound);
        }
    }
    // Elements meet the edges of a box one by one, and round-off decides when.
    let block = |size: [f64; 3], more: &str| {
        down(&format!("shape = {{ box = {{ size = {size:?}, edge = 0.02 }} }}, mass = 2{more}"))
    };
    let lying = block([0.1, 0.06, 0.14], ", orientation = { axis = [1, 0, 0], angle = \"90 deg\" }");
    let figure = off("displacement_m", [&lying, &block([0.1, 0.14, 0.06], "")]);
    claims.at_most("a box laid on its side, displacement_m off that of the same box said so", figure, 1e-4);
}

/// An octahedron in mm and the same in m.
#[test]
fn a_mesh_has_a_unit() {
    let mut claims = Claims::of("bodies");
    let folder = tempfile::tempdir().expect("a folder");
    let shape = |name: &str, size: f64, keys: &str| {
        let corners = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
        let mut text: String = corners
            .map(|c| {
                format!(
                    "v {} {} {}\n",
                    c.map(|x| size * f64::from(x))[0],
                    size * f64::from(c[1]),
                    size * f64::from(c[2])
                )
            })
            .concat();
        for face in ["1 3 5", "3 2 5", "2 4 5", "4 1 5", "3 1 6", "2 3 6", "4 2 6", "1 4 6"] {
            text += &format!("f {face}\n");
        }
        let path = folder.path().join(name);
        fs::write(&path, text).expect("a file");
        format!("shape = {{ mesh = {{ file = {:?}, {keys} }} }}, mass = 2", path.display().to_string())
    };
    let fall = |impactor: &str| scene(impactor, "velocity = 1, duration = 0.02", TAUT);
    let metres = fall(&shape("m.obj", 0.08, "scale = 1"));
    for (name, other) in [
        ("mm", fall(&shape("mm.obj", 80.0, "unit = \"mm\""))),
        ("half as large, scaled by two", fall(&shape("half.obj", 0.04, "scale = 2"))),
    ] {
        let claim = format!("octahedron, {name}, contact force off that in m");
        claims.at_most(&claim, off("contact_force_N", [&other, &metres]), 1e-9);
    }
}

/// An inclined, spinning box beside the film.
#[test]
fn a_body_in_flight_is_in_free_fall() {
    let mut claims = Claims::of("bodies");
    let start = [0.5, -0.3, 2.0];
    let outcome = scene(
        &format!(
            "shape = {{ box = {{ size = [0.1, 0.06, 0.04], edge = 0.005 }} }}, mass = 2, guide = \"free\", position = [1, 1, 1],
             orientation = {{ axis = [1, 1, 0], angle = \"20 deg\" }}, velocity = {start:?}, spin = [3, -5, 2]"
        ),
        "duration = 0.1",
        TAUT,
    );
    let time = 0.1;
    for (name, expected) in [
        ("displacement_x_m", start[0] * time),
        ("displacement_y_m", start[1] * time),
        ("displacement_m", start[2] * time - 0.5 * GRAVITY * time * time),
        ("velocity_x_m_s", start[0]),
        ("velocity_m_s", start[2] - GRAVITY * time),
        ("acceleration_resultant_m_s2", GRAVITY),
    ] {
        claims.near(&format!("in flight, {name}"), last(&outcome.signals, name), expected, 1e-7);
    }
    let energies = channel(&outcome.signals, "total_energy_J");
    let range = energies.iter().copied().fold(0.0_f64, |most, energy| most.max((energy - energies[0]).abs()));
    claims.at_most("in flight, change of kinetic and potential energy over the first", range / energies[0], 1e-6);
}
