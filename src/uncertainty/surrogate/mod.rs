//! Surrogate model: sparse polynomial chaos of independent inputs (Ghanem, Spanos 1991; Xiu, Karniadakis 2002; Blatman,
//! Sudret 2011).
//!
//! The output is a sum of products of orthonormal polynomials, so that mean, variance and Sobol' indices are sums of
//! squares of its coefficients (Sudret 2008).

mod basis;
mod components;
mod output;
mod pursuit;
mod validation;

use thiserror::Error;

use crate::random::Stream;
use crate::statistics::present;
use basis::Degrees;
pub use basis::Family;
pub use components::Components;
pub use output::Output;
use pursuit::Pursuit;
use validation::cross_validated;

/// Why there is no surrogate model.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SurrogateError {
    /// There is not one output a point.
    #[error("{points} points have {outputs} outputs")]
    Outputs {
        /// Number of points.
        points: usize,
        /// Number of outputs.
        outputs: usize,
    },
    /// A point has another number of coordinates than there are inputs.
    #[error("point {point} has {coordinates} coordinates, but there are {inputs} inputs")]
    Coordinates {
        /// Index of the point, from 0.
        point: usize,
        /// Number of its coordinates.
        coordinates: usize,
        /// Number of inputs.
        inputs: usize,
    },
    /// Fewer samples than the folds of the cross-validation need for a linear polynomial.
    #[error("{samples} samples are too few for a linear polynomial of {terms} terms: at least {needed} are needed")]
    TooFewSamples {
        /// Number of finite outputs.
        samples: usize,
        /// Terms of the linear polynomial.
        terms: usize,
        /// Samples that two a term and a fold to leave out need.
        needed: usize,
    },
    /// A coordinate is not within the open unit interval.
    #[error("coordinate {input} of point {point} is {value}, but must be within 0 and 1, neither included")]
    Outside {
        /// Index of the point, from 0.
        point: usize,
        /// Index of the input, from 0.
        input: usize,
        /// The coordinate.
        value: f64,
    },
    /// The truncation is not within (0, 1].
    #[error("the truncation is {q}, but must be positive and at most 1")]
    Truncation {
        /// q of the truncation.
        q: f64,
    },
    /// Cross-validation needs two folds.
    #[error("cross-validation needs at least 2 folds, found {folds}")]
    Folds {
        /// Number of folds.
        folds: usize,
    },
    /// A linear polynomial has more terms than are considered.
    #[error("{inputs} inputs are too many: a model has at most {} candidates", MOST_CANDIDATES)]
    TooManyInputs {
        /// Number of inputs.
        inputs: usize,
    },
    /// The output does not vary.
    #[error("the output is the same everywhere: there is nothing to model")]
    Constant,
}

/// How a surrogate model is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Highest degree that is tried.
    pub highest_degree: usize,
    /// q of the hyperbolic truncation, within (0, 1]: the smaller, the fewer interactions of high degree. Degrees
    /// with more than 4000 products are not tried.
    pub truncation: f64,
    /// Folds of the cross-validation.
    pub folds: usize,
    /// Seed, which decides which sample is in which fold.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { highest_degree: 12, truncation: 0.75, folds: 10, seed: 0 }
    }
}

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
    /// See [`SurrogateError`].
    pub fn fit(
        families: &[Family],
        points: &[Vec<f64>],
        outputs: &[Option<f64>],
        options: &Options,
    ) -> Result<Self, SurrogateError> {
        let (points, outputs) = checked(families, points, outputs, options)?;
        let mean = outputs.iter().sum::<f64>() / outputs.len() as f64;
        let spread: f64 = outputs.iter().map(|y| (y - mean) * (y - mean)).sum();
        if spread <= 0.0 {
            return Err(SurrogateError::Constant);
        }
        // Mixed: folds of successive points of a design would leave out whole regions.
        let order = Stream::new(options.seed).permutation(outputs.len());
        let mut best: Option<(Choice, usize)> = None;
        for degree in 1..=options.highest_degree.max(1) {
            // A symmetric output gains nothing from odd degrees, so one degree without an improvement does not end the
            // search.
            let tried_enough = best.as_ref().is_some_and(|(_, at)| degree > at + DEGREES_TRIED);
            let candidates = basis::hyperbolic(families.len(), degree, options.truncation, MOST_CANDIDATES);
            let Some(candidates) = candidates.filter(|_| !tried_enough) else { break };
            let columns = columns(families, &candidates, &points, degree);
            let (terms, error) = cross_validated(&columns, &outputs, &order, options.folds);
            if best.as_ref().is_none_or(|(best, _)| error < best.error) {
                best = Some((Choice { candidates, columns, terms, error }, degree));
            }
        }
        let (choice, degree) = best.ok_or(SurrogateError::TooManyInputs { inputs: families.len() })?;
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

    /// Second-order Sobol' index: share of the variance that is due to two inputs only together.
    pub fn pair(&self, one: usize, other: usize) -> Option<f64> {
        let (low, high) = (one.min(other), one.max(other));
        let both = |degrees: &Degrees| degrees.len() == 2 && degrees[0].0 == low && degrees[1].0 == high;
        (self.variance() > 0.0).then(|| self.partial(both) / self.variance())
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

fn checked<'a>(
    families: &[Family],
    points: &'a [Vec<f64>],
    outputs: &[Option<f64>],
    options: &Options,
) -> Result<Sample<'a>, SurrogateError> {
    if points.len() != outputs.len() {
        return Err(SurrogateError::Outputs { points: points.len(), outputs: outputs.len() });
    }
    let inputs = families.len();
    if let Some(point) = points.iter().position(|point| point.len() != inputs) {
        return Err(SurrogateError::Coordinates { point, coordinates: points[point].len(), inputs });
    }
    for (point, coordinates) in points.iter().enumerate() {
        if let Some(input) = coordinates.iter().position(|u| !(*u > 0.0 && *u < 1.0)) {
            return Err(SurrogateError::Outside { point, input, value: coordinates[input] });
        }
    }
    if !(options.truncation > 0.0 && options.truncation <= 1.0) {
        return Err(SurrogateError::Truncation { q: options.truncation });
    }
    if options.folds < 2 {
        return Err(SurrogateError::Folds { folds: options.folds });
    }
    let sample: Sample =
        points.iter().zip(outputs).filter_map(|(point, output)| Some((point.as_slice(), present(*output)?))).unzip();
    let (samples, terms) = (sample.1.len(), inputs + 1);
    // The samples without one fold must still be two a term.
    let needed = (2 * terms * options.folds).div_ceil(options.folds - 1) + 1;
    if samples < needed.max(options.folds) {
        return Err(SurrogateError::TooFewSamples { samples, terms, needed: needed.max(options.folds) });
    }
    Ok(sample)
}

#[cfg(test)]
mod tests;
