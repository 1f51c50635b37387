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
    /// The objective has no value at a start nor at any fallback.
    #[error("{start}; nor at any of {tried} fallback starts, the last of them {last:?}: {cause}")]
    Fallback {
        /// The error of the start.
        start: Box<SearchError>,
        /// Number of fallbacks.
        tried: usize,
        /// The last of them.
        last: Vec<f64>,
        /// Why its trial failed.
        cause: String,
    },
    /// A trial failed, and the search stops at failures or cannot go on without it.
    #[error("a trial failed at {x:?}: {cause}")]
    Failed {
        /// The point.
        x: Vec<f64>,
        /// Why.
        cause: String,
        /// Whether a simulation failed numerically.
        numerical: bool,
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
            SearchError::Start { numerical, .. } | SearchError::Failed { numerical, .. } => *numerical,
            SearchError::Fallback { start, .. } => start.is_numerical(),
            _ => false,
        }
    }

    fn cause_of_trial(&self) -> Option<&str> {
        match self {
            SearchError::Start { cause, .. } | SearchError::Failed { cause, .. } => Some(cause),
            SearchError::Fallback { start, .. } => start.cause_of_trial(),
            _ => None,
        }
    }
}
