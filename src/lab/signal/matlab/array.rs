//! Arrays: numbers, texts, structs, and what is not read.

use super::Fault;
use super::element::{Element, Elements, INT8, INT32, MATRIX, UINT32, number, number_width, numbers, text};
use crate::signal::channel_fault::MOST_VALUES;

/// An array with its name.
#[derive(Debug)]
pub struct Array {
    /// Names of the structs around it.
    pub group: String,
    pub name: String,
    pub content: Content,
}

/// The arrays of a file.
#[derive(Debug, Default)]
pub struct Found {
    pub arrays: Vec<Array>,
    /// Numbers of all of them.
    values: usize,
}

/// What an array holds.
#[derive(Debug)]
pub enum Content {
    /// Numbers, column by column.
    Numbers {
        rows: usize,
        columns: usize,
        values: Vec<f64>,
    },
    Text(String),
    /// Why it is not read.
    Unread(String),
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
pub struct Place<'a> {
    pub group: &'a str,
    /// Its name, where the struct around it gives it.
    pub name: Option<&'a str>,
    pub depth: usize,
}

/// Reads the array in `element`, and those within it.
pub fn read(elements: &Elements, element: &Element, place: Place, found: &mut Found) -> Result<(), Fault> {
    if found.arrays.len() >= MOST_ARRAYS {
        return Err(Fault::TooMany { most: MOST_ARRAYS, what: "arrays" });
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
        push(found, group, name.unwrap_or(&own), Content::Unread(why.into()));
        return Ok(());
    }
    let shape = inner.expect(INT32, "the dimensions of an array")?;
    let shape: Vec<usize> = shape.bytes.chunks_exact(4).map(|bytes| number(bytes, is_big) as usize).collect();
    let own = inner.next("the name of an array").map(|element| text(&element, is_big))?;
    let name = name.unwrap_or(&own);
    let count = shape.iter().try_fold(1_usize, |count, length| count.checked_mul(*length)).unwrap_or(usize::MAX);
    let unread = |why: &str| Content::Unread(why.to_owned());
    let content = match kind {
        STRUCT | OBJECT if depth < DEEPEST => {
            if kind == OBJECT {
                inner.next("the class of an object")?;
            }
            return structs(&mut inner, (count, name), place, found);
        }
        STRUCT | OBJECT => unread("it is within too many structs"),
        CELL => unread("it is a cell array"),
        SPARSE => unread("it is a sparse matrix"),
        CHARACTERS => Content::Text(text(&inner.next("the characters of an array")?, is_big)),
        FIRST_NUMERIC..=LAST_NUMERIC if flags & COMPLEX != 0 => unread("it holds complex numbers"),
        FIRST_NUMERIC..=LAST_NUMERIC => {
            let part = inner.next("the numbers of an array")?;
            found.values += part.bytes.len() / number_width(part.kind);
            if found.values > MOST_VALUES {
                return Err(Fault::TooMany { most: MOST_VALUES, what: "numbers" });
            }
            let values = numbers(&part, is_big).ok_or_else(|| inner.wrong(&part, "the numbers of an array"))?;
            match shape[..] {
                _ if values.len() != count => {
                    let what = "the numbers of an array";
                    return Err(Fault::Ends { at: part.at, is_unpacked: inner.is_unpacked, what });
                }
                [rows, columns] if rows == 1 || columns == 1 => {
                    Content::Numbers { rows: rows * columns, columns: 1, values }
                }
                [rows, columns] => Content::Numbers { rows, columns, values },
                _ => unread("it has more than two dimensions"),
            }
        }
        _ => unread("it is of a kind that is not known here"),
    };
    push(found, group, name, content);
    Ok(())
}

fn push(found: &mut Found, group: &str, name: &str, content: Content) {
    found.arrays.push(Array { group: group.to_owned(), name: name.to_owned(), content });
}

/// The fields of `count` structs, each of which is a group.
fn structs(inner: &mut Elements, (count, name): (usize, &str), place: Place, found: &mut Found) -> Result<(), Fault> {
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
        return Err(Fault::TooMany { most: MOST_STRUCTS, what: "structs in an array" });
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
