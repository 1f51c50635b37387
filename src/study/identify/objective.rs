//! The objective of a search, and the outcome of one trial.

use std::error::Error;
use std::fmt;
use std::sync::Arc;

use thiserror::Error;

use crate::script::Compared;
use base::cancellation::Cancellation;

/// An objective function: a scalar, or residuals whose sum of squares is minimized.
///
/// It is evaluated from several threads at once, in any order, also at points whose values the search may not use. A closure `Fn(&[f64]) -> T` is one where `T` is `f64`, `Vec<f64>` (residuals) or a `Result` of these.
pub trait Objective: Sync {
    /// The outcome at `x`, a function of `x` alone, with the curves that were compared with references. That of a cancelled evaluation is
    /// discarded.
    fn trial(&self, x: &[f64], cancellation: &Cancellation) -> Trial;
}

impl<F, T> Objective for F
where
    F: Fn(&[f64]) -> T + Sync,
    T: Into<Evaluation>,
{
    fn trial(&self, x: &[f64], _: &Cancellation) -> Trial {
        self(x).into().into()
    }
}

/// One trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The outcome.
    pub evaluation: Evaluation,
    /// Simulated curves that were compared with references.
    pub compared: Vec<Compared>,
}

/// The outcome of one trial.
#[derive(Clone, Debug, PartialEq)]
pub enum Evaluation {
    /// A finite value.
    Value(ObjectiveValue),
    /// There is no value at this point.
    Failed {
        /// Why.
        cause: String,
        /// Whether a simulation failed numerically.
        numerical: bool,
    },
    /// The search has to stop.
    Fatal(FatalError),
}

/// The value of an objective.
#[derive(Clone, Debug, PartialEq)]
pub enum ObjectiveValue {
    /// A scalar.
    Scalar(f64),
    /// Residuals; the objective value is their Euclidean norm.
    Residuals(Vec<f64>),
}

/// An error that ends the whole search. It is stored with its trial, since the search and not the order in which trials
/// end decides which error counts.
#[derive(Clone, Debug, Error)]
#[error("{0}")]
pub struct FatalError(Arc<dyn Error + Send + Sync>);

/// Why a search, or an estimate about its result, has no result.
#[derive(Clone, Debug, Error)]
pub enum SearchError {
    /// The objective cannot be evaluated any more.
    #[error("{0}")]
    Fatal(#[from] FatalError),
    /// The search was ended, for an error that is reported elsewhere.
    #[error("the search was ended")]
    Ended,
    /// A trial failed without which there is no result.
    #[error("{place}: {cause}")]
    Trial {
        /// Where, in words.
        place: String,
        /// Why it failed.
        cause: String,
        /// Whether a simulation failed numerically.
        numerical: bool,
    },
    /// What is searched, or what the objective gives, does not suit.
    #[error("{0}")]
    Refused(String),
}

/// What is searched, or what the objective gives, does not suit for this cause, a text as that of `format!`.
macro_rules! refused {
    ($($cause:tt)*) => { $crate::identify::objective::SearchError::Refused(format!($($cause)*)) };
}
pub(crate) use refused;

impl SearchError {
    /// Whether a simulation failed numerically.
    pub(crate) fn is_numerical(&self) -> bool {
        matches!(self, SearchError::Trial { numerical: true, .. })
    }

    /// Why the trial failed without which there is no result; none where no trial did.
    pub(crate) fn cause_of_trial(&self) -> Option<&str> {
        match self {
            SearchError::Trial { cause, .. } => Some(cause),
            _ => None,
        }
    }
}

impl From<Evaluation> for Trial {
    fn from(evaluation: Evaluation) -> Trial {
        Trial { evaluation, compared: Vec::new() }
    }
}

impl Evaluation {
    /// A trial without a value, for a cause that is not numerical.
    pub fn failed(cause: impl Into<String>) -> Evaluation {
        Evaluation::Failed { cause: cause.into(), numerical: false }
    }

    /// The value; a trial that failed is an error at this place.
    pub(super) fn value_at(self, place: impl FnOnce() -> String) -> Result<ObjectiveValue, SearchError> {
        match self {
            Evaluation::Value(value) => Ok(value),
            Evaluation::Failed { cause, numerical } => Err(SearchError::Trial { place: place(), cause, numerical }),
            Evaluation::Fatal(error) => Err(error.into()),
        }
    }
}

/// A value that is not finite is a failed trial.
impl From<ObjectiveValue> for Evaluation {
    fn from(value: ObjectiveValue) -> Evaluation {
        let finite = match &value {
            ObjectiveValue::Scalar(value) => value.is_finite(),
            ObjectiveValue::Residuals(residuals) => residuals.iter().all(|r| r.is_finite()),
        };
        if finite { Evaluation::Value(value) } else { Evaluation::failed("the objective is not finite") }
    }
}

impl From<f64> for Evaluation {
    fn from(value: f64) -> Evaluation {
        ObjectiveValue::Scalar(value).into()
    }
}

impl From<Vec<f64>> for Evaluation {
    fn from(residuals: Vec<f64>) -> Evaluation {
        ObjectiveValue::Residuals(residuals).into()
    }
}

/// An error is a failed trial.
impl<T: Into<Evaluation>, E: fmt::Display> From<Result<T, E>> for Evaluation {
    fn from(result: Result<T, E>) -> Evaluation {
        result.map_or_else(|error| Evaluation::failed(error.to_string()), Into::into)
    }
}

impl FatalError {
    /// An error with this cause: a text, or an error of the objective's own.
    pub fn new(cause: impl Into<Box<dyn Error + Send + Sync>>) -> FatalError {
        FatalError(Arc::from(cause.into()))
    }

    /// The cause, where it is an `E`.
    pub fn cause<E: Error + 'static>(&self) -> Option<&E> {
        self.0.downcast_ref()
    }
}

/// By message.
impl PartialEq for FatalError {
    fn eq(&self, other: &FatalError) -> bool {
        self.to_string() == other.to_string()
    }
}

impl From<&str> for FatalError {
    fn from(cause: &str) -> FatalError {
        FatalError::new(cause)
    }
}

impl ObjectiveValue {
    /// The scalar, or the Euclidean norm of the residuals.
    pub fn value(&self) -> f64 {
        match self {
            ObjectiveValue::Scalar(value) => *value,
            ObjectiveValue::Residuals(residuals) => residuals.iter().map(|r| r * r).sum::<f64>().sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(objective: &dyn Objective, x: f64) -> Evaluation {
        objective.trial(&[x], &Cancellation::default()).evaluation
    }

    #[test]
    fn closures_over_scalars_residuals_and_results_are_objectives() {
        assert_eq!(at(&|x: &[f64]| x[0], 2.0), Evaluation::Value(ObjectiveValue::Scalar(2.0)));
        assert_eq!(at(&|x: &[f64]| vec![x[0], 1.0], 2.0), Evaluation::Value(ObjectiveValue::Residuals(vec![2.0, 1.0])));
        let positive = |x: &[f64]| if x[0] > 0.0 { Ok(x[0]) } else { Err("not positive") };
        assert_eq!(at(&positive, 2.0), Evaluation::Value(ObjectiveValue::Scalar(2.0)));
        assert_eq!(at(&positive, -2.0), Evaluation::failed("not positive"));
        assert_eq!(at(&|x: &[f64]| x[0].ln(), -1.0), Evaluation::failed("the objective is not finite"));
    }
}
