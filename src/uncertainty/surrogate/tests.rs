use super::*;
use crate::design::{Levels, Method, points};
use crate::distribution::Distribution;
use crate::functions::{g, g_indices, ishigami, ishigami_indices};

fn sample(inputs: usize, samples: usize, f: impl Fn(&[f64]) -> f64) -> (Vec<Vec<f64>>, Vec<Option<f64>>) {
    let points = points(Method::Sobol, &vec![Levels::Continuous; inputs], samples, 7).unwrap();
    let outputs = points.iter().map(|u| Some(f(u))).collect();
    (points, outputs)
}

/// Q² from 2000 points that the fit has not seen.
fn unseen(model: &Surrogate, inputs: usize, f: impl Fn(&[f64]) -> f64) -> f64 {
    let points = points(Method::Random, &vec![Levels::Continuous; inputs], 2000, 77).unwrap();
    let outputs: Vec<f64> = points.iter().map(|u| f(u)).collect();
    let mean = outputs.iter().sum::<f64>() / 2000.0;
    let errors: f64 = points.iter().zip(&outputs).map(|(u, y)| (model.predict(u) - y).powi(2)).sum();
    1.0 - errors / outputs.iter().map(|y| (y - mean).powi(2)).sum::<f64>()
}

fn worst(found: &[f64], exact: &[f64]) -> f64 {
    found.iter().zip(exact).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max)
}

#[test]
fn ishigamis_function_has_its_indices_in_the_coefficients() {
    let (first, total, variance) = ishigami_indices();
    for (samples, allowed) in [(128, 0.05), (256, 1e-3)] {
        let (points, outputs) = sample(3, samples, ishigami);
        let model = Surrogate::fit(&[Family::Legendre; 3], &points, &outputs, &Options::default()).unwrap();
        let unseen = unseen(&model, 3, ishigami);
        println!(
            "Ishigami, {samples} samples: degree {}, {} terms, Q² {:.6} (unseen {unseen:.6}), S {:.4?}, ST {:.4?}, \
             variance {:.3} ({variance:.3}), S13 {:.4}",
            model.degree(),
            model.terms(),
            model.q2(),
            model.first().unwrap(),
            model.total().unwrap(),
            model.variance(),
            model.pair(2, 0).unwrap()
        );
        assert!(worst(&model.first().unwrap(), &first) < allowed && worst(&model.total().unwrap(), &total) < allowed);
        assert!((model.mean() - 3.5).abs() < 10.0 * allowed);
        assert!(unseen > 1.0 - allowed && model.q2() < 1.0 && model.q2() > 1.0 - 4.0 * allowed);
    }
}

/// Its kinks are no polynomial: the indices of the strong inputs are nevertheless right to a few hundredths.
#[test]
fn the_g_function_has_its_indices_as_far_as_polynomials_reach() {
    let a = [0.0, 1.0, 4.5, 9.0, 99.0];
    let (first, total) = g_indices(&a);
    let (points, outputs) = sample(5, 400, |u| g(&a, u));
    let model = Surrogate::fit(&[Family::Legendre; 5], &points, &outputs, &Options::default()).unwrap();
    let unseen = unseen(&model, 5, |u| g(&a, u));
    println!(
        "g-function, 400 samples: degree {}, {} terms, Q² {:.4} (unseen {unseen:.4}), S {:.4?} ({first:.4?})",
        model.degree(),
        model.terms(),
        model.q2(),
        model.first().unwrap()
    );
    assert!(worst(&model.first().unwrap(), &first) < 0.03 && worst(&model.total().unwrap(), &total) < 0.03);
    assert!((model.q2() - unseen).abs() < 0.03);
}

/// A polynomial of normal inputs is found exactly, with the indices that its coefficients give.
#[test]
fn a_polynomial_of_normal_inputs_is_found_exactly() {
    let inputs = [Distribution::normal(2.0, 0.5).unwrap(), Distribution::normal(-1.0, 2.0).unwrap()];
    let f = |u: &[f64]| {
        let x: Vec<f64> = u.iter().zip(&inputs).map(|(&u, input)| input.quantile(u)).collect();
        x[0] * x[0] + x[0] * x[1]
    };
    let (points, outputs) = sample(2, 40, f);
    let options = Options { truncation: 1.0, ..Options::default() };
    let model = Surrogate::fit(&[Family::Hermite; 2], &points, &outputs, &options).unwrap();
    // x₀ = 2 + z₀/2, x₁ = −1 + 2 z₁: mean 4.25 − 2; z₀: 2 − 1/2; z₁: 4; z₀²: 1/4; z₀ z₁: 1.
    let (mean, variance) = (2.25, 1.5 * 1.5 + 16.0 + 2.0 / 16.0 + 1.0);
    assert!((model.mean() - mean).abs() < 1e-9 && (model.variance() - variance).abs() < 1e-9);
    assert!(worst(&model.first().unwrap(), &[(2.25 + 0.125) / variance, 16.0 / variance]) < 1e-9);
    assert!((model.pair(0, 1).unwrap() - 1.0 / variance).abs() < 1e-9);
    assert!(model.q2() > 1.0 - 1e-9);
}

/// Of outputs that are noise, the share that is predicted is none: choosing terms by the data themselves must not hide
/// that.
#[test]
fn noise_has_no_model() {
    let (points, _) = sample(6, 80, |_| 0.0);
    let q2: Vec<f64> = (0..10)
        .map(|seed| {
            let mut stream = Stream::new(seed);
            let outputs: Vec<Option<f64>> = (0..80).map(|_| Some(stream.normal())).collect();
            Surrogate::fit(&[Family::Legendre; 6], &points, &outputs, &Options::default()).unwrap().q2()
        })
        .collect();
    println!("noise, 80 samples of 6 inputs: Q² {q2:.3?}");
    assert!(q2.iter().all(|q2| *q2 < 0.15) && q2.iter().sum::<f64>() < 0.5, "{q2:?}");
}

#[test]
fn missing_outputs_are_left_out() {
    let (points, mut outputs) = sample(3, 300, ishigami);
    outputs.iter_mut().step_by(10).for_each(|output| *output = None);
    let model = Surrogate::fit(&[Family::Legendre; 3], &points, &outputs, &Options::default()).unwrap();
    assert!(worst(&model.first().unwrap(), &ishigami_indices().0) < 1e-3);
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let fit = |points: &[Vec<f64>], outputs: &[Option<f64>]| {
        Surrogate::fit(&[Family::Legendre; 2], points, outputs, &Options::default()).unwrap_err()
    };
    let points = vec![vec![0.5, 0.25]; 20];
    assert_eq!(fit(&points, &[Some(1.0); 20]), SurrogateError::Constant);
    let few = SurrogateError::TooFewSamples { samples: 5, terms: 3, needed: 10 };
    assert_eq!(fit(&points[..5], &[Some(1.0); 5]), few);
    assert_eq!(fit(&points, &[None; 3]), SurrogateError::Outputs { points: 20, outputs: 3 });
    let mut outside = points.clone();
    outside[3][1] = 1.0;
    assert_eq!(fit(&outside, &[None; 20]), SurrogateError::Outside { point: 3, input: 1, value: 1.0 });
    let bent = vec![vec![0.5]; 20];
    assert_eq!(fit(&bent, &[None; 20]), SurrogateError::Coordinates { point: 0, coordinates: 1, inputs: 2 });
}
