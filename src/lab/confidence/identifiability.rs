//! Identifiability of the parameters of an estimate.
//!
//! Directions in the logarithms of the parameters are the right singular vectors of ∂r/∂ln x (Belsley, Kuh and Welsch,
//! *Regression Diagnostics*, 1980). One without effect on the residuals is not identifiable; one with a wide interval of
//! the linear model is poorly determined.

use nalgebra::DMatrix;

use super::linearization::Linearization;
use super::warning::Warning;

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
