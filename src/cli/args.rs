//! What commands share of their arguments: numbers and quantities, changes of scenarios, values for scripts.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::Failure;
use crate::failure::all;
use crate::live::{self, Viewer};
use crate::shell;
use base::diagnostic::{Diagnostic, Source, Span};
use base::units::{Dimension, Time, UnitError, with_decimal_point};
use scene::scenario::Assignment;
use study::script::argument_value;

/// The number in SI of a quantity with its unit, for clap.
pub(crate) fn quantity(dimension: Dimension, text: &str) -> Result<f64, String> {
    let expected = || format!("expected {} with its unit, such as \"{}\"", dimension.name, dimension.example);
    dimension.parse(text).map_err(|error| match error {
        UnitError::DecimalComma { .. } => format!("{error}; {}", error.hint()),
        UnitError::UnknownUnit { .. } => match dimension.meant(text) {
            Some(meant) => format!("{error}; did you mean \"{meant}\"?"),
            None => format!("{error}; {}", expected()),
        },
        _ => format!("{}, found \"{text}\"", expected()),
    })
}

/// The number in SI of a quantity and of its standard deviation, `1 m +- 2 mm`, for clap.
pub(crate) fn quantity_with_error(dimension: Dimension, text: &str) -> Result<(f64, Option<f64>), String> {
    match text.split_once("+-").or_else(|| text.split_once('±')) {
        Some((value, error)) => Ok((quantity(dimension, value.trim())?, Some(quantity(dimension, error.trim())?))),
        None => Ok((quantity(dimension, text)?, None)),
    }
}

/// A number without unit.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    let found = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    found.ok_or_else(|| {
        decimal_comma(text).unwrap_or_else(|| format!("expected a number without unit, found \"{text}\""))
    })
}

/// A word of an option, what the help says of it, and what it means.
pub(crate) type Choice<T> = (&'static str, &'static str, T);

/// The parser of an option that takes one of these words.
pub(crate) fn choice<T: Copy + Send + Sync + 'static>(words: &'static [Choice<T>]) -> impl TypedValueParser<Value = T> {
    let known = words.iter().map(|(word, help, _)| PossibleValue::new(*word).help(*help));
    PossibleValuesParser::new(known).try_map(move |written| {
        let found = words.iter().find(|(word, ..)| *word == written);
        found.map(|(.., meaning)| *meaning).ok_or("not one of the words")
    })
}

/// The word of a choice, and what the help says of it.
pub(crate) fn words_of<T: PartialEq>(words: &[Choice<T>], chosen: &T) -> [&'static str; 2] {
    words.iter().find(|(.., meaning)| meaning == chosen).map_or([""; 2], |(word, help, _)| [*word, *help])
}

/// A time in ms, as a number or with its unit: `15`, `15 ms`, `0.015 s`.
pub(crate) fn milliseconds(text: &str) -> Result<f64, String> {
    let with_unit = || Time::DIMENSION.parse(text).map(|seconds| 1e3 * seconds);
    let expected = || format!("expected a time in ms, such as 15 or \"15 ms\", found \"{text}\"");
    number(text).or_else(|_| with_unit()).map_err(|_| decimal_comma(text).unwrap_or_else(expected))
}

/// A mistake in the value of an option.
pub(crate) fn in_option(option: &str, text: &str, message: String) -> Diagnostic {
    Diagnostic::new(message).at(&Span::new(&Source::unfiled(option, text.to_owned()), 0..text.len()))
}

/// The time that an option gives with its unit, s.
pub(crate) fn time(option: &str, text: &str) -> Result<f64, Diagnostic> {
    Time::DIMENSION.parse(text).map_err(|error| in_option(option, text, error.to_string()).hint(error.hint()))
}

fn decimal_comma(text: &str) -> Option<String> {
    let point = with_decimal_point(text)?;
    Some(format!("decimal comma in \"{text}\"; write it with a decimal point: \"{point}\""))
}

/// `--live`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ViewerArgs {
    /// Show the runs in an open Rerun viewer while they compute [usual address: rerun+http://127.0.0.1:9876/proxy]
    #[arg(
        long,
        value_name = "URL",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "rerun+http://127.0.0.1:9876/proxy"
    )]
    pub live: Option<String>,
}

impl ViewerArgs {
    /// The viewer that is asked for.
    pub(crate) fn viewer(&self) -> Result<Option<Viewer>, Diagnostic> {
        self.live.as_deref().map(live::viewer).transpose()
    }
}

/// `--set` and `--unset`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Changes {
    /// Change a key of the scenario: key.path=value
    #[arg(long, value_name = "KEY=VALUE", add = shell::changes())]
    pub set: Vec<String>,
    /// Leave out a key that the scenario gives or inherits: key.path
    #[arg(long, value_name = "KEY", add = shell::keys())]
    pub unset: Vec<String>,
}

impl Changes {
    /// The changes to the scenario's keys, those that leave keys out first.
    ///
    /// # Errors
    /// All mistakes in the arguments.
    pub(crate) fn assignments(&self) -> Result<Vec<Assignment>, Failure> {
        let set = all(self.set.iter().map(|argument| Assignment::from_argument(argument)))?;
        Ok(self.unset.iter().map(|path| Assignment::unset(path, "--unset")).chain(set).collect())
    }

    /// These changes, and one more.
    pub(crate) fn and(&self, change: String) -> Changes {
        let mut all = self.clone();
        all.set.push(change);
        all
    }

    /// The arguments that ask for the same: names of options and values in turn.
    pub(crate) fn words(&self) -> impl Iterator<Item = String> + '_ {
        let left_out = self.unset.iter().map(|key| ("--unset", key));
        let changed = self.set.iter().map(|change| ("--set", change));
        left_out.chain(changed).flat_map(|(option, value)| [option.to_owned(), value.clone()])
    }
}

/// `--scenario`, `--arg`, `--set` and `--unset` of scripts.
#[derive(Clone, Debug, Args)]
pub(crate) struct Given {
    /// The scenario that the script finds in args.scenario
    #[arg(long, value_name = "SCENARIO", add = shell::scenarios())]
    pub scenario: Option<String>,
    /// A value that the script finds in args: key=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub arg: Vec<String>,
    #[command(flatten)]
    pub changes: Changes,
}

impl Given {
    /// The constant `args` of the script: numbers, booleans and text.
    ///
    /// # Errors
    /// All mistakes in the arguments.
    pub(crate) fn values(&self) -> Result<rhai::Map, Failure> {
        let value = |argument: &String| match argument.split_once('=') {
            Some((key, value)) => Ok((key.trim().into(), argument_value(value.trim()))),
            None => Err(Diagnostic::new(format!("expected key=value after --arg, found `{argument}`"))),
        };
        let values = all(self.arg.iter().map(value))?;
        let scenario = self.scenario.iter().map(|scenario| ("scenario".into(), scenario.into()));
        Ok(values.into_iter().chain(scenario).collect())
    }
}
