//! Inflation of a clamped circular membrane.

use droptower::simulate::Outcome;

use super::axisymmetric::{Sheet, root};
use super::claims::Claims;
use super::solve::runge_kutta;
use super::tower::{last, run, written};

/// Hencky's coefficients: Poisson's ratio and W of w0 = W a (q a/(E h))^(1/3) (Z. Math. Phys. 63, 1915).
const HENCKY: [[f64; 2]; 3] = [[0.2, 0.67744], [0.3, 0.65344], [0.4, 0.62626]];

/// W from Föppl's equations N″ = −3N′/r − 1/(8N²), w′ = −r/(2N) with a, q, E h = 1 and no radial displacement at the
/// clamp, (1−ν)N + N′ = 0.
fn coefficient(poisson: f64) -> f64 {
    let integrate = |pole: f64| {
        let steps = 4000;
        let step = 1.0 / f64::from(steps);
        let slope = |r: f64, [n, dn, _]: [f64; 3]| {
            let outward = if r == 0.0 { -1.0 / (32.0 * n * n) } else { -3.0 * dn / r - 0.125 / (n * n) };
            [dn, outward, 0.5 * r / n]
        };
        let mut y = [pole, 0.0, 0.0];
        for i in 0..steps {
            y = runge_kutta(&slope, step * f64::from(i), y, step);
        }
        y
    };
    let pole = root(
        |pole| {
            let [n, dn, _] = integrate(pole);
            (1.0 - poisson) * n + dn
        },
        2.0,
    );
    integrate(pole)[2]
}

const RADIUS: f64 = 0.05;
const YOUNG: f64 = 50e6;
const FILM: f64 = 50e-6;

/// Results of a disc under `load` = q a/(E h).
fn inflated(poisson: f64, load: f64, ramp: f64, element: &str) -> Outcome {
    let size = thorough::choose(6, 4);
    let pressure = load * YOUNG * FILM / RADIUS;
    run(&written(&format!(
        "specimen.shape = {{ circle = {{ radius = {RADIUS} }} }}
         specimen.material = {{ density = 915, thickness = {FILM}, elastic = {{ young = {YOUNG}, poisson = {poisson} }} }}
         specimen.mesh = {{ element = \"{element}\", size = \"{size} mm\" }}
         specimen.symmetry = \"quarter\"
         loading.pressure = {{ pressure = {pressure}, ramp = {ramp} }}
         output.frames = 2"
    )))
}

/// Height of the middle at the end, over the radius.
fn height(outcome: &Outcome) -> f64 {
    last(&outcome.signals, "deflection_m") / RADIUS
}

/// At a height of a twentieth of the radius strains are some 1e-3 and Hencky's equations hold within 0.3 %.
#[test]
fn deflection_of_a_clamped_disc_is_that_of_hencky() {
    let mut claims = Claims::of("inflation");
    for [poisson, coefficient] in HENCKY {
        let load = (0.05 / coefficient).powi(3);
        let outcome = inflated(poisson, load, 0.5, "quad4");
        let what = |claim: &str| format!("ν {poisson}, {claim}");
        claims.near(&what("W of w0 = W a (q a/(E h))^(1/3)"), height(&outcome) / load.cbrt(), coefficient, 1e-2);
        claims.at_most(&what("kinetic share"), outcome.kinetic_share.expect("a share"), 1e-2);
        claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
    }
}

/// Far above small strains: the membrane of revolution, integrated.
#[test]
fn a_clamped_disc_rises_as_the_membrane_of_revolution() {
    let mut claims = Claims::of("inflation, finite strain");
    let load = 0.3;
    for (element, poisson) in [("quad4", 0.44), ("quad4-full", 0.44), ("tri3", 0.2)] {
        let sheet = Sheet { young: YOUNG, poisson, thickness: FILM, wrinkling: false };
        let exact = sheet.inflated(RADIUS, RADIUS, load * YOUNG * FILM / RADIUS);
        let what = |claim: &str| format!("{element}, ν {poisson}, pole stretched {:.3}, {claim}", exact.stretch[0][0]);
        let outcome = inflated(poisson, load, 0.1, element);
        claims.near(&what("height over radius"), height(&outcome), exact.depth() / RADIUS, 1e-2);
        claims.at_most(&what("kinetic share"), outcome.kinetic_share.expect("a share"), 1e-2);
    }
}

#[test]
fn the_references_agree_with_one_another() {
    let mut claims = Claims::of("membranes of revolution");
    for [poisson, published] in HENCKY {
        claims.near(&format!("ν {poisson}, W by Föppl's equations"), coefficient(poisson), published, 1e-4);
        let sheet = Sheet { young: 1.0, poisson, thickness: 1.0, wrinkling: false };
        let pressure = 1e-7_f64;
        let large = sheet.inflated(1.0, 1.0, pressure).depth() / pressure.cbrt();
        claims.near(&format!("ν {poisson}, W at finite strain, small load"), large, published, 1e-4);
    }
}
