//! Covariance of the parameters of a linear model with correlated noise.
//!
//! With S = J·diag(x) = U Σ Vᵀ and noise of covariance γ R in each part of the residuals, least squares estimates
//! scatter in ln x with the covariance
//!
//! C = V Σ⁻¹ (Σ_parts γ Uᵀ R U) Σ⁻¹ Vᵀ
//!
//! the sandwich (Huber 1967). R and γ are assumed, see [`Misfit`], or those of the residuals, see [`Noise`]: R is an
//! autoregressive estimate, and the fit absorbs tr(Uᵀ R U) samples of the noise of a part, hence
//! γ = ‖r‖²/(n − tr(Uᵀ R U)). White noise in one part gives the textbook's s² (JᵀJ)⁻¹.
//!
//! A parameter that the fit held adds its own effect on the residuals to R, and a Gaussian prior of a fitted one is a
//! further row of S: equations (126) and (127) of docs/methods.md.

use nalgebra::{DMatrix, DVector};

use super::estimate::Direction;
use super::noise::{Colour, Misfit, Noise};
use super::{ConfidenceOptions, Linearization};
use crate::error::{Error, refusal};
use base::number::significant;

/// Singular values below this share of the largest are rounding errors.
const ROUNDING: f64 = 1e-7;

/// Limit of iterations of the singular value decomposition.
const MAX_ITERATIONS: usize = 10_000;

/// Lower limit of the degrees of freedom of an interval.
const MIN_FREEDOM: f64 = 1.0;

/// Smallest number of samples of a part that the fit must not absorb.
const MIN_LEFT: f64 = 0.5;

/// The noise of one part of the residuals.
pub(super) struct PartNoise {
    noise: Noise,
    /// γ
    variance: f64,
    /// Number of independent samples with the same information.
    pub(super) effective_samples: f64,
    /// Degrees of freedom of γ Uᵀ R U; infinite where it is assumed.
    freedom: f64,
}

impl PartNoise {
    /// The noise that the residuals of part `number`, from one, show, of which the fit absorbs some; from the rows of
    /// U, whose first `rank` columns have an effect.
    fn of_residuals(
        number: usize,
        residuals: &[f64],
        left: &DMatrix<f64>,
        rank: usize,
        colour: Colour,
    ) -> Result<PartNoise, Error> {
        let noise = Noise::from_residuals(residuals, colour);
        let samples = residuals.len() as f64;
        let parameters = trace(&Noise::white(), left, rank);
        if samples - parameters < MIN_LEFT {
            let (samples, absorbed) = (residuals.len(), significant(parameters, 2));
            return Err(refusal!(
                "part {number} of the residuals has {samples}, of which the fit absorbs {absorbed}: its noise is undetermined"
            ));
        }
        let effective_samples = effective_samples(&noise, left, rank);
        let independent = (effective_samples - parameters).max(MIN_FREEDOM);
        let power = residuals.iter().map(|r| r * r).sum::<f64>() / samples;
        Ok(PartNoise {
            variance: power / (independent / effective_samples).min(1.0),
            effective_samples,
            freedom: freedom(samples, effective_samples, independent, noise.order()),
            noise,
        })
    }

    /// The assumed noise of a part, whose size is no estimate.
    fn assumed(misfit: Misfit, left: &DMatrix<f64>, rank: usize) -> PartNoise {
        let noise = Noise::exponential(misfit.correlation);
        PartNoise {
            variance: misfit.error * misfit.error / left.nrows() as f64,
            effective_samples: effective_samples(&noise, left, rank),
            freedom: f64::INFINITY,
            noise,
        }
    }
}

/// tr(Uᵀ R U) over the directions with an effect.
fn trace(noise: &Noise, left: &DMatrix<f64>, rank: usize) -> f64 {
    noise.covariance(left).diagonal().rows(0, rank).sum()
}

fn effective_samples(noise: &Noise, left: &DMatrix<f64>, rank: usize) -> f64 {
    let (samples, parameters) = (left.nrows() as f64, trace(&Noise::white(), left, rank));
    // Noise power along a direction over that of white noise.
    let inflation = if parameters == 0.0 { 1.0 } else { trace(noise, left, rank) / parameters };
    (samples / inflation).min(samples)
}

/// Degrees of freedom of the noise of a part. The logarithm of the power of an autoregression at low frequencies has
/// the variance (2 + 4τ)/N with the inflation τ, or the order where that is larger (Berk, Ann. Statist. 2, 1974); ν
/// degrees of freedom correspond to a variance of 2/ν.
fn freedom(samples: f64, effective_samples: f64, independent: f64, order: usize) -> f64 {
    let inflation = samples / effective_samples;
    let known = samples / (1.0 + 2.0 * inflation.max(order as f64));
    let freedom = if order == 0 { independent } else { independent.min(known) };
    freedom.max(MIN_FREEDOM)
}

/// The noise that a part of the residuals, or the priors, contribute to the covariance.
struct Part {
    /// γ
    variance: f64,
    /// Uᵀ R U over the part.
    between: DMatrix<f64>,
    /// Degrees of freedom of γ Uᵀ R U.
    freedom: f64,
}

/// A singular value decomposition U Σ Vᵀ.
struct Decomposition {
    singular: DVector<f64>,
    left: DMatrix<f64>,
    right: DMatrix<f64>,
    /// Number of directions with an effect on the residuals.
    rank: usize,
}

impl Decomposition {
    fn from_matrix(matrix: DMatrix<f64>) -> Result<Decomposition, Error> {
        if matrix.ncols() == 0 {
            let (left, right) = (matrix, DMatrix::zeros(0, 0));
            return Ok(Decomposition { singular: DVector::zeros(0), left, right, rank: 0 });
        }
        let singular =
            || refusal!("the Jacobian has no singular value decomposition: its entries differ too much in size");
        let svd = matrix.try_svd(true, true, f64::EPSILON, MAX_ITERATIONS).ok_or_else(singular)?;
        let left = svd.u.ok_or_else(singular)?;
        let right = svd.v_t.ok_or_else(singular)?.transpose();
        let singular = svd.singular_values;
        let rank = singular.iter().filter(|value| **value > ROUNDING * singular[0]).count();
        Ok(Decomposition { singular, left, right, rank })
    }
}

/// The covariance in the logarithms of the parameters.
pub(super) struct Covariance {
    /// Unit of every parameter: its size, or one where it is zero.
    scale: Vec<f64>,
    singular: DVector<f64>,
    /// U, with the rows of the priors behind those of the residuals.
    left: DMatrix<f64>,
    /// Directions in the logarithms of the parameters, one a column.
    right: DMatrix<f64>,
    /// Number of directions with an effect on the residuals.
    rank: usize,
    /// The noise of the parts of the residuals.
    pub(super) noise: Vec<PartNoise>,
    parts: Vec<Part>,
    /// Mean variance of the noise.
    variance: f64,
    /// Σ γ Uᵀ R U over the mean variance.
    between: DMatrix<f64>,
}

impl Covariance {
    /// The covariance of the estimate at `linearization`, whose noise and priors `options` give. A column of
    /// `disturbances` is the change of the residuals by one standard deviation of a parameter that the fit held.
    pub(super) fn from_linearization(
        linearization: &Linearization,
        disturbances: &DMatrix<f64>,
        options: &ConfidenceOptions,
    ) -> Result<Covariance, Error> {
        let scale: Vec<f64> = linearization.x.iter().map(|x| if *x == 0.0 { 1.0 } else { x.abs() }).collect();
        let mut scaled = linearization.jacobian.clone();
        scaled.column_iter_mut().zip(&scale).for_each(|(mut column, scale)| column *= *scale);
        let prior = |index: usize| options.prior.get(index).copied().flatten();
        let known: Vec<(usize, f64)> = (0..scale.len()).filter_map(|index| Some((index, prior(index)?))).collect();
        // The fit that left the residuals held the parameters with a prior at their values.
        let fitted: Vec<usize> = (0..scale.len()).filter(|index| prior(*index).is_none()).collect();
        let fit = Decomposition::from_matrix(scaled.select_columns(&fitted))?;
        let noise = noise(linearization, options, &fit)?;
        let weight = if known.is_empty() { 0.0 } else { power(&noise, linearization, &fit).sqrt() };
        let samples = scaled.nrows();
        let Decomposition { singular, left, right, rank } = match known.is_empty() {
            true => fit,
            false => {
                let mut rows = scaled.insert_rows(samples, known.len(), 0.0);
                for (row, (index, deviation)) in known.iter().enumerate() {
                    rows[(samples + row, *index)] = weight * scale[*index] / deviation;
                }
                Decomposition::from_matrix(rows)?
            }
        };
        let part = |(noise, left): (&PartNoise, DMatrix<f64>)| {
            let between = noise.noise.covariance(&left);
            Part { variance: noise.variance, between, freedom: noise.freedom }
        };
        let mut parts: Vec<Part> = noise.iter().zip(over_parts(&left, &linearization.parts)).map(part).collect();
        let lengths = linearization.parts.iter().map(|length| *length as f64);
        let mean = parts.iter().zip(lengths).map(|(part, length)| length * part.variance).sum::<f64>() / samples as f64;
        let variance = if mean == 0.0 && disturbances.ncols() > 0 { 1.0 } else { mean };
        if disturbances.ncols() > 0 {
            let along = left.rows(0, samples).transpose() * disturbances;
            parts.push(Part { variance: 1.0, between: &along * along.transpose(), freedom: f64::INFINITY });
        }
        if !known.is_empty() {
            let between = Noise::white().covariance(&left.rows(samples, known.len()).into_owned());
            parts.push(Part { variance: weight * weight, between, freedom: f64::INFINITY });
        }
        let mut between = DMatrix::zeros(left.ncols(), left.ncols());
        for part in &parts {
            // Parts of an exact fit all have zero variance.
            between += &part.between * if variance == 0.0 { 1.0 } else { part.variance / variance };
        }
        Ok(Covariance { scale, singular, left, right, rank, noise, parts, variance, between })
    }

    /// Degrees of freedom of the variance of a parameter, which is a sum over the parts (Satterthwaite, Biometrics
    /// Bull. 2, 1946); the smallest of all parameters.
    pub(super) fn freedom(&self) -> f64 {
        let share = |part: &Part| {
            let entry = |i: usize, j: usize| match self.has_effect(i) && self.has_effect(j) {
                true => part.between[(i, j)] / (self.strength(i) * self.strength(j)),
                false => 0.0,
            };
            self.in_parameters(entry).diagonal() * part.variance
        };
        let shares: Vec<DVector<f64>> = self.parts.iter().map(share).collect();
        let all: DVector<f64> = shares.iter().sum();
        let of = |index: usize| {
            let part = |(part, share): (&Part, &DVector<f64>)| (share[index] / all[index]).powi(2) / part.freedom;
            1.0 / self.parts.iter().zip(&shares).map(part).sum::<f64>()
        };
        let scattered = (0..all.len()).filter(|index| all[*index] > 0.0);
        let freedom = scattered.map(of).fold(f64::INFINITY, f64::min);
        let fewest = self.noise.iter().map(|part| part.freedom).fold(f64::INFINITY, f64::min);
        if freedom.is_finite() { freedom } else { fewest }
    }

    /// Covariance in ln x for noise of variance one.
    fn unit_covariance(&self) -> DMatrix<f64> {
        let between = |i: usize, j: usize| match self.has_effect(i) && self.has_effect(j) {
            true => self.between[(i, j)],
            false => f64::from(u8::from(i == j)),
        };
        self.in_parameters(|i, j| between(i, j) / (self.strength(i) * self.strength(j)))
    }

    /// Singular value of a direction; at least that of rounding.
    fn strength(&self, direction: usize) -> f64 {
        self.singular[direction].max(ROUNDING * self.singular[0]).max(f64::MIN_POSITIVE.sqrt())
    }

    /// V A Vᵀ
    fn in_parameters(&self, entry: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        let count = self.singular.len();
        let sum = |row: usize, column: usize| -> f64 {
            let term = |i: usize, j: usize| self.right[(row, i)] * entry(i, j) * self.right[(column, j)];
            (0..count).flat_map(|i| (0..count).map(move |j| (i, j))).map(|(i, j)| term(i, j)).sum()
        };
        DMatrix::from_fn(count, count, |row, column| sum(row.max(column), row.min(column)))
    }

    /// Whether a direction has an effect on the residuals.
    fn has_effect(&self, direction: usize) -> bool {
        direction < self.rank
    }

    /// Whether a parameter is part of a direction without effect.
    fn is_undetermined(&self, index: usize) -> bool {
        (self.rank..self.singular.len()).any(|direction| self.right[(index, direction)].abs() > ROUNDING)
    }

    /// Covariance of the parameters; infinite for one in a direction without effect.
    pub(super) fn matrix(&self) -> DMatrix<f64> {
        let unit = self.unit_covariance();
        DMatrix::from_fn(self.scale.len(), self.scale.len(), |i, j| {
            let value = self.variance * unit[(i, j)] * self.scale[i] * self.scale[j];
            if self.is_undetermined(i) || self.is_undetermined(j) {
                f64::INFINITY.copysign(unit[(i, j)])
            } else {
                value
            }
        })
    }

    pub(super) fn correlation(&self) -> DMatrix<f64> {
        let unit = self.unit_covariance();
        let deviation = |index: usize| unit[(index, index)].sqrt();
        DMatrix::from_fn(self.scale.len(), self.scale.len(), |i, j| {
            if i == j { 1.0 } else { (unit[(i, j)] / (deviation(i) * deviation(j))).clamp(-1.0, 1.0) }
        })
    }

    /// Largest over smallest singular value.
    pub(super) fn condition(&self) -> f64 {
        let smallest = self.singular[self.singular.len() - 1];
        if self.rank < self.singular.len() { f64::INFINITY } else { self.singular[0] / smallest }
    }

    /// Combinations of parameters by decreasing singular value; `quantile` is that of an interval.
    pub(super) fn directions(&self, quantile: f64) -> Vec<Direction> {
        let direction = |i: usize| {
            let deviation = (self.variance * self.between[(i, i)]).sqrt() / self.singular[i];
            Direction {
                exponents: self.right.column(i).iter().copied().collect(),
                half_width: if self.has_effect(i) { quantile * deviation } else { f64::INFINITY },
                share: if self.has_effect(i) { self.singular[i] / self.singular[0] } else { 0.0 },
            }
        };
        (0..self.singular.len()).map(direction).collect()
    }

    /// The Gauss–Newton step over the standard errors.
    pub(super) fn gauss_newton_step(&self, linearization: &Linearization, standard_errors: &[f64]) -> Vec<f64> {
        let relative = |(step, error): (f64, &f64)| if *error > 0.0 { step / error } else { 0.0 };
        self.step(&linearization.residuals).into_iter().zip(standard_errors).map(relative).collect()
    }

    /// The step −V Σ⁻¹ Uᵀ r of the parameters, in their units, that compensates the residuals r; the priors are centred
    /// at the estimate.
    pub(super) fn step(&self, residuals: &DVector<f64>) -> Vec<f64> {
        let along = |i: usize| -self.left.column(i).rows(0, residuals.len()).dot(residuals) / self.singular[i];
        let along: Vec<f64> = (0..self.rank).map(along).collect();
        let step = |index: usize| -> f64 {
            let parts = along.iter().enumerate().map(|(i, along)| self.right[(index, i)] * along);
            self.scale[index] * parts.sum::<f64>()
        };
        (0..self.scale.len()).map(step).collect()
    }
}

/// The rows of a matrix that belong to parts of these lengths, one behind the other.
fn over_parts<'a>(matrix: &'a DMatrix<f64>, lengths: &'a [usize]) -> impl Iterator<Item = DMatrix<f64>> + 'a {
    let mut first = 0;
    lengths.iter().map(move |length| {
        first += length;
        matrix.rows(first - length, *length).into_owned()
    })
}

/// The noise of all parts, as assumed or as the residuals show it beside `fit`.
fn noise(
    linearization: &Linearization,
    options: &ConfidenceOptions,
    fit: &Decomposition,
) -> Result<Vec<PartNoise>, Error> {
    let count = linearization.parts.len();
    if let Some(found) = options.misfit.as_ref().map(Vec::len).filter(|found| ![1, count].contains(found)) {
        return Err(refusal!(
            "`misfit` has {found} errors for {count} parts of the residuals: expected one, or one for each part"
        ));
    }
    let mut rest = linearization.residuals.as_slice();
    let parts = over_parts(&fit.left, &linearization.parts).enumerate().map(|(index, left)| {
        let residuals;
        (residuals, rest) = rest.split_at(left.nrows());
        match &options.misfit {
            Some(misfits) => Ok(PartNoise::assumed(misfits[index % misfits.len()], &left, fit.rank)),
            None => PartNoise::of_residuals(index + 1, residuals, &left, fit.rank, options.colour),
        }
    });
    parts.collect()
}

/// Mean power of the noise along the directions of `fit`, or of all samples where it has none.
fn power(noise: &[PartNoise], linearization: &Linearization, fit: &Decomposition) -> f64 {
    let (mut along, mut all) = (0.0, 0.0);
    for (part, left) in noise.iter().zip(over_parts(&fit.left, &linearization.parts)) {
        along += part.variance * trace(&part.noise, &left, fit.rank);
        all += part.variance * left.nrows() as f64;
    }
    if fit.rank == 0 { all / fit.left.nrows() as f64 } else { along / fit.rank as f64 }
}
