//! Slow indentation of a clamped circular film by a ball, against the membrane of revolution over an unknown circle of touch.

use std::f64::consts::PI;

use droptower::simulate::Outcome;

use super::axisymmetric::{Shape, Sheet};
use super::claims::Claims;
use super::tower::{channel, run, written};

const RADIUS: f64 = 0.05;
const BALL: f64 = 0.02;
/// m, at the end.
const DEPTH: f64 = 0.017;
const FILM: Sheet = Sheet { young: 50e6, poisson: 0.44, thickness: 50e-6 };

/// Force on the ball, N.
fn force(shape: &Shape, film: &Sheet) -> f64 {
    2.0 * PI * film.thickness * shape.shear
}

/// Without radial displacement a point load F and the depth δ obey F = (π/3) E h δ³/a² at ν = 1/3
/// (E. Schwerin, Z. Angew. Math. Mech. 9, 1929).
#[test]
fn a_small_ball_is_a_point_load() {
    let mut claims = Claims::of("membrane under a ball");
    let film = Sheet { young: 1.0, poisson: 1.0 / 3.0, thickness: 1.0 };
    let depth = 0.02;
    let shape = film.indented(1.0, 1.0, 1e-4, depth);
    claims.near("F a²/(E h δ³), ν 1/3", force(&shape, &film) / depth.powi(3), PI / 3.0, 1e-2);
    claims.judge();
}

/// Farthest that a node is off the membrane of revolution at the end, over the depth.
fn off(outcome: &Outcome, exact: &Shape) -> f64 {
    let [before, after] = [0, 1].map(|frame| &outcome.frames[frame].films[0].positions);
    let apart = |(before, after): (&[f32; 3], &[f32; 3])| {
        let [r, z] = exact.at(f64::from(before[0].hypot(before[1])));
        (f64::from(after[0].hypot(after[1])) - r).hypot(f64::from(after[2]) - z)
    };
    before.iter().zip(after).map(apart).fold(0.0, f64::max) / exact.depth()
}

#[test]
fn a_ball_pressed_in_meets_the_force_of_the_membrane() {
    let mut claims = Claims::of("indentation");
    for element in ["quad4", "quad4-full", "tri3"] {
        let outcome = run(&written(&format!(
            "specimen.shape = {{ circle = {{ radius = {RADIUS} }} }}
             specimen.material = {{ density = 915, thickness = {}, elastic = {{ young = {}, poisson = {} }} }}
             specimen.mesh = {{ element = \"{element}\", size = \"2.5 mm\" }}
             specimen.symmetry = \"quarter\"
             impactor.shape.sphere.radius = {BALL}
             impactor.friction = 0.0
             loading.indent = {{ depth = {DEPTH}, velocity = 0.2 }}
             output.frames = 2",
            FILM.thickness, FILM.young, FILM.poisson
        )));
        let [pushed, place] = ["force_N", "depth_m"].map(|name| channel(&outcome.signals, name));
        let mut exact = Shape::default();
        for share in [0.4, 0.7, 1.0] {
            let sample = (share * (place.len() - 1) as f64) as usize;
            exact = FILM.indented(RADIUS, RADIUS, BALL + 0.5 * FILM.thickness, place[sample]);
            let what = |claim: &str| format!("{element}, {:.1} mm deep, {claim}", 1e3 * place[sample]);
            claims.near(&what("force, N"), pushed[sample], force(&exact, &FILM), 2e-2);
        }
        claims.holds("the membrane is taut", &format!("{:.2e} Pa at least", exact.least_hoop), exact.least_hoop > 0.0);
        claims.at_most(&format!("{element}, places off over the depth"), off(&outcome, &exact), 1e-2);
        claims.at_most(&format!("{element}, kinetic share"), outcome.kinetic_share.expect("a share"), 1e-2);
    }
    claims.judge();
}
