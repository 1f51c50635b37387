//! One change of a scenario: `key.path = value`, from `--set` or from a script, or a key that is left out.

use super::merge::Unset;
use super::tree::{self, Entry, Node, Table, Value};
use base::diagnostic::{Diagnostic, Source, Span};

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
        if let Ok(tree) = tree::parse(&source)
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
        let mut tree = tree::parse_as(&format!("{key}=0"), &source).map_err(|_| malformed())?;
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
        let tree = tree::parse(&source)?;
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
