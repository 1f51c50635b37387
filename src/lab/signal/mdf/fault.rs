//! Faults in an MDF file.

use std::io;

use thiserror::Error;

use base::file::FileError;

/// A fault of an MDF file, and where it is.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Open(#[from] FileError),
    /// Reading failed within the file.
    #[error("cannot be read further: {0}")]
    Read(#[from] io::Error),
    /// A block is another than the link to it says.
    #[error("byte {at}: expected a block {expected}, found {found:?}")]
    Block {
        /// Place in the file.
        at: u64,
        /// What must be there.
        expected: &'static str,
        /// Its mark.
        found: String,
    },
    /// A block ends before what it must hold, or beyond the end of the file.
    #[error("byte {at}: the block is incomplete")]
    Incomplete {
        /// Place in the file.
        at: u64,
    },
    /// Blocks of a later version.
    #[error("byte {at}: data in columns (`{kind}`, of MDF 4.2) are not read")]
    Columns {
        /// Place in the file.
        at: u64,
        /// Mark of the block.
        kind: String,
    },
    /// Packed data cannot be unpacked.
    #[error("byte {at}: packed data cannot be unpacked: {why}")]
    Packed {
        /// Place in the file.
        at: u64,
        /// Why.
        why: String,
    },
    /// The file has more of something than is read.
    #[error("byte {at}: more than {most} {what}")]
    TooMany {
        /// Place in the file.
        at: u64,
        /// Most that are read.
        most: u64,
        /// Of what.
        what: &'static str,
    },
    /// The data of a group end before its last record, or hold a record of no group.
    #[error("the data of `{group}` end after {found} of {stated} records")]
    Records {
        /// The group.
        group: String,
        /// Records in the data.
        found: u64,
        /// Records that it states.
        stated: u64,
    },
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Fault::Columns { .. } => {
                Some("save it as 4.10 in Python: asammdf.MDF(\"FILE\").convert(\"4.10\").save(\"OUT.mf4\")")
            }
            _ => None,
        }
    }
}
