//! The merged scenario as one text that runs from any folder.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use toml_edit::{DocumentMut, Item, TableLike};

use super::grammar::Rule;
use super::tree::{Node, Table, Value};
use base::diagnostic::{Span, tidy_path};
use base::units;

/// The tree as TOML, with the paths in it made absolute. The comment at the end of the line of a value is preserved: it
/// has its source, and whether it is assumed.
pub fn text(root: &Node, rule: &Rule) -> String {
    text_with(root, rule, &[])
}

/// The tree as TOML like [`text`], with other paths at some key paths.
pub fn text_with(root: &Node, rule: &Rule, paths: &[(&str, &str)]) -> String {
    let mut root = anchored(root.clone(), Some(rule), &mut BTreeSet::new());
    for (place, path) in paths {
        if let Some(node) = root.find_mut(place) {
            node.value = Value::Text((*path).to_owned());
        }
    }
    match root.value {
        Value::Table(table) => commented(&table),
        // A file is always a table.
        _ => String::new(),
    }
}

fn commented(table: &Table) -> String {
    let plain = table.to_toml().to_string();
    match plain.parse::<DocumentMut>() {
        Ok(mut document) => {
            comment(document.as_table_mut(), table, &mut BTreeSet::new());
            document.to_string()
        }
        // What was written is read again by the same grammar; without it, the text is whole but for the comments.
        Err(_) => plain,
    }
}

/// Gives the values of `written` the comments of `table`, one line's only once.
fn comment(written: &mut dyn TableLike, table: &Table, written_lines: &mut BTreeSet<(usize, usize)>) {
    for entry in &table.entries {
        let Some(item) = written.get_mut(&entry.key) else { continue };
        match &entry.node.value {
            Value::Table(inner) => {
                if let Some(written) = item.as_table_like_mut() {
                    comment(written, inner, written_lines);
                }
                continue;
            }
            Value::List(rows) => {
                if let Some(written) = item.as_array_of_tables_mut() {
                    for (written, row) in written.iter_mut().zip(rows) {
                        if let Value::Table(row) = &row.value {
                            comment(written, row, written_lines);
                        }
                    }
                    continue;
                }
            }
            _ => {}
        }
        if let (Some(value), Some((line, text))) = (item.as_value_mut(), end_of_line(&entry.node.span))
            && written_lines.insert(line)
        {
            value.decor_mut().set_suffix(format!("  {text}"));
        }
    }
}

/// The comment behind a value on its line, and the line: its source and where it ends.
fn end_of_line(span: &Span) -> Option<((usize, usize), &str)> {
    let rest = span.source.text.get(span.range.end..)?.lines().next()?;
    let (mut quote, mut at) = (None, None);
    for (place, letter) in rest.char_indices() {
        match (quote, letter) {
            (None, '#') => {
                at = Some(place);
                break;
            }
            (None, '"' | '\'') => quote = Some(letter),
            (Some(open), _) if open == letter => quote = None,
            _ => {}
        }
    }
    let source = Arc::as_ptr(&span.source) as usize;
    at.map(|place| ((source, span.range.end + rest.len()), rest[place..].trim_end()))
}

/// The values of a resolved scenario, as TOML, by the paths of their keys: `layers.count`, `layer.0.height`. None of a
/// text that is no scenario.
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

/// Whether a key has the same value in two of them, however it is written (9.0 and 9, "0.66m" and "660 mm"), or is in neither.
pub fn is_same_value(one: Option<&String>, other: Option<&String>) -> bool {
    let value = |text: Option<&String>| text?.parse::<toml::Value>().ok();
    one == other || value(one).zip(value(other)).is_some_and(|(one, other)| is_same(&one, &other))
}

fn is_same(one: &toml::Value, other: &toml::Value) -> bool {
    use toml::Value::{Array, Float, Integer, String};
    match (one, other) {
        (String(one), String(other)) => units::is_same(one, other),
        (Float(float), Integer(whole)) | (Integer(whole), Float(float)) => *float == *whole as f64,
        (Array(one), Array(other)) => {
            one.len() == other.len() && one.iter().zip(other).all(|(one, other)| is_same(one, other))
        }
        _ => one == other,
    }
}

/// A value of a resolved scenario that the comment on its line marks as assumed: by this word, without "not" before it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assumption {
    /// Path of the key, e.g. `impactor.friction`; items of a list share the path of the list.
    pub key: String,
    /// The value, as TOML.
    pub value: String,
    /// The comment without its `#`.
    pub comment: String,
}

/// The assumed values of a resolved scenario, in its order; none of a text that is not TOML.
pub fn assumptions(scenario: &str) -> Vec<Assumption> {
    let mut found = Vec::new();
    if let Ok(document) = scenario.parse::<DocumentMut>() {
        assumed("", document.as_table(), &mut found);
    }
    found
}

fn is_marked(comment: &str) -> bool {
    let words = || comment.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let before = std::iter::once("").chain(words());
    words().zip(before).any(|(word, before)| word == "assumed" && before != "not")
}

fn assumed(path: &str, table: &dyn TableLike, found: &mut Vec<Assumption>) {
    for (key, item) in table.iter() {
        let key = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match item {
            Item::Value(value) => {
                let suffix = value.decor().suffix().and_then(|suffix| suffix.as_str()).unwrap_or_default();
                let comment = suffix.trim().trim_start_matches('#').trim().to_owned();
                if is_marked(&comment) {
                    let value = value.clone().decorated("", "").to_string();
                    found.push(Assumption { key, value, comment });
                }
            }
            Item::Table(table) => assumed(&key, table, found),
            Item::ArrayOfTables(tables) => tables.iter().for_each(|table| assumed(&key, table, found)),
            Item::None => {}
        }
    }
}

/// The absolute paths that the tree holds, each once.
pub fn paths(root: &Node, rule: &Rule) -> Vec<PathBuf> {
    let mut found = BTreeSet::new();
    anchored(root.clone(), Some(rule), &mut found);
    found.into_iter().collect()
}

/// The path that a node holds, from the folder of the file in which it is written.
fn absolute(node: &Node, text: &str) -> PathBuf {
    let path = node.span.source.folder.join(text);
    tidy_path(&std::path::absolute(&path).unwrap_or(path))
}

/// The node with its paths absolute, which are added to those that are `found`.
fn anchored(node: Node, rule: Option<&Rule>, found: &mut BTreeSet<PathBuf>) -> Node {
    match &node.value {
        Value::Text(text) if rule.is_some_and(Rule::is_path) => {
            let path = absolute(&node, text);
            let value = Value::Text(path.display().to_string());
            found.insert(path);
            Node { value, ..node }
        }
        _ => node.map(rule, |child, rule| anchored(child, rule, found)),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::{Assumption, assumptions};
    use crate::scenario::Document;

    #[test]
    fn comments_mark_values_as_assumed() {
        let scenario = "title = \"a\"\n[impactor]\nfriction = 0.4  # assumed\nmass = 1.0  # not assumed: Table 3\n[[layer]]\n\
                        height = \"a  # b\"  # distance assumed\n";
        let expected = [["impactor.friction", "0.4", "assumed"], ["layer.height", "\"a  # b\"", "distance assumed"]];
        let expected = expected.map(|parts| parts.map(str::to_owned));
        assert_eq!(assumptions(scenario), expected.map(|[key, value, comment]| Assumption { key, value, comment }));
        assert!(assumptions("a = # assumed").is_empty());
    }

    #[test]
    fn comments_at_the_end_of_lines_are_preserved() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write(
            "base.toml",
            "frame.hold = \"all\"  # assumed\n\
             specimen = { symmetry = \"quarter\", mesh = { size = \"10 mm\" } } # Table 3\n",
        );
        write(
            "own.toml",
            "extends = \"base.toml\"\ntitle = \"a # in a text\" # \"quoted\"\n[[layer]]\nheight = \"0 mm\" # one\n",
        );
        let text = Document::read(&folder.path().join("own.toml")).unwrap().resolved();
        for (line, times) in [
            ("title = \"a # in a text\"  # \"quoted\"\n", 1),
            ("hold = \"all\"  # assumed\n", 1),
            ("height = \"0 mm\"  # one\n", 1),
            ("# Table 3\n", 1),
        ] {
            assert_eq!(text.matches(line).count(), times, "{line} in\n{text}");
        }
        assert_eq!(super::leaves(&text)["layer.0.height"], "\"0 mm\"");
    }

    #[test]
    fn the_same_value_may_be_written_in_several_ways() {
        for (one, other, is_same) in [
            ("9", "9.0", true),
            ("\"0.66m\"", "\"660 mm\"", true),
            ("\"9 um\"", "\"0.009 mm\"", true),
            ("[1, \"915 kg/m3\"]", "[1.0, \"915.0 kg/m3\"]", true),
            ("[1, 2]", "[1, 2, 3]", false),
            ("\"12 um\"", "\"12 mm\"", false),
            ("\"12 um\"", "12e-6", false),
            ("\"CFC60\"", "\"CFC180\"", false),
            ("\"1008\"", "\"1008.0\"", false),
        ] {
            let [own, that] = [one, other].map(str::to_owned);
            assert_eq!(super::is_same_value(Some(&own), Some(&that)), is_same, "{one} {other}");
        }
    }
}
