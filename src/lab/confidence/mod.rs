//! How well estimated parameters are known: covariance and intervals of a linear model, and identifiability.
//!
//! Searches and fits of laws linearize their residuals; what follows from that is here.

mod covariance;
mod estimate;
mod noise;
mod warning;

use nalgebra::{DMatrix, DVector};

use crate::error::{Error, refusal};

pub use estimate::{Confidence, Direction};
pub use noise::{Colour, Misfit, Noise};
pub use warning::{CODES, Warning};

/// The linear model r(x̂ + δ) ≈ r(x̂) + J δ.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearization {
    /// The estimate x̂.
    pub x: Vec<f64>,
    /// r(x̂)
    pub residuals: DVector<f64>,
    /// Numbers of residuals of the parts that the residuals are joined from, such as signals; each has noise of its own
    /// variance and correlation.
    pub parts: Vec<usize>,
    /// J = ∂r/∂x, residuals × parameters.
    pub jacobian: DMatrix<f64>,
    /// Largest ‖r(x + h) − 2 r(x) + r(x − h)‖ over the parameters: curvature and roughness over the step of the
    /// differences.
    pub roughness: f64,
    /// Parameters with a one-sided difference: the other side lies beyond a bound or failed.
    pub one_sided: Vec<usize>,
}

impl Linearization {
    /// The linearization for residuals that are joined from parts of these lengths, in their order.
    ///
    /// # Errors
    /// The lengths do not add up to the number of residuals.
    pub fn joined_from(self, parts: &[usize]) -> Result<Linearization, Error> {
        let (sum, found) = (parts.iter().fold(0_usize, |sum, part| sum.saturating_add(*part)), self.residuals.len());
        if sum != found {
            return Err(refusal!(
                "`parts` {parts:?} are {sum} residuals together, and the objective gave {found}: expected the lengths of the \
                 lists that it joins, in their order"
            ));
        }
        Ok(Linearization { parts: parts.into(), ..self })
    }

    /// The linearization in the parameters that are not `held`, and the columns of the Jacobian of those that are.
    pub(super) fn without(&self, held: &[usize]) -> (Linearization, DMatrix<f64>) {
        let fitted: Vec<usize> = (0..self.x.len()).filter(|index| !held.contains(index)).collect();
        let place = |index: &usize| fitted.iter().position(|fitted| fitted == index);
        let linearization = Linearization {
            x: fitted.iter().map(|index| self.x[*index]).collect(),
            jacobian: self.jacobian.select_columns(&fitted),
            one_sided: self.one_sided.iter().filter_map(place).collect(),
            ..self.clone()
        };
        (linearization, self.jacobian.select_columns(held))
    }

    /// The norm of the residuals, ‖r(x̂)‖.
    pub fn norm(&self) -> f64 {
        self.residuals.norm()
    }
}

/// Options of confidence intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfidenceOptions {
    /// Names of the parameters.
    pub names: Vec<String>,
    /// Assumed noise of the residuals.
    pub colour: Colour,
    /// Whether intervals are symmetric in the logarithm, as for multipliers.
    pub relative: bool,
    /// An assumed error of each part of the residuals, or one for all, instead of the noise that the residuals show.
    pub misfit: Option<Vec<Misfit>>,
    /// Standard deviations of Gaussian priors of fitted parameters about the estimate, in their units; none for
    /// parameters that only the residuals determine, and for those behind the end. (127) of docs/methods.md.
    pub prior: Vec<Option<f64>>,
    /// Standard deviations of parameters that the fit held at their values, in their units; none for fitted ones, and
    /// for those behind the end. (126) of docs/methods.md.
    pub held: Vec<Option<f64>>,
}

impl ConfidenceOptions {
    /// Coloured noise and absolute intervals of parameters without priors.
    pub fn new(names: Vec<String>) -> ConfidenceOptions {
        ConfidenceOptions {
            names,
            colour: Colour::Coloured,
            relative: false,
            misfit: None,
            prior: vec![],
            held: vec![],
        }
    }

    /// The parameters that the fit held, and their standard deviations.
    pub(super) fn held(&self) -> impl Iterator<Item = (usize, f64)> {
        self.held.iter().enumerate().filter_map(|(index, deviation)| Some((index, (*deviation)?)))
    }

    /// The options without the parameters that the fit held.
    pub(super) fn of_fitted(&self) -> ConfidenceOptions {
        let is_fitted = |index: usize| self.held.get(index).copied().flatten().is_none();
        let names = self.names.iter().enumerate().filter(|(index, _)| is_fitted(*index));
        let prior = self.prior.iter().enumerate().filter(|(index, _)| is_fitted(*index));
        ConfidenceOptions {
            names: names.map(|(_, name)| name.clone()).collect(),
            prior: prior.map(|(_, deviation)| *deviation).collect(),
            held: vec![],
            ..self.clone()
        }
    }
}
