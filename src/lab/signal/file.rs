//! Recordings from files of any known kind.

use std::io::Read;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::export::Export;
use super::format::Format;
use super::hdf5::{self, Hdf5};
use super::matlab::{self, Matlab};
use super::stored::{self, Catalogue};
use super::t01::{self, T01};
use super::tdms::{self, Tdms};
use super::workbook::{self, Workbook};
pub use super::{ChannelSelection, ReadOptions};
use super::{Measurement, csv, export, isomme};

/// Why a file cannot be read as a recording.
#[derive(Debug, Error)]
pub enum ReadError {
    /// It is not a table.
    #[error(transparent)]
    Csv(#[from] csv::ReadError),
    /// It is not ISO-MME.
    #[error(transparent)]
    Isomme(#[from] isomme::ReadError),
    /// It is no export of a machine.
    #[error(transparent)]
    Export(#[from] export::ReadError),
    /// It is not a file of the format that its first bytes name.
    #[error(transparent)]
    Stored(#[from] stored::ReadError),
}

impl ReadError {
    /// File, line and column (in characters), both counted from one, where the mistake is at such a place.
    pub fn place(&self) -> Option<(PathBuf, usize, usize)> {
        match self {
            ReadError::Csv(error) => error.place(),
            ReadError::Isomme(error) => error.place(),
            ReadError::Export(error) => error.place(),
            ReadError::Stored(_) => None,
        }
    }

    /// Whether all that is wrong is that a table has no column of time, which [`columns`] does without.
    pub fn lacks_time(&self) -> bool {
        match self {
            ReadError::Csv(error) => matches!(error.fault, csv::Fault::NoTime { .. }),
            ReadError::Isomme(_) | ReadError::Export(_) => false,
            ReadError::Stored(error) => matches!(*error.fault, stored::Fault::NoTime { .. }),
        }
    }

    /// Whether two columns of a table have one name, as those of several specimens have.
    pub fn has_equal_names(&self) -> bool {
        matches!(self, ReadError::Csv(error) if matches!(error.fault, csv::Fault::Duplicate { .. }))
    }

    /// Whether the head of a machine's export contradicts itself.
    pub fn is_of_head(&self) -> bool {
        use export::Fault::{StatedTwice, Values};
        matches!(self, ReadError::Export(error) if matches!(error.mistake.fault, StatedTwice { .. } | Values { .. }))
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
            ReadError::Export(error) => error.mistake.fault.to_string(),
            ReadError::Stored(error) => error.fault.to_string(),
        }
    }

    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        match self {
            ReadError::Csv(error) => error.fault.hint(),
            ReadError::Isomme(error) => error.fault.hint(),
            ReadError::Export(error) => error.hint().map(str::to_owned),
            ReadError::Stored(error) => error.fault.hint(),
        }
    }
}

/// Reads what is `wanted` of the recording at `path`: a folder, `.zip`, `.mme`, `.chn` or `.001`, … as ISO-MME, a file of
/// another format by its first bytes, others as tables.
///
/// Holds the wanted channels and nothing else of the file: 8 bytes a value, and as much again for one channel while it
/// is finished.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Measurement, ReadError> {
    if isomme::is_part(path) {
        return Ok(isomme::measure(path, options)?);
    }
    match catalogue(path)? {
        Some(mut file) => Ok(stored::measure(&mut *file, path, options)?),
        None => Ok(csv::measure(path, options)?),
    }
}

/// Reads the columns of the file at `path` for which no time is needed, e.g. stress over strain; see [`csv::columns`].
pub fn columns(path: &Path, options: &ReadOptions) -> Result<csv::Table, ReadError> {
    match catalogue(path)? {
        Some(mut file) => Ok(stored::columns(&mut *file, path, options)?),
        None => Ok(csv::columns(path, options)?),
    }
}

/// Whether the file at `path` is of a format that lists its channels (TDMS, workbook, MATLAB, HDF5, T01), and no text.
pub fn lists_channels(path: &Path) -> bool {
    !matches!(catalogue(path), Ok(None))
}

/// The specimens of the file at `path`, of a tensile machine; none where it holds no force over displacement.
pub fn specimens(path: &Path) -> Result<Option<Export>, ReadError> {
    if isomme::is_part(path) {
        return Ok(None);
    }
    match first_bytes(path) {
        Some(first) if workbook::is_own(&first) => Ok(workbook::specimens(path)?),
        Some(first) if Format::of(&first).is_some() || matlab::is_of_level_4(path, &first) => Ok(None),
        _ => Ok(export::read_text(path)?),
    }
}

/// The channels of the file at `path`, where its first bytes are those of a format that lists them.
fn catalogue(path: &Path) -> Result<Option<Box<dyn Catalogue>>, ReadError> {
    let Some(first) = first_bytes(path) else { return Ok(None) };
    let found = match Format::of(&first) {
        _ if matlab::is_own(&first) => Matlab::open(path).map(boxed),
        _ if hdf5::is_own(&first) => Hdf5::open(path).map(boxed),
        _ if workbook::is_own(&first) => Workbook::open(path).map(boxed),
        _ if tdms::is_own(&first) => Tdms::open(path).map(boxed),
        _ if t01::is_own(&first) => T01::open(path).map(boxed),
        _ if matlab::is_of_level_4(path, &first) => Err(matlab::Fault::Level4.into()),
        Some(format) => Err(stored::Fault::Refused(format)),
        None => return Ok(None),
    };
    Ok(Some(found.map_err(|fault| stored::ReadError::new(path, fault))?))
}

fn boxed<'a>(file: impl Catalogue + 'a) -> Box<dyn Catalogue + 'a> {
    Box::new(file)
}

/// Bytes by which a format is known.
const FIRST: u64 = 1024;

/// The first bytes of the file at `path`; none where it cannot be opened, which its reader reports.
fn first_bytes(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    base::file::open(path).ok()?.take(FIRST).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}
