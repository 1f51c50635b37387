//! The objects of a file, and the lists of those that have data in a segment.

use std::collections::HashMap;
use std::rc::Rc;

use super::Fault;
use super::bytes::Bytes;
use super::chunks::Chunks;
use super::index::{Described, Index, Member};
use super::property::{self, Properties};

/// A group, a channel, or the file itself.
#[derive(Clone, Debug, Default)]
pub struct Object {
    /// None of the file itself, one of a group, two of a channel.
    pub names: Vec<String>,
    pub properties: Properties,
    /// The latest description of its data.
    index: Option<Rc<Index>>,
}

/// All objects of a file, in the order in which they are first named.
#[derive(Clone, Debug, Default)]
pub struct Objects {
    pub all: Vec<Object>,
    places: HashMap<String, usize>,
}

/// The objects of a segment.
#[derive(Clone, Debug, Default)]
pub struct List {
    pub members: Vec<Member>,
    /// Places of the members by object.
    pub places: HashMap<usize, usize>,
    /// How chunks are divided among them.
    pub chunks: Chunks,
}

/// Most members of all lists of a file.
const MOST_MEMBERS: usize = 2_000_000;

impl Objects {
    /// Reads the list of a segment, which goes on from `before` where the segment says so; `held` counts the members of
    /// all lists.
    pub fn read(&mut self, bytes: &mut Bytes, before: Option<&List>, held: &mut usize) -> Result<List, Fault> {
        let mut list = before.cloned().unwrap_or_default();
        for _ in 0..bytes.u32("the number of objects")? {
            let at = bytes.at();
            let path = bytes.text("the path of an object")?;
            let described = Described::read(bytes, &path)?;
            let place = self.place(&path);
            let object = &mut self.all[place];
            let index = match described {
                Described::Nothing => None,
                Described::AsBefore => {
                    Some(object.index.clone().ok_or_else(|| Fault::NoIndex { at, object: path.clone() })?)
                }
                Described::As(index) => Some(Rc::new(index)),
            };
            if index.is_some() {
                object.index.clone_from(&index);
            }
            property::read(bytes, &mut object.properties)?;
            match list.places.get(&place) {
                Some(member) => list.members[*member].1 = index,
                None => {
                    list.places.insert(place, list.members.len());
                    list.members.push((place, index));
                }
            }
        }
        list.chunks = Chunks::from_members(&list.members);
        *held += list.members.len();
        if *held > MOST_MEMBERS {
            return Err(Fault::TooMany {
                at: bytes.at(),
                most: MOST_MEMBERS,
                what: "objects in the lists of segments",
            });
        }
        Ok(list)
    }

    /// The object at this path.
    pub fn find(&self, names: &[&str]) -> Option<&Object> {
        self.places.get(&path(names)).map(|place| &self.all[*place])
    }

    fn place(&mut self, text: &str) -> usize {
        let names = names(text);
        let key = path(&names.iter().map(String::as_str).collect::<Vec<_>>());
        *self.places.entry(key).or_insert_with(|| {
            self.all.push(Object { names, ..Object::default() });
            self.all.len() - 1
        })
    }
}

/// The path of these names: `/'group'/'channel'`, an apostrophe within them twice.
fn path(names: &[&str]) -> String {
    match names {
        [] => "/".to_owned(),
        _ => names.iter().map(|name| format!("/'{}'", name.replace('\'', "''"))).collect(),
    }
}

/// The names in a path.
fn names(path: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut letters = path.chars().peekable();
    while letters.any(|letter| letter == '\'') {
        let mut name = String::new();
        while let Some(letter) = letters.next() {
            if letter == '\'' && letters.next_if_eq(&'\'').is_none() {
                break;
            }
            name.push(letter);
        }
        names.push(name);
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_names_in_apostrophes() {
        for (text, expected) in [
            ("/", &[][..]),
            ("/'a'", &["a"]),
            ("/'a b'/'c/d'", &["a b", "c/d"]),
            ("/'it''s'/''''", &["it's", "'"]),
            ("/'open", &["open"]),
        ] {
            assert_eq!(names(text), expected, "{text}");
        }
        assert_eq!(path(&["it's", "b"]), "/'it''s'/'b'");
        assert_eq!(path(&[]), "/");
    }
}
