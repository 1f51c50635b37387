//! Checks a tree against the grammar: all mistakes at once, each at its place. Values that can be computed with may be
//! implausible: a film of 12 mm, a modulus of 10 Pa, a drop of 120 s. The likely ranges stand beside the keys (`x-likely`).

use std::sync::Arc;

use super::grammar::{Key, Rule, TableRule};
use super::tree::{Entry, Node, Table, Value};
use super::variation::{self, VariedKey};
use base::diagnostic::{Diagnostic, Span, closest};
use base::units::{Angle, Dimension, with_decimal_point};
use base::{number, removed};

/// Largest magnitude of an angle, rad: 360 deg and its round-off.
const FULL_TURN: f64 = std::f64::consts::TAU * (1.0 + 1e-12);

/// The mistakes in `root` against `rule`.
pub fn validate(root: &Node, rule: &Rule) -> Vec<Diagnostic> {
    mistakes(root, rule, &Place::top(root))
}

/// The mistakes in `node`, which is at a place, against `rule`.
fn mistakes(node: &Node, rule: &Rule, place: &Place) -> Vec<Diagnostic> {
    let mut walk = Walk::default();
    walk.node(node, rule, place);
    walk.mistakes
}

impl VariedKey {
    /// The mistakes in what the key may have.
    pub fn validate(&self) -> Vec<Diagnostic> {
        let place = Place { path: self.path.clone(), span: self.span.clone() };
        self.choices().map_or_else(|mistake| vec![mistake], |rule| mistakes(&self.node, &rule, &place))
    }
}

/// A place in the tree.
struct Place {
    /// Key path, empty at the top.
    path: String,
    /// Where a missing key is reported.
    span: Span,
}

impl Place {
    fn top(root: &Node) -> Place {
        Place { path: String::new(), span: root.span.clone() }
    }

    fn under(&self, entry: &Entry) -> Place {
        Place { path: self.name(&entry.key), span: entry.key_span.clone() }
    }

    fn item(&self, index: usize, item: &Node) -> Place {
        Place { path: self.name(&index.to_string()), span: item.span.clone() }
    }

    fn name(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }
}

#[derive(Default)]
struct Walk {
    mistakes: Vec<Diagnostic>,
}

impl Walk {
    fn report(&mut self, mistake: Diagnostic) {
        self.mistakes.push(mistake);
    }

    fn node(&mut self, node: &Node, rule: &Rule, place: &Place) {
        match (rule, &node.value) {
            (Rule::Table(rule), Value::Table(table)) => self.table(table, rule, place),
            (Rule::List { item, min_items, max_items }, Value::List(items)) => {
                self.length(items.len(), *min_items, *max_items, &node.span);
                for (index, child) in items.iter().enumerate() {
                    self.node(child, item, &place.item(index, child));
                }
            }
            (Rule::Tuple(rules), Value::List(items)) => {
                self.length(items.len(), rules.len(), rules.len(), &node.span);
                for (index, (child, rule)) in items.iter().zip(rules).enumerate() {
                    self.node(child, rule, &place.item(index, child));
                }
            }
            (Rule::Choice(words), Value::Text(text)) => {
                if !words.iter().any(|(word, _)| word == text) {
                    self.report(unknown_word(text, rule, place).at(&node.span));
                }
            }
            (Rule::Quantity(dimension, _), value) => {
                self.quantity(value, *dimension, rule, node);
            }
            (Rule::Number { whole, .. }, Value::Whole(_) | Value::Number(_)) => {
                self.number(node, *whole, rule);
            }
            (Rule::Text { .. }, Value::Text(_)) | (Rule::Flag, Value::Flag(_)) | (Rule::Any, _) => {}
            (Rule::Either(rules), _) => self.either(node, rules, place),
            _ => self.report(wrong_kind(node, rule)),
        }
    }

    fn table(&mut self, table: &Table, rule: &TableRule, place: &Place) {
        for entry in &table.entries {
            match (rule.key(&entry.key), &rule.others) {
                (Some(key), _) => match of_other_table(entry, key, rule) {
                    Some(hint) => self.report(wrong_kind(&entry.node, &key.rule).hint(hint)),
                    None => self.node(&entry.node, &key.rule, &place.under(entry)),
                },
                (None, Some(others)) => self.node(&entry.node, others, &place.under(entry)),
                (None, None) if rule.varied => {}
                (None, None) => self.report(unknown_key(entry, table, rule, place)),
            }
        }
        if rule.varied {
            // Keys that vary, each with what it may have.
            self.mistakes.extend(variation::varied_keys(table, rule).iter().flat_map(VariedKey::validate));
        }
        for key in rule.keys.iter().filter(|key| key.required) {
            if table.get(&key.name).is_none() {
                self.report(missing_key(key, place));
            }
        }
        self.groups(table, rule, place);
    }

    /// Keys that exclude one another: at most one group of them, and that one whole.
    fn groups(&mut self, table: &Table, rule: &TableRule, place: &Place) {
        let groups = rule.groups.iter();
        let present: Vec<_> = groups.filter_map(|group| Some((group, first_of(table, group)?))).collect();
        match present.as_slice() {
            [] if rule.group_required => self.report(no_group(rule, place)),
            [] => {}
            [(group, _)] => self.whole_group(table, group, place),
            [(_, first), others @ ..] => {
                for (_, other) in others {
                    let message = format!("`{}` and `{}` exclude each other", first.key, other.key);
                    let (later, earlier) = if is_later(other, first, table) { (other, first) } else { (first, other) };
                    let hint = match list_of_base(later, earlier) {
                        Some(list) => format!(
                            "{list}.0 is its first entry; `unset = [\"{list}\"]` or --unset {list} leaves it out"
                        ),
                        None => format!("keep one of {}", list_groups(rule)),
                    };
                    let label = format!("`{}` is given here", earlier.key);
                    let mistake = Diagnostic::new(message).at(&later.key_span).hint(hint);
                    self.report(mistake.label(&earlier.key_span, label));
                }
            }
        }
    }

    fn whole_group(&mut self, table: &Table, group: &[String], place: &Place) {
        for name in group.iter().filter(|name| table.get(name).is_none()) {
            let message = format!("missing key `{}`", place.name(name));
            let beside = first_of(table, group).map(|entry| format!("`{}` needs it", entry.key));
            self.report(Diagnostic::new(message).at(&place.span).hint_if(beside));
        }
    }

    fn length(&mut self, found: usize, min_items: usize, max_items: usize, span: &Span) {
        if (min_items..=max_items).contains(&found) {
            return;
        }
        let expected = match (min_items, max_items) {
            (least, most) if least == most => format!("{least} items"),
            (least, _) if found < least => {
                format!("at least {least} item{}", if least == 1 { "" } else { "s" })
            }
            (_, most) => format!("at most {most} items"),
        };
        self.report(Diagnostic::new(format!("expected {expected}, found {found}")).at(span));
    }

    fn quantity(&mut self, value: &Value, dimension: Dimension, rule: &Rule, node: &Node) {
        let number = match value {
            Value::Whole(whole) => Ok(*whole as f64),
            Value::Number(number) => Ok(*number),
            Value::Text(text) => match dimension.parse(text) {
                Ok(number) => Ok(number),
                Err(error) => Err(Diagnostic::new(error.to_string()).hint(error.hint())),
            },
            _ => Err(Diagnostic::new(format!("expected {}, found {}", dimension.name, node.found()))
                .hint(format!("write it like \"{}\"", dimension.example))),
        };
        match number {
            Ok(angle) if dimension == Angle::DIMENSION && angle.is_finite() && angle.abs() > FULL_TURN => {
                self.report(beyond_a_turn(node));
            }
            Ok(number) => self.range(number, rule, node, |bound| dimension.show(bound)),
            Err(mistake) => self.report(mistake.at(&node.span)),
        }
    }

    fn number(&mut self, node: &Node, whole: bool, rule: &Rule) {
        match node.value {
            Value::Whole(number) => self.range(number as f64, rule, node, |b| b.to_string()),
            Value::Number(_) if whole => {
                self.report(Diagnostic::new(format!("expected a whole number, found {}", node.found())).at(&node.span))
            }
            Value::Number(number) => self.range(number, rule, node, |b| b.to_string()),
            _ => {}
        }
    }

    fn range(&mut self, number: f64, rule: &Rule, node: &Node, show: impl Fn(f64) -> String) {
        let Some(range) = rule.range() else { return };
        let found = node.found();
        if !number.is_finite() {
            let message = format!("expected a finite number, found {found}");
            self.report(Diagnostic::new(message).at(&node.span));
        } else if !range.contains(number)
            && let Some(bounds) = range.describe(show)
        {
            let message = format!("out of range: expected {bounds}, found {found}");
            let hint = meant(number, rule, node).map(|meant| format!("did you mean \"{meant}\"?"));
            self.report(Diagnostic::new(message).at(&node.span).hint_if(hint));
        }
    }

    /// The mistakes of the one branch that takes values of this kind; of several, whether one fits.
    fn either(&mut self, node: &Node, rules: &[Rule], place: &Place) {
        let meant: Vec<&Rule> = rules.iter().filter(|rule| rule.takes(&node.value)).collect();
        if let ([Rule::Choice(_)], Value::Text(text)) = (meant.as_slice(), &node.value)
            && rules.iter().filter_map(Rule::table).any(|table| table.key(text).is_some())
        {
            let mistake = Diagnostic::new(format!("expected a table, found \"{text}\"")).at(&node.span);
            return self.report(mistake.hint(format!("`{text}` is a key here: {{ {text} = … }}")));
        }
        if let [only] = meant.as_slice() {
            return self.node(node, only, place);
        }
        if meant.iter().any(|rule| mistakes(node, rule, place).is_empty()) {
            return;
        }
        // A number out of its range, where a quantity may be given too, is a mistake of the number.
        if let Some(number) = meant.iter().find(|rule| matches!(rule, Rule::Number { .. })) {
            return self.node(node, number, place);
        }
        let rule = Rule::Either(rules.to_vec());
        self.report(wrong_kind(node, &rule));
    }
}

/// Degrees written as a bare number, which would be read as radians.
fn beyond_a_turn(node: &Node) -> Diagnostic {
    let message = format!("out of range: expected an angle within ±360 deg, found {}", node.found());
    let mistake = Diagnostic::new(message).at(&node.span);
    match node.value {
        Value::Text(_) => mistake.hint("write it like \"45 deg\""),
        _ => mistake.hint(format!("write it like \"{} deg\"; a bare number is in rad", node.found())),
    }
}

/// Whether `entry` is written after `other`: in the same text, or in one that extends or changes the other's.
fn is_later(entry: &Entry, other: &Entry, table: &Table) -> bool {
    if Arc::ptr_eq(&entry.key_span.source, &other.key_span.source) {
        return entry.key_span.range.start > other.key_span.range.start;
    }
    let place = |wanted: &Entry| table.entries.iter().position(|entry| entry.key == wanted.key);
    place(entry) > place(other)
}

/// The key of an inherited list of tables that excludes the key `later`.
fn list_of_base<'t>(later: &Entry, earlier: &'t Entry) -> Option<&'t str> {
    let is_inherited = !Arc::ptr_eq(&later.key_span.source, &earlier.key_span.source);
    (is_inherited && matches!(earlier.node.value, Value::List(_))).then_some(earlier.key.as_str())
}

fn first_of<'t>(table: &'t Table, group: &[String]) -> Option<&'t Entry> {
    table.entries.iter().find(|entry| group.contains(&entry.key))
}

fn wrong_kind(node: &Node, rule: &Rule) -> Diagnostic {
    let message = format!("expected {rule}, found {}", node.found());
    let mistake = Diagnostic::new(message).at(&node.span);
    match (&node.value, rule) {
        (Value::Text(text), Rule::Number { .. }) if with_decimal_point(text).is_some() => {
            let point = with_decimal_point(text).unwrap_or_default();
            mistake.hint(format!("write it with a decimal point: {point}"))
        }
        (Value::Text(text), Rule::Number { .. } | Rule::Flag) if text.parse::<f64>().is_ok() => {
            mistake.hint("leave the quotes out")
        }
        (Value::Text(text), Rule::Either(_)) => {
            let words = rule.words();
            let word = closest(text, words.iter().map(|(word, _)| *word));
            mistake.hint_if(word.map(|word| format!("did you mean \"{word}\"?")))
        }
        (value, _) if !matches!(value, Value::Table(_)) => {
            let outline = rule.table().and_then(TableRule::outline);
            mistake.hint_if(outline.map(|outline| format!("write it like {outline}")))
        }
        _ => mistake,
    }
}

/// The key that is meant by a table where the key takes none: `layer.count` of a list.
fn of_other_table(entry: &Entry, key: &Key, rule: &TableRule) -> Option<String> {
    let Value::Table(written) = &entry.node.value else { return None };
    let first = &written.entries.first().filter(|_| !key.rule.takes(&entry.node.value))?.key;
    let has_it = |other: &&Key| other.rule.table().is_some_and(|table| table.key(first).is_some());
    let name = closest(&entry.key, rule.keys.iter().filter(has_it).map(|other| other.name.as_str()))?;
    Some(format!("did you mean `{name}.{first}`?"))
}

fn unknown_word(text: &str, rule: &Rule, place: &Place) -> Diagnostic {
    let words = rule.words();
    let names = words.iter().map(|(word, _)| *word);
    let meant = || closest(text, names).map(|word| format!("did you mean \"{word}\"?"));
    let hint = removed::value(&place.path, text).or_else(meant);
    Diagnostic::new(format!("expected {rule}, found \"{text}\"")).hint_if(hint)
}

/// Keys that a user may expect, by the ends of their paths, and what there is instead.
const NOT_YET: [[&str; 2]; 1] =
    [["plastic.wrinkling", "a plastic film carries compression; film of the other laws can wrinkle"]];

fn unknown_key(entry: &Entry, table: &Table, rule: &TableRule, place: &Place) -> Diagnostic {
    let path = place.name(&entry.key);
    if let Some([_, hint]) = NOT_YET.iter().find(|[end, _]| path.ends_with(end)) {
        return Diagnostic::new(format!("`{path}` is not supported yet")).at(&entry.key_span).hint(*hint);
    }
    let unknown = Diagnostic::new(format!("unknown key `{}`", entry.key)).at(&entry.key_span);
    if let Some(hint) = removed::key(&path) {
        return unknown.hint(hint);
    }
    // Who gives a value beside this one knows its key.
    let is_beside = |name: &str| {
        let other = table.get(name);
        other.is_some_and(|other| {
            let is_table = matches!(other.node.value, Value::Table(_));
            !is_table && Arc::ptr_eq(&other.key_span.source, &entry.key_span.source)
        })
    };
    let names = || rule.keys.iter().map(|key| key.name.as_str());
    let meant = closest(&entry.key, names().filter(|name| !is_beside(name))).map(str::to_owned);
    let hint = match meant.or_else(|| deeper(rule, &entry.key)) {
        Some(name) => format!("did you mean `{name}`?"),
        None => {
            let known: Vec<String> = names().map(|name| format!("`{name}`")).collect();
            format!("known here: {}", known.join(", "))
        }
    };
    unknown.hint(hint)
}

/// The path of a key of this name in a table below.
fn deeper(rule: &TableRule, name: &str) -> Option<String> {
    rule.keys.iter().find_map(|key| {
        let table = key.rule.table()?;
        let path = match table.key(name) {
            Some(found) => found.name.clone(),
            None => deeper(table, name)?,
        };
        Some(format!("{}.{path}", key.name))
    })
}

fn missing_key(key: &Key, place: &Place) -> Diagnostic {
    let hint = key.sentence.as_ref().map(|sentence| format!("`{}`: {}", key.name, first_clause(sentence)));
    Diagnostic::new(format!("missing key `{}`", place.name(&key.name))).at(&place.span).hint_if(hint)
}

/// The sentence of a key up to its first stop.
fn first_clause(sentence: &str) -> &str {
    sentence.split(['.', ';']).next().unwrap_or(sentence)
}

fn no_group(rule: &TableRule, place: &Place) -> Diagnostic {
    let groups = list_groups(rule);
    let message = match &*place.path {
        "" => format!("one of {groups} is missing"),
        path => format!("`{path}` needs one of {groups}"),
    };
    Diagnostic::new(message).at(&place.span)
}

fn list_groups(rule: &TableRule) -> String {
    let groups: Vec<String> = rule
        .groups
        .iter()
        .map(|group| {
            let keys: Vec<String> = group.iter().map(|key| format!("`{key}`")).collect();
            keys.join(" with ")
        })
        .collect();
    groups.join(", ")
}

/// Number above which a fraction was probably meant as a percentage.
const LEAST_PERCENTAGE: f64 = 2.0;

/// A value outside the likely range of its key.
#[derive(Clone, Debug, PartialEq)]
pub struct Implausible {
    /// Path of the key.
    pub key: String,
    /// SI.
    pub value: f64,
    /// The value as it is written.
    pub found: String,
    /// The likely range in words.
    pub likely: String,
    /// The number in a unit with which it is likely.
    pub meant: Option<String>,
}

/// The implausible values in a tree, in its order.
pub(super) fn implausible(root: &Node, rule: &Rule) -> Vec<Implausible> {
    let mut found = Vec::new();
    walk(root, rule, "", &mut found);
    found
}

fn walk(node: &Node, rule: &Rule, path: &str, found: &mut Vec<Implausible>) {
    let under = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match (rule, &node.value) {
        (Rule::Table(rule), Value::Table(table)) => {
            for entry in &table.entries {
                if let Some(key) = rule.key(&entry.key) {
                    walk(&entry.node, &key.rule, &under(&entry.key), found);
                }
            }
        }
        (Rule::List { item, .. }, Value::List(items)) => {
            // Of a curve the last point: its first ones may be as small as they like.
            let first = if matches!(**item, Rule::Tuple(_)) { items.len().saturating_sub(1) } else { 0 };
            for (place, child) in items.iter().enumerate().skip(first) {
                walk(child, item, &under(&place.to_string()), found);
            }
        }
        (Rule::Tuple(rules), Value::List(items)) => {
            for (place, (child, rule)) in items.iter().zip(rules).enumerate() {
                walk(child, rule, &under(&place.to_string()), found);
            }
        }
        (Rule::Either(rules), _) => {
            if let Some(rule) = rules.iter().find(|rule| rule.takes(&node.value)) {
                walk(node, rule, path, found);
            }
        }
        (Rule::Quantity(..) | Rule::Number { .. }, _) => found.extend(single(node, rule, path)),
        _ => {}
    }
}

/// The value of `node`, where it is outside of the likely range of `rule`.
pub(super) fn single(node: &Node, rule: &Rule, path: &str) -> Option<Implausible> {
    let (value, range) = (value_of(node, rule)?, rule.range()?);
    let [low, high] = range.likely.filter(|_| range.contains(value) && !range.is_likely(value))?;
    let shown = |value: f64| rule.dimension().map_or_else(|| number::plain(value), |dimension| dimension.show(value));
    Some(Implausible {
        key: path.to_owned(),
        value,
        found: match &node.value {
            Value::Text(text) => text.clone(),
            _ => shown(value),
        },
        likely: format!("{} to {}", shown(low), shown(high)),
        meant: meant(value, rule, node),
    })
}

/// SI value of a quantity or number.
fn value_of(node: &Node, rule: &Rule) -> Option<f64> {
    match (&node.value, rule.dimension()) {
        (Value::Whole(whole), _) => Some(*whole as f64),
        (Value::Number(number), _) => Some(*number),
        (Value::Text(text), Some(dimension)) => dimension.parse(text).ok(),
        _ => None,
    }
}

/// The number as it is written in a unit with which it is likely; none where `value` is, or where there is no such
/// unit.
pub(super) fn meant(value: f64, rule: &Rule, node: &Node) -> Option<String> {
    let likely = rule.range()?.likely?;
    let number = match &node.value {
        Value::Text(text) => text.clone(),
        _ => node.found(),
    };
    match rule.dimension() {
        Some(dimension) => dimension.likelier(&number, value, likely),
        // What may well be larger than a hundred is no fraction.
        None => (value > LEAST_PERCENTAGE && likely[1] < 100.0 && (likely[0]..=likely[1]).contains(&(value / 100.0)))
            .then(|| format!("{number} %")),
    }
}
