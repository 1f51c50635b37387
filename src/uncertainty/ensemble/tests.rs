use super::*;
use crate::random::Stream;
use crate::statistics::{deviation, quantiles};

fn about(centre: &[f64], spread: f64) -> impl FnMut() -> Vec<f64> {
    let (centre, mut stream) = (centre.to_vec(), Stream::new(1));
    move || centre.iter().map(|x| x + spread * stream.normal()).collect()
}

/// Mean and covariance of a normal density in three dimensions whose directions differ by a thousand.
#[test]
fn a_normal_density_has_its_mean_deviations_and_correlation() {
    let (deviations, correlation) = ([1.0, 1e3, 1e-3], 0.95_f64);
    let density = |x: &[f64]| {
        let [a, b, c] = [x[0] / deviations[0], (x[1] - 5.0) / deviations[1], x[2] / deviations[2]];
        let tied = (b - correlation * a).powi(2) / (1.0 - correlation * correlation);
        -0.5 * (a * a + tied + c * c)
    };
    let found = sample(&density, about(&[0.0, 5.0, 0.0], 1e-3), &Options { effective: 4000.0, ..Options::default() });
    let found = found.unwrap();
    assert!(found.is_converged() && found.effective.iter().all(|size| *size > 4000.0), "{:?}", found.r_hat);
    for (index, expected) in deviations.iter().enumerate() {
        let own = found.coordinate(index);
        let [ratio, shift] =
            [deviation(&own).unwrap() / expected, (mean(&own).unwrap() - [0.0, 5.0, 0.0][index]) / expected];
        // Four standard errors of 4000 independent samples.
        assert!((ratio - 1.0).abs() < 4.0 / 8000_f64.sqrt() && shift.abs() < 4.0 / 4000_f64.sqrt(), "{ratio} {shift}");
    }
    let both = found.points.iter().map(|x| x[0] * (x[1] - 5.0) / 1e3).sum::<f64>() / found.points.len() as f64;
    assert!((both - correlation).abs() < 0.07, "{both}");
}

/// Rosenbrock's density exp(−(a − x)²/2 − b (y − x²)²/2): x is normal about a, y about x² (Pagani, Wiegand, Nadarajah
/// 2022), so that E[y] = a² + 1 and var(y) = 4 a² + 2 + 1/b.
#[test]
fn rosenbrock_s_banana_has_its_closed_moments() {
    let (a, b) = (1.0, 20.0);
    let density = |x: &[f64]| -0.5 * (a - x[0]).powi(2) - 0.5 * b * (x[1] - x[0] * x[0]).powi(2);
    let options = Options { effective: 3000.0, most_steps: 64_000, ..Options::default() };
    let found = sample(&density, about(&[1.0, 1.0], 0.3), &options).unwrap();
    assert!(found.is_converged(), "{:?} {:?}", found.r_hat, found.effective);
    let (x, y) = (found.coordinate(0), found.coordinate(1));
    assert!((mean(&x).unwrap() - a).abs() < 0.1 && (deviation(&x).unwrap() - 1.0).abs() < 0.07);
    let (expected, spread) = (a * a + 1.0, (4.0 * a * a + 2.0 + 1.0 / b).sqrt());
    assert!((mean(&y).unwrap() - expected).abs() < 5.0 * spread / 3000_f64.sqrt(), "{:?}", mean(&y));
    assert!((deviation(&y).unwrap() / spread - 1.0).abs() < 0.12, "{:?} for {spread}", deviation(&y));
}

/// Two normal densities three deviations from zero, of which the right one has three quarters.
#[test]
fn both_modes_of_a_density_have_their_shares() {
    let normal = |x: f64, centre: f64| (-0.5 * (x - centre).powi(2)).exp();
    let density = |x: &[f64]| (0.25 * normal(x[0], -3.0) + 0.75 * normal(x[0], 3.0)).ln() - 0.5 * x[1] * x[1];
    let options = Options { effective: 2000.0, most_steps: 32_000, ..Options::default() };
    let found = sample(&density, about(&[0.0, 0.0], 3.0), &options).unwrap();
    assert!(found.is_converged(), "{:?}", found.r_hat);
    let right = found.points.iter().filter(|x| x[0] > 0.0).count() as f64 / found.points.len() as f64;
    assert!((right - 0.75).abs() < 0.05, "{right}");
    let ends = quantiles(&found.coordinate(0), &[0.025, 0.975]).unwrap();
    assert!((ends[0] + 4.28).abs() < 0.3 && (ends[1] - 4.83).abs() < 0.3, "{ends:?}");
}

/// Walkers that start in one of two modes far apart stay there, and R̂ says so.
#[test]
fn modes_that_no_walker_crosses_are_not_converged() {
    let density = |x: &[f64]| (-0.5 * (x[0].abs() - 40.0).powi(2)) - 0.5 * x[1] * x[1];
    let mut number = 0;
    let start = || {
        number += 1;
        let mut stream = Stream::new(number);
        // The first ensemble, 32 walkers and the draw that counts the dimensions, on the left.
        let side = if number <= 33 { -40.0 } else { 40.0 };
        vec![side + stream.normal(), stream.normal()]
    };
    let found = sample(&density, start, &Options { most_steps: 1000, ..Options::default() }).unwrap();
    assert!(!found.is_converged() && found.r_hat[0] > 2.0, "{:?}", found.r_hat);
}

#[test]
fn a_seed_gives_the_same_samples_and_another_others() {
    let density = |x: &[f64]| -0.5 * x[0] * x[0];
    let of =
        |seed| sample(&density, about(&[0.0], 1.0), &Options { seed, steps: 50, most_steps: 50, ..Options::default() });
    assert_eq!(of(1).unwrap(), of(1).unwrap());
    assert_ne!(of(1).unwrap().points, of(2).unwrap().points);
}

#[test]
fn what_cannot_be_sampled_is_said() {
    let density = |x: &[f64]| if x[0] > 100.0 { 0.0 } else { f64::NEG_INFINITY };
    let nowhere = sample(&density, about(&[0.0], 1.0), &Options::default()).unwrap_err();
    assert_eq!(nowhere, EnsembleError::Starts { found: 0, needed: 128 });
    let flat = |_: &[f64]| 0.0;
    let few = Options { walkers: Some(3), ..Options::default() };
    let error = sample(&flat, about(&[0.0, 0.0], 1.0), &few).unwrap_err();
    assert_eq!(error, EnsembleError::Walkers { walkers: 3, dimensions: 2 });
    assert_eq!(sample(&flat, Vec::new, &Options::default()).unwrap_err(), EnsembleError::NoCoordinate);
}
