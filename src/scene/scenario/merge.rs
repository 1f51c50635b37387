//! Merging of an extending file, of `--set` or of the changes of a script into the table that it extends.

use super::grammar::{Rule, TableRule};
use super::tree::{Entry, Node, Table, Value};
use base::diagnostic::{Diagnostic, Span, listed};

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
