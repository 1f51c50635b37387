//! A key that varies: the values that it may have.

use std::collections::BTreeSet;
use std::fmt;

use uncertainty::distribution::{Distribution, DistributionError};

use super::super::ModelDiagnostics;
use crate::scenario::{Assignment, Node, Rule, Value, VariedKey};
use base::diagnostic::{Diagnostic, Span};
use base::number;
use base::units::{Dimension, percentage};
use base::written;

/// A key that varies.
#[derive(Clone, Debug)]
pub struct Factor {
    /// Path of the key.
    pub path: String,
    /// Where it stands.
    pub span: Span,
    /// The kind of quantity of its numbers; `None` of numbers without unit and of words.
    pub dimension: Option<Dimension>,
    /// Its values.
    pub values: Values,
}

/// The values of a key that varies.
#[derive(Clone, Debug)]
pub enum Values {
    /// One of these.
    Levels(Vec<Level>),
    /// A number of this distribution, SI.
    Distribution(Distribution),
}

/// A value of a key.
#[derive(Clone, Debug)]
pub struct Level {
    /// As tables and plots show it.
    pub input: Input,
    /// As it is put into the scenario, from the folder of the file in which it is written.
    pub node: Node,
}

/// A value of a key in tables and plots.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A number, SI.
    Number(f64),
    /// A word, or a list or a table as TOML.
    Text(String),
}

impl Factor {
    /// The assignments of listed values that are words, of each word once: a table may list it in thousands of rows.
    pub fn words(&self) -> impl Iterator<Item = Assignment> + '_ {
        let levels: &[Level] = match &self.values {
            Values::Levels(levels) => levels,
            Values::Distribution(_) => &[],
        };
        let mut known = BTreeSet::new();
        levels.iter().filter_map(move |level| match &level.input {
            Input::Text(word) => known.insert(word).then(|| self.assignment(level)),
            Input::Number(_) => None,
        })
    }

    /// Reads the values of a key.
    pub(super) fn read(key: &VariedKey, mistakes: &mut ModelDiagnostics<'_>) -> Option<Factor> {
        // The grammar reports these.
        let rule = key.rule().ok().filter(|_| key.validate().is_empty())?;
        let number = rule.number();
        let dimension = number.and_then(Rule::dimension);
        let read = Reading { dimension, is_whole: matches!(number, Some(Rule::Number { whole: true, .. })) };
        let values = match &key.node.value {
            Value::List(items) => Ok(Values::Levels(items.iter().map(|item| read.level(item)).collect())),
            _ => read.chosen(&key.node),
        };
        match values {
            Ok(values) => Some(Factor { path: key.path.clone(), span: key.span.clone(), dimension, values }),
            Err(message) => {
                mistakes.found.0.push(Diagnostic::new(message).at(&key.node.span));
                None
            }
        }
    }

    /// Its column in tables: the path, and behind it the unit of a number that has one, as in `impactor.mass_kg`.
    pub fn column(&self) -> String {
        match self.dimension.map(Dimension::suffix) {
            Some(suffix) if !suffix.is_empty() => format!("{}_{suffix}", self.path),
            _ => self.path.clone(),
        }
    }

    /// The change of the scenario that gives the key a value.
    pub fn assignment(&self, level: &Level) -> Assignment {
        Assignment::of_node(&self.path, &self.span, &level.node)
    }

    /// A number, SI, as it is written in a scenario, with its unit.
    pub fn written(&self, value: f64) -> String {
        match self.dimension {
            Some(dimension) if value != 0.0 => format!("\"{}\"", dimension.show(value)),
            _ => number::plain(value),
        }
    }

    /// The listed value numbered `place`; the last one beyond it.
    pub(super) fn level(&self, place: usize) -> Level {
        let listed = match &self.values {
            Values::Levels(levels) => levels.get(place).or(levels.last()).cloned(),
            Values::Distribution(_) => None,
        };
        listed.unwrap_or_else(|| self.number(f64::NAN))
    }

    /// Its values in the unit in which a person reads them.
    pub fn shown_values(&self) -> String {
        let shown = |value: f64| written::quantity(value, self.dimension.map_or("1", |dimension| dimension.unit));
        let input = |level: &Level| match &level.input {
            Input::Number(number) => shown(*number),
            Input::Text(text) => text.clone(),
        };
        match &self.values {
            Values::Levels(levels) => named(levels, input),
            Values::Distribution(distribution) => distribution.describe(shown),
        }
    }

    /// The number `value`, SI, as a value of the key.
    pub fn number(&self, value: f64) -> Level {
        Level { input: Input::Number(value), node: Node::new(Value::Number(value), self.span.clone()) }
    }
}

/// How the values of a key are read.
struct Reading {
    dimension: Option<Dimension>,
    is_whole: bool,
}

impl Reading {
    fn level(&self, node: &Node) -> Level {
        let input = match self.number(node) {
            Some(number) => Input::Number(number),
            None => Input::Text(node.to_toml().to_string().trim_matches('"').to_owned()),
        };
        Level { input, node: node.clone() }
    }

    /// The number of a value, SI.
    fn number(&self, node: &Node) -> Option<f64> {
        match &node.value {
            Value::Whole(whole) => Some(*whole as f64),
            Value::Number(number) => Some(*number),
            Value::Text(text) => match self.dimension {
                Some(dimension) => dimension.parse(text).ok(),
                None => percentage(text),
            },
            _ => None,
        }
    }

    /// A range or a distribution.
    fn chosen(&self, node: &Node) -> Result<Values, String> {
        let number = |path: &str| node.find(path).and_then(|node| self.number(node));
        let pair = |kind: &str| Some([number(&format!("{kind}.0"))?, number(&format!("{kind}.1"))?]);
        if let (Some(ends), Some(Value::Whole(count))) = (pair("range"), node.find("count").map(|node| &node.value)) {
            return self.range(ends, usize::try_from(*count).unwrap_or(0), &node.span).map(Values::Levels);
        }
        let given = |kind: &str, names: [&str; 2]| {
            let [first, second] = names.map(|name| number(&format!("{kind}.{name}")));
            Some((first?, second?))
        };
        let shape = || node.find("weibull.shape").and_then(|node| self.number(node));
        let made: Result<Distribution, DistributionError> = if let Some([low, high]) = pair("uniform") {
            Distribution::uniform(low, high)
        } else if let Some((mean, deviation)) = given("normal", ["mean", "deviation"]) {
            Distribution::normal(mean, deviation)
        } else if let Some((mean, deviation)) = given("lognormal", ["mean", "deviation"]) {
            Distribution::log_normal(mean, deviation)
        } else if let (Some(scale), Some(shape)) = (number("weibull.scale"), shape()) {
            Distribution::weibull(scale, shape)
        } else {
            return Err("expected a list, a range or a distribution".into());
        };
        let whole = made.map_err(|error| error.to_string())?;
        let limits = [number("truncate.low"), number("truncate.high")];
        let truncated = match limits {
            [None, None] => Ok(whole),
            [low, high] => whole.truncated(low, high),
        };
        truncated.map(Values::Distribution).map_err(|error| error.to_string())
    }

    /// `count` values at equal distances from the first to the second end.
    fn range(&self, [from, to]: [f64; 2], count: usize, span: &Span) -> Result<Vec<Level>, String> {
        let at = |place: usize| {
            let share = place as f64 / (count - 1) as f64;
            let value = if place + 1 == count { to } else { from + share * (to - from) };
            let node = match self.is_whole {
                true if value.fract() != 0.0 => {
                    return Err(format!("{count} whole numbers at equal distances from {from} to {to} do not exist"));
                }
                true => Value::Whole(value as i64),
                false => Value::Number(number::rounded(value, DIGITS)),
            };
            let node = Node::new(node, span.clone());
            Ok(self.level(&node))
        };
        (0..count).map(at).collect()
    }
}

/// Significant digits of the values of a range: beyond them is the round-off of its steps.
const DIGITS: usize = 12;

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Input::Number(number) => write!(f, "{number}"),
            Input::Text(text) => f.write_str(text),
        }
    }
}

/// Most listed values that are named one by one.
const MOST_NAMED: usize = 6;

/// Listed values as `shown` writes them; of many the ends.
fn named(levels: &[Level], shown: impl Fn(&Level) -> String) -> String {
    match levels {
        [first, .., last] if levels.len() > MOST_NAMED => {
            format!("{} values from {} to {}", levels.len(), shown(first), shown(last))
        }
        _ => levels.iter().map(shown).collect::<Vec<_>>().join(", "),
    }
}

impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Values::Levels(levels) => f.write_str(&named(levels, |level| level.input.to_string())),
            Values::Distribution(distribution) => write!(f, "{distribution}"),
        }
    }
}
