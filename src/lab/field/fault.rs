//! Faults of fields, and where they are.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::signal::file;
use base::diagnostic::listed;

/// Why a field cannot be read.
#[derive(Debug, Error)]
pub enum FieldError {
    /// A file is no table.
    #[error(transparent)]
    Read(#[from] file::ReadError),
    /// A table is no field.
    #[error("{}: {fault}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The fault.
        fault: FileFault,
    },
    /// All files together have too many points.
    #[error("the files of the field have more than {most} points")]
    TooManyPoints {
        /// Most that are read.
        most: usize,
    },
}

/// Why a table is no field.
#[derive(Debug, Error)]
pub enum FileFault {
    /// No columns of places and displacements.
    #[error("no columns of places and displacements that are known among {}", listed(found))]
    NoField {
        /// The columns.
        found: Vec<String>,
    },
    /// A field of two-dimensional correlation.
    #[error("displacements in the plane alone (`{}`, `{}`): fields of two-dimensional correlation are not supported", found[0], found[1])]
    Planar {
        /// The columns of the displacements.
        found: [String; 2],
    },
    /// A column states no unit, and none is given.
    #[error("`{column}` states no unit of length")]
    NoUnit {
        /// The column.
        column: String,
    },
    /// A column is in a unit that is none of length.
    #[error("`{column}` is in `{unit}`, not in a unit of length")]
    NotALength {
        /// The column.
        column: String,
        /// Its unit.
        unit: String,
    },
    /// No point was matched.
    #[error("no point has a displacement")]
    NoPoint,
    /// A table of times has no column of time.
    #[error("no column of time among {}", listed(found))]
    NoTime {
        /// The columns.
        found: Vec<String>,
    },
    /// A time is missing or not later than the one before.
    #[error("time {number} does not come after the one before it")]
    TimeNotIncreasing {
        /// Counted from one.
        number: usize,
    },
}

impl FieldError {
    /// A fault of the file at `path`.
    pub(super) fn in_file(path: &Path, fault: FileFault) -> FieldError {
        FieldError::File { path: path.into(), fault }
    }

    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        let FieldError::File { fault, .. } = self else {
            return match self {
                FieldError::Read(error) => error.hint(),
                _ => None,
            };
        };
        let hint = match fault {
            FileFault::NoField { .. } => {
                "export X, Y, Z and U, V, W of the undeformed places (VIC-3D, MatchID), x, y, z and dx, dy, dz (ARAMIS), \
                 or MODEL_COORDINATES_* and MODEL_DISPLACEMENT_* (DICe)"
            }
            FileFault::NoUnit { .. } => "give it: `unit = \"mm\"`",
            FileFault::NotALength { .. } => "export metric coordinates, not those of the image",
            _ => return None,
        };
        Some(hint.into())
    }
}
