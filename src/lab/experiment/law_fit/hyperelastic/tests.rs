//! Recovery of known coefficients, Treloar's and Kawabata's rubber, stability.

use std::path::Path;

use super::super::*;
use super::*;

fn rubber(name: &str) -> DataSet {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/rubber").join(name);
    StressReader::default().read(&path).expect("a test")
}

fn treloar() -> Vec<DataSet> {
    ["treloar-ut.csv", "treloar-et.csv", "treloar-ps.csv"].map(rubber).into()
}

fn fitted(law: &str, sets: &[DataSet], predicted: &[DataSet], weighting: Weighting) -> LawFit {
    let law = law.parse().expect("a law");
    fit_law(law, sets, predicted, &FitOptions { weighting, stable_to: None }).expect("a fit")
}

/// The stresses of film with these coefficients in four kinds of tests.
fn virtual_sets(energy: Energy, x: &[f64]) -> Vec<DataSet> {
    let law = energy.of_coefficients(x);
    let stretches = || (1..=20).map(|k| 1.0 + 0.1 * f64::from(k));
    let biaxial = stretches().map(|stretch| BiaxialPoint { stretches: [stretch, stretch.sqrt()], stresses: [1.0; 2] });
    let tension = |tension| Measured::Tension(tension, stretches().map(|stretch| [stretch, 1.0]).collect());
    let kinds = [Tension::Uniaxial, Tension::Equibiaxial, Tension::Plane].map(tension);
    let with_stresses = |measured: Measured| {
        let found = stresses(&law, &measured);
        let measured = match measured {
            Measured::Tension(tension, points) => {
                Measured::Tension(tension, points.iter().zip(found).map(|(point, p)| [point[0], p]).collect())
            }
            Measured::Biaxial(points) => {
                let pairs = points.iter().zip(found.chunks(2));
                Measured::Biaxial(pairs.map(|(b, p)| BiaxialPoint { stresses: [p[0], p[1]], ..*b }).collect())
            }
        };
        DataSet::new("virtual", measured).expect("a test")
    };
    kinds.into_iter().chain([Measured::Biaxial(biaxial.collect())]).map(with_stresses).collect()
}

#[test]
fn known_coefficients_of_each_law_are_found_again() {
    let [first, third, second] = Ogden::TRELOAR;
    let treloar = [first, second, third].map(|term| [term.mu, term.alpha]);
    for (law, known) in [
        ("neo-hookean", &[4e5][..]),
        ("compressible-neo-hookean", &[1.1e6, 0.31]),
        ("mooney-rivlin", &[1.6e5, 4e4]),
        ("yeoh", &[1.8e5, -2e3, 5e1]),
        ("gent", &[4e5, 60.0]),
        ("ogden:1", &[3e5, 2.4]),
        ("ogden:2", &[4.6e5, 1.4, -1.2e4, -2.2]),
        ("ogden:3", treloar.as_flattened()),
    ] {
        let Ok(energy) = law.parse() else { panic!("{law}") };
        let sets = virtual_sets(energy, known);
        for weighting in [Weighting::Absolute, Weighting::Relative] {
            let fit = fitted(law, &sets, &[], weighting);
            assert_eq!(fit.coefficients.len(), known.len(), "{law}");
            for (found, known) in fit.coefficients.iter().zip(known) {
                let error = (found.value / known - 1.0).abs();
                assert!(error < 1e-6, "{law} {weighting}: {} is {} and not {known}", found.name, found.value);
            }
            assert!(fit.tests.iter().all(|test| test.quality.r_squared > 1.0 - 1e-12), "{law}: {:?}", fit.tests);
        }
    }
}

#[test]
fn one_ogden_law_follows_treloars_three_tests() {
    let fit = fitted("ogden:3", &treloar(), &[], Weighting::Absolute);
    for test in &fit.tests {
        println!("{}: {:?}", test.set.name, test.quality);
        assert!(test.quality.r_squared >= 0.995, "{}: {:?}", test.set.name, test.quality);
    }
    assert_eq!(fit.unstable_from, None);
    let confidence = fit.confidence.expect("intervals");
    assert!(confidence.standard_errors.iter().all(|error| error.is_finite()), "{confidence:?}");
}

/// Fitted to the uniaxial test, the law fails in equibiaxial tension, as the warning says.
#[test]
fn a_fit_to_uniaxial_tests_alone_is_unsafe_for_biaxial_film() {
    let sets = treloar();
    let (alone, all) = (&sets[..1], &sets[..]);
    let [alone, all] = [alone, all].map(|fitted_to| fitted("ogden:3", fitted_to, &sets[1..2], Weighting::Absolute));
    assert!(alone.warnings.contains(&Warning::UniaxialOnly) && !all.warnings.contains(&Warning::UniaxialOnly));
    let [uniaxial, wrong, right] = [&alone.tests[0], &alone.predictions[0], &all.predictions[0]];
    println!("equibiaxial error: {:?} alone, {:?} together", wrong.quality, right.quality);
    assert!(uniaxial.quality.r_squared > 0.998, "{:?}", uniaxial.quality);
    assert!(wrong.quality.relative_rms > 0.3 && right.quality.relative_rms < 0.04);
    assert!(wrong.quality.r_squared < 0.7 && right.quality.r_squared > 0.995);
}

#[test]
fn kawabatas_biaxial_stresses_are_predicted_from_three_tests() {
    let sets = ["kawabata-ut.csv", "kawabata-et.csv", "kawabata-ps.csv"].map(rubber);
    let biaxial = [rubber("kawabata-biaxial.csv")];
    assert_eq!(biaxial[0].measured.len(), 117);
    let fit = fitted("ogden:3", &sets, &biaxial, Weighting::Absolute);
    let quality = &fit.predictions[0].quality;
    println!("{quality:?}");
    assert!(quality.samples == 234 && quality.relative_rms < 0.03 && quality.r_squared > 0.997, "{quality:?}");
}

/// The free fit of Mooney and Rivlin's law to Treloar's uniaxial test has a negative c₀₁, with which equibiaxial tension
/// is unstable.
#[test]
fn a_fit_that_is_unstable_is_not_taken_where_a_stable_one_exists() {
    let fit = fitted("mooney-rivlin", &treloar()[..1], &[], Weighting::Absolute);
    let rejected = |warning: &Warning| matches!(warning, Warning::UnstableRejected { .. });
    assert!(fit.warnings.iter().any(rejected), "{:?}", fit.warnings);
    let Law::Hyperelastic(law) = &fit.law else { panic!("{:?}", fit.law) };
    assert_eq!((law.instability(), fit.unstable_from), (None, None));
}

#[test]
fn weights_choose_what_is_fitted() {
    let weigh = |weights: [f64; 3]| -> Vec<DataSet> {
        treloar().into_iter().zip(weights).map(|(set, weight)| set.with_weight(weight).expect("a weight")).collect()
    };
    let fits = [[1.0, 1.0, 1.0], [0.0, 1.0, 0.0]].map(|w| fitted("neo-hookean", &weigh(w), &[], Weighting::Absolute));
    let alone = fitted("neo-hookean", &treloar()[1..2], &[], Weighting::Absolute);
    assert!(fits[0].coefficients[0].value != alone.coefficients[0].value);
    assert!((fits[1].coefficients[0].value / alone.coefficients[0].value - 1.0).abs() < 1e-12);
    let error = treloar().remove(0).with_weight(-1.0).expect_err("a weight below zero");
    assert_eq!(error.to_string(), "expected a weight that is zero or above, found -1");
}

/// Neo-Hookean film has no limit.
#[test]
fn a_coefficient_that_is_not_determined_is_named() {
    let sets = virtual_sets(Energy::NeoHookean, &[4e5]);
    let fit = fitted("gent", &sets[..3], &[], Weighting::Absolute);
    let on_bound = |warning: &Warning| matches!(warning, Warning::OnBound { coefficient, .. } if coefficient == "jm");
    assert!(fit.warnings.iter().any(on_bound), "{:?} {:?}", fit.warnings, fit.coefficients);
}

#[test]
fn stresses_that_fall_have_no_law() {
    let points = vec![[1.5, -1e5], [2.0, -2e5], [2.5, -3e5]];
    let set = DataSet::new("wrong", Measured::Tension(Tension::Uniaxial, points)).expect("a test");
    let fit = |law: &str| fit_law(law.parse().expect("a law"), std::slice::from_ref(&set), &[], &FitOptions::default());
    let refused = |law: &str| fit(law).expect_err("no law").to_string();
    assert_eq!(refused("neo-hookean"), "no coefficients that fit have a stiffness at rest");
    assert!(refused("yeoh").starts_with("3 measured stresses for 3 coefficients"));
}

#[test]
fn words_are_laws() {
    for word in ["neo-hookean", "compressible-neo-hookean", "mooney-rivlin", "yeoh", "gent", "ogden:1", "ogden:6"] {
        assert_eq!(word.parse::<Energy>().map(|law| law.to_string()), Ok(word.to_owned()));
    }
    assert_eq!("ogden".parse::<Energy>().map(|law| law.to_string()), Ok("ogden:3".to_owned()));
    for word in ["", "ogden:0", "ogden:7", "ogden:", "yeoh:3", "Ogden:3 "] {
        let error = word.parse::<Energy>().expect_err(word).to_string();
        assert!(error.contains("is not a law that can be fitted: expected neo-hookean, "), "{error}");
    }
}
