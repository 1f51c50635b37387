//! Sheets as tables of channels.

use std::cell::OnceCell;
use std::io::Cursor;
use std::path::Path;

use super::Fault;
use super::sheet::{self, Sheet};
use crate::signal::csv::Lined;
use crate::signal::stored::{self, Axis, Catalogue, Entry};
use crate::signal::text::Lines;
use crate::signal::{Annotations, Warning};

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
    pub fn open(path: &Path) -> Result<Workbook, stored::Fault> {
        let sheets = sheet::read(path)?;
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
                Err(fault) => faults.push(fault),
            }
        }
        if listed.is_empty() {
            return Err(faults.into_iter().next().map_or(stored::Fault::NoChannel, stored::Fault::from));
        }
        for fault in faults {
            let Fault::Sheet { sheet, fault, .. } = fault else { continue };
            warnings.push(Warning::ChannelNotRead { channel: format!("sheet `{sheet}`"), why: fault.to_string() });
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

    fn lined(&self) -> Result<Lined, Fault> {
        let mut lines = Lines::new(Cursor::new(self.text.as_bytes()));
        Lined::read(&mut lines).map_err(|mistake| self.located(mistake.line, mistake.fault))
    }

    /// The values of a column; a mistake in another one does not matter.
    fn column(&self, place: usize) -> Result<Vec<f64>, Fault> {
        let read = |places: &[usize]| Lined::values(&mut Lines::new(Cursor::new(self.text.as_bytes())), places);
        let all = self.columns.get_or_init(|| read(&(0..self.width).collect::<Vec<_>>()).ok());
        match all {
            Some(columns) => Ok(columns[place].clone()),
            None => {
                let alone = read(&[place]).map_err(|mistake| self.located(mistake.line, mistake.fault))?;
                Ok(alone.into_iter().next().unwrap_or_default())
            }
        }
    }

    fn located(&self, row: usize, fault: crate::signal::csv::Fault) -> Fault {
        Fault::Sheet { sheet: self.name.clone(), row, fault: Box::new(fault) }
    }
}

impl Catalogue for Workbook {
    fn entries(&self) -> &[Entry] {
        &self.entries
    }

    fn annotations(&self) -> Annotations {
        self.annotations.clone()
    }

    fn values(&mut self, place: usize) -> Result<Vec<f64>, stored::Fault> {
        let (table, column) = self.places[place];
        Ok(self.tables[table].column(column)?)
    }
}
