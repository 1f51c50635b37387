//! Recordings from files of any known kind.

use std::io::Read;
use std::path::Path;

use super::Measurement;
use super::catalogue::Catalogue;
use super::export::{self, Export};
use super::format::{Format, Support};
use super::{csv, isomme, matlab, workbook};
use crate::error::{Error, refusal};

pub use super::{ChannelSelection, ReadOptions};

/// Reads what is wanted of the recording at `path`: a folder, `.zip`, `.mme`, `.chn` or `.001`, … as ISO-MME, a file of
/// another format by its first bytes, others as tables.
///
/// Holds the wanted channels and nothing else of the file: 8 bytes a value, and as much again for one channel while it
/// is finished.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Measurement, Error> {
    let catalogue = if isomme::is_part(path) { isomme::open(path) } else { open(path, options) };
    catalogue.and_then(|catalogue| catalogue.measure(options)).map_err(|error| error.in_file(path))
}

/// Reads the columns of the file at `path` for which no time is needed, e.g. stress over strain; the number of the sample is in
/// place of a time.
///
/// # Errors
/// The file is no table, a channel or a unit is missing, columns have several lengths, or a cell is no number.
pub fn columns(path: &Path, options: &ReadOptions) -> Result<Measurement, Error> {
    let columns = open(path, options).and_then(|catalogue| catalogue.columns(options));
    columns.map_err(|error| error.in_file(path))
}

/// Whether the file at `path` is of a format that lists its channels (TDMS, workbook, MATLAB, HDF5, T01), and no text.
pub fn lists_channels(path: &Path) -> bool {
    !matches!(listed(path), Ok(None))
}

/// The channels of the file at `path`, which is a table unless its first bytes are those of another format.
fn open(path: &Path, options: &ReadOptions) -> Result<Catalogue, Error> {
    listed(path)?.map_or_else(|| csv::open(path, options), Ok)
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
fn listed(path: &Path) -> Result<Option<Catalogue>, Error> {
    let Some(first) = first_bytes(path) else { return Ok(None) };
    match Format::of(&first).map(|format| (format.name, format.support)) {
        Some((_, Support::Read(_, Some(open)))) => open(path).map(Some),
        _ if matlab::is_of_level_4(path, &first) => Err(matlab::level_4()),
        Some((name, Support::Refused(conversion))) => {
            Err(refusal!("the format {name} is not read").with_hint(conversion))
        }
        _ => Ok(None),
    }
}

/// Bytes by which a format is known.
const FIRST: u64 = 1024;

/// The first bytes of the file at `path`; none where it cannot be opened, which its reader reports.
fn first_bytes(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    base::file::open(path).ok()?.take(FIRST).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}
