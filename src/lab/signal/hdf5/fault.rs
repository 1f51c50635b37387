//! Faults in an HDF5 file.

use hdf5_pure::Error;
use thiserror::Error;

use base::file::FileError;

/// A fault of an HDF5 file, and in which of its objects.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Open(#[from] FileError),
    /// An object of the file is damaged, or of a kind that is not read.
    #[error("`{object}`: {error}")]
    Object {
        /// Its path.
        object: String,
        /// The fault.
        error: Box<Error>,
    },
    /// The file has more groups and data sets than are read.
    #[error("more than {most} groups and data sets")]
    TooMany {
        /// Most that are read.
        most: usize,
    },
    /// A data set ends before its last value.
    #[error("`{object}` has {found} bytes, fewer than its shape needs")]
    Ends {
        /// Its path.
        object: String,
        /// Bytes of it.
        found: usize,
    },
}

impl Fault {
    /// The fault of an object.
    pub fn of(object: &str) -> impl FnOnce(Error) -> Fault {
        move |error| Fault::Object { object: object.to_owned(), error: Box::new(error) }
    }
}
