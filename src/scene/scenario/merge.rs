//! Merging of an extending file, of `--set` or of the changes of a script into the table that it extends.

use super::grammar::{Rule, TableRule};
use super::tree::{Entry, Node, Table, Value};

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
