//! Recordings from files of any known kind.

use std::io::Read;
use std::path::Path;

use super::Measurement;
use super::catalogue::{self, Catalogue};
use super::csv::TextTable;
use super::export::{self, Export};
use super::format::{Format, Support};
use super::hdf5::{self, Hdf5};
use super::isomme::{self, IsoMme};
use super::matlab::{self, Matlab};
use super::t01::{self, T01};
use super::tdms::{self, Tdms};
use super::workbook::{self, Workbook};
use crate::error::{Error, refusal};

pub use super::{ChannelSelection, ReadOptions};

/// Reads what is wanted of the recording at `path`: a folder, `.zip`, `.mme`, `.chn` or `.001`, … as ISO-MME, a file of
/// another format by its first bytes, others as tables.
///
/// Holds the wanted channels and nothing else of the file: 8 bytes a value, and as much again for one channel while it
/// is finished.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Measurement, Error> {
    let measured = if isomme::is_part(path) {
        IsoMme::open(path).and_then(|mut container| catalogue::measure(&mut container, options))
    } else {
        open(path, options).and_then(|mut file| catalogue::measure(&mut *file, options))
    };
    measured.map_err(|error| error.in_file(path))
}

/// Reads the columns of the file at `path` for which no time is needed, e.g. stress over strain; the number of the sample is in
/// place of a time.
///
/// # Errors
/// The file is no table, a channel or a unit is missing, columns have several lengths, or a cell is no number.
pub fn columns(path: &Path, options: &ReadOptions) -> Result<Measurement, Error> {
    let columns = open(path, options).and_then(|mut file| catalogue::columns(&mut *file, options));
    columns.map_err(|error| error.in_file(path))
}

/// Whether the file at `path` is of a format that lists its channels (TDMS, workbook, MATLAB, HDF5, T01), and no text.
pub fn lists_channels(path: &Path) -> bool {
    !matches!(listed(path), Ok(None))
}

/// The channels of the file at `path`, which is a table unless its first bytes are those of another format.
fn open(path: &Path, options: &ReadOptions) -> Result<Box<dyn Catalogue>, Error> {
    match listed(path)? {
        Some(file) => Ok(file),
        None => TextTable::open(path, options).map(boxed),
    }
}

/// The specimens of the file at `path`, of a tensile machine; none where it holds no force over displacement.
pub fn specimens(path: &Path) -> Result<Option<Export>, Error> {
    if isomme::is_part(path) {
        return Ok(None);
    }
    match first_bytes(path) {
        Some(first) if workbook::is_own(&first) => workbook::specimens(path),
        Some(first) if Format::of(&first).is_some() || matlab::is_of_level_4(path, &first) => Ok(None),
        _ => export::read_text(path),
    }
}

/// The channels of the file at `path`, where its first bytes are those of a format that lists them.
fn listed(path: &Path) -> Result<Option<Box<dyn Catalogue>>, Error> {
    let Some(first) = first_bytes(path) else { return Ok(None) };
    let found = match Format::of(&first) {
        _ if matlab::is_own(&first) => Matlab::open(path).map(boxed),
        _ if hdf5::is_own(&first) => Hdf5::open(path).map(boxed),
        _ if workbook::is_own(&first) => Workbook::open(path).map(boxed),
        _ if tdms::is_own(&first) => Tdms::open(path).map(boxed),
        _ if t01::is_own(&first) => T01::open(path).map(boxed),
        _ if matlab::is_of_level_4(path, &first) => Err(matlab::level_4()),
        Some(format) => Err(refused(format)),
        None => return Ok(None),
    };
    found.map(Some)
}

fn refused(format: &Format) -> Error {
    let error = refusal!("the format {} is not read", format.name);
    match format.support {
        Support::Refused(conversion) => error.with_hint(conversion),
        Support::Read(_) => error,
    }
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
