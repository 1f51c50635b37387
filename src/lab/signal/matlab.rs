//! Recordings in MAT-files of level 5, as MATLAB saves them up to version 7: vectors, columns of matrices, and fields of
//! structs.
//!
//! Source: MathWorks, *MAT-File Format*. Those of version 7.3 are HDF5.

use std::fmt::Display;
use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;

use super::Annotations;
use super::catalogue::{Binary, Catalogue, Columns, Reader};
use super::measurement::MOST_VALUES;
use crate::error::{Error, refusal};
use base::file;

/// The variables of a MAT-file.
#[derive(Default)]
struct Matlab {
    columns: Columns,
    /// Rows and numbers of each array, column by column.
    arrays: Vec<(usize, Vec<f64>)>,
    /// Texts and single numbers.
    comments: Vec<String>,
    /// Arrays that were looked at, and numbers of all of them.
    listed: usize,
    values: usize,
}

/// Bytes before the first variable.
const HEADER: usize = 128;
/// Most bytes of a file, and of its variables unpacked.
const MOST_BYTES: u64 = 1 << 30;

/// Reads the variables of the file at `path`. A text or a single number becomes a comment.
pub fn open(path: &Path) -> Result<Catalogue, Error> {
    let mut found = Matlab::from_bytes(&file::read(path, MOST_BYTES)?)?;
    let annotations = Annotations::new(std::mem::take(&mut found.comments));
    Ok(Catalogue::new(std::mem::take(&mut found.columns.entries), annotations, found))
}

impl Matlab {
    fn from_bytes(bytes: &[u8]) -> Result<Matlab, Error> {
        let header = bytes.get(..HEADER).ok_or_else(|| refusal!("byte 0: the file ends within the header"))?;
        let is_big = &header[126..] == b"MI";
        let mut elements = Elements::new(bytes, HEADER, is_big, false);
        let (mut found, mut left) = (Matlab::default(), MOST_BYTES);
        let top = Place { group: "", name: None, depth: 0 };
        while !elements.is_at_end() {
            let element = elements.next("a variable")?;
            match element.kind {
                MATRIX => read(&elements, &element, top, &mut found)?,
                COMPRESSED => {
                    let mut unpacked = Vec::new();
                    let length = ZlibDecoder::new(element.bytes).take(left + 1).read_to_end(&mut unpacked);
                    length
                        .map_err(|error| refusal!("byte {}: the variable cannot be unpacked: {error}", element.at))?;
                    let rest = left.checked_sub(unpacked.len() as u64);
                    left = rest.ok_or_else(|| too_many(MOST_BYTES as usize, "bytes of variables"))?;
                    let mut inner = Elements::new(&unpacked, 0, is_big, true);
                    let variable = inner.expect(MATRIX, "a variable")?;
                    read(&inner, &variable, top, &mut found)?;
                }
                // Others are data of programs, not variables.
                _ => {}
            }
        }
        Ok(found)
    }

    /// Adds an array of these rows and columns, or the reason why its numbers are not read.
    fn push(&mut self, names: [&str; 2], shape: Result<[usize; 2], &str>, values: Vec<f64>) -> Result<(), Error> {
        let rows = shape.map_or(0, |[rows, _]| rows);
        let shape = shape.map(|shape| shape.map(|length| length as u64)).map_err(str::to_owned);
        self.columns.push(names, None, self.arrays.len(), shape)?;
        self.arrays.push((rows, values));
        Ok(())
    }

    /// Adds an array that is a string or a single number.
    fn comment(&mut self, [group, name]: [&str; 2], value: impl Display) {
        let label = if group.is_empty() { name.to_owned() } else { format!("{group}/{name}") };
        self.comments.push(Annotations::value_comment(&label, value));
    }
}

impl Reader for Matlab {
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        let (array, column) = self.columns.places[place];
        let (rows, values) = &self.arrays[array];
        Ok(values[column * rows..(column + 1) * rows].to_vec())
    }
}

/// Deepest struct within a struct, and most arrays.
const DEEPEST: usize = 16;
const MOST_ARRAYS: usize = 100_000;
/// Most elements of an array of structs.
const MOST_STRUCTS: usize = 1000;

/// Bits of the flags of an array.
const COMPLEX: u32 = 0x0800;

/// Kinds of arrays.
const CELL: u32 = 1;
const STRUCT: u32 = 2;
const OBJECT: u32 = 3;
const CHARACTERS: u32 = 4;
const SPARSE: u32 = 5;
const FIRST_NUMERIC: u32 = 6;
const LAST_NUMERIC: u32 = 15;
const OPAQUE: u32 = 17;

/// Where an array is.
#[derive(Clone, Copy)]
struct Place<'a> {
    pub group: &'a str,
    /// Its name, where the struct around it gives it.
    pub name: Option<&'a str>,
    pub depth: usize,
}

/// Reads the array in `element`, and those within it. In one piece, since the parts of an array follow each other in the file.
fn read(elements: &Elements, element: &Element, place: Place, found: &mut Matlab) -> Result<(), Error> {
    if found.listed >= MOST_ARRAYS {
        return Err(too_many(MOST_ARRAYS, "arrays"));
    }
    let Place { group, name, depth } = place;
    // An empty array may be nothing at all.
    if element.bytes.is_empty() {
        return Ok(());
    }
    let (is_big, mut inner) = (elements.is_big, elements.within(element));
    let flags = inner.expect(UINT32, "the flags of an array")?;
    let flags = flags.bytes.get(..4).map_or(0, |bytes| number(bytes, is_big));
    let kind = flags & 0xff;
    if kind == OPAQUE {
        let own = inner.next("the name of an object").map(|name| text(&name, is_big)).unwrap_or_default();
        let why = "it is an object, such as a table or a timeseries; save the struct of it instead: \
            table2struct(T, \"ToScalar\", true)";
        found.listed += 1;
        return found.push([group, name.unwrap_or(&own)], Err(why), vec![]);
    }
    let shape = inner.expect(INT32, "the dimensions of an array")?;
    let shape: Vec<usize> = shape.bytes.chunks_exact(4).map(|bytes| number(bytes, is_big) as usize).collect();
    let own = inner.next("the name of an array").map(|element| text(&element, is_big))?;
    let names = [group, name.unwrap_or(&own)];
    let count = shape.iter().try_fold(1_usize, |count, length| count.checked_mul(*length)).unwrap_or(usize::MAX);
    if matches!(kind, STRUCT | OBJECT) && depth < DEEPEST {
        if kind == OBJECT {
            inner.next("the class of an object")?;
        }
        return structs(&mut inner, (count, names[1]), place, found);
    }
    found.listed += 1;
    let why = match kind {
        STRUCT | OBJECT => "it is within too many structs",
        CELL => "it is a cell array",
        SPARSE => "it is a sparse matrix",
        CHARACTERS => {
            let text = text(&inner.next("the characters of an array")?, is_big);
            found.comment(names, text.trim());
            return Ok(());
        }
        FIRST_NUMERIC..=LAST_NUMERIC if flags & COMPLEX != 0 => "it holds complex numbers",
        FIRST_NUMERIC..=LAST_NUMERIC => {
            let part = inner.next("the numbers of an array")?;
            let wrong = || inner.wrong(&part, "the numbers of an array");
            let (meaning, width) = number_format(part.kind).ok_or_else(wrong)?;
            found.values += part.bytes.len() / width;
            if found.values > MOST_VALUES {
                return Err(too_many(MOST_VALUES, "numbers"));
            }
            let numbers = part.bytes.chunks_exact(width).map(|bytes| meaning.number(bytes, is_big));
            let values: Vec<f64> = numbers.collect::<Option<_>>().ok_or_else(wrong)?;
            match shape[..] {
                _ if values.len() != count => return Err(inner.ends(part.at, "the numbers of an array")),
                [1, 1] => {
                    found.comment(names, values[0]);
                    return Ok(());
                }
                [rows, columns] if rows == 1 || columns == 1 => return found.push(names, Ok([count, 1]), values),
                [rows, columns] => return found.push(names, Ok([rows, columns]), values),
                _ => "it has more than two dimensions",
            }
        }
        _ => "it is of a kind that is not known here",
    };
    found.push(names, Err(why), vec![])
}

/// The fields of `count` structs, each of which is a group.
fn structs(inner: &mut Elements, (count, name): (usize, &str), place: Place, found: &mut Matlab) -> Result<(), Error> {
    let is_big = inner.is_big;
    let length = inner.expect(INT32, "the length of names of fields")?;
    let length = length.bytes.get(..4).map_or(0, |bytes| number(bytes, is_big) as usize);
    let names = inner.expect(INT8, "the names of fields")?;
    let fields: Vec<String> = names
        .bytes
        .chunks_exact(length.max(1))
        .map(|name| String::from_utf8_lossy(name.split(|byte| *byte == 0).next().unwrap_or_default()).into_owned())
        .collect();
    if count > MOST_STRUCTS {
        return Err(too_many(MOST_STRUCTS, "structs in an array"));
    }
    for number in 1..=count {
        let own = if count > 1 { format!("{name}({number})") } else { name.to_owned() };
        let group = if place.group.is_empty() { own } else { format!("{}/{own}", place.group) };
        for field in &fields {
            let element = inner.expect(MATRIX, "a field of a struct")?;
            read(inner, &element, Place { group: &group, name: Some(field), depth: place.depth + 1 }, found)?;
        }
    }
    Ok(())
}

/// Kinds of elements.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Elements, one after the other.
#[derive(Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    at: usize,
    pub is_big: bool,
    pub is_unpacked: bool,
}

/// One element.
#[derive(Clone, Copy)]
struct Element<'a> {
    pub kind: u32,
    pub bytes: &'a [u8],
    /// Place of its bytes.
    pub at: usize,
}

impl<'a> Elements<'a> {
    /// Those in `bytes` from the place `at` on.
    fn new(bytes: &'a [u8], at: usize, is_big: bool, is_unpacked: bool) -> Elements<'a> {
        Elements { bytes, at, is_big, is_unpacked }
    }

    /// Those within `element`, which is one of these.
    fn within(&self, element: &Element<'a>) -> Elements<'a> {
        Elements { bytes: &self.bytes[..element.at + element.bytes.len()], at: element.at, ..*self }
    }

    /// Whether none is left; fewer bytes than a tag are filler.
    fn is_at_end(&self) -> bool {
        self.at + 8 > self.bytes.len()
    }

    /// The next one, which is `what`.
    fn next(&mut self, what: &'static str) -> Result<Element<'a>, Error> {
        let start = self.at;
        let ends = |elements: &Elements| elements.ends(start, what);
        let tag = self.bytes.get(self.at..self.at + 8).ok_or_else(|| ends(self))?;
        let word = |at: usize| number(&tag[at..at + 4], self.is_big);
        let (first, second) = (word(0), word(4));
        // Up to four bytes are in the tag itself.
        if first >> 16 != 0 {
            let (kind, length) = (first & 0xffff, (first >> 16) as usize);
            let bytes = tag[4..].get(..length).ok_or_else(|| ends(self))?;
            let element = Element { kind, bytes, at: self.at + 4 };
            self.at += 8;
            return Ok(element);
        }
        let at = self.at + 8;
        let end = at.checked_add(second as usize).filter(|end| *end <= self.bytes.len());
        let end = end.ok_or_else(|| ends(self))?;
        self.at = if first == COMPRESSED { end } else { end.next_multiple_of(8).min(self.bytes.len()) };
        Ok(Element { kind: first, bytes: &self.bytes[at..end], at })
    }

    /// The next one, of this kind.
    fn expect(&mut self, kind: u32, what: &'static str) -> Result<Element<'a>, Error> {
        let element = self.next(what)?;
        if element.kind == kind { Ok(element) } else { Err(self.wrong(&element, what)) }
    }

    /// The fault of an element in place of `what`.
    fn wrong(&self, element: &Element, what: &'static str) -> Error {
        let (place, found) = (self.place(element.at), element.kind);
        refusal!("{place}: expected {what}, found an element of the kind {found}")
    }

    /// The fault of an end within `what`.
    fn ends(&self, at: usize, what: &str) -> Error {
        refusal!("{}: the file ends within {what}", self.place(at))
    }

    /// A place in the file, or in an unpacked variable.
    fn place(&self, at: usize) -> String {
        format!("byte {at}{}", if self.is_unpacked { " of a packed variable" } else { "" })
    }
}

/// Four bytes as a number.
fn number(bytes: &[u8], is_big: bool) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(bytes);
    if is_big { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) }
}

/// How the numbers of a kind are meant, and their bytes; none of a kind that has none.
fn number_format(kind: u32) -> Option<(Binary, usize)> {
    Some(match kind {
        INT8 => (Binary::Signed, 1),
        2 => (Binary::Unsigned, 1),
        3 => (Binary::Signed, 2),
        4 => (Binary::Unsigned, 2),
        INT32 => (Binary::Signed, 4),
        UINT32 => (Binary::Unsigned, 4),
        7 => (Binary::Float, 4),
        9 => (Binary::Float, 8),
        12 => (Binary::Signed, 8),
        13 => (Binary::Unsigned, 8),
        _ => return None,
    })
}

/// The text of an element of characters.
fn text(element: &Element, is_big: bool) -> String {
    match element.kind {
        4 | 17 => {
            let units = element.bytes.chunks_exact(2).map(|pair| match is_big {
                true => u16::from_be_bytes([pair[0], pair[1]]),
                false => u16::from_le_bytes([pair[0], pair[1]]),
            });
            char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
        }
        _ => String::from_utf8_lossy(element.bytes).into_owned(),
    }
}

/// Refuses a file that holds more than is read.
fn too_many(most: usize, what: &str) -> Error {
    refusal!("more than {most} {what}").with_hint("save the variables that are needed alone")
}

/// Refuses a MAT-file of level 4.
pub fn level_4() -> Error {
    refusal!("a MAT-file of level 4, which is not read").with_hint("save it again in MATLAB: save FILE -v7")
}

/// Whether the first bytes are those of a file of level 5.
pub fn is_own(first: &[u8]) -> bool {
    first.starts_with(b"MATLAB 5.0 MAT-file")
}

/// Whether a file called `.mat` is of level 4, which has no mark: it begins with a number below 5000, its kind.
pub fn is_of_level_4(path: &Path, first: &[u8]) -> bool {
    let is_called = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mat"));
    let kind = first.first_chunk().map(|bytes| u32::from_le_bytes(*bytes).min(u32::from_be_bytes(*bytes)));
    is_called && kind.is_some_and(|kind| kind < 5000)
}
