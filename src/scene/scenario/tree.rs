//! The tree of a file: keys and values with their places in the source; the merging of trees, and changes
//! of one key from `--set` or a script.

use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

use toml::de::{DeTable, DeValue};

use super::grammar::{Rule, TableRule};
use base::diagnostic::{Diagnostic, Source, Span, listed};
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
            (node, _) = node.step(step)?;
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

    /// The node with each value of its keys or places as `change` leaves it, which is told its rule.
    pub fn map(self, rule: Option<&Rule>, mut change: impl FnMut(Node, Option<&Rule>) -> Node) -> Node {
        let value = match self.value {
            Value::Table(table) => {
                let entries = table.entries.into_iter().map(|entry| {
                    let rule = rule.and_then(|rule| rule.under(&entry.key));
                    Entry { node: change(entry.node, rule), ..entry }
                });
                Value::Table(Table { entries: entries.collect() })
            }
            Value::List(items) => {
                let items = items.into_iter().enumerate();
                let items = items.map(|(place, item)| change(item, rule.and_then(|rule| rule.item(place))));
                Value::List(items.collect())
            }
            other => other,
        };
        Node { value, ..self }
    }

    /// The value of a key or the item at a place, and where the key or the item stands.
    pub fn step(&self, step: &str) -> Option<(&Node, &Span)> {
        match &self.value {
            Value::Table(table) => table.get(step).map(|entry| (&entry.node, &entry.key_span)),
            Value::List(items) => items.get(step.parse::<usize>().ok()?).map(|item| (item, &item.span)),
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

/// `over` merged over `base`: tables key by key; anything else replaces. A key that excludes others
/// (`drop_height` and `velocity`) replaces them too, but `layers` does not replace `[[layer]]`.
/// A table whose keys are numbers changes the items of a list.
pub fn merge(base: Node, over: Node, rule: Option<&Rule>) -> Node {
    // A file is meant as a whole: with keys of the base it would be another material.
    if over.included {
        return over;
    }
    let (span, included) = (over.span.clone(), base.included);
    let value = match (base.value, over.value) {
        (Value::Table(base), Value::Table(over)) => Value::Table(merge_tables(base, over, rule.and_then(Rule::table))),
        (Value::List(base), Value::Table(over)) if numbers_items_of(&base, &over) => {
            Value::List(merge_items(base, over, rule))
        }
        (_, value) => return Node::new(value, span),
    };
    Node { value, span, included }
}

fn merge_tables(mut base: Table, over: Table, rule: Option<&TableRule>) -> Table {
    // All before the first is merged: two keys of `over` that exclude each other both stay, which is a mistake.
    for entry in &over.entries {
        if let Some(rule) = rule {
            drop_excluded(&mut base, &entry.key, rule);
        }
    }
    for entry in over.entries {
        let child = rule.and_then(|r| r.key(&entry.key)).map(|key| &key.rule);
        merge_entry(&mut base, entry, child);
    }
    base
}

fn merge_entry(base: &mut Table, entry: Entry, rule: Option<&Rule>) {
    let Some(place) = base.entries.iter().position(|e| e.key == entry.key) else {
        base.entries.push(entry);
        return;
    };
    let old = base.entries[place].node.clone();
    base.entries[place] = Entry { node: merge(old, entry.node, rule), ..entry };
}

/// Removes the groups of keys that `key` excludes, so that a valid base stays valid. Of keys that may both be left out,
/// a list of tables (`[[layer]]`) has more in it than what would replace it: it stays, and the conflict is a mistake.
fn drop_excluded(base: &mut Table, key: &str, rule: &TableRule) {
    let Some(own) = rule.group_of(key) else {
        return;
    };
    let stays = |entry: &Entry| !rule.group_required && matches!(entry.node.value, Value::List(_));
    base.entries.retain(|entry| rule.group_of(&entry.key).is_none_or(|group| group == own) || stays(entry));
}

fn numbers_items_of(items: &[Node], over: &Table) -> bool {
    !over.entries.is_empty()
        && over.entries.iter().all(|e| e.key.parse::<usize>().is_ok_and(|place| place < items.len()))
}

fn merge_items(mut items: Vec<Node>, over: Table, rule: Option<&Rule>) -> Vec<Node> {
    for entry in over.entries {
        let place = entry.key.parse::<usize>().ok();
        if let Some((place, item)) = place.and_then(|p| items.get_mut(p).map(|item| (p, item))) {
            let rule = rule.and_then(|r| r.item(place));
            *item = merge(item.clone(), entry.node, rule);
        }
    }
    items
}

/// The name of the key that lists what is left out.
const KEY: &str = "unset";

/// A key path that is left out, and where that is written.
#[derive(Clone, Debug)]
pub struct Unset {
    pub path: String,
    pub span: Span,
}

impl Unset {
    /// Takes `unset` out of a table that may have it; what is not a list of texts is left to the validator.
    pub fn take(table: &mut Table, rule: Option<&Rule>) -> Vec<Unset> {
        if rule.and_then(Rule::table).and_then(|rule| rule.key(KEY)).is_none() {
            return vec![];
        }
        let Some(Value::List(items)) = table.get(KEY).map(|entry| &entry.node.value) else {
            return vec![];
        };
        let unset = |item: &Node| match &item.value {
            Value::Text(path) => Some(Unset { path: path.trim().to_owned(), span: item.span.clone() }),
            _ => None,
        };
        let Some(found) = items.iter().map(unset).collect::<Option<Vec<Unset>>>() else {
            return vec![];
        };
        table.remove(KEY);
        found
    }

    /// Removes the key from what is inherited.
    pub fn apply(&self, inherited: &mut Node) -> Result<(), Diagnostic> {
        let (parent, key) = self.path.rsplit_once('.').unwrap_or(("", &self.path));
        let table = if parent.is_empty() { Some(&mut *inherited) } else { inherited.find_mut(parent) };
        let removed = match table.map(|node| &mut node.value) {
            Some(Value::Table(table)) => table.remove(key),
            Some(Value::List(_)) => {
                let hint = format!("give the whole list `{parent}` instead");
                return Err(Diagnostic::new(format!("`{}` is an entry of a list", self.path))
                    .at(&self.span)
                    .hint(hint));
            }
            _ => None,
        };
        removed.map(|_| ()).ok_or_else(|| self.not_inherited(inherited))
    }

    /// The mistake of a file that inherits nothing.
    pub fn without_base(&self) -> Diagnostic {
        let mistake = Diagnostic::new("nothing is inherited that could be left out").at(&self.span);
        mistake.hint("`unset` leaves out keys of the file that `extends` names")
    }

    /// The key is not there; the hint lists the keys of the last table of its path that is.
    fn not_inherited(&self, inherited: &Node) -> Diagnostic {
        let mistake = Diagnostic::new(format!("`{}` is not inherited", self.path)).at(&self.span);
        let ends =
            std::iter::successors(Some(self.path.as_str()), |path| path.rsplit_once('.').map(|(start, _)| start));
        let deepest = ends.skip(1).chain([""]).find_map(|path| match &inherited.find(path)?.value {
            Value::Table(table) => Some((path, table)),
            _ => None,
        });
        let Some((path, table)) = deepest else { return mistake };
        let keys: Vec<String> = table.entries.iter().map(|entry| entry.key.clone()).collect();
        let place = if path.is_empty() { "the scenario".to_owned() } else { format!("`{path}`") };
        mistake.hint(format!("{place} has {}", listed(&keys)))
    }
}

/// A value for a key path, or a key path that is left out, for [`Document::with`](super::Document::with).
#[derive(Clone, Debug)]
pub struct Assignment {
    change: Change,
}

/// The effect of an assignment on its key.
#[derive(Clone, Debug)]
pub(super) enum Change {
    /// This tree of one key is merged into the scenario.
    Set(Node),
    /// This key is left out.
    Unset(Unset),
}

impl Assignment {
    /// Reads the argument of `--set`, `key.path=value`. The value is TOML or else a bare text, so
    /// that `frame.hold=none` and `specimen.mesh.size=20mm` need no quotes.
    pub fn from_argument(argument: &str) -> Result<Assignment, Vec<Diagnostic>> {
        let source = Source::unfiled("--set", argument.to_owned());
        if let Ok(tree) = parse(&source)
            && sets_one_key(&tree, argument)
        {
            return Ok(Assignment { change: Change::Set(tree) });
        }
        let everything = Span::new(&source, 0..argument.len());
        let malformed = || {
            let hint = "write it like layers.count=10";
            vec![Diagnostic::new("expected key.path=value").at(&everything).hint(hint)]
        };
        let (key, value) = argument.split_once('=').ok_or_else(malformed)?;
        if !key.trim().is_empty() && value.trim().is_empty() {
            let hint = format!("to leave an inherited key out: --unset {}", key.trim());
            return Err(vec![Diagnostic::new("expected a value after `=`").at(&everything).hint(hint)]);
        }
        let mut tree = parse_as(&format!("{key}=0"), &source).map_err(|_| malformed())?;
        let text = value.trim();
        if text.is_empty() || text.contains('\n') || !sets_one_key(&tree, argument) {
            return Err(malformed());
        }
        let start = key.len() + 1 + (value.len() - value.trim_start().len());
        let span = Span::new(&source, start..start + text.len());
        replace_leaf(&mut tree, Node::new(Value::Text(text.to_owned()), span));
        Ok(Assignment { change: Change::Set(tree) })
    }

    /// A key path that is left out; `origin` names where it is written in diagnostics.
    pub fn unset(path: &str, origin: &str) -> Assignment {
        let source = Source::unfiled(origin, path.to_owned());
        let span = Span::new(&source, 0..path.len());
        Assignment { change: Change::Unset(Unset { path: path.trim().to_owned(), span }) }
    }

    /// A value that a script gives for a key path; `origin` names the script in diagnostics.
    pub fn from_value(path: &str, value: &toml::Value, origin: &str) -> Result<Assignment, Vec<Diagnostic>> {
        let source = Source::unfiled(origin, format!("{path} = {value}"));
        let tree = parse(&source)?;
        Ok(Assignment { change: Change::Set(tree) })
    }

    /// A value written at `span` for a key path; files that it names are found from the folder of that text.
    pub fn of_node(path: &str, span: &Span, value: &Node) -> Assignment {
        let under = |node: Node, key: &str| {
            let entry = Entry { key: key.to_owned(), key_span: span.clone(), node };
            Node::new(Value::Table(Table { entries: vec![entry] }), span.clone())
        };
        Assignment { change: Change::Set(path.rsplit('.').fold(value.clone(), under)) }
    }

    pub(super) fn change(&self) -> &Change {
        &self.change
    }
}

/// Whether the text sets one key, and is not e.g. a header or two lines.
fn sets_one_key(node: &Node, argument: &str) -> bool {
    let Value::Table(table) = &node.value else {
        return false;
    };
    table.entries.len() == 1 && argument.contains('=') && !argument.trim_start().starts_with('[')
}

/// Puts `leaf` at the end of a path of single keys.
fn replace_leaf(node: &mut Node, leaf: Node) {
    if let Value::Table(table) = &mut node.value
        && let Some(entry) = table.entries.first_mut()
    {
        return replace_leaf(&mut entry.node, leaf);
    }
    *node = leaf;
}
