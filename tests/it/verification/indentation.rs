//! Slow indentation of a clamped circular film by a ball, against the membrane of revolution over an unknown circle of touch.

use std::f64::consts::PI;

use super::axisymmetric::{Shape, Sheet};
use super::claims::Claims;
use super::sheet::DENSITY;
use super::tower::{channel, loading_of_1008, run};

const RADIUS: f64 = 0.05;
const BALL: f64 = 0.02;
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

#[test]
fn a_ball_pressed_in_meets_the_force_of_the_membrane() {
    let mut claims = Claims::of("indentation");
    let changes = [
        format!("specimen.shape={{ circle = {{ radius = {RADIUS} }} }}"),
        format!(
            "specimen.material={{ density = {DENSITY}, thickness = {}, elastic = {{ young = {}, poisson = {} }} }}",
            FILM.thickness, FILM.young, FILM.poisson
        ),
        "specimen.mesh.size=2mm".to_owned(),
        "specimen.damping=500".to_owned(),
        "layers={ count = 1, faces = [0], prestrain = { md = 0, td = 0 } }".to_owned(),
        format!("impactor.shape.sphere.radius={BALL}"),
        "impactor.mass=1e3".to_owned(),
        "impactor.friction=0".to_owned(),
        "loading.impact.velocity=0.1".to_owned(),
        "loading.impact.gravity=0".to_owned(),
        "loading.impact.duration=180ms".to_owned(),
        "output.frames=2".to_owned(),
    ];
    let outcome = run(&loading_of_1008(&changes.iter().map(String::as_str).collect::<Vec<_>>()));
    let [pushed, place] = ["contact_force_N", "displacement_m"].map(|name| channel(&outcome.signals, name));
    for depth in [0.006, 0.01, 0.014, 0.017] {
        let sample = place.iter().position(|d| -d >= depth).expect("deep enough");
        let exact = FILM.indented(RADIUS, RADIUS, BALL + 0.5 * FILM.thickness, -place[sample]);
        let what = |claim: &str| format!("depth {:.0} mm, {claim}", 1e3 * depth);
        claims.holds(&what("taut"), &format!("least hoop stress {:.2e} Pa", exact.least_hoop), exact.least_hoop > 0.0);
        claims.near(&what("force, N"), pushed[sample], force(&exact, &FILM), 2e-2);
    }
    claims.judge();
}
