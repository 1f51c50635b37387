//! Runs and their figures, and what starts many of them: scripts, searches, sweeps.
#![warn(missing_docs)]

/// Why what a script leaves is refused; shown, and not told apart.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Error(String);

impl Error {
    pub(crate) fn new(message: impl Into<String>) -> Error {
        Error(message.into())
    }
}

pub mod store;
pub mod script;
pub mod functions;
pub mod field_comparison;
pub mod post;
pub mod evaluate;
pub mod scenario_functions;
pub mod identify;
pub mod sweep;
pub mod calibrate;
pub mod codes;
pub mod reference;
