//! How well the parameters of an estimate are known: covariance, intervals, correlation.
//!
//! With the linear model of a [`Tangent`], S = J·diag(x) = U Σ Vᵀ and noise of covariance γ R in every part that the
//! residuals were joined from, least squares scatter in ln x with the covariance
//!
//! C = V Σ⁻¹ (Σ_parts γ Uᵀ R U) Σ⁻¹ Vᵀ
//!
//! the sandwich (Huber 1967) with an autoregressive estimate of R, see [`Noise`]. The fit takes the share tr(Uᵀ R U) of a
//! part's noise with it, hence γ = ‖r‖²/(n − tr(Uᵀ R U)). White noise in one part gives the textbook's s² (JᵀJ)⁻¹.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT, StudentsTError};
use thiserror::Error;

use super::identifiability::{self, Direction};
use super::noise::{Colour, Noise};
use super::tangent::Tangent;

/// Singular values below this share of the largest are nothing but rounding.
const ROUNDING: f64 = 1e-7;

/// Rounds in which singular values are found; a few for each parameter do.
const MOST_ROUNDS: usize = 10_000;

/// Degrees of freedom that an interval has at least.
const LEAST_FREEDOM: f64 = 1.0;

/// Residuals that the fit must leave of a part for its noise to be seen.
const LEAST_LEFT: f64 = 0.5;

/// Probability that the truth lies below the upper end of a two-sided interval of 95 %.
const BELOW_UPPER: f64 = 0.975;

/// What is asked about an estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Of the parameters.
    pub names: Vec<String>,
    pub colour: Colour,
    /// Whether intervals are symmetric in the logarithm, as multipliers want it.
    pub relative: bool,
}

/// How well the parameters of an estimate are known.
#[derive(Clone, Debug, PartialEq)]
pub struct Confidence {
    pub names: Vec<String>,
    /// The estimate.
    pub x: Vec<f64>,
    /// Standard errors, in the unit of the parameter; infinite where the residuals say nothing about it.
    pub standard_errors: Vec<f64>,
    /// Intervals of 95 %.
    pub intervals: Vec<[f64; 2]>,
    /// Whether they are symmetric in the logarithm.
    pub relative: bool,
    /// Covariance of the parameters; infinite where a standard error is.
    pub covariance: DMatrix<f64>,
    pub correlation: DMatrix<f64>,
    /// Number of residuals.
    pub samples: usize,
    /// Number of independent residuals that would say as much about the parameters.
    pub effective_samples: f64,
    /// Degrees of freedom of the standard errors; where parts have noise of their own, of the one that has the fewest.
    pub freedom: f64,
    /// Student's quantile of the intervals.
    pub quantile: f64,
    /// Variance of a parameter over (JᵀJ)⁻¹: the increase of ‖r‖² at one standard error.
    pub increases: Vec<f64>,
    /// Largest over smallest singular value of ∂r/∂ln x.
    pub condition: f64,
    /// Combinations of parameters by how well they are known, the best first.
    pub directions: Vec<Direction>,
    /// Change of the parameters, in standard errors, by which a Gauss–Newton step would still improve them.
    pub unfinished: Vec<f64>,
    /// What the user should know before trusting it.
    pub warnings: Vec<String>,
}

/// Why it cannot be said how well parameters are known.
#[derive(Debug, Error)]
pub enum ConfidenceError {
    #[error("the slopes of the residuals have no singular values: they are of too different sizes")]
    Singular,
    #[error(
        "part {number} of the residuals has {samples}, and the fit takes {taken:.1} of them with it: nothing is left to see its \
         noise by"
    )]
    Taken { number: usize, samples: usize, taken: f64 },
    #[error("there is no distribution of Student with {freedom} degrees of freedom: {source}")]
    Student { freedom: f64, source: StudentsTError },
}

impl Confidence {
    /// How well the parameters at `tangent` are known.
    ///
    /// # Errors
    /// The slopes are beyond what numbers can hold; a part of the residuals is nothing but fitted.
    pub fn of(tangent: &Tangent, question: &Question) -> Result<Confidence, ConfidenceError> {
        let spread = Spread::of(tangent, question.colour)?;
        let covariance = spread.covariance();
        let standard_errors: Vec<f64> = covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
        let freedom = spread.freedom();
        let quantile = quantile(freedom)?;
        let half_widths = standard_errors.iter().map(|error| quantile * error);
        let intervals = tangent.x.iter().zip(half_widths).map(|(x, width)| Reach::new(*x, width, question.relative));
        let mut confidence = Confidence {
            names: question.names.clone(),
            x: tangent.x.clone(),
            intervals: intervals.map(|reach| [reach.at(-1.0), reach.at(1.0)]).collect(),
            relative: question.relative,
            correlation: spread.correlation(),
            samples: tangent.residuals.len(),
            effective_samples: spread.parts.iter().map(|part| part.effective_samples).sum(),
            freedom,
            quantile,
            increases: spread.increases(),
            condition: spread.condition(),
            directions: spread.directions(quantile),
            unfinished: spread.unfinished(tangent, &standard_errors),
            warnings: vec![],
            covariance,
            standard_errors,
        };
        confidence.warnings = identifiability::warnings(&confidence, tangent);
        Ok(confidence)
    }
}

/// Places around an estimate, counted in half-widths of its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    x: f64,
    half_width: f64,
    relative: bool,
}

impl Reach {
    /// A parameter at zero has no logarithm; its interval is absolute.
    pub(super) fn new(x: f64, half_width: f64, relative: bool) -> Reach {
        Reach { x, half_width, relative: relative && x != 0.0 }
    }

    /// The place `share` half-widths above.
    pub(super) fn at(&self, share: f64) -> f64 {
        let Reach { x, half_width, .. } = *self;
        if share == 0.0 || half_width == 0.0 {
            x
        } else if self.relative {
            x * (share * half_width / x).exp()
        } else {
            x + share * half_width
        }
    }
}

/// The noise of one part of the residuals, and what the fit takes of it.
struct Part {
    /// γ
    variance: f64,
    /// Uᵀ R U over the part.
    between: DMatrix<f64>,
    /// Number of independent samples that would say as much.
    effective_samples: f64,
    /// Degrees of freedom of γ Uᵀ R U.
    freedom: f64,
}

impl Part {
    /// From the part's rows of U, of which the first `rank` columns are felt; `number` counts from one.
    fn of(
        number: usize,
        residuals: &[f64],
        left: &DMatrix<f64>,
        rank: usize,
        colour: Colour,
    ) -> Result<Part, ConfidenceError> {
        let noise = Noise::of(residuals, colour);
        let between = noise.between(left);
        let felt = |between: &DMatrix<f64>| between.diagonal().rows(0, rank).sum();
        let samples = residuals.len() as f64;
        let parameters = felt(&Noise::white().between(left));
        if samples - parameters < LEAST_LEFT {
            return Err(ConfidenceError::Taken { number, samples: residuals.len(), taken: parameters });
        }
        // One direction's share of the noise over what it would be of white noise.
        let inflation = if parameters == 0.0 { 1.0 } else { felt(&between) / parameters };
        let effective_samples = (samples / inflation).min(samples);
        let independent = (effective_samples - parameters).max(LEAST_FREEDOM);
        let power = residuals.iter().map(|r| r * r).sum::<f64>() / samples;
        Ok(Part {
            variance: power / (independent / effective_samples).min(1.0),
            between,
            effective_samples,
            freedom: freedom(samples, effective_samples, independent, noise.order()),
        })
    }
}

/// An autoregression is known no better than its samples allow: the logarithm of its power at low frequencies varies by
/// (2 + 4τ)/N with the inflation τ, or the order where that is more (Berk, Ann. Statist. 2, 1974), and ν degrees of freedom
/// stand for a variance of 2/ν.
fn freedom(samples: f64, effective_samples: f64, independent: f64, order: usize) -> f64 {
    let inflation = samples / effective_samples;
    let known = samples / (1.0 + 2.0 * inflation.max(order as f64));
    let freedom = if order == 0 { independent } else { independent.min(known) };
    freedom.max(LEAST_FREEDOM)
}

/// The sandwich in the logarithms of the parameters.
struct Spread {
    /// Unit of every parameter: its size, or one where it is zero.
    scale: Vec<f64>,
    singular: DVector<f64>,
    /// U
    left: DMatrix<f64>,
    /// Directions in the logarithms of the parameters, one a column.
    right: DMatrix<f64>,
    /// Directions that the residuals feel at all.
    rank: usize,
    parts: Vec<Part>,
    /// Mean variance of the noise.
    variance: f64,
    /// Σ γ Uᵀ R U over the mean variance.
    between: DMatrix<f64>,
}

impl Spread {
    fn of(tangent: &Tangent, colour: Colour) -> Result<Spread, ConfidenceError> {
        let scale: Vec<f64> = tangent.x.iter().map(|x| if *x == 0.0 { 1.0 } else { x.abs() }).collect();
        let mut scaled = tangent.jacobian.clone();
        scaled.column_iter_mut().zip(&scale).for_each(|(mut column, scale)| column *= *scale);
        let svd = scaled.try_svd(true, true, f64::EPSILON, MOST_ROUNDS).ok_or(ConfidenceError::Singular)?;
        let singular = svd.singular_values;
        let left = svd.u.ok_or(ConfidenceError::Singular)?;
        let right = svd.v_t.ok_or(ConfidenceError::Singular)?.transpose();
        let rank = singular.iter().filter(|value| **value > ROUNDING * singular[0]).count();
        let mut parts = Vec::new();
        let mut first = 0;
        for (place, length) in tangent.parts.iter().enumerate() {
            let residuals = &tangent.residuals.as_slice()[first..first + length];
            parts.push(Part::of(place + 1, residuals, &left.rows(first, *length).into_owned(), rank, colour)?);
            first += length;
        }
        let lengths = tangent.parts.iter().map(|length| *length as f64);
        let variance =
            parts.iter().zip(lengths).map(|(part, length)| length * part.variance).sum::<f64>() / first as f64;
        let mut between = DMatrix::zeros(left.ncols(), left.ncols());
        for part in &parts {
            // Parts of an exact fit have no scatter that could tell them apart.
            between += &part.between * if variance == 0.0 { 1.0 } else { part.variance / variance };
        }
        Ok(Spread { scale, singular, left, right, rank, parts, variance, between })
    }

    /// Degrees of freedom of a parameter's variance, which is a sum over the parts (Satterthwaite, Biometrics Bull. 2, 1946);
    /// the fewest of all parameters.
    fn freedom(&self) -> f64 {
        let share = |part: &Part| {
            let entry = |i: usize, j: usize| match self.is_felt(i) && self.is_felt(j) {
                true => part.between[(i, j)] / (self.strength(i) * self.strength(j)),
                false => 0.0,
            };
            self.turned(entry).diagonal() * part.variance
        };
        let shares: Vec<DVector<f64>> = self.parts.iter().map(share).collect();
        let all: DVector<f64> = shares.iter().sum();
        let of = |place: usize| {
            let part = |(part, share): (&Part, &DVector<f64>)| (share[place] / all[place]).powi(2) / part.freedom;
            1.0 / self.parts.iter().zip(&shares).map(part).sum::<f64>()
        };
        let scattered = (0..all.len()).filter(|place| all[*place] > 0.0);
        let freedom = scattered.map(of).fold(f64::INFINITY, f64::min);
        let fewest = self.parts.iter().map(|part| part.freedom).fold(f64::INFINITY, f64::min);
        if freedom.is_finite() { freedom } else { fewest }
    }

    /// Covariance in ln x, for noise of variance one.
    fn shape(&self) -> DMatrix<f64> {
        let between = |i: usize, j: usize| match self.is_felt(i) && self.is_felt(j) {
            true => self.between[(i, j)],
            false => f64::from(u8::from(i == j)),
        };
        self.turned(|i, j| between(i, j) / (self.strength(i) * self.strength(j)))
    }

    /// Singular value of a direction; one that is not felt counts as felt as little as rounding lets be seen.
    fn strength(&self, direction: usize) -> f64 {
        self.singular[direction].max(ROUNDING * self.singular[0]).max(f64::MIN_POSITIVE.sqrt())
    }

    /// V A Vᵀ
    fn turned(&self, entry: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        let count = self.singular.len();
        let sum = |row: usize, column: usize| -> f64 {
            let term = |i: usize, j: usize| self.right[(row, i)] * entry(i, j) * self.right[(column, j)];
            (0..count).flat_map(|i| (0..count).map(move |j| (i, j))).map(|(i, j)| term(i, j)).sum()
        };
        DMatrix::from_fn(count, count, |row, column| sum(row.max(column), row.min(column)))
    }

    fn is_felt(&self, direction: usize) -> bool {
        direction < self.rank
    }

    /// Whether a parameter takes part in a direction that is not felt.
    fn is_lost(&self, place: usize) -> bool {
        (self.rank..self.singular.len()).any(|direction| self.right[(place, direction)].abs() > ROUNDING)
    }

    fn covariance(&self) -> DMatrix<f64> {
        let shape = self.shape();
        DMatrix::from_fn(self.scale.len(), self.scale.len(), |i, j| {
            let value = self.variance * shape[(i, j)] * self.scale[i] * self.scale[j];
            if self.is_lost(i) || self.is_lost(j) { f64::INFINITY.copysign(shape[(i, j)]) } else { value }
        })
    }

    fn correlation(&self) -> DMatrix<f64> {
        let shape = self.shape();
        let deviation = |place: usize| shape[(place, place)].sqrt();
        DMatrix::from_fn(self.scale.len(), self.scale.len(), |i, j| {
            if i == j { 1.0 } else { (shape[(i, j)] / (deviation(i) * deviation(j))).clamp(-1.0, 1.0) }
        })
    }

    fn increases(&self) -> Vec<f64> {
        let white = self.turned(|i, j| if i == j { self.strength(i).powi(-2) } else { 0.0 });
        let shape = self.shape();
        (0..self.scale.len()).map(|place| self.variance * shape[(place, place)] / white[(place, place)]).collect()
    }

    fn condition(&self) -> f64 {
        let smallest = self.singular[self.singular.len() - 1];
        if self.rank < self.singular.len() { f64::INFINITY } else { self.singular[0] / smallest }
    }

    fn directions(&self, quantile: f64) -> Vec<Direction> {
        let direction = |i: usize| {
            let deviation = (self.variance * self.between[(i, i)]).sqrt() / self.singular[i];
            Direction {
                exponents: self.right.column(i).iter().copied().collect(),
                half_width: if self.is_felt(i) { quantile * deviation } else { f64::INFINITY },
                share: if self.is_felt(i) { self.singular[i] / self.singular[0] } else { 0.0 },
            }
        };
        (0..self.singular.len()).map(direction).collect()
    }

    /// −V Σ⁻¹ Uᵀ r over the standard errors.
    fn unfinished(&self, tangent: &Tangent, standard_errors: &[f64]) -> Vec<f64> {
        let along: Vec<f64> =
            (0..self.rank).map(|i| -self.left.column(i).dot(&tangent.residuals) / self.singular[i]).collect();
        let step = |place: usize| -> f64 {
            let parts = along.iter().enumerate().map(|(i, along)| self.right[(place, i)] * along);
            self.scale[place] * parts.sum::<f64>()
        };
        let over = |(place, error): (usize, &f64)| if *error > 0.0 { step(place) / error } else { 0.0 };
        standard_errors.iter().enumerate().map(over).collect()
    }
}

/// Student's quantile of a two-sided interval of 95 %.
fn quantile(freedom: f64) -> Result<f64, ConfidenceError> {
    let student = StudentsT::new(0.0, 1.0, freedom);
    student
        .map(|student| student.inverse_cdf(BELOW_UPPER))
        .map_err(|source| ConfidenceError::Student { freedom, source })
}

#[cfg(test)]
mod tests {
    use super::super::noise::tests::{neighbours, normals};
    use super::*;

    fn known(tangent: &Tangent, colour: Colour) -> Confidence {
        let names = ["a", "b", "c"].iter().take(tangent.x.len()).map(|name| (*name).to_owned()).collect();
        Confidence::of(tangent, &Question { names, colour, relative: false }).unwrap()
    }

    fn tangent(x: &[f64], residuals: &[f64], jacobian: DMatrix<f64>) -> Tangent {
        let residuals = DVector::from_column_slice(residuals);
        let parts = vec![residuals.len()];
        Tangent { x: x.into(), residuals, parts, jacobian, bend: 0.0, one_sided: vec![] }
    }

    /// a e^{−b t} at t in [0, 4] with the noise `noise`, fitted by Gauss and Newton.
    fn decay(truth: [f64; 2], noise: &[f64]) -> Tangent {
        let time = |place: usize| 4.0 * place as f64 / noise.len() as f64;
        let value = |[a, b]: [f64; 2], place: usize| a * (-b * time(place)).exp();
        let at = |x: [f64; 2]| {
            let residual = |place: usize| value(x, place) - value(truth, place) - noise[place];
            let slope = |place: usize, column: usize| {
                let decay = (-x[1] * time(place)).exp();
                if column == 0 { decay } else { -x[0] * time(place) * decay }
            };
            let residuals: Vec<f64> = (0..noise.len()).map(residual).collect();
            tangent(&x, &residuals, DMatrix::from_fn(noise.len(), 2, slope))
        };
        let mut x = truth;
        for _ in 0..8 {
            let here = at(x);
            let jacobian = &here.jacobian;
            let step =
                (jacobian.transpose() * jacobian).try_inverse().unwrap() * jacobian.transpose() * &here.residuals;
            x = [x[0] - step[0], x[1] - step[1]];
        }
        at(x)
    }

    /// Share of `trials` in which the interval holds the truth, for each of two parameters.
    fn coverage(trials: u64, colour: Colour, noise: impl Fn(u64) -> Vec<f64>) -> [f64; 2] {
        let truth = [2.0, 0.8];
        let mut held = [0.0; 2];
        for seed in 0..trials {
            let noise: Vec<f64> = noise(seed).iter().map(|noise| 0.1 * noise).collect();
            let found = known(&decay(truth, &noise), colour);
            for ((held, [lower, upper]), truth) in held.iter_mut().zip(found.intervals).zip(truth) {
                *held += f64::from(u8::from((lower..=upper).contains(&truth))) / trials as f64;
            }
        }
        held
    }

    /// Longley's kind of check: s² (JᵀJ)⁻¹ with s² = ‖r‖²/(N − p), written out.
    #[test]
    fn a_line_through_white_noise_has_the_textbook_s_covariance() {
        let (count, noise) = (40, normals(5, 40));
        let jacobian = DMatrix::from_fn(count, 2, |row, column| if column == 0 { 1.0 } else { row as f64 });
        let y = DVector::from_fn(count, |row, _| noise[row] + 3.0 - 0.5 * row as f64);
        let inverse = (jacobian.transpose() * &jacobian).try_inverse().unwrap();
        let x = &inverse * jacobian.transpose() * &y;
        let residuals = &jacobian * &x - &y;
        let variance = residuals.norm_squared() / (count - 2) as f64;
        let found = known(&tangent(x.as_slice(), residuals.as_slice(), jacobian), Colour::White);
        let expected = variance * inverse;
        assert!((&found.covariance - &expected).amax() < 1e-12 * expected.amax(), "{found:?}");
        assert_eq!(found.effective_samples, count as f64);
        assert!((found.freedom - 38.0).abs() < 1e-9, "{}", found.freedom);
        // Tables of Student's distribution: 2.0244 at 38 degrees of freedom.
        assert!((found.quantile - 2.0244).abs() < 1e-4, "{}", found.quantile);
        let half_width = found.quantile * expected[(1, 1)].sqrt();
        assert!((found.intervals[1][1] - x[1] - half_width).abs() < 1e-10);
        assert!((found.increases[1] - variance).abs() < 1e-10);
        assert!(found.unfinished.iter().all(|step| step.abs() < 1e-9));
        assert_eq!(found.warnings, Vec::<String>::new());
    }

    /// Every standard error against the scatter of the estimates themselves, coloured noise: the sandwich written out with the
    /// whole matrix R that made it.
    #[test]
    fn coloured_noise_widens_as_the_whole_matrix_says() {
        let (count, phi) = (4000, 0.7_f64);
        let found = decay([2.0, 0.8], &neighbours(11, count, phi).iter().map(|e| 0.01 * e).collect::<Vec<_>>());
        let confidence = known(&found, Colour::Coloured);
        let inverse = (found.jacobian.transpose() * &found.jacobian).try_inverse().unwrap();
        let mut between = DMatrix::zeros(2, 2);
        for row in 0..count {
            for column in row.saturating_sub(60)..(row + 61).min(count) {
                let rho = 1e-4 * phi.powi(row.abs_diff(column) as i32);
                between += rho * found.jacobian.row(row).transpose() * found.jacobian.row(column);
            }
        }
        let expected = &inverse * between * &inverse;
        for place in 0..2 {
            let ratio = confidence.standard_errors[place] / expected[(place, place)].sqrt();
            assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
        }
        let naive = known(&found, Colour::White).standard_errors[0];
        assert!(confidence.standard_errors[0] > 2.0 * naive);
    }

    /// Two signals of `count` samples, white noise and noise whose neighbours are correlated by 0.9, with a mean each: the
    /// tangent of the means, in one list.
    fn two_means(seed: u64, count: usize) -> Tangent {
        let noise = [normals(seed, count), neighbours(seed + 5000, count, 0.9)];
        let means = noise.each_ref().map(|noise| noise.iter().sum::<f64>() / count as f64);
        let left: Vec<f64> =
            noise.iter().zip(means).flat_map(|(noise, mean)| noise.iter().map(move |e| mean - e)).collect();
        let jacobian = DMatrix::from_fn(2 * count, 2, |row, column| f64::from(u8::from(row / count == column)));
        tangent(&means, &left, jacobian)
    }

    /// Deviation of the mean of n values whose neighbours are correlated by φ: √(Σ φ^|i−j|)/n.
    fn deviation_of_mean(count: usize, phi: f64) -> f64 {
        let lag = |lag: usize| (count - lag) as f64 * phi.powi(lag as i32);
        (count as f64 + 2.0 * (1..count).map(lag).sum::<f64>()).sqrt() / count as f64
    }

    #[test]
    fn every_signal_of_a_joined_list_has_its_own_noise() {
        const COUNT: usize = 400;
        const TRIALS: u64 = 100;
        let mean = |known: &dyn Fn(Tangent) -> Confidence| {
            let mut mean = [0.0; 2];
            for seed in 0..TRIALS {
                let found = known(two_means(seed, COUNT)).standard_errors;
                mean.iter_mut().zip(found).for_each(|(mean, found)| *mean += found / TRIALS as f64);
            }
            mean
        };
        let apart = mean(&|found| known(&found.joined_from(&[COUNT, COUNT]).unwrap(), Colour::Coloured));
        for (found, phi) in apart.into_iter().zip([0.0, 0.9]) {
            let expected = deviation_of_mean(COUNT, phi);
            assert!((found / expected - 1.0).abs() < 0.1, "{found} for {expected}");
        }
        let joined = mean(&|found| known(&found, Colour::Coloured));
        println!("standard errors {apart:.3?}, as one record {joined:.3?}");
        assert!(joined[0] > 2.0 * apart[0] && joined[1] < 0.85 * apart[1], "{joined:?} for {apart:?}");
    }

    /// A part that says nothing of the other's parameters is as if it were alone.
    #[test]
    fn parts_of_a_joined_list_are_known_as_each_alone() {
        let whole = known(&two_means(3, 300).joined_from(&[300, 300]).unwrap(), Colour::Coloured);
        let mut samples = 0.0;
        let mut freedom = f64::INFINITY;
        for place in 0..2 {
            let Tangent { x, residuals, .. } = two_means(3, 300);
            let own = &residuals.as_slice()[300 * place..300 * (place + 1)];
            let alone = known(&tangent(&[x[place]], own, DMatrix::from_element(300, 1, 1.0)), Colour::Coloured);
            let ratio = whole.standard_errors[place] / alone.standard_errors[0];
            let increase = whole.increases[place] / alone.increases[0];
            assert!((ratio - 1.0).abs() < 1e-9 && (increase - 1.0).abs() < 1e-9, "{ratio}, {increase}");
            samples += alone.effective_samples;
            freedom = freedom.min(alone.freedom);
        }
        assert!((whole.effective_samples / samples - 1.0).abs() < 1e-9, "{} for {samples}", whole.effective_samples);
        assert!((whole.freedom / freedom - 1.0).abs() < 1e-9, "{} for {freedom}", whole.freedom);
    }

    /// One mean of 20 quiet and 20 loud values, weighted alike: Welch's test of means, of half their difference.
    #[test]
    fn a_parameter_that_parts_share_has_welch_s_degrees_of_freedom() {
        let [quiet, loud] = [normals(1, 20), normals(2, 20)].map(|drawn| {
            let mean = drawn.iter().sum::<f64>() / 20.0;
            drawn.iter().map(|e| e - mean).collect::<Vec<_>>()
        });
        let joined: Vec<f64> = quiet.iter().copied().chain(loud.iter().map(|e| 5.0 * e)).collect();
        let mean = tangent(&[1.0], &joined, DMatrix::from_element(40, 1, 1.0)).joined_from(&[20, 20]).unwrap();
        let found = known(&mean, Colour::White);
        // The mean takes half a sample of either part with it.
        let power = |part: &[f64]| part.iter().map(|e| e * e).sum::<f64>() / 19.5 * 20.0 / 1600.0;
        let [quiet, loud] = [power(&joined[..20]), power(&joined[20..])];
        assert!((found.covariance[(0, 0)] / (quiet + loud) - 1.0).abs() < 1e-12);
        let expected = (quiet + loud).powi(2) / (quiet.powi(2) / 19.5 + loud.powi(2) / 19.5);
        assert!((found.freedom / expected - 1.0).abs() < 1e-12, "{} for {expected}", found.freedom);
    }

    #[test]
    fn a_part_that_is_only_fitted_has_no_noise_to_be_seen() {
        let jacobian = DMatrix::from_fn(6, 2, |row, column| f64::from(u8::from((row == 5) == (column == 1))));
        let residuals = [1.0, -1.0, 2.0, -1.0, -1.0, 0.0];
        let found = tangent(&[1.0, 2.0], &residuals, jacobian).joined_from(&[5, 1]).unwrap();
        let question = Question { names: vec!["a".into(), "b".into()], colour: Colour::White, relative: false };
        let error = Confidence::of(&found, &question).unwrap_err().to_string();
        assert!(error.starts_with("part 2 of the residuals has 1, and the fit takes 1.0 of them with it"), "{error}");
    }

    #[test]
    fn parameters_that_enter_as_a_product_only_are_named() {
        // r = a b t − e at a = 2, b = 3
        let noise = normals(2, 30);
        let jacobian = DMatrix::from_fn(30, 2, |row, column| [3.0, 2.0][column] * row as f64);
        let found = known(&tangent(&[2.0, 3.0], &noise, jacobian), Colour::White);
        let name = ["a·b^-1", "a^-1·b"].into_iter().find(|name| found.warnings[0].starts_with(name));
        let rest = " is not identifiable: it may change at will, the curves do not change with it";
        assert_eq!(name.map(|name| format!("{name}{rest}")), found.warnings.first().cloned());
        assert_eq!(found.standard_errors, [f64::INFINITY; 2]);
        assert_eq!(found.condition, f64::INFINITY);
        assert_eq!(found.warnings[1], "a and b are correlated by -1.000: they change against each other");
    }

    #[test]
    fn a_combination_that_noise_hides_is_named_with_its_factor() {
        // ln-slopes: strong along a·b, weak along a/b, whose standard error is 1/0.05/√2.
        let rows = [[1e3, 1e3], [0.05, -0.05], [0.0, 0.0], [0.0, 0.0]];
        let jacobian = DMatrix::from_fn(4, 2, |row, column| rows[row][column]);
        let found = known(&tangent(&[1.0, 1.0], &[0.0, 0.0, 1.0, -1.0], jacobian), Colour::White);
        // t(2) = 4.3027, s = 1; the logarithm of a/b has the deviation 1/0.05.
        let factor = (4.3027_f64 * 20.0).exp();
        let told = &found.warnings[0];
        assert!(told.starts_with("a·b^-1 is not") || told.starts_with("a^-1·b is not"), "{told}");
        assert!(told.contains(&format!("by a factor {factor:.0e} while")), "{told} for {factor}");
    }

    #[test]
    fn an_exact_fit_has_no_width_and_says_what_that_means() {
        let jacobian = DMatrix::from_fn(10, 2, |row, column| (row as f64).powi(column as i32));
        let found = known(&tangent(&[1.0, 2.0], &[0.0; 10], jacobian), Colour::Coloured);
        assert_eq!((&found.intervals[..], &found.standard_errors[..]), (&[[1.0; 2], [2.0; 2]][..], &[0.0; 2][..]));
        assert!(found.correlation.iter().chain(&found.unfinished).all(|value| value.is_finite()));
        assert!(
            found.warnings.iter().any(|warning| warning.contains("what the model itself does beside")),
            "{found:?}"
        );
    }

    #[test]
    fn a_parameter_without_effect_leaves_the_other_alone() {
        let jacobian = DMatrix::from_fn(20, 2, |row, column| if column == 0 { row as f64 } else { 0.0 });
        let found = known(&tangent(&[1.0, 2.0], &normals(1, 20), jacobian), Colour::White);
        assert!(found.standard_errors[0].is_finite() && found.standard_errors[1].is_infinite());
        assert!(found.warnings[0].starts_with("b is not identifiable: it may change at will"), "{:?}", found.warnings);
    }

    #[test]
    fn an_estimate_beside_the_minimum_is_told() {
        let jacobian = DMatrix::from_element(20, 1, 1.0);
        let residuals: Vec<f64> = normals(4, 20).iter().map(|e| e + 2.0).collect();
        let found = known(&tangent(&[1.0], &residuals, jacobian), Colour::White);
        assert!(found.warnings.iter().any(|warning| warning.starts_with("a is not at its minimum")), "{found:?}");
    }

    #[test]
    fn relative_intervals_are_symmetric_in_the_logarithm() {
        for x in [0.5, -0.5] {
            let reach = Reach::new(x, 1.0, true);
            let [lower, upper] = [reach.at(-1.0), reach.at(1.0)];
            assert!(lower < x && upper > x && (lower * upper - x * x).abs() < 1e-12 && lower * x > 0.0);
        }
        assert_eq!(Reach::new(0.0, 1.0, true).at(1.0), 1.0);
    }

    /// The table of coverage in docs/theory.md, section 15: shares of the intervals that hold the truth, within three
    /// standard deviations of what they promise, and far from it where coloured noise is taken for white.
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        const TRIALS: u64 = 400;
        type Draw = fn(u64) -> Vec<f64>;
        let rows: [(&str, Draw, f64); 4] = [
            ("white, 40", |seed| normals(seed + 2000, 40), 0.95),
            ("moving mean of 5, 500", |seed| moving_mean(&normals(seed, 504)), 0.70),
            ("neighbours correlated by 0.8, 800", |seed| neighbours(seed + 1000, 800, 0.8), 0.60),
            ("by 0.9, 300", |seed| neighbours(seed + 3000, 300, 0.9), 0.45),
        ];
        let band = |share: f64| 3.0 * (share * (1.0 - share) / TRIALS as f64).sqrt();
        for (name, draw, at_most) in rows {
            let [coloured, white] = [Colour::Coloured, Colour::White].map(|colour| coverage(TRIALS, colour, draw));
            println!("{name}: {coloured:.3?}, as white {white:.3?}");
            for (held, white) in coloured.into_iter().zip(white) {
                assert!((held - 0.95).abs() < band(0.95), "{name}: {held}");
                assert!(white < at_most + band(at_most), "{name}: {white} where it is taken for white");
            }
        }
        // Too few independent samples to know the correlation by, which section 15 says.
        let [few, white] =
            [Colour::Coloured, Colour::White].map(|colour| coverage(TRIALS, colour, |seed| neighbours(seed, 100, 0.9)));
        println!("by 0.9, 100: {few:.3?}, as white {white:.3?}");
        assert!(few.iter().all(|held| (0.7..0.95 - band(0.95)).contains(held)), "{few:?}");
    }

    fn moving_mean(drawn: &[f64]) -> Vec<f64> {
        drawn.windows(5).map(|five| five.iter().sum::<f64>() / 5.0).collect()
    }
}
