//! How a law is fitted, and why it cannot be.

use thiserror::Error;

use super::Weighting;

/// How a law is fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitOptions {
    /// Reference of the residuals.
    pub weighting: Weighting,
    /// Stretch up to which the law is to be stable in every kind of tension; the largest of the tests where none is
    /// given.
    pub stable_to: Option<f64>,
}

/// Why a law cannot be fitted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FitError {
    /// There is no test, or none has a weight.
    #[error("no test has a weight above zero")]
    NoData,
    /// There are fewer stresses than coefficients.
    #[error("{samples} measured stresses for {unknowns} coefficients: there must be more stresses than coefficients")]
    TooFew {
        /// Number of stresses.
        samples: usize,
        /// Number of coefficients.
        unknowns: usize,
    },
    /// The law has no finite stress at the measured stretches.
    #[error("the law has no finite stress at the measured stretches")]
    NoValue,
    /// No coefficients with a stiffness at rest fit.
    #[error("no coefficients that fit have a stiffness at rest")]
    NoStiffness,
    /// The stretch up to which the law is to be stable is not above one.
    #[error("expected a largest stretch above 1, found {0}")]
    StableTo(f64),
}

impl FitError {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            FitError::TooFew { .. } => Some("fit a law with fewer coefficients, or add tests"),
            FitError::NoValue | FitError::NoStiffness => {
                Some("check signs, units and the order of the columns: nominal stress grows with stretch")
            }
            FitError::NoData | FitError::StableTo(_) => None,
        }
    }
}
