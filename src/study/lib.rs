//! Runs and their figures, and what starts many of them: scripts, searches, sweeps.
#![warn(missing_docs)]

/// Why something is refused, and a remedy where one follows; shown, and not told apart.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    message: String,
    hint: Option<String>,
}

impl Error {
    pub(crate) fn new(message: impl Into<String>) -> Error {
        Error { message: message.into(), hint: None }
    }

    pub(crate) fn with_hint(self, hint: impl Into<String>) -> Error {
        Error { hint: Some(hint.into()), ..self }
    }

    pub(crate) fn with_hint_if(self, hint: Option<&str>) -> Error {
        Error { hint: hint.map(str::to_owned), ..self }
    }

    /// The remedy.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
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
