//! Surrogate model: sparse polynomial chaos of independent inputs (Ghanem, Spanos 1991; Xiu, Karniadakis 2002; Blatman,
//! Sudret 2011).
//!
//! The output is a sum of products of orthonormal polynomials, so that mean, variance and Sobol' indices are sums of
//! squares of its coefficients (Sudret 2008).

mod basis;
mod components;

pub use basis::Family;
use basis::{Degrees, Pursuit};
pub use components::Components;

use crate::random::Stream;
use crate::statistics::{check_counts, present, variance};
use crate::{Error, ensure};

/// Highest degree that is worth its time where nothing else is known.
pub const HIGHEST_DEGREE: usize = 12;

/// q of the hyperbolic truncation, within (0, 1]: the smaller, the fewer interactions of high degree.
const TRUNCATION: f64 = 0.75;

/// Folds of the cross-validation.
const FOLDS: usize = 10;

/// Most products of polynomials that are considered.
const MOST_CANDIDATES: usize = 4000;
/// Degrees without an improvement after which no higher one is tried.
const DEGREES_TRIED: usize = 3;

#[derive(Clone, Debug, PartialEq)]
struct Term {
    /// Inputs that take part and their degrees.
    degrees: Degrees,
    coefficient: f64,
}

/// Polynomial chaos of an output, at points of the open unit cube: cumulative probabilities of the inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Surrogate {
    families: Vec<Family>,
    terms: Vec<Term>,
    degree: usize,
    q2: f64,
}

impl Surrogate {
    /// Fits outputs at points of the open unit cube, one family an input; outputs that are missing or no finite
    /// numbers are left out.
    ///
    /// Terms are chosen by orthogonal matching pursuit from the products that the truncation allows, their number and
    /// the degree by the error of k-fold cross-validation, in which every fold chooses terms of its own. Never more
    /// terms than half the samples are taken.
    ///
    /// # Errors
    /// See [`Error`].
    pub fn fit(
        families: &[Family],
        points: &[Vec<f64>],
        outputs: &[Option<f64>],
        highest_degree: usize,
    ) -> Result<Self, Error> {
        let (points, outputs) = checked(families, points, outputs)?;
        let mean = outputs.iter().sum::<f64>() / outputs.len() as f64;
        let spread: f64 = outputs.iter().map(|y| (y - mean) * (y - mean)).sum();
        ensure(spread > 0.0, || "the output is the same everywhere: there is nothing to model")?;
        // Mixed: folds of successive points of a design would leave out whole regions.
        let order = Stream::new(0).permutation(outputs.len());
        let mut best: Option<(Choice, usize)> = None;
        for degree in 1..=highest_degree.max(1) {
            // A symmetric output gains nothing from odd degrees, so one degree without an improvement does not end the
            // search.
            let tried_enough = best.as_ref().is_some_and(|(_, at)| degree > at + DEGREES_TRIED);
            let candidates = basis::hyperbolic(families.len(), degree, TRUNCATION, MOST_CANDIDATES);
            let Some(candidates) = candidates.filter(|_| !tried_enough) else { break };
            let columns = columns(families, &candidates, &points, degree);
            let (terms, error) = cross_validated(&columns, &outputs, &order);
            if best.as_ref().is_none_or(|(best, _)| error < best.error) {
                best = Some((Choice { candidates, columns, terms, error }, degree));
            }
        }
        let (choice, degree) = best.ok_or_else(|| {
            Error::new(format!(
                "{inputs} inputs are too many: a model has at most {} candidates",
                MOST_CANDIDATES,
                inputs = families.len()
            ))
        })?;
        // Chosen anew with all samples, now that their number is known.
        let terms = choice.terms(&outputs);
        Ok(Self { families: families.to_vec(), terms, degree, q2: 1.0 - choice.error / spread })
    }

    /// The output at a point of the open unit cube.
    ///
    /// # Panics
    /// The point has another number of coordinates than the fit.
    pub fn predict(&self, point: &[f64]) -> f64 {
        assert_eq!(point.len(), self.families.len(), "one coordinate an input");
        self.sum_of_terms(&polynomials(&self.families, point, self.degree))
    }

    /// The output where the polynomials of the inputs have these values, of at least the degree of this model.
    fn sum_of_terms(&self, values: &Polynomials) -> f64 {
        self.terms.iter().map(|term| term.coefficient * values.product(&term.degrees)).sum()
    }

    /// Q²: share of the variance of outputs that were left out of the fit that is predicted; 1 is perfect, 0 as good as
    /// their mean. Indices of a model of low Q² tell little.
    ///
    /// Terms are chosen without the outputs that are left out; their number and the degree are those of the largest Q²,
    /// which raises it, by up to a tenth where nothing can be predicted.
    pub fn q2(&self) -> f64 {
        self.q2
    }

    /// Degree whose truncation was chosen.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of terms, the constant one included.
    pub fn terms(&self) -> usize {
        self.terms.len()
    }

    /// Mean of the output.
    pub fn mean(&self) -> f64 {
        self.sum_over(|degrees| degrees.is_empty(), |coefficient| coefficient)
    }

    /// Variance of the output.
    pub fn variance(&self) -> f64 {
        self.partial(|degrees| !degrees.is_empty())
    }

    /// First-order Sobol' index of every input; none where the model is constant.
    pub fn first(&self) -> Option<Vec<f64>> {
        self.shares(|input, degrees| degrees.len() == 1 && degrees[0].0 == input)
    }

    /// Total Sobol' index of every input; none where the model is constant.
    pub fn total(&self) -> Option<Vec<f64>> {
        self.shares(|input, degrees| degrees.iter().any(|&(other, _)| other == input))
    }

    fn shares(&self, of: impl Fn(usize, &Degrees) -> bool) -> Option<Vec<f64>> {
        let variance = self.variance();
        let share = |input| self.partial(|degrees| of(input, degrees)) / variance;
        (variance > 0.0).then(|| (0..self.families.len()).map(share).collect())
    }

    fn partial(&self, of: impl Fn(&Degrees) -> bool) -> f64 {
        self.sum_over(of, |coefficient| coefficient * coefficient)
    }

    fn sum_over(&self, of: impl Fn(&Degrees) -> bool, value: impl Fn(f64) -> f64) -> f64 {
        self.terms.iter().filter(|term| of(&term.degrees)).map(|term| value(term.coefficient)).sum()
    }
}

/// Values of the polynomials of every input at a point.
struct Polynomials {
    /// Of degree zero and above, input after input.
    values: Vec<f64>,
    /// Values an input.
    stride: usize,
}

impl Polynomials {
    /// The product of the polynomials of these degrees.
    fn product(&self, degrees: &Degrees) -> f64 {
        degrees.iter().map(|&(input, own)| self.values[input * self.stride + own]).product()
    }
}

fn polynomials(families: &[Family], point: &[f64], degree: usize) -> Polynomials {
    let stride = degree + 1;
    let mut values = vec![0.0; families.len() * stride];
    for ((family, &u), own) in families.iter().zip(point).zip(values.chunks_exact_mut(stride)) {
        family.fill(u, own);
    }
    Polynomials { values, stride }
}

/// The candidates of one degree, and how many of them to take.
struct Choice {
    candidates: Vec<Degrees>,
    columns: Vec<Vec<f64>>,
    terms: usize,
    error: f64,
}

impl Choice {
    fn terms(&self, outputs: &[f64]) -> Vec<Term> {
        let mut pursuit = Pursuit::new(&self.columns, outputs.to_vec(), outputs.len());
        (0..self.terms).take_while(|_| pursuit.step()).for_each(drop);
        let term = |(index, coefficient): (usize, f64)| Term { degrees: self.candidates[index].clone(), coefficient };
        pursuit.terms().into_iter().map(term).collect()
    }
}

/// Values of every candidate at all points.
fn columns(families: &[Family], candidates: &[Degrees], points: &[&[f64]], degree: usize) -> Vec<Vec<f64>> {
    let values: Vec<Polynomials> = points.iter().map(|u| polynomials(families, u, degree)).collect();
    candidates.iter().map(|degrees| values.iter().map(|values| values.product(degrees)).collect()).collect()
}

/// Points and outputs that are not missing.
type Sample<'a> = (Vec<&'a [f64]>, Vec<f64>);

fn checked<'a>(families: &[Family], points: &'a [Vec<f64>], outputs: &[Option<f64>]) -> Result<Sample<'a>, Error> {
    check_counts(points, outputs)?;
    let inputs = families.len();
    for (point, coordinates) in points.iter().enumerate() {
        let count = coordinates.len();
        ensure(count == inputs, || format!("point {point} has {count} coordinates, but there are {inputs} inputs"))?;
        for (input, value) in coordinates.iter().enumerate() {
            ensure(*value > 0.0 && *value < 1.0, || {
                format!("coordinate {input} of point {point} is {value}, but must be within 0 and 1, neither included")
            })?;
        }
    }
    let sample: Sample =
        points.iter().zip(outputs).filter_map(|(point, output)| Some((point.as_slice(), present(*output)?))).unzip();
    let (samples, terms) = (sample.1.len(), inputs + 1);
    // The samples without one fold must still be two a term.
    let needed = ((2 * terms * FOLDS).div_ceil(FOLDS - 1) + 1).max(FOLDS);
    ensure(samples >= needed, || {
        format!("{samples} samples are too few for a linear polynomial of {terms} terms: at least {needed} are needed")
    })?;
    Ok(sample)
}

/// An output as a function of the inputs: a polynomial chaos, or a constant where it is the same in all samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    kind: Kind,
    error: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Constant(f64),
    Varying(Surrogate),
}

impl Output {
    /// Fits outputs at points of the open unit cube.
    ///
    /// # Errors
    /// See [`Error`].
    pub fn fit(
        families: &[Family],
        points: &[Vec<f64>],
        outputs: &[f64],
        highest_degree: usize,
    ) -> Result<Output, Error> {
        if let Some(first) = outputs.first().filter(|first| outputs.iter().all(|output| output == *first)) {
            return Ok(Output { kind: Kind::Constant(*first), error: 0.0 });
        }
        let given: Vec<Option<f64>> = outputs.iter().copied().map(Some).collect();
        let surrogate = Surrogate::fit(families, points, &given, highest_degree)?;
        let error = variance(outputs).unwrap_or(0.0) * (1.0 - surrogate.q2()).max(0.0);
        Ok(Output { kind: Kind::Varying(surrogate), error })
    }

    /// Its value at a point of the open unit cube.
    ///
    /// # Panics
    /// The point has another number of coordinates than the fit.
    pub fn at(&self, point: &[f64]) -> f64 {
        match &self.kind {
            Kind::Constant(value) => *value,
            Kind::Varying(surrogate) => surrogate.predict(point),
        }
    }

    /// Variance of its error, by cross-validation.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The polynomial chaos of an output that varies.
    fn surrogate(&self) -> Option<&Surrogate> {
        match &self.kind {
            Kind::Constant(_) => None,
            Kind::Varying(surrogate) => Some(surrogate),
        }
    }

    /// Its value where the polynomials of the inputs have these values, of at least its degree.
    fn with(&self, values: &Polynomials) -> f64 {
        match &self.kind {
            Kind::Constant(value) => *value,
            Kind::Varying(surrogate) => surrogate.sum_of_terms(values),
        }
    }
}

/// Terms without an improvement after which no further one is tried.
const TERMS_TRIED: usize = 25;

/// Number of terms with the least sum of squared errors over all folds, and that error.
///
/// The pursuits of all folds go on in step. Sample `order[i]` is left out in fold i modulo [`FOLDS`].
fn cross_validated(columns: &[Vec<f64>], outputs: &[f64], order: &[usize]) -> (usize, f64) {
    let parts: Vec<(Vec<usize>, usize)> = (0..FOLDS).map(|fold| rows_of_fold(order, fold)).collect();
    let arranged = |values: &[f64], rows: &[usize]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let of_folds: Vec<Vec<Vec<f64>>> =
        parts.iter().map(|(rows, _)| columns.iter().map(|column| arranged(column, rows)).collect()).collect();
    let mut pursuits: Vec<Pursuit> = of_folds
        .iter()
        .zip(&parts)
        .map(|(columns, (rows, fitted))| Pursuit::new(columns, arranged(outputs, rows), *fitted))
        .collect();
    let mut best = (0, f64::INFINITY);
    for terms in 1.. {
        // All go a step, also where one of them is at its end.
        let ended = pursuits.iter_mut().map(Pursuit::step).filter(|further| !further).count();
        if ended > 0 || terms > best.0 + TERMS_TRIED {
            break;
        }
        let error = pursuits.iter().map(Pursuit::prediction_error).sum();
        if error < best.1 {
            best = (terms, error);
        }
    }
    best
}

/// Rows of a fold, those that are fitted first, and their number.
fn rows_of_fold(order: &[usize], fold: usize) -> (Vec<usize>, usize) {
    let places = |left_out: bool| (0..order.len()).filter(move |place| (place % FOLDS == fold) == left_out);
    let rows: Vec<usize> = places(false).chain(places(true)).map(|place| order[place]).collect();
    (rows, places(false).count())
}

#[cfg(test)]
mod tests {
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
            let model = Surrogate::fit(&[Family::Legendre; 3], &points, &outputs, HIGHEST_DEGREE).unwrap();
            let (unseen, own) = (unseen(&model, 3, ishigami), [model.first().unwrap(), model.total().unwrap()]);
            let (degree, terms, found) = (model.degree(), model.terms(), model.variance());
            print!("Ishigami, {samples} samples: degree {degree}, {terms} terms, Q² {:.6} (unseen", model.q2());
            println!(" {unseen:.6}), S and ST {own:.4?}, variance {found:.3} ({variance:.3})");
            let off = [worst(&own[0], &first), worst(&own[1], &total)];
            assert!(off.iter().all(|off| *off < allowed), "{off:?}");
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
        let model = Surrogate::fit(&[Family::Legendre; 5], &points, &outputs, HIGHEST_DEGREE).unwrap();
        let unseen = unseen(&model, 5, |u| g(&a, u));
        let (degree, terms, own) = (model.degree(), model.terms(), model.first().unwrap());
        print!("g-function, 400 samples: degree {degree}, {terms} terms, Q² {:.4} (unseen {unseen:.4})", model.q2());
        println!(", S {own:.4?} ({first:.4?})");
        assert!(worst(&own, &first) < 0.03 && worst(&model.total().unwrap(), &total) < 0.03);
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
        let model = Surrogate::fit(&[Family::Hermite; 2], &points, &outputs, HIGHEST_DEGREE).unwrap();
        // x₀ = 2 + z₀/2, x₁ = −1 + 2 z₁: mean 4.25 − 2; z₀: 2 − 1/2; z₁: 4; z₀²: 1/4; z₀ z₁: 1.
        let (mean, variance) = (2.25, 1.5 * 1.5 + 16.0 + 2.0 / 16.0 + 1.0);
        assert!((model.mean() - mean).abs() < 1e-9 && (model.variance() - variance).abs() < 1e-9);
        assert!(worst(&model.first().unwrap(), &[(2.25 + 0.125) / variance, 16.0 / variance]) < 1e-9);
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
                Surrogate::fit(&[Family::Legendre; 6], &points, &outputs, HIGHEST_DEGREE).unwrap().q2()
            })
            .collect();
        println!("noise, 80 samples of 6 inputs: Q² {q2:.3?}");
        assert!(q2.iter().all(|q2| *q2 < 0.15) && q2.iter().sum::<f64>() < 0.5, "{q2:?}");
    }

    #[test]
    fn missing_outputs_are_left_out() {
        let (points, mut outputs) = sample(3, 300, ishigami);
        outputs.iter_mut().step_by(10).for_each(|output| *output = None);
        let model = Surrogate::fit(&[Family::Legendre; 3], &points, &outputs, HIGHEST_DEGREE).unwrap();
        assert!(worst(&model.first().unwrap(), &ishigami_indices().0) < 1e-3);
    }

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let fit = |points: &[Vec<f64>], outputs: &[Option<f64>]| {
            Surrogate::fit(&[Family::Legendre; 2], points, outputs, HIGHEST_DEGREE).unwrap_err()
        };
        let points = vec![vec![0.5, 0.25]; 20];
        let same = fit(&points, &[Some(1.0); 20]);
        assert_eq!(same, Error::new("the output is the same everywhere: there is nothing to model"));
        let few = Error::new("5 samples are too few for a linear polynomial of 3 terms: at least 10 are needed");
        assert_eq!(fit(&points[..5], &[Some(1.0); 5]), few);
        assert_eq!(fit(&points, &[None; 3]), Error::new("20 points have 3 outputs"));
        let mut outside = points.clone();
        outside[3][1] = 1.0;
        let message = "coordinate 1 of point 3 is 1, but must be within 0 and 1, neither included";
        assert_eq!(fit(&outside, &[None; 20]), Error::new(message));
        let bent = vec![vec![0.5]; 20];
        assert_eq!(fit(&bent, &[None; 20]), Error::new("point 0 has 1 coordinates, but there are 2 inputs"));
    }
}
