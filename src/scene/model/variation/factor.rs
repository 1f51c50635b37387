//! A key that varies and the values that it may have, also those of a table in CSV: a column for each key that varies, a
//! row for each run.

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use super::super::Checker;
use crate::scenario::{Assignment, Node, Rule, Value, VariedKey, distribution_rule, validate};
use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::units::{Dimension, percentage};
use base::{file, number, written};
use uncertainty::distribution::Distribution;

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
    pub(super) fn read(key: &VariedKey, checker: &mut Checker<'_>) -> Option<Factor> {
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
                checker.found.report(&key.node.span, message);
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

/// A distribution of two numbers.
type Make = fn(f64, f64) -> Result<Distribution, uncertainty::Error>;

/// The distributions: their key, those of their numbers below it, and what is made of these.
const DISTRIBUTIONS: [(&str, [&str; 2], Make); 4] = [
    ("uniform", ["0", "1"], Distribution::uniform),
    ("normal", ["mean", "deviation"], Distribution::normal),
    ("lognormal", ["mean", "deviation"], Distribution::log_normal),
    ("weibull", ["scale", "shape"], Distribution::weibull),
];

/// A distribution of numbers without unit, written as that of a key that varies.
///
/// # Errors
/// What is wrong with it.
pub fn distribution(node: &Node) -> Result<Distribution, String> {
    let mistakes: Vec<String> = validate(node, &distribution_rule()).iter().map(Diagnostic::in_line).collect();
    match mistakes.is_empty() {
        true => Reading { dimension: None, is_whole: false }.distribution(node),
        false => Err(mistakes.join("; ")),
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
        let count = node.find("count").map(|node| &node.value);
        if let ([Some(from), Some(to)], Some(Value::Whole(count))) = (["range.0", "range.1"].map(number), count) {
            return self.range([from, to], usize::try_from(*count).unwrap_or(0), &node.span).map(Values::Levels);
        }
        self.distribution(node).map(Values::Distribution)
    }

    fn distribution(&self, node: &Node) -> Result<Distribution, String> {
        let number = |path: &str| node.find(path).and_then(|node| self.number(node));
        let made = DISTRIBUTIONS.into_iter().find_map(|(kind, names, make)| {
            let [first, second] = names.map(|name| number(&format!("{kind}.{name}")));
            Some(make(first?, second?))
        });
        let made = made.ok_or("expected a list, a range or a distribution")?;
        let whole = made.map_err(|error| error.to_string())?;
        let limits = [number("truncate.low"), number("truncate.high")];
        match limits {
            [None, None] => Ok(whole),
            [low, high] => whole.truncated(low, high).map_err(|error| error.to_string()),
        }
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

/// Most bytes of a table.
const MOST_BYTES: u64 = 1 << 30;

/// Reads the table in `path`, which the scenario names at `named`.
pub(super) fn read(path: &Path, named: &Span, checker: &mut Checker<'_>) -> Vec<Factor> {
    let before = checker.found.0.len();
    match columns(path, named, checker) {
        Ok(_) if checker.found.0.len() > before => vec![],
        Ok(factors) => factors,
        Err(mistake) => {
            checker.found.0.push(mistake);
            vec![]
        }
    }
}

fn columns(path: &Path, named: &Span, checker: &mut Checker<'_>) -> Result<Vec<Factor>, Diagnostic> {
    let refused = |why: String| Diagnostic::new(format!("cannot read {}: {why}", shown_path(path))).at(named);
    let text = file::read_text(path, MOST_BYTES).map_err(|error| refused(error.to_string()))?;
    let source = Source::file(path, text);
    let mut reader = ReaderBuilder::new().comment(Some(b'#')).trim(Trim::All).from_reader(source.text.as_bytes());
    let header = reader.headers().map_err(|error| refused(error.to_string()))?.clone();
    let rows: Vec<StringRecord> =
        reader.records().collect::<Result<_, _>>().map_err(|error| refused(error.to_string()))?;
    if rows.is_empty() {
        return Err(refused("it has no rows".into()).hint("a header with the paths of keys, then a row for each run"));
    }
    let place = |record: &StringRecord| {
        let start = record.position().map_or(0, |position| position.byte() as usize).min(source.text.len());
        let line = source.text[start..].trim_start_matches(['\r', '\n']);
        let start = source.text.len() - line.len();
        Span::new(&source, start..start + line.lines().next().unwrap_or_default().len())
    };
    let head = place(&header);
    let mut factors = Vec::new();
    for (column, label) in header.iter().enumerate() {
        let items = rows.iter().map(|row| Node::new(value(row.get(column).unwrap_or_default()), place(row)));
        let node = Node::new(Value::List(items.collect()), head.clone());
        match key(label, &head, node) {
            Ok(key) => {
                checker.found.0.extend(key.validate());
                factors.extend(Factor::read(&key, checker));
            }
            Err(mistake) => checker.found.0.push(mistake),
        }
    }
    Ok(factors)
}

/// The key that a column is called by, with or without its unit behind.
fn key(label: &str, head: &Span, node: Node) -> Result<VariedKey, Diagnostic> {
    let of = |path: &str| VariedKey { path: path.into(), span: head.clone(), node: node.clone() };
    let whole = of(label);
    let Err(mistake) = whole.rule() else { return Ok(whole) };
    let without_unit = label.char_indices().filter(|(_, letter)| *letter == '_').find_map(|(end, _)| {
        let key = of(&label[..end]);
        let suffix = key.rule().ok()?.dimension()?.suffix();
        (suffix == label[end + 1..]).then_some(key)
    });
    without_unit.ok_or(mistake)
}

/// A cell: a number, a Boolean, or a string.
fn value(cell: &str) -> Value {
    if let Ok(whole) = cell.parse::<i64>() {
        return Value::Whole(whole);
    }
    match (cell.parse::<f64>(), cell.parse::<bool>()) {
        (Ok(number), _) => Value::Number(number),
        (_, Ok(flag)) => Value::Flag(flag),
        _ => Value::Text(cell.into()),
    }
}

impl Values {
    /// Number of listed values; `None` of a distribution.
    pub(super) fn count(&self) -> Option<usize> {
        match self {
            Values::Levels(levels) => Some(levels.len()),
            Values::Distribution(_) => None,
        }
    }
}
