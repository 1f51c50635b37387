//! A MAT-file: its variables as channels.

use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;

use super::Fault;
use super::array::{self, Array, Content, Found, Place};
use super::element::{COMPRESSED, Elements, MATRIX};
use crate::signal::Annotations;
use crate::signal::stored::{self, Catalogue, Columns, Entry};
use base::file;

/// A MAT-file whose variables are read.
pub struct Matlab {
    columns: Columns,
    arrays: Vec<Array>,
    comments: Vec<String>,
}

/// Bytes before the first variable.
const HEADER: usize = 128;
/// Most bytes of a file, and of its variables unpacked.
const MOST_BYTES: u64 = 1 << 30;
/// Longest text that becomes a comment, characters.
const LONGEST_COMMENT: usize = 200;

impl Matlab {
    /// Reads the variables of the file at `path`. A text or a single number becomes a comment.
    pub fn open(path: &Path) -> Result<Matlab, stored::Fault> {
        let bytes = file::read(path, MOST_BYTES)?;
        let arrays = arrays(&bytes)?;
        let mut matlab = Matlab { columns: Columns::default(), arrays: Vec::new(), comments: Vec::new() };
        for array in arrays {
            let names = [array.group.as_str(), array.name.as_str()];
            let label = if array.group.is_empty() { array.name.clone() } else { names.join("/") };
            let shape = match &array.content {
                Content::Numbers { rows: 1, columns: 1, values } => {
                    matlab.comments.push(format!("{label}: {}", values.first().copied().unwrap_or(f64::NAN)));
                    continue;
                }
                Content::Text(text) => {
                    let text: String = text.trim().chars().take(LONGEST_COMMENT).collect();
                    matlab.comments.push(format!("{label}: {}", text.replace(char::is_control, " ")));
                    continue;
                }
                Content::Numbers { rows, columns, .. } => Ok([*rows as u64, *columns as u64]),
                Content::Unread(why) => Err(why.clone()),
            };
            matlab.columns.push(names, None, matlab.arrays.len(), shape)?;
            matlab.arrays.push(array);
        }
        Ok(matlab)
    }
}

/// The arrays of a file.
fn arrays(bytes: &[u8]) -> Result<Vec<Array>, Fault> {
    let header = bytes.get(..HEADER).ok_or(Fault::Ends { at: 0, is_unpacked: false, what: "the header" })?;
    let is_big = &header[126..] == b"MI";
    let mut elements = Elements::new(bytes, HEADER, is_big, false);
    let (mut found, mut left) = (Found::default(), MOST_BYTES);
    let top = Place { group: "", name: None, depth: 0 };
    while !elements.is_at_end() {
        let element = elements.next("a variable")?;
        match element.kind {
            MATRIX => array::read(&elements, &element, top, &mut found)?,
            COMPRESSED => {
                let mut unpacked = Vec::new();
                let read = ZlibDecoder::new(element.bytes).take(left + 1).read_to_end(&mut unpacked);
                read.map_err(|error| Fault::Unpacked { at: element.at, why: error.to_string() })?;
                let too_many = Fault::TooMany { most: MOST_BYTES as usize, what: "bytes of variables" };
                left = left.checked_sub(unpacked.len() as u64).ok_or(too_many)?;
                let mut inner = Elements::new(&unpacked, 0, is_big, true);
                let variable = inner.expect(MATRIX, "a variable")?;
                array::read(&inner, &variable, top, &mut found)?;
            }
            // Others are data of programs, not variables.
            _ => {}
        }
    }
    Ok(found.arrays)
}

impl Catalogue for Matlab {
    fn entries(&self) -> &[Entry] {
        &self.columns.entries
    }

    fn annotations(&self) -> Annotations {
        Annotations::new(self.comments.clone())
    }

    fn values(&mut self, place: usize) -> Result<Vec<f64>, stored::Fault> {
        let (array, column) = self.columns.places[place];
        Ok(match &self.arrays[array].content {
            Content::Numbers { rows, values, .. } => values[column * rows..(column + 1) * rows].to_vec(),
            Content::Text(_) | Content::Unread(_) => Vec::new(),
        })
    }
}
