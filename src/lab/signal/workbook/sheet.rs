//! The cells of sheets as texts, row by row.

use std::fs::File;
use std::io::{BufReader, Read, copy, sink};
use std::path::Path;

use calamine::{DataRef, Reader, SheetType, Xlsx};
use zip::ZipArchive;

use super::Fault;
use base::file;

/// A sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    pub name: String,
    /// Rows with their numbers, counted from one, blank ones too.
    pub rows: Vec<(usize, Vec<String>)>,
}

/// Most bytes of all parts beside the sheets, unpacked: they are held in memory.
const MOST_BYTES: u64 = 64 << 20;
/// Most cells of all sheets, empty ones before others too.
const MOST_CELLS: usize = 8_000_000;

/// The sheets of the workbook at `path`.
pub fn read(path: &Path) -> Result<Vec<Sheet>, Fault> {
    check(path)?;
    let mut book: Xlsx<BufReader<File>> = Xlsx::new(BufReader::new(file::open(path)?))?;
    let sheets = book.sheets_metadata().iter().filter(|sheet| sheet.typ == SheetType::WorkSheet);
    let names: Vec<String> = sheets.map(|sheet| sheet.name.clone()).collect();
    let mut held = 0;
    names.into_iter().map(|name| cells(&mut book, name, &mut held)).collect()
}

fn cells(book: &mut Xlsx<BufReader<File>>, name: String, held: &mut usize) -> Result<Sheet, Fault> {
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
            return Err(Fault::ManyCells { sheet: name, limit: MOST_CELLS });
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
fn check(path: &Path) -> Result<(), Fault> {
    let mut archive = ZipArchive::new(BufReader::new(file::open(path)?))?;
    let has = |name: &str| archive.file_names().any(|other| other.is_ok_and(|other| other == name));
    let others = [("xl/workbook.bin", "Excel in binary form (.xlsb)"), ("content.xml", "OpenDocument (.ods)")];
    if let Some((_, of)) = others.into_iter().find(|(name, _)| has(name)) {
        return Err(Fault::Other { of });
    }
    if !has("xl/workbook.xml") {
        return Err(Fault::NoWorkbook);
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
        left = left.checked_sub(unpacked).ok_or(Fault::TooLarge { limit: MOST_BYTES })?;
    }
    Ok(())
}
