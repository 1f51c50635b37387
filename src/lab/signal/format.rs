//! The formats of recordings: those that are read, and those that are known by their first bytes and refused with the
//! conversion that helps; the recordings in a folder, by the endings of their names.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::catalogue::Catalogue;
use super::{hdf5, matlab, t01, tdms, workbook};
use crate::error::Error;
use base::file;

/// A format of recordings.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Its name.
    pub name: &'static str,
    /// Usual endings of its files.
    pub endings: &'static str,
    /// Whether it is read, or else how to convert it.
    pub support: Support,
    /// Whether the first bytes of a file are those of the format; none where others than these know it.
    is_own: fn(&[u8]) -> bool,
}

/// Lists the channels of the file at a path.
pub type Open = fn(&Path) -> Result<Catalogue, Error>;

/// Whether a format is read.
#[derive(Clone, Copy, Debug)]
pub enum Support {
    /// It is; what becomes of its parts, and what lists the channels of a file, for formats that are known by their first bytes.
    Read(&'static str, Option<Open>),
    /// It is not; the conversion that helps.
    Refused(&'static str),
}

/// Writes the formats, a row each: name and endings; then `read by` its module, of which `open` lists the channels of a file and `is_own`
/// knows its first bytes, and what becomes of its parts, or `refused`, the conversion that helps and by which first bytes the format is known.
macro_rules! formats {
    ($($name:literal $endings:literal $how:ident $(by $module:ident)? $text:literal $(if $is_own:expr)?;)+) => {
        /// All formats, those that are read first.
        pub const FORMATS: &[Format] = &[$(Format {
            name: $name,
            endings: $endings,
            support: formats!(@$how $text $(, $module)?),
            is_own: formats!(@own $(by $module)? $($is_own)?),
        }),+];
    };
    (@read $text:literal) => { Support::Read($text, None) };
    (@read $text:literal, $module:ident) => { Support::Read($text, Some($module::open)) };
    (@refused $text:literal) => { Support::Refused($text) };
    (@own) => { |_| false };
    (@own by $module:ident) => { $module::is_own };
    (@own $is_own:expr) => { $is_own };
}

formats! {
    "Table in text" ".csv, .txt, .tsv, .dat" read
        "any separator, decimal mark and column names; UTF-8, UTF-16, GBK or Windows-1252; units in the header, in a line \
            below it, or given";
    "ISO-MME" ".mme with its folder, .chn, .001, …, .zip" read "channels by code or long name, each over its own time";
    "NI TDMS" ".tdms" read by tdms
        "GROUP/CHANNEL with unit_string; time by wf_start_offset and wf_increment, or by the channel Time of the group; \
            scales are applied, DAQmx, interleaved, big-endian and truncated files are read";
    "Workbook of Excel" ".xlsx" read by workbook "a sheet as a table: SHEET/COLUMN, or the column alone where one sheet holds a table";
    "MATLAB" ".mat" read by matlab
        "vectors, columns of matrices and fields of structs, STRUCT/FIELD, over the field time or t beside them; versions \
            5 to 7.3";
    "HDF5" ".h5, .hdf5" read by hdf5
        "data sets, columns of matrices and fields of records, GROUP/NAME, over the data set time or t beside them; units \
            from the attribute unit or units";
    "Time history of OpenRadioss" "T01" read by t01
        "energies of the model, GROUP/DZ of nodes, GROUP/impulse FZ of rigid bodies, in SI; of a deck of droptower's also \
            displacement_m, velocity_m_s and acceleration_m_s2 of the impactor over the time of the test";
    "Exports of tensile machines" ".csv, .txt, .tra, .xlsx" read
        "by `droptower reduce coupon`: specimens side by side, below each other or one a sheet, of Zwick, Instron, MTS and \
            Shimadzu; width, thickness, gauge, speed and direction from the head";
    "ASAM MDF" ".mf4, .mdf, .dat" refused
        "convert it with asammdf, in Python: asammdf.MDF(\"FILE\").to_dataframe().to_csv(\"OUT.csv\", \
            index_label=\"time_s\")"
        if |first| first.starts_with(b"MDF     ") || first.starts_with(b"UnFinMF ");
    "Universal file (UFF 58)" ".uff, .unv" refused
        "in Python: pyuff.UFF(\"FILE\").read_sets() has time as x and values as data; write them as CSV"
        if is_universal;
    "Excel before 2007" ".xls" refused
        "save it as .xlsx, or each sheet as CSV" if |first| first.starts_with(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1");
    "Apache Parquet" ".parquet" refused
        "in Python: pandas.read_parquet(\"FILE\").to_csv(\"OUT.csv\", index=False)" if |first| first.starts_with(b"PAR1");
    "Apache Arrow or Feather" ".feather, .arrow" refused
        "in Python: pandas.read_feather(\"FILE\").to_csv(\"OUT.csv\", index=False)"
        if |first| first.starts_with(b"ARROW1") || first.starts_with(b"FEA1");
    "imc FAMOS" ".dat, .raw" refused "export it from FAMOS as ASCII, with a column of time" if |first| first.starts_with(b"|CF,");
    "NumPy" ".npy" refused
        "in Python: numpy.savetxt(\"OUT.csv\", numpy.load(\"FILE\"), delimiter=\",\")" if |first| first.starts_with(b"\x93NUMPY");
    "SQLite" ".db, .sqlite" refused
        "export the table: sqlite3 -header -csv FILE \"select * from TABLE\" > OUT.csv"
        if |first| first.starts_with(b"SQLite format 3\0");
    "gzip" ".gz" refused "unpack it: gunzip FILE" if |first| first.starts_with(b"\x1f\x8b");
}

impl Format {
    /// The one whose first bytes these are.
    pub fn of(first: &[u8]) -> Option<&'static Format> {
        FORMATS.iter().find(|format| (format.is_own)(first))
    }
}

/// Whether a text begins with the separator of data sets, -1, and the number 58 of functions.
fn is_universal(first: &[u8]) -> bool {
    let text = String::from_utf8_lossy(first);
    let mut lines = text.lines();
    let separator = lines.next().is_some_and(|line| line.starts_with("    -1") && line.trim() == "-1");
    separator && lines.next().is_some_and(|line| line.trim_start().starts_with("58"))
}

/// What a folder holds, without hidden files; both in the order of the names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FolderContents {
    /// Files with the ending of a format that is read, and tests of ISO-MME.
    pub recordings: Vec<PathBuf>,
    /// Other files and folders.
    pub others: Vec<PathBuf>,
}

/// The recordings in `folder`, by their endings: what is in its folders is not looked at, unless such a folder, or
/// `folder` itself, is a test of ISO-MME.
///
/// # Errors
/// The folder cannot be listed.
pub fn folder_contents(folder: &Path) -> io::Result<FolderContents> {
    if is_test(folder) {
        return Ok(FolderContents { recordings: vec![folder.to_owned()], others: vec![] });
    }
    let is_hidden = |path: &PathBuf| path.file_name().is_none_or(|name| name.as_encoded_bytes().starts_with(b"."));
    let entries = file::entries(folder)?.into_iter().filter(|path| !is_hidden(path));
    let is_recording = |path: &PathBuf| if path.is_dir() { is_test(path) } else { has_known_ending(path) };
    let (recordings, others) = entries.partition(is_recording);
    Ok(FolderContents { recordings, others })
}

/// Whether a folder is one test of ISO-MME: it has one `.mme` file.
fn is_test(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_own = |path: &PathBuf| ending(path).is_some_and(|ending| ending == "mme");
    entries.map(|entry| entry.path()).filter(is_own).count() == 1
}

/// Whether the name of a file ends as those of a format that is read. Channels of ISO-MME are no recordings of their own.
fn has_known_ending(path: &Path) -> bool {
    let endings = FORMATS.iter().filter(|format| matches!(format.support, Support::Read(..)));
    let mut endings = endings.flat_map(|format| format.endings.split(", ")).filter_map(|ending| {
        let ending = ending.split(' ').next()?.strip_prefix('.')?;
        Some(ending).filter(|ending| *ending != "chn" && ending.parse::<u32>().is_err())
    });
    ending(path).is_some_and(|own| endings.any(|known| known == own))
}

fn ending(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_known_by_their_first_bytes() {
        for (first, expected) in [
            (&b"MDF     4.10    asammdf"[..], Some("ASAM MDF")),
            (b"MDF     3.30    ", Some("ASAM MDF")),
            (b"    -1\n    58\n", Some("Universal file (UFF 58)")),
            (b"    -1\n   151\n", None),
            (b"PAR1\x15\x04", Some("Apache Parquet")),
            (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", Some("Excel before 2007")),
            (b"TDSm", Some("NI TDMS")),
            (b"PK\x03\x04", Some("Workbook of Excel")),
            (b"time_s,a\n", None),
            (b"", None),
        ] {
            assert_eq!(Format::of(first).map(|format| format.name), expected, "{first:?}");
        }
    }

    #[test]
    fn recordings_are_known_by_their_endings_and_tests_by_their_head() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        for name in ["b.TDMS", "a.csv", "notes.md", ".hidden.csv", "channel.001", "test.chn", "c.mat", "noending"] {
            fs::write(place(name), "x").expect("a file");
        }
        for name in ["test", "other"] {
            fs::create_dir(place(name)).expect("a folder");
        }
        fs::write(place("test/7.mme"), "x").expect("a file");
        let FolderContents { recordings, others } = folder_contents(folder.path()).expect("its contents");
        let expected = ["a.csv", "b.TDMS", "c.mat", "test"].map(place);
        assert_eq!((recordings, others.len()), (expected.to_vec(), 5));
        let own = folder_contents(&place("test")).expect("its contents");
        assert_eq!(own.recordings, [place("test")]);
        assert!(folder_contents(&place("nowhere")).is_err());
    }
}
