//! Faults in a TDMS file.

use std::io;

use thiserror::Error;

/// A fault of a TDMS file, and where it is.
#[derive(Debug, Error)]
pub enum Fault {
    /// Reading failed within the file.
    #[error("cannot be read further: {0}")]
    Read(#[from] io::Error),
    /// The file is the index of another.
    #[error("it is the index of a TDMS file, without its values")]
    IndexFile,
    /// A segment does not begin where the one before it ends.
    #[error("byte {at}: a segment begins with `TDSm`, found {found:?}")]
    NoSegment {
        /// Place in the file.
        at: u64,
        /// Bytes in place of the tag.
        found: String,
    },
    /// A segment states lengths that contradict each other.
    #[error("byte {at}: the raw data of the segment begin beyond its end")]
    Offsets {
        /// Place of the segment in the file.
        at: u64,
    },
    /// A list of objects is longer than any that is read.
    #[error("byte {at}: the segment lists objects in {bytes} bytes")]
    LongList {
        /// Place of the segment in the file.
        at: u64,
        /// Its length.
        bytes: u64,
    },
    /// A list of objects ends before what it announces.
    #[error("byte {at}: the list of objects ends within {what}")]
    Ends {
        /// Place in the file.
        at: u64,
        /// What is incomplete.
        what: &'static str,
    },
    /// A type of data that the format does not have.
    #[error("byte {at}: {what} has the unknown type {code:#x}")]
    UnknownType {
        /// Place in the file.
        at: u64,
        /// What has it.
        what: &'static str,
        /// The number of the type.
        code: u32,
    },
    /// An object refers to a description of its data that was not given before.
    #[error("byte {at}: `{object}` repeats a description of data that was not given")]
    NoIndex {
        /// Place in the file.
        at: u64,
        /// The object.
        object: String,
    },
    /// The first segment has no list of objects.
    #[error("byte {at}: the segment repeats a list of objects that was not given")]
    NoObjects {
        /// Place of the segment in the file.
        at: u64,
    },
    /// A description of data that cannot be right.
    #[error("byte {at}: the data of `{object}`: {why}")]
    Index {
        /// Place in the file.
        at: u64,
        /// The object.
        object: String,
        /// What is wrong.
        why: &'static str,
    },
    /// The data of a segment cannot be divided among its channels.
    #[error("byte {at}: {why}")]
    Layout {
        /// Place of the segment in the file.
        at: u64,
        /// What is wrong.
        why: &'static str,
    },
    /// The file has more segments or lists than are read.
    #[error("byte {at}: more than {most} {what}")]
    TooMany {
        /// Place in the file.
        at: u64,
        /// Most that are read.
        most: usize,
        /// Of what.
        what: &'static str,
    },
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Fault::IndexFile => Some("read the .tdms file beside it"),
            Fault::TooMany { .. } => Some("defragment the file: TDMS Defragment in LabVIEW"),
            _ => None,
        }
    }
}
