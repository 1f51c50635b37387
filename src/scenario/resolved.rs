//! The merged scenario as one text that runs from any folder.

use std::collections::BTreeMap;

use super::grammar::Rule;
use super::tree::{Node, Value};
use crate::diagnostic::tidy_path;

/// The tree as TOML, with the paths in it made absolute.
pub fn text(root: &Node, rule: &Rule) -> String {
    text_with(root, rule, &[])
}

/// Likewise, with the paths at some key paths given as they shall stand.
pub fn text_with(root: &Node, rule: &Rule, paths: &[(&str, &str)]) -> String {
    let mut root = anchored(root, Some(rule));
    for (place, path) in paths {
        if let Some(node) = root.find_mut(place) {
            node.value = Value::Text((*path).to_owned());
        }
    }
    match root.value {
        Value::Table(table) => table.to_toml().to_string(),
        // A file is always a table.
        _ => String::new(),
    }
}

/// The values of a resolved scenario, as TOML, by the paths of their keys: `layers.count`, `layer.0.height`. None of a text that is
/// no scenario.
pub fn leaves(scenario: &str) -> BTreeMap<String, String> {
    let mut leaves = BTreeMap::new();
    let root: toml::Table = scenario.parse().unwrap_or_default();
    gather("", toml::Value::Table(root), &mut leaves);
    leaves
}

fn gather(path: &str, value: toml::Value, leaves: &mut BTreeMap<String, String>) {
    let under = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        toml::Value::Table(table) => table.into_iter().for_each(|(key, value)| gather(&under(&key), value, leaves)),
        toml::Value::Array(items) if items.iter().any(toml::Value::is_table) => {
            items.into_iter().enumerate().for_each(|(place, item)| gather(&under(&place.to_string()), item, leaves));
        }
        leaf => drop(leaves.insert(path.to_owned(), leaf.to_string())),
    }
}

fn anchored(node: &Node, rule: Option<&Rule>) -> Node {
    let value = match &node.value {
        Value::Text(text) if rule.is_some_and(Rule::is_path) => {
            let path = node.span.source.folder.join(text);
            let absolute = std::path::absolute(&path).unwrap_or(path);
            Value::Text(tidy_path(&absolute).display().to_string())
        }
        Value::List(items) => {
            let items = items.iter().enumerate();
            let items = items.map(|(place, item)| anchored(item, rule.and_then(|r| r.item(place))));
            Value::List(items.collect())
        }
        Value::Table(table) => {
            let mut table = table.clone();
            for entry in &mut table.entries {
                let rule = rule.and_then(|rule| rule.under(&entry.key));
                entry.node = anchored(&entry.node, rule);
            }
            Value::Table(table)
        }
        other => other.clone(),
    };
    Node { value, ..node.clone() }
}
