//! Values that can be computed with but are implausible: a film of 12 mm, a modulus of 10 Pa, a drop of 120 s. The
//! likely ranges stand beside the keys (`x-likely`).

use base::number;

use super::grammar::{Range, Rule};
use super::tree::{Node, Value};

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
        (Rule::Quantity(_, range) | Rule::Number { range, .. }, _) => found.extend(single(node, rule, range, path)),
        _ => {}
    }
}

fn single(node: &Node, rule: &Rule, range: &Range, path: &str) -> Option<Implausible> {
    let value = value_of(node, rule)?;
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
