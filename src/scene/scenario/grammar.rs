//! The schema compiled into rules: the values that each key may have. The validator, the merge of
//! extending files and `droptower explain` use the rules, not the schema.

use std::fmt;
use std::sync::LazyLock;

use serde_json::Value as Json;

use super::tree::Value;
use super::{Expectations, Material, Scenario, schema};
use base::units::Dimension;

/// The values that are allowed at one place.
#[derive(Clone, Debug)]
pub enum Rule {
    /// A table.
    Table(TableRule),
    /// Any number of items of one kind.
    List {
        /// Rule of each item.
        item: Box<Rule>,
        /// Fewest items.
        min_items: usize,
        /// Most items.
        max_items: usize,
    },
    /// A list with a rule for each place.
    Tuple(Vec<Rule>),
    /// One of these words, each with its description.
    Choice(Vec<(String, Option<String>)>),
    /// A quantity with a unit.
    Quantity(Dimension, Range),
    /// A number.
    Number {
        /// Whether it is an integer.
        whole: bool,
        /// Its bounds.
        range: Range,
    },
    /// A string; `path` where it names a file.
    Text {
        /// Whether it names a file.
        path: bool,
        /// Whether the content of that file replaces it.
        included: bool,
    },
    /// A Boolean.
    Flag,
    /// Any value.
    Any,
    /// Any one of these.
    Either(Vec<Rule>),
}

/// The keys of a table.
#[derive(Clone, Debug, Default)]
pub struct TableRule {
    /// The keys.
    pub keys: Vec<Key>,
    /// Sets of keys of which a table has at most one.
    pub groups: Vec<Vec<String>>,
    /// Whether it must have one of them.
    pub group_required: bool,
    /// Whether its other keys are paths of keys that vary.
    pub varied: bool,
    /// The rule of its other keys, which may have any name.
    pub others: Option<Box<Rule>>,
}

/// A key of a table.
#[derive(Clone, Debug)]
pub struct Key {
    /// Its name.
    pub name: String,
    /// Its title, where its schema has one.
    pub title: Option<String>,
    /// Its description.
    pub sentence: Option<String>,
    /// Its value where it is left out.
    pub default: Option<Json>,
    /// Whether it must be given.
    pub required: bool,
    /// Its allowed values.
    pub rule: Rule,
}

/// Bounds of a number, in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    /// The lower bound.
    pub from: Option<Bound>,
    /// The upper bound.
    pub to: Option<Bound>,
    /// Values outside of these are probably in another unit; zero is not asked.
    pub likely: Option<[f64; 2]>,
}

/// One end of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The value of the bound.
    pub value: f64,
    /// Whether the bound itself is in the range.
    pub included: bool,
}

/// Most keys of a table that a hint shows.
const MOST_OUTLINED: usize = 5;

impl Key {
    /// What the key is, in a few words: its title, the beginning of its description where that is short, or its name.
    pub fn title(&self) -> String {
        let words = || self.name.replace('_', " ");
        // A point within a sentence is that of a file's name.
        let beginning = |sentence: &str| {
            let clause = sentence.split([';', ',', ':', '(']).next()?.split(". ").next()?;
            Some(clause.trim().trim_end_matches('.').replace('`', ""))
        };
        let beginning = self.sentence.as_deref().and_then(beginning);
        let short = beginning.filter(|text| (1..=LONGEST_TITLE).contains(&text.chars().count()));
        self.title.clone().or(short).unwrap_or_else(words)
    }

    /// The key and the kind of its value, as a hint shows it.
    fn outline(&self) -> String {
        let value = match self.rule {
            Rule::List { .. } | Rule::Tuple(_) => "[…]",
            _ => "…",
        };
        format!("{} = {value}", self.name)
    }
}

/// Most characters of a title that is the beginning of a description.
const LONGEST_TITLE: usize = 40;

/// The title of the key at a path of a scenario, in which numbers are places in lists; none of a path that is no key.
pub fn title(path: &str) -> Option<String> {
    Some(key_at(path)?.title())
}

/// The key at a path of a scenario.
fn key_at(path: &str) -> Option<&'static Key> {
    let (mut rule, mut found) = (scenario(), None);
    for step in path.split('.') {
        match rule.table().and_then(|table| table.key(step)) {
            Some(key) => {
                found = Some(key);
                rule = &key.rule;
            }
            // Of several forms, as of one impactor or a list of them, the table has no place of this number.
            None => rule = rule.item(step.parse().ok()?)?,
        }
    }
    found
}

/// The rule of a whole scenario.
pub fn scenario() -> &'static Rule {
    static RULE: LazyLock<Rule> = LazyLock::new(|| compile(&schema::whole::<Scenario>()));
    &RULE
}

/// The rule of a material file.
pub fn material() -> &'static Rule {
    static RULE: LazyLock<Rule> = LazyLock::new(|| compile(&schema::whole::<Material>()));
    &RULE
}

/// The rule of a file about what a run must give.
pub fn expectations() -> &'static Rule {
    static RULE: LazyLock<Rule> = LazyLock::new(|| compile(&schema::whole::<Expectations>()));
    &RULE
}

impl Rule {
    /// The forms of a value: those of which any one is allowed, or the one.
    fn forms(&self) -> &[Rule] {
        match self {
            Rule::Either(rules) => rules,
            other => std::slice::from_ref(other),
        }
    }

    /// The table among the allowed values.
    pub fn table(&self) -> Option<&TableRule> {
        self.forms().iter().find_map(|rule| match rule {
            Rule::Table(table) => Some(table),
            _ => None,
        })
    }

    /// The rule of the item at `place` of the list among the allowed values.
    pub fn item(&self, place: usize) -> Option<&Rule> {
        self.forms().iter().find_map(|rule| match rule {
            Rule::List { item, .. } => Some(&**item),
            Rule::Tuple(items) => items.get(place),
            _ => None,
        })
    }

    /// The rule of the value of a key: of a table, or, where the key is a number, of a list.
    pub fn under(&self, key: &str) -> Option<&Rule> {
        let of_table = self.table().and_then(|table| table.key(key)).map(|key| &key.rule);
        of_table.or_else(|| self.item(key.parse().ok()?))
    }

    /// The rule at a key path below, such as `layers.faces.1`.
    pub fn at(&self, path: &str) -> Option<&Rule> {
        path.split('.').try_fold(self, |rule, key| rule.under(key))
    }

    /// Whether the path of a file is allowed.
    pub fn is_path(&self) -> bool {
        self.forms().iter().any(|rule| matches!(rule, Rule::Text { path: true, .. }))
    }

    /// Whether a path is replaced by the content of its file.
    pub fn is_included(&self) -> bool {
        self.forms().iter().any(|rule| matches!(rule, Rule::Text { included: true, .. }))
    }

    /// The dimension of the quantity among the allowed values.
    pub fn dimension(&self) -> Option<Dimension> {
        match self {
            Rule::Quantity(dimension, _) => Some(*dimension),
            Rule::List { item, .. } => item.dimension(),
            Rule::Tuple(items) => items.iter().find_map(Rule::dimension),
            Rule::Either(rules) => rules.iter().find_map(Rule::dimension),
            _ => None,
        }
    }

    /// The range of the number among the allowed values.
    pub fn range(&self) -> Option<Range> {
        match self {
            Rule::Quantity(_, range) | Rule::Number { range, .. } => Some(*range),
            Rule::List { item, .. } => item.range(),
            _ => None,
        }
    }

    /// Whether the value is of a kind that can be allowed.
    pub fn takes(&self, value: &Value) -> bool {
        match self {
            Rule::Table(_) => matches!(value, Value::Table(_)),
            Rule::List { .. } | Rule::Tuple(_) => matches!(value, Value::List(_)),
            Rule::Choice(_) | Rule::Text { .. } => matches!(value, Value::Text(_)),
            Rule::Quantity(..) => matches!(value, Value::Text(_) | Value::Whole(_) | Value::Number(_)),
            Rule::Number { .. } => matches!(value, Value::Whole(_) | Value::Number(_)),
            Rule::Flag => matches!(value, Value::Flag(_)),
            Rule::Any => true,
            Rule::Either(rules) => rules.iter().any(|rule| rule.takes(value)),
        }
    }

    /// The quantity or the number among the allowed values.
    pub fn number(&self) -> Option<&Rule> {
        self.forms().iter().find(|rule| matches!(rule, Rule::Quantity(..) | Rule::Number { .. }))
    }

    /// Whether a number without unit is allowed beside a quantity, as for a limit of strain or of stress.
    pub fn takes_bare_number(&self) -> bool {
        match self {
            Rule::Either(rules) => rules.iter().any(|rule| matches!(rule, Rule::Number { .. })),
            Rule::List { item, .. } => item.takes_bare_number(),
            Rule::Tuple(items) => items.iter().any(Rule::takes_bare_number),
            _ => false,
        }
    }

    /// The words among the allowed values.
    pub fn words(&self) -> Vec<(&str, Option<&str>)> {
        match self {
            Rule::Choice(words) => words.iter().map(|(word, sentence)| (word.as_str(), sentence.as_deref())).collect(),
            Rule::List { item, .. } => item.words(),
            Rule::Either(rules) => rules.iter().flat_map(Rule::words).collect(),
            _ => Vec::new(),
        }
    }
}

/// The expectation as an error names it: "a length".
impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Rule::Table(_) => f.write_str("a table"),
            Rule::List { item, .. } => write!(f, "a list of {}", plural(item)),
            Rule::Tuple(items) => {
                let items: Vec<String> = items.iter().map(Rule::to_string).collect();
                write!(f, "[{}]", items.join(", "))
            }
            Rule::Choice(words) => {
                let words: Vec<String> = words.iter().map(|(w, _)| format!("\"{w}\"")).collect();
                f.write_str(&words.join(" or "))
            }
            Rule::Quantity(dimension, _) => f.write_str(dimension.name),
            Rule::Number { whole: true, .. } => f.write_str("a whole number"),
            Rule::Number { .. } => f.write_str("a number"),
            Rule::Text { path: true, .. } => f.write_str("a path"),
            Rule::Text { .. } => f.write_str("a string"),
            Rule::Flag => f.write_str("true or false"),
            Rule::Any => f.write_str("a value"),
            Rule::Either(rules) => {
                let rules: Vec<String> = rules.iter().map(Rule::to_string).collect();
                f.write_str(&rules.join(" or "))
            }
        }
    }
}

/// The plural of the items of a list.
fn plural(rule: &Rule) -> String {
    match rule {
        Rule::Table(_) => "tables".to_owned(),
        Rule::Number { .. } => "numbers".to_owned(),
        Rule::Text { path: false, .. } => "strings".to_owned(),
        Rule::Text { path: true, .. } => "paths".to_owned(),
        Rule::Quantity(dimension, _) => {
            let name = dimension.name;
            let noun = name.split_once(' ').map_or(name, |(_, noun)| noun);
            match noun.strip_suffix('y') {
                Some(stem) => format!("{stem}ies"),
                None if noun.ends_with('s') => format!("{noun}es"),
                None => format!("{noun}s"),
            }
        }
        other => other.to_string(),
    }
}

impl TableRule {
    /// The rule of this key.
    pub fn key(&self, name: &str) -> Option<&Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// How the table is written, as a hint shows it: ``{ size = […], edge = … }``; none of a table without keys of its own.
    pub fn outline(&self) -> Option<String> {
        let braces = |keys: &[&Key]| {
            let entries: Vec<String> = keys.iter().take(MOST_OUTLINED).map(|key| key.outline()).collect();
            let rest = if keys.len() > MOST_OUTLINED { ", …" } else { "" };
            format!("`{{ {}{rest} }}`", entries.join(", "))
        };
        let (grouped, own): (Vec<&Key>, Vec<&Key>) =
            self.keys.iter().partition(|key| self.group_of(&key.name).is_some());
        if own.is_empty() && !grouped.is_empty() && self.groups.iter().all(|group| group.len() == 1) {
            let kinds: Vec<String> = grouped.iter().take(MOST_OUTLINED).map(|key| braces(&[key])).collect();
            let rest = if grouped.len() > MOST_OUTLINED { ", …" } else { "" };
            return Some(format!("{}{rest}", kinds.join(" or ")));
        }
        let first = grouped.into_iter().filter(|key| self.group_of(&key.name) == Some(0));
        let (needed, others): (Vec<&Key>, Vec<&Key>) = own.into_iter().partition(|key| key.required);
        let keys: Vec<&Key> = first.chain(needed).chain(others).collect();
        (!keys.is_empty()).then(|| braces(&keys))
    }

    /// Which of the groups the key belongs to.
    pub fn group_of(&self, name: &str) -> Option<usize> {
        self.groups.iter().position(|group| group.iter().any(|key| key == name))
    }
}

impl Range {
    /// Whether the value lies within.
    pub fn contains(&self, value: f64) -> bool {
        let above = self.from.is_none_or(|b| value > b.value || (b.included && value == b.value));
        let below = self.to.is_none_or(|b| value < b.value || (b.included && value == b.value));
        above && below
    }

    /// Whether the value is one that is meant: within the likely ones, or zero.
    pub fn is_likely(&self, value: f64) -> bool {
        value == 0.0 || self.likely.is_none_or(|[low, high]| (low..=high).contains(&value))
    }

    /// In words, each bound as `show` writes it; `None` where every number is allowed.
    pub fn describe(&self, show: impl Fn(f64) -> String) -> Option<String> {
        let from = self.from.map(|b| {
            let words = if b.included { "at least" } else { "more than" };
            format!("{words} {}", show(b.value))
        });
        let to = self.to.map(|b| {
            let words = if b.included { "at most" } else { "less than" };
            format!("{words} {}", show(b.value))
        });
        match (from, to) {
            (Some(from), Some(to)) => Some(format!("{from} and {to}")),
            (from, to) => from.or(to),
        }
    }
}

/// Words, each with its sentence.
type Words = Vec<(String, Option<String>)>;

/// The rule that a schema states.
pub fn compile(schema: &Json) -> Rule {
    if schema["x-any"].as_bool() == Some(true) {
        return Rule::Any;
    }
    if let Some(branches) = list_of(schema, "anyOf") {
        return Rule::Either(branches.iter().map(compile).flat_map(|rule| rule.forms().to_vec()).collect());
    }
    if let Some(name) = schema["x-quantity"].as_str()
        && let Some(dimension) = Dimension::named(name)
    {
        return Rule::Quantity(dimension, range(schema));
    }
    if let Some(words) = words(schema) {
        return Rule::Choice(words);
    }
    if is_tagged(schema) {
        return Rule::Table(tagged(list_of(schema, "oneOf").into_iter().flatten()));
    }
    if let Some((words, tables)) = words_and_tables(schema) {
        return Rule::Either(vec![Rule::Choice(words), Rule::Table(tagged(tables.into_iter()))]);
    }
    match schema["type"].as_str() {
        Some("object") => Rule::Table(table(schema)),
        Some("array") => list(schema),
        Some("number") => Rule::Number { whole: false, range: range(schema) },
        Some("integer") => Rule::Number { whole: true, range: range(schema) },
        Some("boolean") => Rule::Flag,
        _ => {
            let is = |what: &str| schema[what].as_bool().unwrap_or(false);
            Rule::Text { path: is("x-path"), included: is("x-included") }
        }
    }
}

fn list_of<'a>(schema: &'a Json, key: &str) -> Option<&'a Vec<Json>> {
    schema[key].as_array()
}

fn text_of(schema: &Json, key: &str) -> Option<String> {
    let text = schema[key].as_str()?;
    Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn texts(list: &Json) -> Vec<String> {
    let items = list.as_array().into_iter().flatten();
    items.filter_map(Json::as_str).map(str::to_owned).collect()
}

fn range(schema: &Json) -> Range {
    let bound = |key: &str, included: bool| {
        let value = schema[key].as_f64()?;
        Some(Bound { value, included })
    };
    Range {
        from: bound("exclusiveMinimum", false).or(bound("minimum", true)),
        to: bound("exclusiveMaximum", false).or(bound("maximum", true)),
        likely: likely(schema),
    }
}

fn likely(schema: &Json) -> Option<[f64; 2]> {
    Some([schema["x-likely"][0].as_f64()?, schema["x-likely"][1].as_f64()?])
}

/// The words of a plain `enum` and of a `oneOf` of constants, which may be mixed.
fn words(schema: &Json) -> Option<Words> {
    if let Some(word) = schema["const"].as_str() {
        return Some(vec![(word.to_owned(), text_of(schema, "description"))]);
    }
    if schema["enum"].is_array() {
        let words = texts(&schema["enum"]).into_iter();
        return Some(words.map(|word| (word, None)).collect());
    }
    let branches: Option<Vec<_>> = list_of(schema, "oneOf")?.iter().map(words).collect();
    branches.map(|b| b.into_iter().flatten().collect())
}

/// Whether the schema is that of an enumeration whose variants are keys.
fn is_tagged(schema: &Json) -> bool {
    list_of(schema, "oneOf").is_some_and(|b| b.iter().all(|b| b["properties"].is_object()))
}

/// The words of an enumeration of which some variants are keys, and the branches of these.
fn words_and_tables(schema: &Json) -> Option<(Words, Vec<&Json>)> {
    let (tables, others): (Vec<&Json>, Vec<&Json>) =
        list_of(schema, "oneOf")?.iter().partition(|branch| branch["properties"].is_object());
    let words: Option<Vec<Words>> = others.into_iter().map(words).collect();
    let words: Words = words?.into_iter().flatten().collect();
    (!tables.is_empty() && !words.is_empty()).then_some((words, tables))
}

/// The rule of the `branches` of an enumeration whose variants are keys.
fn tagged<'a>(branches: impl Iterator<Item = &'a Json>) -> TableRule {
    let mut table = TableRule { group_required: true, ..TableRule::default() };
    for branch in branches {
        for mut key in keys(branch) {
            key.required = false;
            key.sentence = text_of(branch, "description").or(key.sentence);
            table.groups.push(vec![key.name.clone()]);
            table.keys.push(key);
        }
    }
    table
}

fn table(schema: &Json) -> TableRule {
    let one_of = list_of(schema, "oneOf");
    let groups = match one_of {
        Some(branches) => branches.iter().map(|b| texts(&b["required"])).collect(),
        None => texts(&schema["not"]["required"]).into_iter().map(|key| vec![key]).collect(),
    };
    TableRule {
        keys: keys(schema),
        groups,
        group_required: one_of.is_some(),
        varied: schema["x-varied"].as_bool().unwrap_or(false),
        others: schema.get("additionalProperties").filter(|rule| rule.is_object()).map(|rule| Box::new(compile(rule))),
    }
}

fn keys(schema: &Json) -> Vec<Key> {
    let required = texts(&schema["required"]);
    let properties = schema["properties"].as_object().into_iter().flatten();
    properties
        .map(|(name, property)| Key {
            name: name.clone(),
            title: text_of(property, "title"),
            sentence: text_of(property, "description"),
            default: property.get("default").cloned(),
            required: required.contains(name),
            rule: compile(property),
        })
        .collect()
}

fn list(schema: &Json) -> Rule {
    if let Some(items) = list_of(schema, "prefixItems") {
        return Rule::Tuple(items.iter().map(compile).collect());
    }
    let length = |key: &str| schema[key].as_u64().and_then(|n| usize::try_from(n).ok());
    let mut item = compile(&schema["items"]);
    if let Rule::Quantity(_, range) = &mut item {
        range.likely = likely(schema).or(range.likely);
    }
    Rule::List {
        item: Box::new(item),
        min_items: length("minItems").unwrap_or(0),
        max_items: length("maxItems").unwrap_or(usize::MAX),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hint_shows_how_a_table_is_written() {
        for (path, expected) in [
            ("impactor.shape.box", "`{ size = […], edge = … }`"),
            ("impactor.shape.sphere", "`{ radius = … }` or `{ diameter = … }`"),
            ("impactor.shape.capsule", "`{ radius = …, length = … }`"),
        ] {
            let table = key_at(path).and_then(|key| key.rule.table()).unwrap_or_else(|| panic!("{path} is no table"));
            assert_eq!(table.outline().as_deref(), Some(expected), "{path}");
        }
    }
}
