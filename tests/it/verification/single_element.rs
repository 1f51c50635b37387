//! One element between two jaws follows its curve at every speed.

use std::f64::consts::FRAC_PI_2;

use droptower::simulate::{self, Across, Outcome};

use super::claims::Claims;
use super::solve::line;
use super::tower::{channel, last, run, shipped};

/// The printed points of the paper's Tables 4 and 5: strain, stress (Pa).
const MD: [[f64; 2]; 3] = [[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]];
const TD: [[f64; 2]; 3] = [[0.33, 8e6], [0.69, 10e6], [7.01, 16.2e6]];
/// The assumed shear curve, scenarios/materials/lldpe-shear.csv: angle, stress (Pa).
const SHEAR: [[f64; 2]; 3] = [[0.2727, 4.73e6], [0.8, 8.66e6], [1.4, 9.5e6]];

/// Largest difference of the run's stress from `law`, over the law's stress, between two strains.
fn deviation(outcome: &Outcome, law: impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> f64 {
    let strain = channel(&outcome.signals, "strain");
    let stress = channel(&outcome.signals, "stress_Pa");
    let between = strain.iter().zip(stress).filter(|(e, _)| **e >= from && **e <= to);
    between.map(|(e, s)| (s / law(*e) - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn an_element_follows_its_curve_and_breaks_at_its_end() {
    let mut claims = Claims::of("single element");
    for (name, curve, until) in [("md", MD, 1.45), ("td", TD, 7.1)] {
        for speed in ["0.0002", "0.02", "0.2"] {
            let what = |claim: &str| format!("{name} at {speed} m/s, {claim}");
            let model = shipped(&format!("stretch/{name}-{speed}.toml"), &[&format!("loading.stretch.until={until}")]);
            let outcome = run(&model);
            let end = curve[2][0];
            let strain = channel(&outcome.signals, "strain");
            let sample = strain[1] - strain[0];
            let followed = deviation(&outcome, |e| line(&curve, e), [0.005, end - sample]);
            claims.at_most(&what("stress off its curve"), followed, 1e-3);
            let rate = speed.parse::<f64>().expect("a speed") / 0.005;
            let broke = outcome.rupture_time.expect("a break") * rate;
            claims.at_most(&what("samples from the break strain"), (broke - end).abs() / sample, 1.0);
            claims.at_most(&what("stress after the break, Pa"), last(&outcome.signals, "stress_Pa").abs(), 1e-9);
            claims.at_most(&what("kinetic share"), outcome.kinetic_share.expect("a share"), 1e-2);
            claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
        }
    }
}

/// With all nodes in the jaws the element's gradient is diag(1 + e, 1). Fibres at ±45° both have the stretch
/// λ = √((1 + (1+e)²)/2) and close up by the angle γ = 2 atan(1+e) − π/2, so that the force over the stress-free
/// section, the derivative of the energy by e, is (σ_md + σ_td)(1+e)/(2λ) + 2τ(γ)/(1 + (1+e)²).
fn oblique(e: f64) -> f64 {
    let along = 1.0 + e;
    let stretch = (0.5 * (1.0 + along * along)).sqrt();
    let angle = 2.0 * along.atan() - FRAC_PI_2;
    let fibres = line(&MD, stretch - 1.0) + line(&TD, stretch - 1.0);
    fibres * along / (2.0 * stretch) + 2.0 * line(&SHEAR, angle) / (1.0 + along * along)
}

#[test]
fn at_45_degrees_the_force_is_that_of_the_closed_form() {
    let mut claims = Claims::of("single element, 45 deg");
    for speed in ["0.0002", "0.02", "0.2"] {
        let outcome = run(&shipped(&format!("stretch/45deg-{speed}.toml"), &[]));
        let what = |claim: &str| format!("{speed} m/s, {claim}");
        claims.at_most(&what("force off the closed form"), deviation(&outcome, oblique, [0.005, 0.4]), 1e-3);
        claims.at_most(&what("kinetic share"), outcome.kinetic_share.expect("a share"), 1e-2);
        claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
    }
}

/// An elastic film in place of the shipped fabric.
const ELASTIC: &str =
    "specimen.material={ density = 915, thickness = 12e-6, elastic = { young = 50e6, poisson = 0.44 } }";

/// Quasi-static equilibrium compared with a run, which has inertia and a time step; with curves by strain rate, at the
/// rate of the jaws.
#[test]
fn the_quasi_static_stress_is_that_of_the_run() {
    let mut claims = Claims::of("single element, quasi-static");
    for (name, changes, to) in [
        ("md-0.02", &[][..], 1.39),
        ("td-0.02", &[], 7.01),
        ("45deg-0.02", &[], 0.4),
        ("45deg-0.02", &[r#"specimen.mesh.element="tri3""#], 0.4),
        ("md-0.02", &[ELASTIC], 1.0),
        ("md-0.02", &[ELASTIC, r#"specimen.mesh.element="quad4-full""#], 1.0),
        ("rates", &["loading.stretch.velocity=0.002", r#"output.sample_rate="200 Hz""#], 1.39),
        ("rates", &["loading.stretch.velocity=0.3"], 0.75),
        ("rates", &["loading.stretch.velocity=0.3", r#"loading.stretch.direction="TD""#], 1.39),
    ] {
        let model = shipped(&format!("stretch/{name}.toml"), changes);
        let outcome = run(&model);
        let [strains, stress] = ["strain", "stress_Pa"].map(|name| channel(&outcome.signals, name));
        let pulled = simulate::pull(&model, strains, Across::Held).expect("a pull");
        let samples = strains.iter().zip(stress.iter().zip(&pulled)).filter(|(e, _)| (0.005..=to - 0.01).contains(*e));
        let apart = samples.map(|(_, (run, pulled))| (run / pulled - 1.0).abs()).fold(0.0, f64::max);
        let what = format!("{name} {}", changes.join(" "));
        claims.at_most(&format!("{what}, stress of the run off the quasi-static one"), apart, 1e-3);
    }
}

/// St. Venant–Kirchhoff in plane stress: P = E* (1+e)(e + e²/2), with E* = E/(1−ν²) where the width is held and E where
/// it is free.
#[test]
fn quasi_static_stress_of_elastic_film_has_the_closed_form() {
    let mut claims = Claims::of("single element, elastic");
    let model = shipped("stretch/single-element.toml", &[ELASTIC]);
    let strains: Vec<f64> = (0..=60).map(|k| 0.01 * f64::from(k)).collect();
    for (across, modulus) in [(Across::Held, 50e6 / (1.0 - 0.44 * 0.44)), (Across::Free, 50e6)] {
        let pulled = simulate::pull(&model, &strains, across).expect("a pull");
        let exact = strains.iter().map(|e| modulus * (1.0 + e) * (e + 0.5 * e * e));
        let apart = exact.zip(&pulled).map(|(exact, found)| (exact - found).abs()).fold(0.0, f64::max);
        claims.at_most(&format!("width {across:?}, stress off over E"), apart / modulus, 1e-8);
    }
}

/// A long strip of fabric at an angle to its fibres, whose film shears: the element with free sides against a mesh of
/// 60 by 5 mm between jaws; and at a small strain 1/E = cos⁴/E₁ + sin⁴/E₂ + cos² sin²/G.
#[test]
fn a_strip_at_an_angle_is_that_of_a_long_mesh() {
    let mut claims = Claims::of("single element, strip at an angle");
    let free = "specimen.material.fabric.absorption=0";
    for angle in [15, 45, 75] {
        let direction = format!("loading.stretch.direction=\"{angle} deg\"");
        let long = [
            direction.as_str(),
            free,
            "specimen.shape={ rectangle = [\"60 mm\", \"5 mm\"] }",
            "specimen.mesh.size=\"1.25 mm\"",
            "loading.stretch.velocity=\"0.06 m/s\"",
            "loading.stretch.until=0.2",
        ];
        let outcome = run(&shipped("stretch/single-element.toml", &long));
        let [strains, stresses] = ["strain", "stress_Pa"].map(|name| channel(&outcome.signals, name));
        let element = shipped("stretch/single-element.toml", &[&direction, free]);
        let (last, stress) = (strains[strains.len() - 1], stresses[stresses.len() - 1]);
        let pulled = simulate::pull(&element, &[last], Across::Strip).expect("a pull")[0];
        claims.at_most(&format!("{angle} degrees, mesh off the element"), (stress / pulled - 1.0).abs(), 2e-3);
    }
    // 8.4 MPa at 0.26, 8 MPa at 0.33 and the first point of the shear curve.
    let shear = 17.4e6;
    for angle in [10_i32, 22, 45, 67, 80] {
        let direction = format!("loading.stretch.direction=\"{angle} deg\"");
        let straight = format!("specimen.material.fabric.shear.curve=[[1, {shear}]]");
        let model = shipped("stretch/single-element.toml", &[&direction, free, &straight]);
        let found = simulate::pull(&model, &[1e-6], Across::Strip).expect("a pull")[0] / 1e-6;
        let (sine, cosine) = f64::from(angle).to_radians().sin_cos();
        let compliance = cosine.powi(4) * 0.26 / 8.4e6 + sine.powi(4) * 0.33 / 8e6 + (sine * cosine).powi(2) / shear;
        claims.at_most(&format!("{angle} degrees, modulus off"), (found * compliance - 1.0).abs(), 1e-4);
    }
    // Elastic film is alike at every angle, and does not shear.
    let elastic = shipped("stretch/single-element.toml", &[ELASTIC, "loading.stretch.direction=\"30 deg\""]);
    let [strip, free] = [Across::Strip, Across::Free].map(|across| simulate::pull(&elastic, &[0.1, 0.4], across));
    let (strip, free) = (strip.expect("a pull"), free.expect("a pull"));
    let apart = strip.iter().zip(&free).map(|(strip, free)| (strip / free - 1.0).abs()).fold(0.0, f64::max);
    claims.at_most("elastic film at 30 degrees, strip off the free one", apart, 1e-8);
}

/// Equal strains in both directions: P = E/(1−ν) (1+e)(e + e²/2).
#[test]
fn equibiaxial_stress_of_elastic_film_has_the_closed_form() {
    let mut claims = Claims::of("single element, equibiaxial");
    let model = shipped("stretch/single-element.toml", &[ELASTIC]);
    let path: Vec<[f64; 2]> = (0..=60).map(|k| [f64::from(k), 0.01 * f64::from(k)]).collect();
    let stresses = simulate::pull_along(&model, &path, Across::Equal).expect("a pull");
    let exact = |e: f64| 50e6 / (1.0 - 0.44) * (1.0 + e) * (e + 0.5 * e * e);
    let apart = path.iter().zip(&stresses).map(|([_, e], found)| (exact(*e) - found).abs()).fold(0.0, f64::max);
    claims.at_most("stress off over E", apart / 50e6, 1e-8);
}

/// Film that is stretched at once and held relaxes by its series: P = E* (1+e)(e + e²/2) (1 − Σ g (1 − exp(−t/τ))).
#[test]
fn held_film_relaxes_by_its_series() {
    let mut claims = Claims::of("single element, relaxation");
    let film = r#"specimen.material={ density = 915, thickness = 12e-6, elastic = { young = 50e6, poisson = 0.0 }, prony = [{ share = 0.3, time = 0.05 }, { share = 0.2, time = 0.5 }] }"#;
    let model = shipped("stretch/single-element.toml", &[film]);
    let path: Vec<[f64; 2]> = (0..=40).map(|k| [0.05 * f64::from(k), 0.2]).collect();
    let stresses = simulate::pull_along(&model, &path, Across::Free).expect("a pull");
    let left = |t: f64| 1.0 - 0.3 * (1.0 - (-t / 0.05).exp()) - 0.2 * (1.0 - (-t / 0.5).exp());
    let exact = |t: f64| 50e6 * 1.2 * 0.22 * left(t);
    let apart = path.iter().zip(&stresses).map(|([t, _], found)| (found / exact(*t) - 1.0).abs()).fold(0.0, f64::max);
    claims.at_most("stress off the closed form", apart, 1e-7);
    let back = simulate::pull_along(&model, &[[1.0, 0.1], [0.5, 0.2]], Across::Free).expect_err("time goes back");
    assert_eq!(back.to_string(), "expected times from zero on that do not go back, found 0.5 s after 1 s");
}

#[test]
fn quasi_static_stress_on_unloading_and_beyond_the_break() {
    let model = shipped("stretch/single-element.toml", &["specimen.material.fabric.absorption=0.5"]);
    let pulled = simulate::pull(&model, &[0.26, 0.13, 0.26, 1.38, 1.40, 1.41], Across::Held).expect("a pull");
    let [up, down, again, most, _, broken] = pulled[..] else { panic!("{pulled:?}") };
    assert!((up / 8.4e6 - 1.0).abs() < 1e-9 && (again / up - 1.0).abs() < 1e-9);
    // Without loss it would be half of it.
    assert!(down < 0.45 * up, "{down}");
    assert!(most > 29e6 && broken == 0.0, "{most}, {broken}");
    let free = simulate::pull(&model, &[0.13, 0.26], Across::Free).expect("a pull");
    assert!((free[1] / 8.4e6 - 1.0).abs() < 1e-9, "a fabric does not contract: {free:?}");
}

#[test]
fn unsuitable_scenarios_and_strains_are_refused() {
    let message = |model: &str, strain: f64| {
        let failed = simulate::pull(&shipped(model, &[]), &[strain], Across::Free);
        failed.expect_err("a mistake").to_string()
    };
    assert!(message("drop/1008.toml", 0.1).starts_with("only a scenario with `[loading.stretch]` can be pulled"));
    assert_eq!(message("stretch/single-element.toml", -1.0), "expected an engineering strain above -1, found -1");
    assert_eq!(message("stretch/single-element.toml", f64::NAN), "expected an engineering strain above -1, found NaN");
}
