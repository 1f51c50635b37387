//! Keys that a scenario leaves out although it inherits them: `unset`, `--unset`, `()` in a script.

use super::grammar::Rule;
use super::tree::{Node, Table, Value};
use base::diagnostic::{Diagnostic, Span, listed};

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
