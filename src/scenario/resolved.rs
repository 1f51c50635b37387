//! The merged scenario as one text that runs from any folder.

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
