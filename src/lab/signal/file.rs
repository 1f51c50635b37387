//! Recordings from files of any known kind.

use std::path::{Path, PathBuf};

use thiserror::Error;

pub use super::{ChannelSelection, ReadOptions};
use super::{Measurement, csv, isomme};

/// Why a file cannot be read as a recording.
#[derive(Debug, Error)]
pub enum ReadError {
    /// It is not a table.
    #[error(transparent)]
    Csv(#[from] csv::ReadError),
    /// It is not ISO-MME.
    #[error(transparent)]
    Isomme(#[from] isomme::ReadError),
}

impl ReadError {
    /// File, line and column (in characters), both counted from one, where the mistake is at such a place.
    pub fn place(&self) -> Option<(PathBuf, usize, usize)> {
        match self {
            ReadError::Csv(error) => error.place(),
            ReadError::Isomme(error) => error.place(),
        }
    }

    /// Whether all that is wrong is that a table has no column of time, which [`columns`] does without.
    pub fn lacks_time(&self) -> bool {
        matches!(self, ReadError::Csv(error) if matches!(error.fault, csv::Fault::NoTime { .. }))
    }

    /// Whether all that is wrong is that a table has no rows of numbers.
    pub fn lacks_samples(&self) -> bool {
        use csv::Fault::{Empty, NoNumbers, NoRows};
        matches!(self, ReadError::Csv(error) if matches!(error.fault, Empty | NoRows | NoNumbers { .. }))
    }

    /// The fault without file and place.
    pub fn fault(&self) -> String {
        match self {
            ReadError::Csv(error) => error.fault.to_string(),
            ReadError::Isomme(error) => error.fault.to_string(),
        }
    }

    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        match self {
            ReadError::Csv(error) => error.fault.hint(),
            ReadError::Isomme(error) => error.fault.hint(),
        }
    }
}

/// Reads what is `wanted` of the recording at `path`: a folder, `.zip`, `.mme`, `.chn` or `.001`, … as ISO-MME, others as
/// tables.
///
/// Holds the wanted channels and nothing else of the file: 8 bytes a value, and as much again for one channel while it
/// is finished.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Measurement, ReadError> {
    if isomme::is_part(path) {
        return Ok(isomme::measure(path, options)?);
    }
    Ok(csv::measure(path, options)?)
}

/// Reads the columns of the table at `path` for which no time is needed, e.g. stress over strain; see [`csv::columns`].
pub fn columns(path: &Path, options: &ReadOptions) -> Result<csv::Table, ReadError> {
    Ok(csv::columns(path, options)?)
}
