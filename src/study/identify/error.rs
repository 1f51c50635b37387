//! Why a search has no result.

use std::error::Error;

use thiserror::Error;

use super::pool::trial_pool::PoolError;

/// Why a search has no result.
#[derive(Debug, Error)]
pub enum SearchError {
    /// There are no more trials.
    #[error(transparent)]
    Pool(#[from] PoolError),
    /// The objective has no value at a start.
    #[error("the objective has no value at the start {x:?}: {cause}")]
    Start {
        /// The start.
        x: Vec<f64>,
        /// Why its trial failed.
        cause: String,
        /// Whether a simulation failed numerically.
        numerical: bool,
    },
    /// There is no derivative.
    #[error("a trial failed at {x:?}: the trials on both sides failed, there is no derivative")]
    NoDerivative {
        /// The point of the second of them.
        x: Vec<f64>,
    },
    /// The method needs residuals.
    #[error(
        "levenberg-marquardt needs residuals, and the objective gave a number: return a signal or a list, or use \
         nelder-mead"
    )]
    NotResiduals,
    /// The number of residuals changed.
    #[error("the objective gave {found} residuals at {x:?}, and {expected} at the start")]
    Residuals {
        /// The point.
        x: Vec<f64>,
        /// Number of residuals there.
        found: usize,
        /// Number of residuals at the start.
        expected: usize,
    },
    /// There are fewer residuals than unknowns.
    #[error("the objective gave {found} residuals for {unknowns} unknowns: levenberg-marquardt needs at least as many")]
    TooFew {
        /// Number of residuals.
        found: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// CMA-ES rejects its options.
    #[error("cma-es cannot start: {0}")]
    CmaEs(String),
}

/// An error of a search, or of what follows one.
pub(crate) trait SearchFailure: Error + 'static {
    /// Whether a simulation failed numerically.
    fn is_numerical(&self) -> bool;

    /// Why the trial failed without which there is no result; none where no trial did.
    fn cause_of_trial(&self) -> Option<&str>;
}

impl SearchFailure for SearchError {
    fn is_numerical(&self) -> bool {
        match self {
            SearchError::Start { numerical, .. } => *numerical,
            _ => false,
        }
    }

    fn cause_of_trial(&self) -> Option<&str> {
        match self {
            SearchError::Start { cause, .. } => Some(cause),
            _ => None,
        }
    }
}
