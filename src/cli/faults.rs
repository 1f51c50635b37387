//! Errors of the modules as diagnostics.

use std::fs;

use crate::diagnostic::{Diagnostic, Source, Span};
use crate::post::{EvaluateError, PrepareError};
use crate::script::{Fault, ReadError};
use crate::store::StoreError;

/// Exit status where results could not be written.
pub const WRITE_FAILURE: u8 = 1;

/// A script fault at its place in the script.
pub fn script(fault: &Fault) -> Diagnostic {
    let Ok(text) = fs::read_to_string(&fault.file) else {
        return Diagnostic::new(fault.to_string());
    };
    let source = Source::file(&fault.file, text);
    let mistake = Diagnostic::new(fault.message.as_str()).at(&Span::position(&source, fault.line, fault.column));
    Diagnostic { hint: fault.hint.clone(), ..mistake }
}

/// A script that cannot start.
pub fn reading(error: &ReadError) -> Vec<Diagnostic> {
    match error {
        ReadError::Faults(faults) => faults.iter().map(script).collect(),
        other => vec![Diagnostic::new(other.to_string())],
    }
}

/// What would go wrong after the run.
pub fn preparing(error: &PrepareError) -> Vec<Diagnostic> {
    match error {
        PrepareError::Script(error) => reading(error),
        other => vec![Diagnostic::new(other.to_string())],
    }
}

/// What went wrong after the run.
pub fn evaluating(error: &EvaluateError) -> Diagnostic {
    match error {
        EvaluateError::Script(fault) => script(fault),
        other => Diagnostic::new(other.to_string()),
    }
}

/// Results that cannot be stored.
pub fn storing(error: &StoreError) -> Diagnostic {
    Diagnostic::new(error.to_string())
}
