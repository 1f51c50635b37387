//! What decides an evaluation, as a person reads it: kept beside its record, so that a difference can be named.
//!
//! Keys of evaluations are digests, which say that two differ and not in what. A description holds the values of the resolved
//! scenario by their keys, and of files that it names what they hold. Descriptions of many runs of one scenario differ in a
//! few keys: each is stored as its difference from one of the first.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::post::Plan;
use crate::store::evaluations::Key;
use base::file::Digest;
use scene::model::Model;
use scene::scenario::{self, Document};

/// Characters beyond which a message does not print a value.
const LONGEST_VALUE: usize = 60;

/// Most bytes of a description; a larger one, as of a scenario with thousands of points of curves, is not kept.
const MOST_BYTES: usize = 256 << 10;

/// Most descriptions that others are stored as differences from.
const MOST_BASES: usize = 16;

/// Tables of a scenario that decide figures and not the run.
const OF_FIGURES: [&str; 2] = ["reference", "post"];

/// Keys that decide nothing of a run.
const OF_NOTHING: [&str; 2] = ["title", "variation"];

/// The key under which a description has the end of a run that a search cut short, which no scenario can have.
const CUT: &str = "end within a search";

/// What decides a run, or the figures of one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Description {
    /// Whether it has the reference and the post script, which decide figures.
    has_figures: bool,
    /// Values, as TOML, by their keys; of a file, what it holds.
    values: BTreeMap<String, String>,
}

/// A key in which two descriptions differ.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The key, by its path in the scenario.
    pub key: String,
    /// Its value there; none where it has none.
    pub there: Option<String>,
    /// Its value here.
    pub here: Option<String>,
}

/// A description as it is stored: the key of another one, and the values that differ from it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Stored {
    pub(super) base: [u8; 16],
    has_figures: bool,
    /// Values of keys of the other one, by their places there; none of a key that it alone has.
    changes: Vec<(u32, Option<String>)>,
    /// Values of further keys.
    added: Vec<(String, String)>,
}

/// The descriptions that a process has stored whole.
#[derive(Debug, Default)]
pub(super) struct Bases(Vec<(Key, Description)>);

impl Description {
    /// What decides the figures of the run of `model`, checked from `document`, by `plan`.
    pub fn of_figures(document: &Document, model: &Model, plan: &Plan) -> Description {
        let mut description = Description { has_figures: true, values: values(document, model) };
        if let Some(script) = plan.whole_script() {
            description.set("post.script", Digest::from_bytes(script.as_bytes()).to_string());
        }
        description
    }

    /// What decides the run of `model`, checked from `document`; `cut` is the time (s) at which a search ends it.
    pub fn of_run(document: &Document, model: &Model, cut: Option<f64>) -> Description {
        let mut description = Description { has_figures: true, values: values(document, model) }.without_figures();
        if let Some(time) = cut {
            description.set(CUT, format!("{time} s"));
        }
        description
    }

    /// The description with another value of a key, as TOML.
    pub fn with(mut self, key: &str, value: String) -> Description {
        self.set(key, value);
        self
    }

    fn set(&mut self, key: &str, value: String) {
        self.values.insert(key.to_owned(), value);
    }

    /// The part of it that decides the run.
    #[must_use]
    pub fn without_figures(mut self) -> Description {
        self.values.retain(|key, _| !is_below(key, &OF_FIGURES));
        self.has_figures = false;
        self
    }

    /// Whether it has the reference and the post script.
    pub fn has_figures(&self) -> bool {
        self.has_figures
    }

    /// The keys in which `other` differs, in their order.
    pub fn differences(&self, other: &Description) -> Vec<Difference> {
        differences(&other.values, &self.values)
    }

    /// Number of keys in which `other` differs.
    pub(super) fn distance(&self, other: &Description) -> usize {
        let is_other = |(key, value): &(&String, &String)| other.values.get(*key) != Some(value);
        let missing = other.values.keys().filter(|key| !self.values.contains_key(*key)).count();
        self.values.iter().filter(is_other).count() + missing
    }

    /// Its keys, in their order.
    pub(super) fn keys(&self) -> Vec<String> {
        self.values.keys().cloned().collect()
    }

    fn size(&self) -> usize {
        self.values.iter().map(|(key, value)| key.len() + value.len() + 4).sum()
    }

    fn key(&self) -> Key {
        let parts: Vec<&[u8]> =
            self.values.iter().flat_map(|(key, value)| [key.as_bytes(), value.as_bytes()]).collect();
        Key::from_parts(&parts)
    }
}

/// The values of a scenario that decide its runs and figures; of files that it names, what they hold.
fn values(document: &Document, model: &Model) -> BTreeMap<String, String> {
    let mut values = scenario::leaves(&document.resolved());
    values.retain(|key, _| !is_below(key, &OF_NOTHING));
    // A file that cannot be read has no digest, and the evaluation that needs it no record.
    let digest = |path| Digest::of_file(path).map_or_else(|error| error.to_string(), |digest| digest.to_string());
    for mesh in model.meshes() {
        values.insert(mesh.key, digest(mesh.path));
    }
    if let Some(reference) = &model.reference {
        if let Some(signals) = &reference.signals {
            values.insert("reference.signals".into(), digest(signals));
        }
        for (place, file) in reference.field.iter().flat_map(|field| &field.files).enumerate() {
            values.insert(format!("reference.field.files.{place}"), digest(file));
        }
    }
    values
}

fn is_below(key: &str, tables: &[&str]) -> bool {
    tables.contains(&key.split('.').next().unwrap_or_default())
}

/// The keys in which values `then` and `now` differ, in their order.
pub fn differences(then: &BTreeMap<String, String>, now: &BTreeMap<String, String>) -> Vec<Difference> {
    let keys: BTreeSet<&String> = then.keys().chain(now.keys()).collect();
    let difference = |key: &String| {
        let (there, here) = (then.get(key).cloned(), now.get(key).cloned());
        (there != here).then(|| Difference { key: key.clone(), there, here })
    };
    keys.into_iter().filter_map(difference).collect()
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Difference { key, there, here } = self;
        match (there, here) {
            (Some(there), Some(here)) if there.len().max(here.len()) > LONGEST_VALUE => {
                write!(f, "there `{key}` is another one")
            }
            (Some(there), Some(here)) => write!(f, "there `{key}` is {there}, here it is {here}"),
            (None, Some(_)) => write!(f, "there it has no `{key}`"),
            (Some(_), None) => write!(f, "there it has `{key}`, here it has none"),
            (None, None) => write!(f, "`{key}`"),
        }
    }
}

impl Bases {
    /// The description as it is stored, and the one that it is stored as a difference from, where that is not stored yet;
    /// none of a description that is too large.
    pub(super) fn stored(&mut self, description: &Description) -> Option<(Stored, Option<(Key, Description)>)> {
        if description.size() > MOST_BYTES {
            return None;
        }
        let nearest = self.0.iter().map(|(key, base)| (description.distance(base), *key, base));
        let nearest = nearest.min_by_key(|(distance, ..)| *distance);
        // One that differs in a quarter of its values is stored whole.
        let near = nearest.filter(|(distance, ..)| 4 * distance <= description.values.len());
        if let Some((_, key, base)) = near {
            return Some((Stored::new(description, key, base), None));
        }
        let key = description.key();
        if self.0.len() == MOST_BASES {
            self.0.remove(0);
        }
        self.0.push((key, description.clone()));
        Some((Stored::new(description, key, description), Some((key, description.clone()))))
    }
}

impl Stored {
    fn new(description: &Description, base_key: Key, base: &Description) -> Stored {
        let changes = base.values.iter().zip(0..).filter_map(|((key, value), place)| {
            let own = description.values.get(key);
            (own != Some(value)).then(|| (place, own.cloned()))
        });
        let added = description.values.iter().filter(|(key, _)| !base.values.contains_key(*key));
        Stored {
            base: base_key.0,
            has_figures: description.has_figures,
            changes: changes.collect(),
            added: added.map(|(key, value)| (key.clone(), value.clone())).collect(),
        }
    }

    /// Whether it has the reference and the post script.
    pub(super) fn has_figures(&self) -> bool {
        self.has_figures
    }

    /// The description, where `base` is the one that it is stored as a difference from.
    pub(super) fn description(self, base: &Description) -> Description {
        let mut changes: HashMap<u32, Option<String>> = self.changes.into_iter().collect();
        let own = base.values.iter().zip(0..).filter_map(|((key, value), place)| {
            let value = changes.remove(&place).unwrap_or_else(|| Some(value.clone()))?;
            Some((key.clone(), value))
        });
        let values = own.collect::<BTreeMap<_, _>>();
        Description { has_figures: self.has_figures, values: values.into_iter().chain(self.added).collect() }
    }

    /// The number of keys in which it differs from `here`, which differs from its base in `of_base`; `keys` are those of the
    /// base in their order.
    pub(super) fn distance(&self, here: &Description, base: &Description, keys: &[String], of_base: usize) -> usize {
        let is_same = |value: Option<&String>, key: &String| here.values.get(key) == value;
        let mut distance = of_base;
        for (place, value) in &self.changes {
            let Some(key) = keys.get(*place as usize) else { continue };
            distance += usize::from(!is_same(value.as_ref(), key));
            distance = distance.saturating_sub(usize::from(!is_same(base.values.get(key), key)));
        }
        for (key, value) in &self.added {
            distance += usize::from(!is_same(Some(value), key));
            distance = distance.saturating_sub(usize::from(here.values.contains_key(key)));
        }
        distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description(values: &[(&str, &str)]) -> Description {
        let values = values.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
        Description { has_figures: true, values: values.collect() }
    }

    #[test]
    fn a_difference_names_its_key() {
        let long = "1".repeat(LONGEST_VALUE + 1);
        let here = description(&[("a", "1"), ("b", "2"), ("d", "1"), ("post.script", "5 bytes")]);
        let there = description(&[("a", "1"), ("b", "3"), ("c", "1"), ("d", &long)]);
        let words: Vec<String> = here.differences(&there).iter().map(ToString::to_string).collect();
        let expected = [
            "there `b` is 3, here it is 2",
            "there it has `c`, here it has none",
            "there `d` is another one",
            "there it has no `post.script`",
        ];
        assert_eq!(words, expected);
        assert_eq!(here.distance(&there), expected.len());
        assert_eq!(here.without_figures().distance(&there.without_figures()), 3);
    }

    #[test]
    fn descriptions_that_differ_little_are_stored_as_differences() {
        let many: Vec<(String, String)> = (0..40).map(|at| (format!("k{at}"), "1".to_owned())).collect();
        let first = Description { has_figures: true, values: many.into_iter().collect() };
        let second = first.clone().with("k3", "2".into()).with("new", "1".into());
        let third = first.clone().with("k4", "2".into()).without_figures();
        let mut bases = Bases::default();
        let (stored, base) = bases.stored(&first).unwrap();
        let (key, base) = base.expect("the first is stored whole");
        assert_eq!((stored.base, stored.changes.len()), (key.0, 0));
        for other in [&second, &third] {
            let (stored, whole) = bases.stored(other).unwrap();
            assert!(whole.is_none() && stored.changes.len() == 1 && stored.base == key.0);
            let keys = base.keys();
            for here in [&first, &second, &third] {
                assert_eq!(stored.distance(here, &base, &keys, here.distance(&base)), here.distance(other));
            }
            assert_eq!(stored.description(&base), *other);
        }
        assert!(bases.stored(&description(&[("other", "1")])).unwrap().1.is_some());
        assert!(bases.stored(&description(&[("large", &"1".repeat(MOST_BYTES))])).is_none());
    }
}
