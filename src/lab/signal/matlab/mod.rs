//! Recordings in MAT-files of level 5, as MATLAB saves them up to version 7: vectors, columns of matrices, and fields of
//! structs.
//!
//! Source: MathWorks, *MAT-File Format*. Those of version 7.3 are HDF5.

mod array;
mod element;
mod file;

use std::path::Path;

use thiserror::Error;

use base::file::FileError;

pub use file::Matlab;

/// A fault of a MAT-file, and where it is.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Open(#[from] FileError),
    /// An element ends before what it announces.
    #[error("byte {at}{}: the file ends within {what}", unpacked(*is_unpacked))]
    Ends {
        /// Place in the file, or in what was unpacked.
        at: usize,
        /// Whether that is a place in an unpacked variable.
        is_unpacked: bool,
        /// What is incomplete.
        what: &'static str,
    },
    /// An element of another kind than there must be.
    #[error("byte {at}{}: expected {what}, found an element of the kind {found}", unpacked(*is_unpacked))]
    Element {
        /// Place in the file, or in what was unpacked.
        at: usize,
        /// Whether that is a place in an unpacked variable.
        is_unpacked: bool,
        /// What must be there.
        what: &'static str,
        /// The number of the kind.
        found: u32,
    },
    /// A variable cannot be unpacked.
    #[error("byte {at}: the variable cannot be unpacked: {why}")]
    Unpacked {
        /// Place in the file.
        at: usize,
        /// Why.
        why: String,
    },
    /// The file holds more than is read.
    #[error("more than {most} {what}")]
    TooMany {
        /// Most that are read.
        most: usize,
        /// Of what.
        what: &'static str,
    },
    /// A MAT-file of level 4.
    #[error("a MAT-file of level 4, which is not read")]
    Level4,
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Fault::Level4 => Some("save it again in MATLAB: save FILE -v7"),
            Fault::TooMany { .. } => Some("save the variables that are needed alone"),
            _ => None,
        }
    }
}

fn unpacked(is_unpacked: bool) -> &'static str {
    if is_unpacked { " of a packed variable" } else { "" }
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
