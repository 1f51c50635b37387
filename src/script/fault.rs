use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use rhai::{Dynamic, Engine, EvalAltResult, ImmutableString, ParseError, Position};
use thiserror::Error;

/// A mistake in a script, found while reading or while running it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}:{line}:{column}: {message}", file.display())]
pub struct Fault {
    /// The script.
    pub file: PathBuf,
    /// Counted from one.
    pub line: usize,
    /// In characters, counted from one.
    pub column: usize,
    /// What is wrong.
    pub message: String,
    /// What to write instead, if there is a close match.
    pub hint: Option<String>,
    /// Whether a simulation failed numerically, which is no mistake of the script.
    pub numerical: bool,
}

impl Fault {
    pub(super) fn parsing(file: &Path, error: &ParseError) -> Fault {
        Fault::at(file, error.position(), error.err_type().to_string())
    }

    /// The innermost cause of a nested error.
    pub(super) fn running(file: &Path, error: &EvalAltResult) -> Fault {
        let culprit = error.unwrap_inner();
        let position = culprit.position();
        let message = match culprit {
            EvalAltResult::ErrorRuntime(value, _) => thrown(value),
            EvalAltResult::ErrorTerminated(reason, _) => reason.to_string(),
            other => without_position(&other.to_string(), position),
        };
        Fault { numerical: is_numerical(error), ..Fault::at(file, position, message) }
    }

    pub(super) fn starting(file: &Path, error: &io::Error) -> Fault {
        Fault::at(file, Position::NONE, format!("cannot start a thread for the script: {error}"))
    }

    pub(super) fn at(file: &Path, position: Position, message: String) -> Fault {
        Fault {
            file: file.into(),
            line: position.line().unwrap_or(1),
            column: position.position().unwrap_or(1),
            message: lower_first(&message),
            hint: None,
            numerical: false,
        }
    }

    pub(super) fn with_hint(self, hint: Option<String>) -> Fault {
        Fault { hint, ..self }
    }
}

fn without_position(message: &str, position: Position) -> String {
    let suffix = format!(" ({position})");
    message.strip_suffix(&suffix).unwrap_or(message).to_owned()
}

/// Messages of the interpreter begin with a capital letter.
fn lower_first(message: &str) -> String {
    let mut letters = message.chars();
    let first = letters.next().map(|c| c.to_lowercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

/// What a script catches where a simulation failed numerically: a text whose type distinguishes it from a mistake.
#[derive(Clone, Debug)]
struct NumericalFailure(ImmutableString);

/// The error of a host function whose simulation failed numerically.
pub fn numerical_failure(message: impl Display) -> Box<EvalAltResult> {
    let thrown = NumericalFailure(message.to_string().into());
    Box::new(EvalAltResult::ErrorRuntime(Dynamic::from(thrown), Position::NONE))
}

/// Whether the error is an uncaught numerical failure of a simulation.
pub fn is_numerical(error: &EvalAltResult) -> bool {
    matches!(error.unwrap_inner(), EvalAltResult::ErrorRuntime(value, _) if value.is::<NumericalFailure>())
}

/// The thrown value as text.
pub fn thrown(value: &Dynamic) -> String {
    value.read_lock::<NumericalFailure>().map_or_else(|| value.to_string(), |failure| failure.0.to_string())
}

/// Registers the text operations on such a failure.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_type_with_name::<NumericalFailure>("numerical failure")
        .register_fn("to_string", |failure: &mut NumericalFailure| failure.0.clone())
        .register_fn("to_debug", |failure: &mut NumericalFailure| failure.0.clone())
        .register_fn("+", |text: ImmutableString, failure: NumericalFailure| text + failure.0)
        .register_fn("+", |failure: NumericalFailure, text: ImmutableString| failure.0 + text)
        .register_fn("contains", |wrong: &mut NumericalFailure, text: &str| wrong.0.contains(text));
}

/// The result of a host function.
pub type HostResult<T> = Result<T, Box<EvalAltResult>>;

/// The error of a host function; the engine adds the position of the call.
pub fn refuse(message: impl Display) -> Box<EvalAltResult> {
    message.to_string().into()
}
