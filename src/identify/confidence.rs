//! How well the parameters of an estimate are known: covariance, intervals, correlation.
//!
//! With the linear model of a [`Tangent`], S = J·diag(x) = U Σ Vᵀ and noise of covariance γ R, least squares scatter in ln x
//! with the covariance
//!
//! C = γ V Σ⁻¹ (Uᵀ R U) Σ⁻¹ Vᵀ
//!
//! the sandwich (Huber 1967) with an autoregressive estimate of R, see [`Noise`]. The fit takes the share tr(Uᵀ R U) of the
//! noise's power with it, hence γ = ‖r‖²/(N − tr(Uᵀ R U)). White noise gives the textbook's s² (JᵀJ)⁻¹.

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
    /// Degrees of freedom of the standard errors.
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
    #[error("there is no distribution of Student with {freedom} degrees of freedom: {source}")]
    Student { freedom: f64, source: StudentsTError },
}

impl Confidence {
    /// How well the parameters at `tangent` are known.
    ///
    /// # Errors
    /// The slopes are beyond what numbers can hold.
    pub fn of(tangent: &Tangent, question: &Question) -> Result<Confidence, ConfidenceError> {
        let noise = Noise::of(tangent.residuals.as_slice(), question.colour);
        let spread = Spread::of(tangent, &noise)?;
        let covariance = spread.covariance();
        let standard_errors: Vec<f64> = covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
        let freedom = spread.freedom(&noise);
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
            effective_samples: spread.effective_samples,
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

/// The sandwich in the logarithms of the parameters.
struct Spread {
    /// Unit of every parameter: its size, or one where it is zero.
    scale: Vec<f64>,
    singular: DVector<f64>,
    left: DMatrix<f64>,
    /// Directions in the logarithms of the parameters, one a column.
    right: DMatrix<f64>,
    /// Directions that the residuals feel at all.
    rank: usize,
    /// Uᵀ R U
    between: DMatrix<f64>,
    /// Variance of the noise.
    variance: f64,
    samples: usize,
    effective_samples: f64,
}

impl Spread {
    fn of(tangent: &Tangent, noise: &Noise) -> Result<Spread, ConfidenceError> {
        let scale: Vec<f64> = tangent.x.iter().map(|x| if *x == 0.0 { 1.0 } else { x.abs() }).collect();
        let mut scaled = tangent.jacobian.clone();
        scaled.column_iter_mut().zip(&scale).for_each(|(mut column, scale)| column *= *scale);
        let (left, singular, right) = decomposed(scaled)?;
        let rank = singular.iter().filter(|value| **value > ROUNDING * singular[0]).count();
        let between = noise.between(&left);
        let samples = tangent.residuals.len() as f64;
        let taken = between.diagonal().rows(0, rank).sum();
        // One direction's share of the noise over what it would be of white noise.
        let inflation = if rank == 0 { 1.0 } else { taken / rank as f64 };
        let effective_samples = (samples / inflation).min(samples);
        let independent = (effective_samples - rank as f64).max(LEAST_FREEDOM) / effective_samples;
        let variance = tangent.residuals.norm_squared() / samples / independent.min(1.0);
        let samples = tangent.residuals.len();
        Ok(Spread { scale, singular, left, right, rank, between, variance, samples, effective_samples })
    }

    /// Degrees of freedom of the variances. An autoregression is known no better than its samples allow: the logarithm of its
    /// power at low frequencies varies by (2 + 4τ)/N with the inflation τ, or the order where that is more (Berk, Ann.
    /// Statist. 2, 1974), and ν degrees of freedom stand for a variance of 2/ν.
    fn freedom(&self, noise: &Noise) -> f64 {
        let independent = self.effective_samples - self.rank as f64;
        let samples = self.samples as f64;
        let inflation = samples / self.effective_samples;
        let known = samples / (1.0 + 2.0 * inflation.max(noise.order as f64));
        let freedom = if noise.order == 0 { independent } else { independent.min(known) };
        freedom.max(LEAST_FREEDOM)
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

/// U, Σ and V, the largest singular value first.
fn decomposed(matrix: DMatrix<f64>) -> Result<(DMatrix<f64>, DVector<f64>, DMatrix<f64>), ConfidenceError> {
    let svd = matrix.try_svd(true, true, f64::EPSILON, MOST_ROUNDS).ok_or(ConfidenceError::Singular)?;
    let [left, right] = [svd.u, svd.v_t].map(|turn| turn.ok_or(ConfidenceError::Singular));
    Ok((left?, svd.singular_values, right?.transpose()))
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
        Tangent { x: x.into(), residuals, jacobian, bend: 0.0, one_sided: vec![] }
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
        assert_eq!((found.effective_samples, found.freedom), (count as f64, (count - 2) as f64));
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

    /// Of 400 estimates, 95 % of the intervals hold the truth, within three standard deviations of that count.
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        const TRIALS: u64 = 400;
        let band = 3.0 * (0.95 * 0.05 / TRIALS as f64).sqrt();
        let moving_mean =
            |seed: u64| normals(seed, 504).windows(5).map(|five| five.iter().sum::<f64>() / 5.0).collect::<Vec<_>>();
        let filtered = |seed: u64| neighbours(seed + 1000, 800, 0.8);
        for held in coverage(TRIALS, Colour::White, |seed| normals(seed + 2000, 40)) {
            assert!((held - 0.95).abs() < band, "{held} with white noise");
        }
        for held in coverage(TRIALS, Colour::Coloured, moving_mean).into_iter().chain(coverage(
            TRIALS,
            Colour::Coloured,
            filtered,
        )) {
            assert!((held - 0.95).abs() < band, "{held} with coloured noise");
        }
        for held in coverage(TRIALS, Colour::White, filtered) {
            assert!(held < 0.65, "{held} where coloured noise is taken for white");
        }
    }
}
