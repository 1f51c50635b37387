//! The objects of a file, descriptions of their raw data, and the lists of those that have data in a segment.

use std::collections::HashMap;
use std::rc::Rc;

use super::segment::Chunks;
use super::value::{Bytes, Kind, Properties, read_properties, too_many, unknown_type};
use crate::error::{Error, refusal};

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
    pub fn read(&mut self, bytes: &mut Bytes, before: Option<&List>, held: &mut usize) -> Result<List, Error> {
        let mut list = before.cloned().unwrap_or_default();
        for _ in 0..bytes.u32("the number of objects")? {
            let at = bytes.at();
            let path = bytes.text("the path of an object")?;
            let place = self.place(&path);
            let object = &mut self.all[place];
            let none = || refusal!("byte {at}: `{path}` repeats a description of data that was not given");
            let index = match bytes.u32(DESCRIPTION)? {
                NOTHING => None,
                AS_BEFORE => Some(object.index.clone().ok_or_else(none)?),
                header => Some(Rc::new(Index::read(bytes, header, &path)?)),
            };
            if index.is_some() {
                object.index.clone_from(&index);
            }
            read_properties(bytes, &mut object.properties)?;
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
            return Err(too_many(bytes.at(), MOST_MEMBERS, "objects in the lists of segments"));
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

/// What an object has in each chunk of a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Index {
    /// Type of its values.
    pub kind: Kind,
    /// Values in a chunk.
    pub count: u64,
    /// Bytes in a chunk; of DAQmx none, since its buffers are shared.
    pub bytes: u64,
    /// Of DAQmx: where its values are in the buffers.
    pub daqmx: Option<Daqmx>,
}

/// An object in a segment; without data there where it has no description.
pub type Member = (usize, Option<Rc<Index>>);

/// Raw data of DAQmx: one buffer a card, each with rows of so many bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Daqmx {
    pub scalers: Vec<Scaler>,
    /// Bytes of a row of each buffer.
    pub widths: Vec<u32>,
}

/// Where the values of one scaler are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaler {
    pub kind: Kind,
    pub buffer: usize,
    /// Bytes of the row before the value.
    pub offset: u32,
    /// The one bit that is the value, of a digital line.
    pub bit: Option<u8>,
    /// Number that scales know it by.
    pub id: u32,
}

/// Beginnings of descriptions that are no lengths: of no data in the segment, of those of before, and of DAQmx.
const NOTHING: u32 = u32::MAX;
const AS_BEFORE: u32 = 0;
const FORMAT_CHANGING_SCALERS: u32 = 0x1269;
const DIGITAL_LINE_SCALERS: u32 = 0x126a;

/// Most scalers or buffers of a channel.
const MOST_SCALERS: u32 = 256;

/// What a file that ends within a description ends in.
const DESCRIPTION: &str = "the description of data";

impl Index {
    /// Reads the description of the data of `object` behind its `header`.
    fn read(bytes: &mut Bytes, header: u32, object: &str) -> Result<Index, Error> {
        let at = bytes.at();
        let wrong = |why: &str| refusal!("byte {at}: the data of `{object}`: {why}");
        let code = bytes.u32(DESCRIPTION)?;
        let kind = Kind::from_code(code).ok_or_else(|| unknown_type(at, "the data", code))?;
        if bytes.u32(DESCRIPTION)? != 1 {
            return Err(wrong("expected one dimension"));
        }
        let count = bytes.u64(DESCRIPTION)?;
        let lines = header == DIGITAL_LINE_SCALERS;
        if lines || header == FORMAT_CHANGING_SCALERS {
            let daqmx = Daqmx::read(bytes, lines, wrong)?;
            return Ok(Index { kind, count, bytes: 0, daqmx: Some(daqmx) });
        }
        let size = match kind.width() {
            Some(width) => count.checked_mul(width as u64).ok_or_else(|| wrong("more bytes than a file has"))?,
            None if kind == Kind::Text => bytes.u64(DESCRIPTION)?,
            None => return Err(wrong("raw data of DAQmx without its scalers")),
        };
        Ok(Index { kind, count, bytes: size, daqmx: None })
    }
}

impl Daqmx {
    /// Reads the scalers; `wrong` is the fault of a description that cannot be right.
    fn read(bytes: &mut Bytes, lines: bool, wrong: impl Fn(&str) -> Error) -> Result<Daqmx, Error> {
        const WHAT: &str = "the scalers of DAQmx";
        let count = bytes.u32(WHAT)?;
        if count > MOST_SCALERS {
            return Err(wrong("more than 256 scalers"));
        }
        let mut scalers = Vec::new();
        for _ in 0..count {
            let code = bytes.u32(WHAT)?;
            let kind = Kind::from_scaler_code(code).ok_or_else(|| wrong("a scaler of an unknown type"))?;
            let (buffer, offset) = (bytes.u32(WHAT)? as usize, bytes.u32(WHAT)?);
            bytes.take(if lines { 1 } else { 4 }, WHAT)?;
            let id = bytes.u32(WHAT)?;
            let (offset, bit) = if lines { (offset / 8, Some((offset % 8) as u8)) } else { (offset, None) };
            scalers.push(Scaler { kind, buffer, offset, bit, id });
        }
        let buffers = bytes.u32(WHAT)?;
        if buffers > MOST_SCALERS {
            return Err(wrong("more than 256 buffers"));
        }
        let widths = (0..buffers).map(|_| bytes.u32(WHAT)).collect::<Result<Vec<_>, _>>()?;
        let fits = |scaler: &Scaler| {
            let end = u64::from(scaler.offset) + scaler.kind.width().unwrap_or(0) as u64;
            widths.get(scaler.buffer).is_some_and(|width| end <= u64::from(*width))
        };
        if scalers.iter().all(fits) {
            Ok(Daqmx { scalers, widths })
        } else {
            Err(wrong("a scaler lies beyond the rows of its buffer"))
        }
    }
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
