//! Recordings in workbooks of Excel (`.xlsx`): each sheet is a table, with the same recognition of header and units as one in
//! text.

use std::fs::File;
use std::io::{BufReader, Cursor, Read, copy, sink};
use std::path::Path;

use calamine::{DataRef, Reader as _, SheetType, Xlsx, XlsxError};
use zip::ZipArchive;
use zip::result::ZipError;

use super::catalogue::{Axis, Catalogue, Entry, Loaded, Reader};
use super::csv::TextTable;
use super::export::{self, Export};
use super::text::Lines;
use super::{Annotations, ReadOptions, Warning};
use crate::error::{Error, refusal};
use base::file;

/// The sheets of a workbook.
struct Workbook {
    sheets: Vec<Sheet>,
    /// Sheet and column of each channel.
    places: Vec<(usize, usize)>,
    loaded: Loaded,
}

/// A sheet with a line a row, whose cells are between tabs.
struct Sheet {
    name: String,
    text: String,
}

/// Lists the columns of the workbook at `path`: `SHEET/COLUMN`, or the column alone where one sheet holds a table.
pub fn open(path: &Path) -> Result<Catalogue, Error> {
    let listed = sheets(path)?.into_iter().filter(|sheet| !sheet.text.is_empty()).map(|sheet| {
        let found = sheet.list();
        (sheet, found)
    });
    let (listed, refused): (Vec<_>, Vec<_>) = listed.partition(|(_, found)| found.is_ok());
    if let (true, Some((sheet, Err(error)))) = (listed.is_empty(), refused.first()) {
        return Err(sheet.located(error));
    }
    let (mut comments, mut warnings) = (Vec::new(), Vec::new());
    for (sheet, found) in &refused {
        let why = found.as_ref().err().map_or("", Error::message).to_owned();
        warnings.push(Warning::ChannelNotRead { channel: format!("sheet `{}`", sheet.name), why });
    }
    let is_one = listed.len() == 1;
    let (mut held, mut all, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for (place, (sheet, found)) in listed.into_iter().enumerate() {
        let (annotations, entries) = found?;
        comments.extend(annotations.comments().iter().cloned());
        warnings.extend(annotations.warnings);
        let (group, first) = (if is_one { "" } else { sheet.name.as_str() }, all.len());
        for (column, entry) in entries.into_iter().enumerate() {
            // Without a header the first column is the time.
            let axis = if entry.axis == Axis::Unknown { Axis::Unknown } else { Axis::Channel(first) };
            let samples = entry.samples;
            all.push(Entry { samples, axis, ..Entry::from_column(group, entry.column) });
            places.push((place, column));
        }
        held.push(sheet);
    }
    let mut annotations = Annotations::new(comments);
    annotations.warnings = warnings;
    Ok(Catalogue::new(all, annotations, Workbook { sheets: held, places, loaded: Loaded::default() }))
}

impl Sheet {
    /// Of the cells of its rows.
    fn new(name: String, mut rows: Vec<Vec<String>>) -> Sheet {
        // Empty cells at the end of a row are not stored; a row of numbers has as many as the names or units above it.
        let mut widths = [0; 2];
        for cells in &mut rows {
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
        Sheet { name, text: rows.into_iter().flat_map(|cells| [cells.join("\t"), "\n".to_owned()]).collect() }
    }

    fn lines(&self) -> Lines<Cursor<&[u8]>> {
        Lines::new(Cursor::new(self.text.as_bytes()))
    }

    fn table(&self) -> Result<TextTable<Cursor<&[u8]>>, Error> {
        TextTable::new(self.lines(), &ReadOptions::default())
    }

    /// Its annotations and columns; the axis of a column without a header is no longer unknown.
    fn list(&self) -> Result<(Annotations, Vec<Entry>), Error> {
        let mut table = self.table()?;
        let annotations = std::mem::take(&mut table.annotations);
        let mut entries = std::mem::take(&mut table.entries);
        let is_named = table.has_header();
        let rows = table.count_rows()? as u64;
        for entry in &mut entries {
            entry.samples = Some(rows);
            entry.axis = if is_named { Axis::Unknown } else { Axis::Channel(0) };
        }
        Ok((annotations, entries))
    }

    /// The refusal of a table in text as one of this sheet.
    fn located(&self, error: &Error) -> Error {
        let row = if error.line() > 0 { format!(", row {}", error.line()) } else { String::new() };
        let located = refusal!("sheet `{}`{row}: {}", self.name, error.message());
        error.hint().map_or(located.clone(), |hint| located.with_hint(hint))
    }
}

impl Reader for Workbook {
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        Ok(self.loaded.take(place))
    }

    fn load(&mut self, channels: &[usize], times: &[usize], _: &mut Vec<Warning>) -> Result<(), Error> {
        let wanted = [channels, times].concat();
        for (number, sheet) in self.sheets.iter().enumerate() {
            let of_sheet: Vec<usize> = wanted.iter().copied().filter(|place| self.places[*place].0 == number).collect();
            // What is wrong in another sheet does not matter.
            if of_sheet.is_empty() {
                continue;
            }
            let columns: Vec<usize> = of_sheet.iter().map(|place| self.places[*place].1).collect();
            let values = sheet.table().and_then(|mut table| table.read_columns(&columns, None, &mut Vec::new()));
            let values = values.map_err(|error| sheet.located(&error))?;
            of_sheet.into_iter().zip(values).for_each(|(place, values)| self.loaded.insert(place, values));
        }
        Ok(())
    }
}

/// The specimens of a machine's export in the workbook at `path`; none where no sheet holds force over displacement.
pub fn specimens(path: &Path) -> Result<Option<Export>, Error> {
    let mut export = Export::default();
    for sheet in sheets(path).map_err(|error| error.in_file(path))? {
        let found = export::read(&mut sheet.lines(), Some(&sheet.name));
        let Some(found) = found.map_err(|error| sheet.located(&error).in_file(path))? else { continue };
        export.specimens.extend(found.specimens);
    }
    Ok((!export.specimens.is_empty()).then_some(export))
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
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut reader = book.worksheet_cells_reader(&name)?;
    while let Some(cell) = reader.next_cell()? {
        let (row, column) = cell.get_position();
        let text = text(cell.get_value());
        if text.is_empty() {
            continue;
        }
        let (row, column) = (row as usize, column as usize);
        *held += (row + 1).saturating_sub(rows.len()) + (column + 1).saturating_sub(rows.get(row).map_or(0, Vec::len));
        if *held > MOST_CELLS {
            return Err(refusal!("sheet `{name}` has more than {MOST_CELLS} cells"));
        }
        // Those of a damaged file may be in any order.
        rows.resize(rows.len().max(row + 1), Vec::new());
        let cells = &mut rows[row];
        if cells.len() <= column {
            cells.resize(column + 1, String::new());
        }
        cells[column] = text;
    }
    Ok(Sheet::new(name, rows))
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

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;
    use crate::signal::{ChannelSelection, file as recording};

    /// A workbook of sheets `S1`, `S2`, … with these rows, whose cells are numbers or texts.
    fn workbook(sheets: &[Vec<Vec<String>>], path: &Path) {
        let mut zip = ZipWriter::new(File::create(path).unwrap());
        let mut part = |name: &str, content: &str| {
            zip.start_file(name, SimpleFileOptions::default()).unwrap();
            zip.write_all(content.as_bytes()).unwrap();
        };
        let kinds = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
        let relation = |id: &str, kind: &str, target: &str| {
            format!("<Relationship Id=\"{id}\" Type=\"{kinds}/{kind}\" Target=\"{target}\"/>")
        };
        let (mut names, mut relations) = (String::new(), String::new());
        for (number, rows) in (1..).zip(sheets) {
            names += &format!("<sheet name=\"S{number}\" sheetId=\"{number}\" r:id=\"r{number}\"/>");
            let target = format!("worksheets/sheet{number}.xml");
            relations += &relation(&format!("r{number}"), "worksheet", &target);
            let cell = |text: &String| match text.parse::<f64>() {
                Ok(number) => format!("<c><v>{number}</v></c>"),
                Err(_) => format!("<c t=\"inlineStr\"><is><t>{text}</t></is></c>"),
            };
            let row = |cells: &Vec<String>| format!("<row>{}</row>", cells.iter().map(cell).collect::<String>());
            let rows: String = rows.iter().map(row).collect();
            part(&format!("xl/{target}"), &format!("<worksheet><sheetData>{rows}</sheetData></worksheet>"));
        }
        part("xl/workbook.xml", &format!("<workbook><sheets>{names}</sheets></workbook>"));
        part("xl/_rels/workbook.xml.rels", &format!("<Relationships>{relations}</Relationships>"));
        let whole = relation("r1", "officeDocument", "xl/workbook.xml");
        part("_rels/.rels", &format!("<Relationships>{whole}</Relationships>"));
        zip.finish().unwrap();
    }

    fn rows(text: &str) -> Vec<Vec<String>> {
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    }

    #[test]
    fn a_row_of_another_sheet_does_not_matter() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.xlsx");
        workbook(&[rows("time,a [N]\n0,1\n1,2"), rows("time,b [N]\n0,1\n1,2,3")], &path);
        for (name, expected) in
            [("S1/a", None), ("a", None), ("b", Some("sheet `S2`, row 3: expected 2 cells, found 3"))]
        {
            let channels = ChannelSelection::Named(vec![name.into()]);
            let found = recording::read(&path, &ReadOptions { channels, ..ReadOptions::default() });
            assert_eq!(found.err().map(|error| error.message().to_owned()).as_deref(), expected, "{name}");
        }
    }

    #[test]
    fn comments_are_those_of_their_sheet() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.xlsx");
        let sheet = |comment: &str| rows(&format!("{comment}\nExtension,Load\nmm,N\n0,0\n1,4\n2,7"));
        workbook(&[sheet("# direction: MD"), sheet("# VIRTUAL: nothing was pulled")], &path);
        let found = specimens(&path).unwrap().unwrap().specimens;
        let comments: Vec<String> = found.into_iter().flat_map(|specimen| specimen.comments).collect();
        assert_eq!(comments, ["direction: MD", "VIRTUAL: nothing was pulled"]);
    }

    /// Of four thousand cells; a count of those before each of them is over the limit.
    #[test]
    fn cells_are_counted_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("wide.xlsx");
        workbook(&[vec![vec!["1".to_owned(); 4001]]], &path);
        assert_eq!(sheets(&path).unwrap().len(), 1);
    }
}
