//! Confidence intervals of estimated parameters, and their identifiability.
//!
//! Directions in the logarithms of the parameters are the right singular vectors of ∂r/∂ln x (Belsley, Kuh and Welsch,
//! *Regression Diagnostics*, 1980). One without effect on the residuals is not identifiable; one with a wide interval of
//! the linear model is poorly determined.

use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use super::covariance::Covariance;
use super::warning::Warning;
use super::{ConfidenceOptions, Linearization};
use crate::error::{Error, refusal};

/// Probability of a value below the upper end of a two-sided interval of 95 %.
const BELOW_UPPER: f64 = 0.975;

/// Degrees of freedom above which Student's quantile is the normal distribution's in seven digits.
const NORMAL: f64 = 1e7;

/// Standard errors, intervals and correlation of estimated parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Confidence {
    /// Names of the fitted parameters.
    pub names: Vec<String>,
    /// The estimate.
    pub x: Vec<f64>,
    /// Standard errors in the units of the parameters; infinite without effect on the residuals.
    pub standard_errors: Vec<f64>,
    /// Intervals of 95 %: lower and upper end.
    pub intervals: Vec<[f64; 2]>,
    /// Covariance of the parameters; infinite where a standard error is.
    pub covariance: DMatrix<f64>,
    /// Correlation of the parameters.
    pub correlation: DMatrix<f64>,
    /// Number of residuals.
    pub samples: usize,
    /// Number of independent residuals with the same information about the parameters.
    pub effective_samples: f64,
    /// Degrees of freedom of the standard errors; the smallest where parts have noise of their own, infinite where the
    /// noise is assumed.
    pub freedom: f64,
    /// Student's quantile of the intervals.
    pub quantile: f64,
    /// Condition number: largest over smallest singular value of ∂r/∂ln x.
    pub condition: f64,
    /// Combinations of parameters, the best-determined first.
    pub directions: Vec<Direction>,
    /// The parameters that the fit held, and what one standard deviation of each changes the others by, in their units.
    pub shifts: Vec<(String, Vec<f64>)>,
    /// A Gauss–Newton step from the estimate, standard errors; zero at a minimum.
    pub gauss_newton_step: Vec<f64>,
    /// Doubts about the intervals.
    pub warnings: Vec<Warning>,
}

impl Confidence {
    /// The confidence intervals at the point of `linearization`.
    ///
    /// # Errors
    /// The Jacobian has no singular value decomposition, or the fit absorbs all samples of a part.
    pub fn from_linearization(linearization: &Linearization, options: &ConfidenceOptions) -> Result<Confidence, Error> {
        let (held, deviations): (Vec<usize>, Vec<f64>) = options.held().unzip();
        // Parameters that are known from elsewhere are not estimated, but what they may be off by shifts those that are: their
        // columns leave the Jacobian and come back as disturbances of the residuals, scaled by their standard deviations.
        let (linearization, mut disturbances) = linearization.without(&held);
        let (linearization, fitted) = (&linearization, options.of_fitted());
        disturbances.column_iter_mut().zip(&deviations).for_each(|(mut column, deviation)| column *= *deviation);
        let sandwich = Covariance::from_linearization(linearization, &disturbances, &fitted)?;
        let shift = |column: usize, index: usize| {
            (options.names[index].clone(), sandwich.step(&disturbances.column(column).into_owned()))
        };
        let covariance = sandwich.matrix();
        let standard_errors: Vec<f64> = covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
        let freedom = sandwich.freedom();
        let quantile = quantile(freedom)?;
        // Student's t, not the normal distribution: the variance of the residuals is estimated from the same few samples.
        let half_widths = standard_errors.iter().map(|error| quantile * error);
        let intervals = linearization.x.iter().zip(half_widths).map(|(x, width)| interval(*x, width, options.relative));
        let mut confidence = Confidence {
            names: fitted.names,
            shifts: held.iter().enumerate().map(|(column, index)| shift(column, *index)).collect(),
            x: linearization.x.clone(),
            intervals: intervals.collect(),
            correlation: sandwich.correlation(),
            samples: linearization.residuals.len(),
            effective_samples: sandwich.noise.iter().map(|part| part.effective_samples).sum(),
            freedom,
            quantile,
            condition: sandwich.condition(),
            directions: sandwich.directions(quantile),
            gauss_newton_step: sandwich.gauss_newton_step(linearization, &standard_errors),
            warnings: vec![],
            covariance,
            standard_errors,
        };
        confidence.warnings = confidence.check(linearization, options);
        Ok(confidence)
    }

    fn check(&self, linearization: &Linearization, options: &ConfidenceOptions) -> Vec<Warning> {
        let names = &self.names;
        let weak = self.directions.iter().filter_map(|direction| direction.check(names, &self.x));
        let mut warnings: Vec<Warning> = weak.collect();
        warnings.extend(correlated(names, &self.correlation));
        // An assumed misfit says what the residuals would show.
        if options.misfit.is_none() {
            warnings.extend(few_independent(self.samples, self.effective_samples, names.len()));
            warnings.extend(below_roughness(linearization));
        }
        let one_sided = linearization.one_sided.iter().map(|index| names[*index].clone());
        warnings.extend(one_sided.map(|parameter| Warning::OneSided { parameter }));
        warnings.extend(not_at_minimum(names, &self.gauss_newton_step));
        warnings
    }
}

/// Student's quantile of a two-sided interval of 95 %; that of the normal distribution for noise of a known variance.
fn quantile(freedom: f64) -> Result<f64, Error> {
    if freedom > NORMAL {
        return Ok(Normal::standard().inverse_cdf(BELOW_UPPER));
    }
    let student = StudentsT::new(0.0, 1.0, freedom);
    student
        .map(|student| student.inverse_cdf(BELOW_UPPER))
        .map_err(|error| refusal!("Student's distribution is undefined for {freedom} degrees of freedom: {error}"))
}

/// The interval about `x`, symmetric or, for a relative one, symmetric in the logarithm. Zero has no logarithm: its interval
/// is absolute.
fn interval(x: f64, half_width: f64, relative: bool) -> [f64; 2] {
    [-half_width, half_width].map(|width| match relative {
        _ if width == 0.0 => x,
        true if x != 0.0 => x * (width / x).exp(),
        _ => x + width,
    })
}

/// Half-width of the interval of 95 % of a combination, as a factor, above which it is poorly determined.
const TOO_WIDE: f64 = 1.5;

/// Singular value over the largest below which errors of model and sensor determine a combination, whatever the noise.
/// Condition indices from 30 to 100 indicate moderate to strong relations (Belsley, Kuh and Welsch 1980).
const TOO_WEAK: f64 = 0.01;

/// Correlation of two parameters above which there is a warning.
const TOO_CORRELATED: f64 = 0.95;

/// Exponents below this share of the largest are omitted in the name of a combination.
const MINOR: f64 = 0.1;

/// Independent residuals for each parameter, and share of all residuals, below which they show model error.
const FEW: f64 = 10.0;
const DEPENDENT: f64 = 1.0 / 3.0;

/// Gauss–Newton step, standard errors, above which an estimate is not at its minimum.
const NOT_AT_MINIMUM: f64 = 0.5;

/// A combination Π x_j^{v_j} of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// v, a unit vector.
    pub exponents: Vec<f64>,
    /// Half-width of the interval of 95 % of Σ v_j ln x_j.
    pub half_width: f64,
    /// Its singular value over the largest.
    pub share: f64,
}

impl Direction {
    /// The largest exponent, with its sign.
    fn leading(&self) -> f64 {
        self.exponents.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(1.0)
    }

    /// The half-width as a factor, for a leading exponent of one.
    fn factor(&self) -> f64 {
        (self.half_width / self.leading().abs()).exp()
    }

    /// The combination, such as `k1·ke^-0.8`. A parameter at zero has no logarithm and appears as an exponential.
    fn name(&self, names: &[String], x: &[f64]) -> String {
        let leading = self.leading();
        let factor = |((exponent, name), x): ((&f64, &String), &f64)| {
            let sign = if *x < 0.0 { -1.0 } else { 1.0 };
            let exponent = (10.0 * sign * exponent / leading).round() / 10.0;
            let base = if *x == 0.0 { format!("exp({name})") } else { name.clone() };
            (exponent.abs() >= MINOR).then(|| if exponent == 1.0 { base } else { format!("{base}^{exponent}") })
        };
        self.exponents.iter().zip(names).zip(x).filter_map(factor).collect::<Vec<_>>().join("·")
    }

    /// A warning if the combination is not identifiable, poorly determined, or weakly identifiable.
    pub(super) fn check(&self, names: &[String], x: &[f64]) -> Option<Warning> {
        let combination = self.name(names, x);
        let factor = self.factor();
        if self.share == 0.0 {
            Some(Warning::NoEffect { combination })
        } else if factor > TOO_WIDE {
            Some(Warning::PoorlyDetermined { combination, factor })
        } else {
            (self.share < TOO_WEAK).then(|| Warning::WeaklyIdentifiable { combination, ratio: 1.0 / self.share })
        }
    }
}

/// Warnings of all pairs of strongly correlated parameters.
pub(super) fn correlated(names: &[String], correlation: &DMatrix<f64>) -> Vec<Warning> {
    let pairs = (0..names.len()).flat_map(|i| (i + 1..names.len()).map(move |j| (i, j)));
    let warning = |(i, j): (usize, usize)| {
        let correlation = correlation[(i, j)];
        let parameters = [names[i].clone(), names[j].clone()];
        (correlation.abs() > TOO_CORRELATED).then_some(Warning::Correlated { parameters, correlation })
    };
    pairs.filter_map(warning).collect()
}

/// A warning if few of the residuals are independent.
pub(super) fn few_independent(samples: usize, effective_samples: f64, parameters: usize) -> Option<Warning> {
    let few = effective_samples < FEW * parameters as f64 && effective_samples < DEPENDENT * samples as f64;
    few.then_some(Warning::FewIndependentResiduals { samples, effective_samples, parameters })
}

/// A warning if the residuals are no larger than the roughness of the model.
pub(super) fn below_roughness(linearization: &Linearization) -> Option<Warning> {
    let (norm, roughness) = (linearization.norm(), linearization.roughness);
    (norm <= roughness || norm == 0.0).then_some(Warning::ResidualsBelowRoughness { norm, roughness })
}

/// Warnings of parameters that a Gauss–Newton step, in standard errors, would move.
pub(super) fn not_at_minimum(names: &[String], step: &[f64]) -> Vec<Warning> {
    let off = names.iter().zip(step).filter(|(_, step)| step.abs() > NOT_AT_MINIMUM);
    off.map(|(name, step)| Warning::NotAtMinimum { parameter: name.clone(), standard_errors: step.abs() }).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::super::noise::tests::{neighbours, normals};
    use super::super::noise::{Colour, Misfit};
    use super::*;

    fn confidence(linearization: &Linearization, colour: Colour) -> Confidence {
        let mut names = abc().names;
        names.truncate(linearization.x.len());
        asked(linearization, ConfidenceOptions { colour, ..ConfidenceOptions::new(names) })
    }

    fn asked(linearization: &Linearization, options: ConfidenceOptions) -> Confidence {
        Confidence::from_linearization(linearization, &options).unwrap()
    }

    fn linearization(x: &[f64], residuals: &[f64], jacobian: DMatrix<f64>) -> Linearization {
        let residuals = DVector::from_column_slice(residuals);
        let parts = vec![residuals.len()];
        Linearization { x: x.into(), residuals, parts, jacobian, roughness: 0.0, one_sided: vec![] }
    }

    /// a e^{−b t} at t in [0, 4] with the noise `noise`, fitted by Gauss and Newton.
    fn decay(truth: [f64; 2], noise: &[f64]) -> Linearization {
        let time = |index: usize| 4.0 * index as f64 / noise.len() as f64;
        let value = |[a, b]: [f64; 2], index: usize| a * (-b * time(index)).exp();
        let at = |x: [f64; 2]| {
            let residual = |index: usize| value(x, index) - value(truth, index) - noise[index];
            let slope = |index: usize, column: usize| {
                let decay = (-x[1] * time(index)).exp();
                if column == 0 { decay } else { -x[0] * time(index) * decay }
            };
            let residuals: Vec<f64> = (0..noise.len()).map(residual).collect();
            linearization(&x, &residuals, DMatrix::from_fn(noise.len(), 2, slope))
        };
        let mut x = truth;
        for _ in 0..8 {
            let here = at(x);
            let jacobian = &here.jacobian;
            let inverse = (jacobian.transpose() * jacobian).try_inverse().unwrap();
            let step = inverse * jacobian.transpose() * &here.residuals;
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
            let found = confidence(&decay(truth, &noise), colour);
            for ((held, [lower, upper]), truth) in held.iter_mut().zip(found.intervals).zip(truth) {
                *held += f64::from(u8::from((lower..=upper).contains(&truth))) / trials as f64;
            }
        }
        held
    }

    #[test]
    fn relative_intervals_are_symmetric_in_the_logarithm() {
        for x in [0.5, -0.5] {
            let [lower, upper] = interval(x, 1.0, true);
            assert!(lower < x && upper > x && (lower * upper - x * x).abs() < 1e-12 && lower * x > 0.0);
        }
        assert_eq!(interval(0.0, 1.0, true), [-1.0, 1.0]);
    }

    /// Longley's kind of check: s² (JᵀJ)⁻¹ with s² = ‖r‖²/(N − p), written out.
    #[test]
    fn a_line_through_white_noise_has_the_covariance_of_the_textbook() {
        let (count, noise) = (40, normals(5, 40));
        let jacobian = DMatrix::from_fn(count, 2, |row, column| if column == 0 { 1.0 } else { row as f64 });
        let y = DVector::from_fn(count, |row, _| noise[row] + 3.0 - 0.5 * row as f64);
        let inverse = (jacobian.transpose() * &jacobian).try_inverse().unwrap();
        let x = &inverse * jacobian.transpose() * &y;
        let residuals = &jacobian * &x - &y;
        let variance = residuals.norm_squared() / (count - 2) as f64;
        let found = confidence(&linearization(x.as_slice(), residuals.as_slice(), jacobian), Colour::White);
        let expected = variance * inverse;
        assert!((&found.covariance - &expected).amax() < 1e-12 * expected.amax(), "{found:?}");
        assert_eq!(found.effective_samples, count as f64);
        assert!((found.freedom - 38.0).abs() < 1e-9, "{}", found.freedom);
        // Tables of Student's distribution: 2.0244 at 38 degrees of freedom.
        assert!((found.quantile - 2.0244).abs() < 1e-4, "{}", found.quantile);
        let half_width = found.quantile * expected[(1, 1)].sqrt();
        assert!((found.intervals[1][1] - x[1] - half_width).abs() < 1e-10);
        assert!(found.gauss_newton_step.iter().all(|step| step.abs() < 1e-9));
        assert_eq!(found.warnings, []);
    }

    /// Every standard error against the scatter of the estimates themselves, coloured noise: the sandwich written out
    /// with the whole matrix R that made it.
    #[test]
    fn coloured_noise_widens_intervals_as_its_correlation_matrix_does() {
        let (count, phi) = (4000, 0.7_f64);
        let found = decay([2.0, 0.8], &neighbours(11, count, phi).iter().map(|e| 0.01 * e).collect::<Vec<_>>());
        let coloured = confidence(&found, Colour::Coloured);
        let inverse = (found.jacobian.transpose() * &found.jacobian).try_inverse().unwrap();
        let mut between = DMatrix::zeros(2, 2);
        for row in 0..count {
            for column in row.saturating_sub(60)..(row + 61).min(count) {
                let rho = 1e-4 * phi.powi(row.abs_diff(column) as i32);
                between += rho * found.jacobian.row(row).transpose() * found.jacobian.row(column);
            }
        }
        let expected = &inverse * between * &inverse;
        for index in 0..2 {
            let ratio = coloured.standard_errors[index] / expected[(index, index)].sqrt();
            assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
        }
        let naive = confidence(&found, Colour::White).standard_errors[0];
        assert!(coloured.standard_errors[0] > 2.0 * naive);
    }

    /// Two signals of `count` samples, white noise and noise whose neighbours are correlated by 0.9, with a mean each:
    /// the linearization of the means, in one list.
    fn two_means(seed: u64, count: usize) -> Linearization {
        let noise = [normals(seed, count), neighbours(seed + 5000, count, 0.9)];
        let means = noise.each_ref().map(|noise| noise.iter().sum::<f64>() / count as f64);
        let of = |(noise, mean): (&Vec<f64>, f64)| noise.iter().map(|e| mean - e).collect::<Vec<_>>();
        let left = noise.iter().zip(means).map(of).collect::<Vec<_>>().concat();
        let jacobian = DMatrix::from_fn(2 * count, 2, |row, column| f64::from(u8::from(row / count == column)));
        linearization(&means, &left, jacobian)
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
        let mean = |errors_of: &dyn Fn(Linearization) -> Confidence| {
            let mut mean = [0.0; 2];
            for seed in 0..TRIALS {
                let found = errors_of(two_means(seed, COUNT)).standard_errors;
                mean.iter_mut().zip(found).for_each(|(mean, found)| *mean += found / TRIALS as f64);
            }
            mean
        };
        let apart = mean(&|found| confidence(&found.joined_from(&[COUNT, COUNT]).unwrap(), Colour::Coloured));
        for (found, phi) in apart.into_iter().zip([0.0, 0.9]) {
            let expected = deviation_of_mean(COUNT, phi);
            assert!((found / expected - 1.0).abs() < 0.1, "{found} for {expected}");
        }
        let joined = mean(&|found| confidence(&found, Colour::Coloured));
        println!("standard errors {apart:.3?}, as one record {joined:.3?}");
        assert!(joined[0] > 2.0 * apart[0] && joined[1] < 0.85 * apart[1], "{joined:?} for {apart:?}");
    }

    /// A part that says nothing of the other's parameters is as if it were alone.
    #[test]
    fn independent_parts_have_the_covariance_of_each_alone() {
        let whole = confidence(&two_means(3, 300).joined_from(&[300, 300]).unwrap(), Colour::Coloured);
        let mut samples = 0.0;
        let mut freedom = f64::INFINITY;
        for index in 0..2 {
            let Linearization { x, residuals, .. } = two_means(3, 300);
            let own = &residuals.as_slice()[300 * index..300 * (index + 1)];
            let alone =
                confidence(&linearization(&[x[index]], own, DMatrix::from_element(300, 1, 1.0)), Colour::Coloured);
            let ratio = whole.standard_errors[index] / alone.standard_errors[0];
            assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
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
        let mean = linearization(&[1.0], &joined, DMatrix::from_element(40, 1, 1.0)).joined_from(&[20, 20]).unwrap();
        let found = confidence(&mean, Colour::White);
        // The mean takes half a sample of either part with it.
        let power = |part: &[f64]| part.iter().map(|e| e * e).sum::<f64>() / 19.5 * 20.0 / 1600.0;
        let [quiet, loud] = [power(&joined[..20]), power(&joined[20..])];
        assert!((found.covariance[(0, 0)] / (quiet + loud) - 1.0).abs() < 1e-12);
        let expected = (quiet + loud).powi(2) / (quiet.powi(2) / 19.5 + loud.powi(2) / 19.5);
        assert!((found.freedom / expected - 1.0).abs() < 1e-12, "{} for {expected}", found.freedom);
    }

    #[test]
    fn a_part_that_the_fit_absorbs_has_no_noise() {
        let jacobian = DMatrix::from_fn(6, 2, |row, column| f64::from(u8::from((row == 5) == (column == 1))));
        let residuals = [1.0, -1.0, 2.0, -1.0, -1.0, 0.0];
        let found = linearization(&[1.0, 2.0], &residuals, jacobian).joined_from(&[5, 1]).unwrap();
        let names = vec!["a".into(), "b".into()];
        let question = ConfidenceOptions { colour: Colour::White, ..ConfidenceOptions::new(names) };
        let error = Confidence::from_linearization(&found, &question).unwrap_err().to_string();
        assert!(error.starts_with("part 2 of the residuals has 1, of which the fit absorbs 1:"), "{error}");
    }

    /// A parabola at 200 places in parts of these lengths, and the correlation e^(−|i − j|/θ) of the error of each.
    fn parabola(parts: &[(usize, f64)]) -> (Linearization, DMatrix<f64>) {
        let jacobian = DMatrix::from_fn(200, 3, |row, column| (row as f64 / 50.0 - 1.0).powi(column as i32));
        let residuals: Vec<f64> = normals(1, 200).iter().map(|e| 1e-3 * e).collect();
        let mut correlation = DMatrix::zeros(200, 200);
        let mut first = 0;
        for (length, theta) in parts {
            let rho = |row: usize, column: usize| (-(row.abs_diff(column) as f64) / theta).exp();
            let mut own = correlation.view_mut((first, first), (*length, *length));
            own.copy_from(&DMatrix::from_fn(*length, *length, rho));
            first += length;
        }
        let lengths: Vec<usize> = parts.iter().map(|(length, _)| *length).collect();
        let found = linearization(&[1.0, -2.0, 0.5], &residuals, jacobian).joined_from(&lengths).unwrap();
        (found, correlation)
    }

    fn abc() -> ConfidenceOptions {
        ConfidenceOptions::new(["a", "b", "c"].map(str::to_owned).into())
    }

    /// The covariance of least squares with noise of the covariance K is (JᵀJ)⁻¹ JᵀKJ (JᵀJ)⁻¹, whatever the residuals
    /// are.
    #[test]
    fn an_assumed_misfit_has_the_covariance_of_its_correlation_matrix() {
        let (found, correlation) = parabola(&[(150, 20.0), (50, 3.0)]);
        let error = [0.3, 0.1];
        let variance = |row: usize| if row < 150 { error[0] * error[0] / 150.0 } else { error[1] * error[1] / 50.0 };
        let noise = DMatrix::from_fn(200, 200, |row, column| variance(row) * correlation[(row, column)]);
        let jacobian = &found.jacobian;
        let inverse = (jacobian.transpose() * jacobian).try_inverse().unwrap();
        let expected = &inverse * jacobian.transpose() * noise * jacobian * &inverse;
        let misfit = [(error[0], 20.0), (error[1], 3.0)].map(|(error, correlation)| Misfit { error, correlation });
        let confidence = asked(&found, ConfidenceOptions { misfit: Some(misfit.into()), ..abc() });
        assert!((&confidence.covariance - &expected).amax() < 1e-12 * expected.amax(), "{confidence:?}");
        // The normal distribution's, since the noise is known.
        assert!((confidence.quantile - 1.959_964).abs() < 1e-6 && confidence.freedom == f64::INFINITY);
        let half_width = confidence.quantile * expected[(2, 2)].sqrt();
        assert!((confidence.intervals[2][1] - 0.5 - half_width).abs() < 1e-12);
        let white = Some(vec![Misfit { error: 0.3, correlation: 0.0 }]);
        let white = asked(&found, ConfidenceOptions { misfit: white, ..abc() });
        assert!(confidence.standard_errors[0] > 4.0 * white.standard_errors[0]);
        let three = ConfidenceOptions { misfit: Some(vec![misfit[0]; 3]), ..abc() };
        let refused = Confidence::from_linearization(&found, &three).unwrap_err().to_string();
        assert!(refused.starts_with("`misfit` has 3 errors for 2 parts of the residuals"), "{refused}");
    }

    /// A known prior of c, white noise: by the Schur complement the covariance of a and b is
    /// [AᵀA − Aᵀg (gᵀg + σ²/s²)⁻¹ gᵀA]⁻¹ σ², with A the columns of a and b and g that of c.
    #[test]
    fn a_nuisance_parameter_with_a_prior_leaves_the_marginal_covariance_of_the_others() {
        let (found, _) = parabola(&[(200, 1.0)]);
        let (columns, g) = (found.jacobian.columns(0, 2).into_owned(), found.jacobian.column(2).into_owned());
        let variance = 0.2_f64.powi(2) / 200.0;
        let misfit = Some(vec![Misfit { error: 0.2, correlation: 0.0 }]);
        for deviation in [1e-6, 3e-3, 0.02, 1e6] {
            let information = g.norm_squared() + variance / (deviation * deviation);
            let along = columns.transpose() * &g;
            let schur = columns.transpose() * &columns - &along * along.transpose() / information;
            let expected = schur.try_inverse().unwrap() * variance;
            let (misfit, prior) = (misfit.clone(), vec![None, None, Some(deviation)]);
            let confidence = asked(&found, ConfidenceOptions { misfit, prior, ..abc() });
            let marginal = confidence.covariance.view((0, 0), (2, 2)).into_owned();
            assert!((&marginal - &expected).amax() < 1e-9 * expected.amax(), "{deviation}: {marginal} {expected}");
            assert!(confidence.standard_errors[2] <= deviation * (1.0 + 1e-9), "{deviation}");
        }
    }

    /// With correlated noise: the covariance of the estimate that the rows of the prior weight, written out.
    #[test]
    fn priors_and_a_coloured_misfit_have_the_sandwich_of_all_rows() {
        let (found, correlation) = parabola(&[(200, 20.0)]);
        let noise = correlation * (0.2_f64.powi(2) / 200.0);
        let free = found.jacobian.columns(0, 2).into_owned();
        let q = free.clone().svd(true, false).u.unwrap();
        let power = (q.transpose() * &noise * &q).trace() / 2.0;
        let deviation = 0.02;
        let rows = found.jacobian.clone().insert_row(200, 0.0);
        let rows = DMatrix::from_fn(201, 3, |row, column| match (row, column) {
            (200, 2) => power.sqrt() / deviation,
            _ => rows[(row, column)],
        });
        let mut all = noise.insert_row(200, 0.0).insert_column(200, 0.0);
        all[(200, 200)] = power;
        let inverse = (rows.transpose() * &rows).try_inverse().unwrap();
        let expected = &inverse * rows.transpose() * all * rows * &inverse;
        let misfit = Some(vec![Misfit { error: 0.2, correlation: 20.0 }]);
        let prior = vec![None, None, Some(deviation)];
        let confidence = asked(&found, ConfidenceOptions { misfit, prior, ..abc() });
        assert!((&confidence.covariance - &expected).amax() < 1e-9 * expected.amax(), "{confidence:?} {expected}");
    }

    /// A fit that holds c adds to the noise K what it does not know of c: (JᵀJ)⁻¹ Jᵀ (K + s² g gᵀ) J (JᵀJ)⁻¹.
    #[test]
    fn a_held_parameter_adds_its_own_covariance() {
        let (found, correlation) = parabola(&[(200, 20.0)]);
        let deviation = 0.02;
        let (columns, g) = (found.jacobian.columns(0, 2).into_owned(), found.jacobian.column(2).into_owned());
        let noise = correlation * (0.2_f64.powi(2) / 200.0) + deviation * deviation * &g * g.transpose();
        let inverse = (columns.transpose() * &columns).try_inverse().unwrap();
        let expected = &inverse * columns.transpose() * noise * &columns * &inverse;
        let misfit = Some(vec![Misfit { error: 0.2, correlation: 20.0 }]);
        let held = vec![None, None, Some(deviation)];
        let confidence = asked(&found, ConfidenceOptions { misfit, held: held.clone(), ..abc() });
        assert_eq!((confidence.names.len(), confidence.x.len()), (2, 2));
        assert!((&confidence.covariance - &expected).amax() < 1e-9 * expected.amax(), "{confidence:?}");
        let shift = -deviation * &inverse * columns.transpose() * &g;
        let [(name, found_shift)] = &confidence.shifts[..] else { panic!("{confidence:?}") };
        assert!(name == "c" && (found_shift[1] / shift[1] - 1.0).abs() < 1e-9, "{found_shift:?} {shift}");
        // Of an exact fit, only what is not known of c.
        let exact = Linearization { residuals: DVector::zeros(200), ..found };
        let exact = asked(&exact, ConfidenceOptions { held, ..abc() });
        assert!((exact.standard_errors[1] / shift[1].abs() - 1.0).abs() < 1e-9, "{exact:?}");
    }

    /// The noise is that which the fit of a and b left; the prior of c then widens their intervals.
    #[test]
    fn a_prior_beside_noise_of_the_residuals_widens_intervals() {
        let (found, _) = parabola(&[(200, 1.0)]);
        let at = |prior| asked(&found, ConfidenceOptions { colour: Colour::White, prior, ..abc() });
        let held = linearization(&[1.0, -2.0], found.residuals.as_slice(), found.jacobian.columns(0, 2).into_owned());
        let held = confidence(&held, Colour::White);
        let [narrow, wide, free] = [vec![None, None, Some(1e-9)], vec![None, None, Some(1.0)], vec![]].map(at);
        for index in 0..2 {
            assert!((narrow.standard_errors[index] / held.standard_errors[index] - 1.0).abs() < 1e-6);
            assert!((wide.standard_errors[index] / free.standard_errors[index] - 1.0).abs() < 0.01);
        }
        assert!(free.standard_errors[1] > 1.2 * held.standard_errors[1]);
        // All with a prior: the residuals are noise that no parameter has fitted.
        let all = at(vec![Some(1e-9); 3]);
        assert!(all.standard_errors.iter().all(|error| (error / 1e-9 - 1.0).abs() < 1e-3), "{all:?}");
    }

    #[test]
    fn parameters_that_enter_as_a_product_only_are_named() {
        // r = a b t − e at a = 2, b = 3
        let noise = normals(2, 30);
        let jacobian = DMatrix::from_fn(30, 2, |row, column| [3.0, 2.0][column] * row as f64);
        let found = confidence(&linearization(&[2.0, 3.0], &noise, jacobian), Colour::White);
        let Warning::NoEffect { combination } = &found.warnings[0] else { panic!("{found:?}") };
        assert!(["a·b^-1", "a^-1·b"].contains(&combination.as_str()), "{combination}");
        assert_eq!(found.standard_errors, [f64::INFINITY; 2]);
        assert_eq!(found.condition, f64::INFINITY);
        assert_eq!(found.warnings[1].to_string(), "a and b are correlated by -1.00");
    }

    #[test]
    fn a_combination_hidden_by_noise_has_a_warning_with_its_factor() {
        // ln-slopes: strong along a·b, weak along a/b, whose standard error is 1/0.05/√2.
        let rows = [[1e3, 1e3], [0.05, -0.05], [0.0, 0.0], [0.0, 0.0]];
        let jacobian = DMatrix::from_fn(4, 2, |row, column| rows[row][column]);
        let found = confidence(&linearization(&[1.0, 1.0], &[0.0, 0.0, 1.0, -1.0], jacobian), Colour::White);
        // t(2) = 4.3027, s = 1; the logarithm of a/b has the deviation 1/0.05.
        let factor = (4.3027_f64 * 20.0).exp();
        let Warning::PoorlyDetermined { combination, factor: found } = &found.warnings[0] else { panic!("{found:?}") };
        assert!(["a·b^-1", "a^-1·b"].contains(&combination.as_str()), "{combination}");
        assert_eq!(format!("{found:.0e}"), format!("{factor:.0e}"));
    }

    #[test]
    fn an_exact_fit_has_intervals_of_zero_width_and_a_warning() {
        let jacobian = DMatrix::from_fn(10, 2, |row, column| (row as f64).powi(column as i32));
        let found = confidence(&linearization(&[1.0, 2.0], &[0.0; 10], jacobian), Colour::Coloured);
        assert_eq!((&found.intervals[..], &found.standard_errors[..]), (&[[1.0; 2], [2.0; 2]][..], &[0.0; 2][..]));
        assert!(found.correlation.iter().chain(&found.gauss_newton_step).all(|value| value.is_finite()));
        let below = |warning: &Warning| matches!(warning, Warning::ResidualsBelowRoughness { .. });
        assert!(found.warnings.iter().any(below), "{found:?}");
    }

    #[test]
    fn a_parameter_without_effect_does_not_change_the_other() {
        let jacobian = DMatrix::from_fn(20, 2, |row, column| if column == 0 { row as f64 } else { 0.0 });
        let found = confidence(&linearization(&[1.0, 2.0], &normals(1, 20), jacobian), Colour::White);
        assert!(found.standard_errors[0].is_finite() && found.standard_errors[1].is_infinite());
        assert_eq!(found.warnings[0], Warning::NoEffect { combination: "b".into() });
    }

    #[test]
    fn an_estimate_off_the_minimum_has_a_warning() {
        let jacobian = DMatrix::from_element(20, 1, 1.0);
        let residuals: Vec<f64> = normals(4, 20).iter().map(|e| e + 2.0).collect();
        let found = confidence(&linearization(&[1.0], &residuals, jacobian), Colour::White);
        let off = |warning: &Warning| matches!(warning, Warning::NotAtMinimum { parameter, .. } if parameter == "a");
        assert!(found.warnings.iter().any(off), "{found:?}");
    }

    /// The table of coverage in docs/methods.md, section 15: shares of the intervals that hold the truth, within three
    /// standard deviations of what they promise, and far from it where coloured noise is taken for white.
    #[test]
    fn intervals_have_their_nominal_coverage() {
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
