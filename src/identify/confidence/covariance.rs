//! Covariance of the parameters of a linear model with correlated noise.
//!
//! With S = J·diag(x) = U Σ Vᵀ and noise of covariance γ R in each part of the residuals, least squares estimates
//! scatter in ln x with the covariance
//!
//! C = V Σ⁻¹ (Σ_parts γ Uᵀ R U) Σ⁻¹ Vᵀ
//!
//! the sandwich (Huber 1967) with an autoregressive estimate of R, see [`Noise`]. The fit absorbs tr(Uᵀ R U) samples of
//! the noise of a part, hence γ = ‖r‖²/(n − tr(Uᵀ R U)). White noise in one part gives the textbook's s² (JᵀJ)⁻¹.

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::identifiability::Direction;
use super::linearization::Linearization;
use super::noise::{Colour, Noise};

/// Singular values below this share of the largest are rounding errors.
const ROUNDING: f64 = 1e-7;

/// Limit of iterations of the singular value decomposition.
const MAX_ITERATIONS: usize = 10_000;

/// Lower limit of the degrees of freedom of an interval.
const MIN_FREEDOM: f64 = 1.0;

/// Smallest number of samples of a part that the fit must not absorb.
const MIN_LEFT: f64 = 0.5;

/// Why a linear model has no covariance.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CovarianceError {
    /// The singular values cannot be computed.
    #[error("the Jacobian has no singular value decomposition: its entries differ too much in size")]
    Singular,
    /// The fit absorbs all samples of a part.
    #[error(
        "part {number} of the residuals has {samples}, of which the fit absorbs {absorbed:.1}: its noise is \
         undetermined"
    )]
    Absorbed {
        /// The part, from one.
        number: usize,
        /// Number of its residuals.
        samples: usize,
        /// Number of residuals that the fit absorbs.
        absorbed: f64,
    },
}

/// The noise of one part of the residuals.
pub(super) struct Part {
    /// γ
    variance: f64,
    /// Uᵀ R U over the part.
    between: DMatrix<f64>,
    /// Number of independent samples with the same information.
    pub(super) effective_samples: f64,
    /// Degrees of freedom of γ Uᵀ R U.
    freedom: f64,
}

impl Part {
    /// From the rows of U of part `number`, from one; the first `rank` columns have an effect.
    fn of(
        number: usize,
        residuals: &[f64],
        left: &DMatrix<f64>,
        rank: usize,
        colour: Colour,
    ) -> Result<Part, CovarianceError> {
        let noise = Noise::of(residuals, colour);
        let between = noise.covariance(left);
        let trace = |between: &DMatrix<f64>| between.diagonal().rows(0, rank).sum();
        let samples = residuals.len() as f64;
        let parameters = trace(&Noise::white().covariance(left));
        if samples - parameters < MIN_LEFT {
            return Err(CovarianceError::Absorbed { number, samples: residuals.len(), absorbed: parameters });
        }
        // Noise power along a direction over that of white noise.
        let inflation = if parameters == 0.0 { 1.0 } else { trace(&between) / parameters };
        let effective_samples = (samples / inflation).min(samples);
        let independent = (effective_samples - parameters).max(MIN_FREEDOM);
        let power = residuals.iter().map(|r| r * r).sum::<f64>() / samples;
        Ok(Part {
            variance: power / (independent / effective_samples).min(1.0),
            between,
            effective_samples,
            freedom: freedom(samples, effective_samples, independent, noise.order()),
        })
    }
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

/// The covariance in the logarithms of the parameters.
pub(super) struct Covariance {
    /// Unit of every parameter: its size, or one where it is zero.
    scale: Vec<f64>,
    singular: DVector<f64>,
    /// U
    left: DMatrix<f64>,
    /// Directions in the logarithms of the parameters, one a column.
    right: DMatrix<f64>,
    /// Number of directions with an effect on the residuals.
    rank: usize,
    pub(super) parts: Vec<Part>,
    /// Mean variance of the noise.
    variance: f64,
    /// Σ γ Uᵀ R U over the mean variance.
    between: DMatrix<f64>,
}

impl Covariance {
    pub(super) fn of(linearization: &Linearization, colour: Colour) -> Result<Covariance, CovarianceError> {
        let scale: Vec<f64> = linearization.x.iter().map(|x| if *x == 0.0 { 1.0 } else { x.abs() }).collect();
        let mut scaled = linearization.jacobian.clone();
        scaled.column_iter_mut().zip(&scale).for_each(|(mut column, scale)| column *= *scale);
        let svd = scaled.try_svd(true, true, f64::EPSILON, MAX_ITERATIONS).ok_or(CovarianceError::Singular)?;
        let singular = svd.singular_values;
        let left = svd.u.ok_or(CovarianceError::Singular)?;
        let right = svd.v_t.ok_or(CovarianceError::Singular)?.transpose();
        let rank = singular.iter().filter(|value| **value > ROUNDING * singular[0]).count();
        let mut parts = Vec::new();
        let mut first = 0;
        for (index, length) in linearization.parts.iter().enumerate() {
            let residuals = &linearization.residuals.as_slice()[first..first + length];
            parts.push(Part::of(index + 1, residuals, &left.rows(first, *length).into_owned(), rank, colour)?);
            first += length;
        }
        let lengths = linearization.parts.iter().map(|length| *length as f64);
        let variance =
            parts.iter().zip(lengths).map(|(part, length)| length * part.variance).sum::<f64>() / first as f64;
        let mut between = DMatrix::zeros(left.ncols(), left.ncols());
        for part in &parts {
            // Parts of an exact fit all have zero variance.
            between += &part.between * if variance == 0.0 { 1.0 } else { part.variance / variance };
        }
        Ok(Covariance { scale, singular, left, right, rank, parts, variance, between })
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
        let fewest = self.parts.iter().map(|part| part.freedom).fold(f64::INFINITY, f64::min);
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

    /// Variance of each parameter over (JᵀJ)⁻¹.
    pub(super) fn increases(&self) -> Vec<f64> {
        let white = self.in_parameters(|i, j| if i == j { self.strength(i).powi(-2) } else { 0.0 });
        let unit = self.unit_covariance();
        (0..self.scale.len()).map(|index| self.variance * unit[(index, index)] / white[(index, index)]).collect()
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

    /// The Gauss–Newton step −V Σ⁻¹ Uᵀ r over the standard errors.
    pub(super) fn gauss_newton_step(&self, linearization: &Linearization, standard_errors: &[f64]) -> Vec<f64> {
        let along: Vec<f64> =
            (0..self.rank).map(|i| -self.left.column(i).dot(&linearization.residuals) / self.singular[i]).collect();
        let step = |index: usize| -> f64 {
            let parts = along.iter().enumerate().map(|(i, along)| self.right[(index, i)] * along);
            self.scale[index] * parts.sum::<f64>()
        };
        let relative = |(index, error): (usize, &f64)| if *error > 0.0 { step(index) / error } else { 0.0 };
        standard_errors.iter().enumerate().map(relative).collect()
    }
}
