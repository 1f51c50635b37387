//! The tree of a file: keys and values with their places in the source.

use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

use toml::de::{DeTable, DeValue};

use base::diagnostic::{Diagnostic, Source, Span};
use base::number;

/// Significant digits of a number that is named: nobody writes more, and those of a sweep are quantiles.
const DIGITS: usize = 9;

/// A value with its place.
#[derive(Clone, Debug)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Its place in the source.
    pub span: Span,
    /// Whether the value is the whole of a file, which replaces what it is merged into.
    pub included: bool,
}

/// A value of TOML; dates and times, which the language does not have, are stored as text.
#[derive(Clone, Debug)]
pub enum Value {
    /// A string.
    Text(String),
    /// An integer.
    Whole(i64),
    /// A number with a fraction or an exponent.
    Number(f64),
    /// A Boolean.
    Flag(bool),
    /// A date or time.
    Time(String),
    /// An array.
    List(Vec<Node>),
    /// A table.
    Table(Table),
}

/// Keys in the order in which they were written.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Its keys and values.
    pub entries: Vec<Entry>,
}

/// A key, its place, and its value.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// The place of the key.
    pub key_span: Span,
    /// The value.
    pub node: Node,
}

/// Parses a whole source; all syntax errors at once.
pub fn parse(source: &Arc<Source>) -> Result<Node, Vec<Diagnostic>> {
    parse_as(&source.text, source)
}

/// Parses `text`, whose places are those of `source`.
pub fn parse_as(text: &str, source: &Arc<Source>) -> Result<Node, Vec<Diagnostic>> {
    let (document, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        let mut mistakes: Vec<Diagnostic> = errors.iter().map(|e| syntax_error(e, source)).collect();
        // Further errors of the same line are mostly consequences of the first.
        let mut lines = HashSet::new();
        mistakes.retain(|mistake| lines.insert(mistake.span.as_ref().map(Span::line_number)));
        return Err(mistakes);
    }
    let mut mistakes = Vec::new();
    let table = table(document.get_ref(), source, &mut mistakes);
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    Ok(Node::new(Value::Table(table), Span::new(source, 0..0)))
}

fn syntax_error(error: &toml::de::Error, source: &Arc<Source>) -> Diagnostic {
    let message = error.message().lines().next().unwrap_or_default();
    let span = Span::new(source, error.span().unwrap_or(0..0));
    if let Some(range) = decimal_comma(&source.text, span.range.start) {
        let point = source.text[range.clone()].replace(',', ".");
        let mistake = Diagnostic::new("decimal comma").at(&Span::new(source, range));
        return mistake.hint(format!("write it with a decimal point: {point}"));
    }
    Diagnostic::new(message.trim().trim_end_matches(", expected nothing")).at(&span)
}

/// A number with a decimal comma in the line at `at`: digits on both sides of a comma behind an equals sign, which a
/// comma, a bracket, a comment or nothing follows.
fn decimal_comma(text: &str, at: usize) -> Option<Range<usize>> {
    let begin = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let line = text[begin..].lines().next().unwrap_or_default();
    let found = line.match_indices(',').find_map(|(comma, _)| {
        let digit = |c: char| c.is_ascii_digit();
        let before = line[..comma].trim_end_matches(digit);
        let is_value = before.trim_end_matches(['+', '-']).trim_end_matches([' ', '\t']).ends_with('=');
        let after = line[comma + 1..].trim_start_matches(digit);
        let (start, end) = (before.trim_end_matches(['+', '-']).len(), line.len() - after.len());
        let is_end = after.trim_start().is_empty() || after.trim_start().starts_with([',', '}', ']', '#']);
        (before.len() < comma && comma + 1 < end && is_value && is_end).then_some(start..end)
    });
    found.map(|range| begin + range.start..begin + range.end)
}

fn table(table: &DeTable<'_>, source: &Arc<Source>, mistakes: &mut Vec<Diagnostic>) -> Table {
    let entries = table.iter().map(|(key, value)| Entry {
        key: key.get_ref().to_string(),
        key_span: Span::new(source, key.span()),
        node: Node::new(self::value(value.get_ref(), source, value.span(), mistakes), Span::new(source, value.span())),
    });
    Table { entries: entries.collect() }
}

fn value(value: &DeValue<'_>, source: &Arc<Source>, range: Range<usize>, mistakes: &mut Vec<Diagnostic>) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(time) => Value::Time(time.to_string()),
        DeValue::Integer(digits) => {
            let whole = i64::from_str_radix(digits.as_str(), digits.radix());
            whole.map(Value::Whole).unwrap_or_else(|_| {
                let span = Span::new(source, range);
                mistakes.push(Diagnostic::new("whole number too large").at(&span));
                Value::Whole(0)
            })
        }
        DeValue::Float(digits) => Value::Number(digits.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Table(inner) => Value::Table(table(inner, source, mistakes)),
        DeValue::Array(items) => {
            let items = items.iter().map(|item| {
                let value = self::value(item.get_ref(), source, item.span(), mistakes);
                Node::new(value, Span::new(source, item.span()))
            });
            Value::List(items.collect())
        }
    }
}

impl Node {
    /// A value that is not included from a file.
    pub fn new(value: Value, span: Span) -> Node {
        Node { value, span, included: false }
    }

    /// Bytes that it takes in memory, about.
    pub fn size(&self) -> usize {
        let within: usize = match &self.value {
            Value::Text(text) | Value::Time(text) => text.len(),
            Value::Whole(_) | Value::Number(_) | Value::Flag(_) => 0,
            Value::List(items) => items.iter().map(Node::size).sum(),
            Value::Table(table) => {
                let size = |entry: &Entry| size_of::<Entry>() + entry.key.len() + entry.node.size();
                table.entries.iter().map(size).sum()
            }
        };
        size_of::<Node>() + within
    }

    /// The node at the key path, e.g. `specimen.shape.rectangle.0`.
    pub fn find(&self, path: &str) -> Option<&Node> {
        let mut node = self;
        for step in path.split('.').filter(|step| !step.is_empty()) {
            node = node.child(step)?;
        }
        Some(node)
    }

    /// The node at the path of keys, mutable.
    pub fn find_mut(&mut self, path: &str) -> Option<&mut Node> {
        let mut node = self;
        for step in path.split('.') {
            node = match &mut node.value {
                Value::Table(table) => &mut table.entries.iter_mut().find(|entry| entry.key == step)?.node,
                Value::List(items) => items.get_mut(step.parse::<usize>().ok()?)?,
                _ => return None,
            };
        }
        Some(node)
    }

    fn child(&self, step: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(table) => table.get(step).map(|entry| &entry.node),
            Value::List(items) => items.get(step.parse::<usize>().ok()?),
            _ => None,
        }
    }

    /// The value of the tree without places.
    pub fn to_toml(&self) -> toml::Value {
        match &self.value {
            Value::Text(text) | Value::Time(text) => toml::Value::String(text.clone()),
            Value::Whole(whole) => toml::Value::Integer(*whole),
            Value::Number(number) => toml::Value::Float(*number),
            Value::Flag(flag) => toml::Value::Boolean(*flag),
            Value::List(items) => toml::Value::Array(items.iter().map(Node::to_toml).collect()),
            Value::Table(table) => toml::Value::Table(table.to_toml()),
        }
    }

    /// The kind of value that was found, as an error names it.
    pub fn found(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("\"{text}\""),
            Value::Time(text) => text.clone(),
            Value::Whole(whole) => whole.to_string(),
            Value::Number(number) => number::plain(number::rounded(*number, DIGITS)),
            Value::Flag(flag) => flag.to_string(),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }
}

impl Table {
    /// The entry under `key`.
    pub fn get(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    /// Takes the entry under `key` out of the table.
    pub fn remove(&mut self, key: &str) -> Option<Entry> {
        let place = self.entries.iter().position(|entry| entry.key == key)?;
        Some(self.entries.remove(place))
    }

    /// The table without places.
    pub fn to_toml(&self) -> toml::Table {
        let entries = self.entries.iter();
        entries.map(|entry| (entry.key.clone(), entry.node.to_toml())).collect()
    }
}
