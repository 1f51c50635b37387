//! What is to be small.

use std::error::Error;
use std::sync::Arc;

use thiserror::Error;

use crate::script::Compared;
use crate::simulate::Cancellation;

/// Something with a value at every point; asked from several threads at once, in any order, some points in vain.
pub trait Objective: Sync {
    /// What is found at `x`; the same whenever it is asked. Once it is cancelled, whatever comes soonest will do.
    fn evaluate(&self, x: &[f64], cancellation: &Cancellation) -> Evaluation;

    /// The same with what was held against references on the way, for pictures.
    fn observe(&self, x: &[f64], cancellation: &Cancellation) -> Observed {
        self.evaluate(x, cancellation).into()
    }

    /// Files that were read since the objective was made, with what they held: found again changed, its answers are void.
    fn inputs(&self) -> Vec<(std::path::PathBuf, String)> {
        Vec::new()
    }
}

/// One trial as it is remembered.
#[derive(Clone, Debug, PartialEq)]
pub struct Observed {
    pub found: Evaluation,
    /// What was held against references.
    pub compared: Vec<Compared>,
}

/// What came of one trial.
#[derive(Clone, Debug, PartialEq)]
pub enum Evaluation {
    Answer(Answer),
    /// There is no value here.
    Failed {
        /// Why.
        cause: String,
        /// Whether a simulation went wrong numerically.
        numerical: bool,
    },
    /// The whole search cannot go on.
    Broken(Broken),
}

/// Why an objective cannot go on. It stays with the trial that found it, since of several trials it is the search that says
/// which one counts.
#[derive(Clone, Debug, Error)]
#[error("{0}")]
pub struct Broken(Arc<dyn Error + Send + Sync>);

/// What an objective answers.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    Value(f64),
    /// Differences whose squares are to be small together.
    Residuals(Vec<f64>),
}

impl From<Evaluation> for Observed {
    fn from(found: Evaluation) -> Observed {
        Observed { found, compared: Vec::new() }
    }
}

impl Evaluation {
    /// No value, for a cause that is not numerical.
    pub fn failed(cause: impl Into<String>) -> Evaluation {
        Evaluation::Failed { cause: cause.into(), numerical: false }
    }
}

impl Broken {
    /// For `cause`: a text, or an error of the objective's own.
    pub fn new(cause: impl Into<Box<dyn Error + Send + Sync>>) -> Broken {
        Broken(Arc::from(cause.into()))
    }

    /// The cause, where it is of that kind.
    pub fn cause<E: Error + 'static>(&self) -> Option<&E> {
        self.0.downcast_ref()
    }
}

/// Equal where they say the same.
impl PartialEq for Broken {
    fn eq(&self, other: &Broken) -> bool {
        self.to_string() == other.to_string()
    }
}

impl From<&str> for Broken {
    fn from(cause: &str) -> Broken {
        Broken::new(cause)
    }
}

impl Answer {
    /// The value, or the Euclidean norm of the residuals.
    pub fn value(&self) -> f64 {
        match self {
            Answer::Value(value) => *value,
            Answer::Residuals(residuals) => residuals.iter().map(|r| r * r).sum::<f64>().sqrt(),
        }
    }

    /// The answer where all of it is finite.
    pub(super) fn checked(self) -> Evaluation {
        let finite = match &self {
            Answer::Value(value) => value.is_finite(),
            Answer::Residuals(residuals) => residuals.iter().all(|r| r.is_finite()),
        };
        if finite { Evaluation::Answer(self) } else { Evaluation::failed("the objective is not a number") }
    }
}

impl<F: Fn(&[f64]) -> f64 + Sync> Objective for F {
    fn evaluate(&self, x: &[f64], _: &Cancellation) -> Evaluation {
        Answer::Value(self(x)).checked()
    }
}
