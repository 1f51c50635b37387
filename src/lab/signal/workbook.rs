//! Recordings in workbooks of Excel (`.xlsx`): each sheet is a table, with the same recognition of header and units as one in
//! text.

use std::cell::OnceCell;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, copy, sink};
use std::path::Path;

use calamine::{DataRef, Reader, SheetType, Xlsx, XlsxError};
use zip::ZipArchive;
use zip::result::ZipError;

use super::csv::Lined;
use super::export::{self, Count, Export, Rows};
use super::stored::{Axis, Catalogue, Entry, no_channel};
use super::text::Lines;
use super::{Annotations, Warning};
use crate::error::{Error, refusal};
use base::file;

/// A workbook whose columns are listed: `SHEET/COLUMN`, or the column alone where one sheet holds a table.
pub struct Workbook {
    tables: Vec<Table>,
    entries: Vec<Entry>,
    /// Table and column of each entry.
    places: Vec<(usize, usize)>,
    annotations: Annotations,
}

/// The lines of a sheet.
struct Table {
    name: String,
    text: String,
    /// Number of columns.
    width: usize,
    /// The values of all columns, once one was asked for; none where a cell of one is no number.
    columns: OnceCell<Option<Vec<Vec<f64>>>>,
}

impl Workbook {
    /// Lists the columns of the workbook at `path`.
    pub fn open(path: &Path) -> Result<Workbook, Error> {
        let sheets = sheets(path)?;
        let mut book = Workbook {
            tables: Vec::new(),
            entries: Vec::new(),
            places: Vec::new(),
            annotations: Annotations::default(),
        };
        let (mut comments, mut warnings, mut faults, mut listed) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for sheet in sheets.into_iter().filter(|sheet| !sheet.rows.is_empty()) {
            let table = Table::new(sheet);
            match table.lined() {
                Ok(lined) => listed.push((table, lined)),
                Err(fault) => faults.push((table, fault)),
            }
        }
        if listed.is_empty() {
            return Err(faults.first().map_or_else(no_channel, |(table, fault)| table.located(fault)));
        }
        for (table, fault) in faults {
            let (channel, why) = (format!("sheet `{}`", table.name), fault.message().to_owned());
            warnings.push(Warning::ChannelNotRead { channel, why });
        }
        let is_one = listed.len() == 1;
        for (place, (mut table, lined)) in listed.into_iter().enumerate() {
            table.width = lined.columns.len();
            comments.extend(lined.annotations.comments().iter().cloned());
            warnings.extend(lined.annotations.warnings);
            let first = book.entries.len();
            for (column, name) in lined.columns.into_iter().enumerate() {
                let group = if is_one { "" } else { table.name.as_str() };
                let mut entry = Entry::new(group, &name.label, None)?;
                // A line of units below the names.
                entry.column.unit = name.unit;
                entry.column.unknown_unit = name.unknown_unit;
                entry.samples = lined.rows as u64;
                if !lined.has_header {
                    entry.axis = Axis::Channel(first);
                }
                book.entries.push(entry);
                book.places.push((place, column));
            }
            book.tables.push(table);
        }
        book.annotations = Annotations::new(comments);
        book.annotations.warnings = warnings;
        Ok(book)
    }
}

impl Table {
    fn new(mut sheet: Sheet) -> Table {
        // Empty cells at the end of a row are not stored; a row of numbers has as many as the names or units above it.
        let mut widths = [0; 2];
        for (_, cells) in &mut sheet.rows {
            let first = cells.iter().find(|cell| !cell.is_empty());
            match first.map(|cell| cell.parse::<f64>().is_ok()) {
                Some(true) if cells.len() < widths[0].max(widths[1]) => {
                    cells.resize(widths[0].max(widths[1]), String::new());
                }
                Some(true) => {}
                Some(false) => widths = [widths[1], cells.len()],
                None => widths = [0; 2],
            }
        }
        let lines = sheet.rows.iter().map(|(_, cells)| cells.join("\t"));
        let text = lines.flat_map(|line| [line, "\n".to_owned()]).collect();
        Table { name: sheet.name, text, width: 0, columns: OnceCell::new() }
    }

    fn lined(&self) -> Result<Lined, Error> {
        let mut lines = Lines::new(Cursor::new(self.text.as_bytes()));
        Lined::read(&mut lines)
    }

    /// The values of a column; a mistake in another one does not matter.
    fn column(&self, place: usize) -> Result<Vec<f64>, Error> {
        let read = |places: &[usize]| Lined::values(&mut Lines::new(Cursor::new(self.text.as_bytes())), places);
        let all = self.columns.get_or_init(|| read(&(0..self.width).collect::<Vec<_>>()).ok());
        match all {
            Some(columns) => Ok(columns[place].clone()),
            None => {
                let alone = read(&[place]).map_err(|error| self.located(&error))?;
                Ok(alone.into_iter().next().unwrap_or_default())
            }
        }
    }

    /// The refusal of a table in text as one of this sheet.
    fn located(&self, error: &Error) -> Error {
        let row = if error.line() > 0 { format!(", row {}", error.line()) } else { String::new() };
        let located = refusal!("sheet `{}`{row}: {}", self.name, error.message());
        error.hint().map_or(located.clone(), |hint| located.with_hint(hint))
    }
}

impl Catalogue for Workbook {
    fn entries(&self) -> &[Entry] {
        &self.entries
    }

    fn annotations(&self) -> Annotations {
        self.annotations.clone()
    }

    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        let (table, column) = self.places[place];
        self.tables[table].column(column)
    }
}

/// The specimens of a machine's export in the workbook at `path`; none where no sheet holds force over displacement.
pub fn specimens(path: &Path) -> Result<Option<Export>, Error> {
    let mut export = Export::default();
    for sheet in sheets(path).map_err(|error| error.in_file(path))? {
        let name = sheet.name.clone();
        let found = in_sheet(sheet).map_err(|error| {
            let located = refusal!("sheet `{name}`, row {}: {}", error.line(), error.message());
            error.hint().map_or(located.clone(), |hint| located.with_hint(hint)).in_file(path)
        });
        export.specimens.extend(found?);
    }
    Ok((!export.specimens.is_empty()).then_some(export))
}

fn in_sheet(sheet: Sheet) -> Result<Vec<export::Specimen>, Error> {
    let (mut rows, mut count) = (Rows::default(), Count::default());
    for (number, cells) in sheet.rows {
        rows.push(number, cells, &mut count)?;
    }
    export::read_sheet(&rows, Some(&sheet.name))
}

/// A sheet.
#[derive(Clone, Debug, PartialEq)]
struct Sheet {
    pub name: String,
    /// Rows with their numbers, counted from one, blank ones too.
    pub rows: Vec<(usize, Vec<String>)>,
}

/// Most bytes of all parts beside the sheets, unpacked: they are held in memory.
const MOST_BYTES: u64 = 64 << 20;
/// Most cells of all sheets, empty ones before others too.
const MOST_CELLS: usize = 8_000_000;

/// The sheets of the workbook at `path`.
fn sheets(path: &Path) -> Result<Vec<Sheet>, Error> {
    check(path)?;
    let mut book: Xlsx<BufReader<File>> = Xlsx::new(BufReader::new(file::open(path)?))?;
    let sheets = book.sheets_metadata().iter().filter(|sheet| sheet.typ == SheetType::WorkSheet);
    let names: Vec<String> = sheets.map(|sheet| sheet.name.clone()).collect();
    let mut held = 0;
    names.into_iter().map(|name| cells(&mut book, name, &mut held)).collect()
}

fn cells(book: &mut Xlsx<BufReader<File>>, name: String, held: &mut usize) -> Result<Sheet, Error> {
    let mut rows: Vec<(usize, Vec<String>)> = Vec::new();
    let mut reader = book.worksheet_cells_reader(&name)?;
    while let Some(cell) = reader.next_cell()? {
        let (row, column) = cell.get_position();
        let text = text(cell.get_value());
        if text.is_empty() {
            continue;
        }
        let (row, column) = (row as usize, column as usize);
        let blank = row.saturating_sub(rows.len());
        *held += blank + column + 1;
        if *held > MOST_CELLS {
            return Err(refusal!("sheet `{name}` has more than {MOST_CELLS} cells"));
        }
        while rows.len() <= row {
            rows.push((rows.len() + 1, Vec::new()));
        }
        // Those of a damaged file may be in any order.
        let Some((_, cells)) = rows.get_mut(row) else { continue };
        if cells.len() <= column {
            cells.resize(column + 1, String::new());
        }
        cells[column] = text;
    }
    Ok(Sheet { name, rows })
}

/// A cell as text: numbers in the shortest form that reads back to the same bits.
fn text(value: &DataRef) -> String {
    match value {
        DataRef::Empty => String::new(),
        DataRef::Int(number) => number.to_string(),
        DataRef::Float(number) => number.to_string(),
        DataRef::String(text) => clean(text),
        DataRef::SharedString(text) => clean(text),
        DataRef::Bool(value) => value.to_string(),
        // A date is no number of a recording; what it counts from, and the unit of a column of durations, are not known here.
        DataRef::DateTime(time) if time.is_duration() => format!("a duration of {} s", 86400.0 * time.as_f64()),
        DataRef::DateTime(time) => format!("date {}", time.as_f64()),
        DataRef::DateTimeIso(time) | DataRef::DurationIso(time) => clean(time),
        DataRef::Error(error) => error.to_string(),
    }
}

/// The text in one line, without what separates cells.
fn clean(text: &str) -> String {
    text.trim().replace(|letter: char| letter.is_control(), " ")
}

/// Refuses what is no workbook of Excel, and parts that would unpack to more than is read.
fn check(path: &Path) -> Result<(), Error> {
    let mut archive = ZipArchive::new(BufReader::new(file::open(path)?))?;
    let has = |name: &str| archive.file_names().any(|other| other.is_ok_and(|other| other == name));
    let others = [("xl/workbook.bin", "Excel in binary form (.xlsb)"), ("content.xml", "OpenDocument (.ods)")];
    if let Some((_, of)) = others.into_iter().find(|(name, _)| has(name)) {
        let error = refusal!("a workbook of {of}, which is not read");
        return Err(error.with_hint("save it as .xlsx, or each sheet as CSV"));
    }
    if !has("xl/workbook.xml") {
        let error = refusal!("a zip archive without a workbook of Excel in it");
        return Err(error.with_hint("of an ISO-MME test, let its name end in .zip"));
    }
    let mut left = MOST_BYTES;
    for place in 0..archive.len() {
        let part = archive.by_index(place)?;
        let name = part.name()?.to_ascii_lowercase();
        let is_held = name.ends_with(".xml") || name.ends_with(".rels");
        if !is_held || name.starts_with("xl/worksheets/sheet") {
            continue;
        }
        // What an archive states of its parts need not be so.
        let unpacked = copy(&mut part.take(left + 1), &mut sink()).map_err(file::FileError::Io)?;
        let too_large = || refusal!("its parts beside the sheets unpack to more than {MOST_BYTES} bytes");
        left = left.checked_sub(unpacked).ok_or_else(too_large)?;
    }
    Ok(())
}

/// Whether the first bytes are those of an archive in zip, which a workbook is.
pub fn is_own(first: &[u8]) -> bool {
    first.starts_with(b"PK\x03\x04")
}

impl From<XlsxError> for Error {
    fn from(error: XlsxError) -> Error {
        Error::new(error.to_string())
    }
}

impl From<ZipError> for Error {
    fn from(error: ZipError) -> Error {
        refusal!("not a readable zip archive: {error}")
    }
}
