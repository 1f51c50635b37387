//! The linear model of residuals about an estimate.

use nalgebra::{DMatrix, DVector};

use crate::error::{Error, refusal};

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
