use std::fmt::{self, Display};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use rhai::{
    AST, ASTNode, Dynamic, Engine, EvalAltResult, Expr, FuncInfo, ImmutableString, ParseError, ParseErrorType,
    Position, Variant,
};
use thiserror::Error;

use super::Session;
use super::checks::{as_call, each_node, order};
use super::module::{self, SourceText, Unit};
use base::diagnostic::did_you_mean;

/// A mistake in a script, found while reading or while running it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}:{line}:{column}: {message}", file.display())]
pub struct Fault {
    /// The script, or a module that it imports.
    pub file: PathBuf,
    /// The text of the file.
    pub text: Arc<str>,
    /// Counted from one.
    pub line: usize,
    /// In characters, counted from one.
    pub column: usize,
    /// The mistake in words.
    pub message: String,
    /// The word to write instead, if there is a close match.
    pub hint: Option<String>,
    /// Whether a simulation failed numerically, which is no mistake of the script.
    pub numerical: bool,
    /// Whether the same script may succeed another time: it took too long, was stopped, or could not be started.
    pub may_pass: bool,
}

impl Fault {
    pub(super) fn parsing(file: &SourceText, error: &ParseError) -> Fault {
        match error.err_type() {
            ParseErrorType::Reserved(word) if UNSUPPORTED.contains(&word.as_str()) => {
                let hint = (word == "export").then(|| "a module exports all its functions and constants".into());
                Fault::located(file, error.position(), format!("`{word}` is not supported in scripts")).with_hint(hint)
            }
            other => Fault::located(file, error.position(), other.to_string()),
        }
    }

    /// The innermost cause of a nested error in a program, whose script is the first of `units`.
    pub(super) fn running(engine: &Engine, units: &[Unit], error: &EvalAltResult) -> Fault {
        let unit = origin(units, error);
        let (file, program) = (&unit.source, &unit.program);
        let culprit = error.unwrap_inner();
        let position = culprit.position();
        let at = |message: String| Fault::located(file, position, message);
        match culprit {
            EvalAltResult::ErrorRuntime(value, _) => of_value(unit, position, value),
            EvalAltResult::ErrorTerminated(reason, _) => match reason.read_lock::<TooLarge>() {
                Some(too_large) => at(too_large.to_string()),
                None => Fault { may_pass: true, ..at(reason.to_string()) },
            },
            EvalAltResult::ErrorFunctionNotFound(signature, _) => at(not_taken(signature)),
            EvalAltResult::ErrorPropertyNotFound(name, _) => {
                let fields = Session::of_engine(engine).fields();
                let names = fields.iter().flat_map(|fields| fields.names.iter().copied());
                at(format!("there is no property `{name}`")).with_hint(did_you_mean(name, names))
            }
            EvalAltResult::ErrorTooManyOperations(_) => {
                at(format!("the script takes more than {} steps of the interpreter", engine.max_operations()))
                    .with_hint(Some(
                        "a loop may never end; sums over samples are faster as functions of the signal".into(),
                    ))
            }
            EvalAltResult::ErrorDotExpr(..) => match property_at(program, position) {
                Some(name) if is_function(engine, &name) => {
                    at(format!("`{name}` is a function and has no brackets here"))
                        .with_hint(Some(format!("call it as `.{name}()`")))
                }
                _ => at(without_position(&culprit.to_string(), position)),
            },
            other => at(without_position(&other.to_string(), position)),
        }
    }

    pub(super) fn starting(file: &SourceText, error: &io::Error) -> Fault {
        let message = format!("cannot start a thread for the script: {error}");
        Fault { may_pass: true, ..Fault::located(file, Position::NONE, message) }
    }

    pub(super) fn located(source: &SourceText, position: Position, message: String) -> Fault {
        Fault {
            file: source.file.clone(),
            text: Arc::clone(&source.text),
            line: position.line().unwrap_or(1),
            column: position.position().unwrap_or(1),
            message: lower_first(&message),
            hint: None,
            numerical: false,
            may_pass: false,
        }
    }

    pub(super) fn with_hint(self, hint: Option<String>) -> Fault {
        Fault { hint, ..self }
    }
}

/// Where a nested error begins: in the function that it left first, or else in the script.
fn origin<'u>(units: &'u [Unit], error: &EvalAltResult) -> &'u Unit {
    let mut unit = &units[0];
    let mut error = error;
    loop {
        let (id, function, inner) = match error {
            EvalAltResult::ErrorInFunctionCall(function, id, inner, _) => (id, Some(function.as_str()), inner),
            EvalAltResult::ErrorInModule(id, inner, _) => (id, None, inner),
            _ => return unit,
        };
        unit = module::find(units, Some(id), function).unwrap_or(unit);
        error = inner;
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

/// Words of the language that scripts are not offered.
const UNSUPPORTED: [&str; 3] = ["export", "eval", "curry"];

/// The fault of a thrown value: at the key of a map where it names one.
fn of_value(unit: &Unit, position: Position, value: &Dynamic) -> Fault {
    let (file, program) = (&unit.source, &unit.program);
    let numerical = value.is::<NumericalFailure>();
    match value.read_lock::<KeyMistake>() {
        Some(mistake) => {
            let place = place_of_key(program, &mistake.key, position).unwrap_or(position);
            Fault::located(file, place, mistake.message.to_string()).with_hint(mistake.hint.clone())
        }
        None => Fault { numerical, ..Fault::located(file, position, thrown(value)) },
    }
}

fn is_function(engine: &Engine, name: &str) -> bool {
    let found = |function: FuncInfo<'_>| (function.metadata.name == name).then_some(());
    !engine.collect_fn_metadata(None, found, true).is_empty()
}

/// A call that no function takes, from its signature `range (i64, string)`.
fn not_taken(signature: &str) -> String {
    let Some((name, types)) = signature.split_once(" (") else {
        return format!("undefined function `{signature}`");
    };
    let types = types.strip_suffix(')').unwrap_or(types).split(", ");
    let words: Vec<&str> = types.filter(|name| !name.is_empty()).map(in_words).collect();
    match words[..] {
        [] => format!("`{name}` takes values, and has none here"),
        _ => format!("`{name}` does not take ({})", words.join(", ")),
    }
}

/// A type of the interpreter in words.
fn in_words(name: &str) -> &str {
    match name {
        "i64" => "whole number",
        "f64" => "number",
        "bool" => "true or false",
        "string" | "&str | ImmutableString | String" => "text",
        "array" => "list",
        "Fn" => "function",
        "()" => "nothing",
        other => other,
    }
}

/// Why a script is ended that holds more bytes than it may, which is no matter of time.
#[derive(Clone, Copy)]
pub(super) struct TooLarge {
    limit: usize,
}

impl TooLarge {
    pub(super) fn new(limit: usize) -> TooLarge {
        TooLarge { limit }
    }
}

impl fmt::Display for TooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the signals, curves, scenarios and runs that the script holds take more than {} MiB",
            self.limit >> 20
        )
    }
}

/// The error that a script catches where a simulation failed numerically: a text whose type distinguishes it from a
/// mistake.
#[derive(Clone, Debug)]
struct NumericalFailure(ImmutableString);

/// The error that a script catches where a host function refuses a key of a map.
#[derive(Clone, Debug)]
struct KeyMistake {
    key: String,
    message: ImmutableString,
    hint: Option<String>,
}

/// The error of a host function that refuses the key `key` of a map: the script is shown there.
pub fn refuse_key(key: &str, message: &str, hint: Option<String>) -> Box<EvalAltResult> {
    let thrown = KeyMistake { key: key.into(), message: message.into(), hint };
    Box::new(EvalAltResult::ErrorRuntime(Dynamic::from(thrown), Position::NONE))
}

/// The refusal `error` of what stands at the key `key` of a map; one that has a place already keeps it.
pub fn at_key(key: &str, error: EvalAltResult) -> Box<EvalAltResult> {
    match error {
        EvalAltResult::ErrorRuntime(value, Position::NONE) if value.is_string() => {
            refuse_key(key, &value.to_string(), None)
        }
        other => Box::new(other),
    }
}

/// The refusal `error` of what belongs to `place`, such as a test, with which its message begins; that of a key of a map has a place of
/// its own.
pub fn refuse_within(place: &str, error: Box<EvalAltResult>) -> Box<EvalAltResult> {
    if refused_key(&error).is_some() { error } else { refuse!("{place}: {}", cause(&error)) }
}

impl KeyMistake {
    fn text(&self) -> String {
        let hint = self.hint.as_ref().map(|hint| format!(" ({hint})")).unwrap_or_default();
        format!("{}{hint}", self.message)
    }
}

/// The error of a host function whose simulation failed numerically.
pub fn numerical_failure(message: impl Display) -> Box<EvalAltResult> {
    let thrown = NumericalFailure(message.to_string().into());
    Box::new(EvalAltResult::ErrorRuntime(Dynamic::from(thrown), Position::NONE))
}

/// Whether the error is an uncaught numerical failure of a simulation.
pub fn is_numerical(error: &EvalAltResult) -> bool {
    matches!(error.unwrap_inner(), EvalAltResult::ErrorRuntime(value, _) if value.is::<NumericalFailure>())
}

/// The mistake in a key of a map that an uncaught error is.
fn mistake_of(error: &EvalAltResult) -> Option<KeyMistake> {
    match error.unwrap_inner() {
        EvalAltResult::ErrorRuntime(value, _) => value.clone().try_cast(),
        _ => None,
    }
}

/// The key of a map that the error refuses.
pub fn refused_key(error: &EvalAltResult) -> Option<String> {
    mistake_of(error).map(|mistake| mistake.key)
}

/// The text of an uncaught mistake in a key of a map, which [`thrown`] gives.
pub fn key_mistake(error: &EvalAltResult) -> Option<String> {
    mistake_of(error).map(|mistake| mistake.text())
}

/// The thrown value as text.
pub fn thrown(value: &Dynamic) -> String {
    if let Some(mistake) = value.read_lock::<KeyMistake>() {
        return mistake.text();
    }
    value.read_lock::<NumericalFailure>().map_or_else(|| value.to_string(), |failure| failure.0.to_string())
}

/// What went wrong, in words: the thrown value, or the error itself.
pub fn cause(error: &EvalAltResult) -> String {
    match error {
        EvalAltResult::ErrorRuntime(value, _) => thrown(value),
        other => other.to_string(),
    }
}

/// Registers the text operations on what host functions throw.
pub(super) fn register(engine: &mut Engine) {
    register_text(engine, "mistake", KeyMistake::text);
    register_text(engine, "numerical failure", |failure: &NumericalFailure| failure.0.to_string());
}

fn register_text<T: Variant + Clone>(engine: &mut Engine, name: &str, text: fn(&T) -> String) {
    engine
        .register_type_with_name::<T>(name)
        .register_fn("to_string", move |thrown: &mut T| text(thrown))
        .register_fn("to_debug", move |thrown: &mut T| text(thrown))
        .register_fn("+", move |before: ImmutableString, thrown: T| before + text(&thrown))
        .register_fn("+", move |thrown: T, after: ImmutableString| text(&thrown) + after.as_str())
        .register_fn("contains", move |thrown: &mut T, part: &str| text(thrown).contains(part));
}

/// The result of a host function.
pub type HostResult<T> = Result<T, Box<EvalAltResult>>;

/// The error of a host function; the engine adds the position of the call.
pub fn refuse(message: impl Display) -> Box<EvalAltResult> {
    message.to_string().into()
}

/// The function and the macro have one name, which one module cannot define twice.
mod of_text {
    /// The same of a text as that of `format!`.
    macro_rules! refuse {
        ($($message:tt)*) => { $crate::script::refuse(format!($($message)*)) };
    }
    pub(crate) use refuse;
}
pub(crate) use of_text::refuse;

/// The same with a hint in parentheses.
pub fn refuse_hinted(message: &impl Display, hint: Option<impl Display>) -> Box<EvalAltResult> {
    match hint {
        Some(hint) => refuse!("{message} ({hint})"),
        None => refuse(message),
    }
}

/// The place of the key `name` of a map among the arguments of the call at `call`; none where the map was built before.
fn place_of_key(program: &AST, name: &str, call: Position) -> Option<Position> {
    let is_call = |node: &ASTNode| as_call(node).is_some_and(|(_, position, _)| position == call);
    let mut found: Vec<Position> = Vec::new();
    each_node(program, |node, path| {
        if let ASTNode::Expr(Expr::Map(map, _)) = node
            && path.iter().any(is_call)
        {
            found.extend(map.0.iter().filter(|(key, _)| key.name == name).map(|(key, _)| key.pos));
        }
    });
    found.into_iter().min_by_key(|position| order(*position))
}

/// The property that stands at `place`, or whose dot does.
fn property_at(program: &AST, place: Position) -> Option<String> {
    let mut found = None;
    each_node(program, |node, _| {
        if let ASTNode::Expr(Expr::Property(property, position)) = node
            && *position == place
        {
            found = Some(property.2.to_string());
        }
    });
    found
}

/// Whether `program` reads a property `name`, has it as a text, or reads the keys of something.
pub(super) fn mentions(program: &AST, name: &str) -> bool {
    let mut found = false;
    each_node(program, |node, _| {
        found |= match node {
            ASTNode::Expr(Expr::Property(property, _)) => property.2 == name,
            ASTNode::Expr(Expr::StringConstant(text, _)) => text == name,
            ASTNode::Expr(Expr::MethodCall(call, _)) => call.name == "keys",
            _ => false,
        };
    });
    found
}

/// Whether `program` reads the argument `name` with one of these methods of `args`.
pub(super) fn reads_with(program: &AST, methods: &[&str], name: &str) -> bool {
    let is_name = |argument: &Expr| matches!(argument, Expr::StringConstant(text, _) if text == name);
    let mut found = false;
    each_node(program, |node, _| {
        let call = as_call(node).filter(|(call, _, is_method)| *is_method && methods.contains(&call.name.as_str()));
        found |= call.is_some_and(|(call, ..)| call.args.first().is_some_and(is_name));
    });
    found
}
