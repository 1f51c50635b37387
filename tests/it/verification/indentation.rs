//! Slow indentation of a clamped circular film by a ball, compared with the membrane of revolution with an unknown
//! contact circle.

use std::f64::consts::PI;

use droptower::simulate::Outcome;

use super::axisymmetric::{Shape, Sheet};
use super::claims::Claims;
use super::tower::{channel, run, written};

const RADIUS: f64 = 0.05;
const BALL: f64 = 0.02;
/// m, at the end.
const DEPTH: f64 = 0.017;
const TAUT: Sheet = Sheet { young: 50e6, poisson: 0.44, thickness: 50e-6, wrinkling: false };
const WRINKLED: Sheet = Sheet { wrinkling: true, ..TAUT };
/// Pre-strain of the wrinkled film: it is longer than its clamp is wide, so that its hoops would be pressed.
const SLACK: f64 = -0.02;

/// Force on the ball, N.
fn force(shape: &Shape, film: &Sheet) -> f64 {
    2.0 * PI * film.thickness * shape.shear
}

/// Without radial displacement a point load F and the depth δ obey F = (π/3) E h δ³/a² at ν = 1/3
/// (E. Schwerin, Z. Angew. Math. Mech. 9, 1929).
#[test]
fn a_small_ball_is_a_point_load() {
    let mut claims = Claims::of("membrane under a ball");
    let film = Sheet { young: 1.0, poisson: 1.0 / 3.0, thickness: 1.0, wrinkling: false };
    let depth = 0.02;
    let shape = film.indented(1.0, 1.0, 1e-4, depth);
    claims.near("F a²/(E h δ³), ν 1/3", force(&shape, &film) / depth.powi(3), PI / 3.0, 1e-2);
}

/// Farthest that a node is off the membrane of revolution at the end, over the depth; `mounted` is the stretch at the
/// start.
fn off(outcome: &Outcome, exact: &Shape, mounted: f64) -> f64 {
    let [before, after] = [0, 1].map(|snapshot| &outcome.snapshots[snapshot].films[0].positions);
    let apart = |(before, after): (&[f32; 3], &[f32; 3])| {
        let [r, z] = exact.at(f64::from(before[0].hypot(before[1])) / mounted);
        (f64::from(after[0].hypot(after[1])) - r).hypot(f64::from(after[2]) - z)
    };
    before.iter().zip(after).map(apart).fold(0.0, f64::max) / exact.depth()
}

#[test]
fn force_and_shape_are_those_of_the_membrane_of_revolution() {
    let mut claims = Claims::of("indentation");
    let films = [("quad4", TAUT), ("tri3", WRINKLED), ("quad4-full", TAUT), ("tri3", TAUT), ("quad4", WRINKLED)];
    for (element, film) in thorough::first(2, films) {
        let what = |claim: &str| format!("{element}, {}, {claim}", if film.wrinkling { "wrinkled" } else { "taut" });
        let prestrain = if film.wrinkling { SLACK } else { 0.0 };
        let size = thorough::choose(4.0, 2.5);
        let outcome = run(&written(&format!(
            "specimen.shape = {{ circle = {{ radius = {RADIUS} }} }}
             specimen.material = {{ density = 915, thickness = {}, elastic = {{ young = {}, poisson = {}, wrinkling = {} }} }}
             specimen.mesh = {{ element = \"{element}\", size = \"{size} mm\" }}
             specimen.symmetry = \"quarter\"
             layers.prestrain = {{ md = {prestrain}, td = {prestrain} }}
             impactor.shape.sphere.radius = {BALL}
             impactor.friction = 0.0
             loading.indent = {{ depth = {DEPTH}, velocity = 0.2 }}
             output.frames = 2",
            film.thickness, film.young, film.poisson, film.wrinkling
        )));
        let [pushed, place] = ["force_N", "depth_m"].map(|name| channel(&outcome.signals, name));
        let own = RADIUS / (1.0 + prestrain);
        let mut exact = Shape::default();
        for share in if film.wrinkling { [0.7, 0.85, 1.0] } else { [0.4, 0.7, 1.0] } {
            let sample = (share * (place.len() - 1) as f64) as usize;
            exact = film.indented(own, RADIUS, BALL + 0.5 * film.thickness, place[sample]);
            let at = what(&format!("{:.1} mm deep", 1e3 * place[sample]));
            claims.near(&format!("{at}, force, N"), pushed[sample], force(&exact, &film), 2e-2);
        }
        let hoop = exact.least_hoop;
        let claim = what("hoop stress without wrinkles");
        claims.holds(&claim, &format!("{hoop:.2e} Pa at least"), (hoop < 0.0) == film.wrinkling);
        claims.at_most(&what("places off over the depth"), off(&outcome, &exact, 1.0 + prestrain), 1e-2);
        claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
        claims.at_most(&what("kinetic share"), outcome.kinetic_share.expect("a share"), 1e-2);
    }
}
