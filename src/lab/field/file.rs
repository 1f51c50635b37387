//! One file of a field.

use std::path::Path;

use super::columns::{self, Found, Lack};
use super::fault::{FieldError, FileFault};
use crate::signal::column_name::ColumnName;
use crate::signal::csv::{Column, Table};
use crate::signal::file;
use crate::signal::{Annotations, ReadOptions};
use base::units::Length;

/// Words in the place of a number where nothing was matched.
const GAPS: &[&str] = &["nan", "-nan", "nan(ind)", "-nan(ind)", "n/a", "non numérique", "n. def.", "?"];

/// What the caller states about the files of a field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldOptions {
    /// Length of one unit of places and displacements where a file states none, m.
    pub unit: Option<f64>,
}

/// The points of one file that were matched.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldFile {
    /// The program whose names its columns have.
    pub program: &'static str,
    /// Labels of the columns of places and displacements.
    pub columns: [String; 6],
    /// Undeformed places, m.
    pub places: Vec<[f64; 3]>,
    /// Their displacements, m.
    pub displacements: Vec<[f64; 3]>,
    /// Points that were not matched.
    pub missing: usize,
    /// Comments of the file, and what its reading reports.
    pub annotations: Annotations,
}

/// Reads the field in the file at `path`: a table in text or a workbook, with the columns of one of the known programs. A point
/// counts as not matched where a cell is empty or no number, and where `sigma` is negative.
///
/// # Errors
/// The file is no such table, or a unit is missing.
pub fn read(path: &Path, options: &FieldOptions) -> Result<FieldFile, FieldError> {
    let table = file::columns(path, &ReadOptions { gaps: GAPS, ..ReadOptions::default() })?;
    let Table { columns, annotations } = with_names_of_comment(table);
    from_columns(columns, annotations, options).map_err(|fault| FieldError::in_file(path, fault))
}

fn from_columns(
    mut columns: Vec<Column>,
    annotations: Annotations,
    options: &FieldOptions,
) -> Result<FieldFile, FileFault> {
    let Found { naming, places, displacements, sigma } = columns::find(&columns).map_err(|lack| match lack {
        Lack::OutOfPlane(found) => FileFault::Planar { found },
        Lack::All => FileFault::NoField { found: columns.iter().map(|column| column.label.clone()).collect() },
    })?;
    let all = [places, displacements].concat();
    for place in &all {
        in_metres(&mut columns[*place], options)?;
    }
    let of_row = |row: usize, three: [usize; 3]| three.map(|place| columns[place].values[row]);
    let is_matched = |row: usize| sigma.is_none_or(|sigma| columns[sigma].values[row] >= 0.0);
    let rows = columns[places[0]].values.len();
    let mut points = (Vec::new(), Vec::new());
    for row in 0..rows {
        let (place, mut displacement) = (of_row(row, places), of_row(row, displacements));
        if naming.deformed {
            displacement = [0, 1, 2].map(|axis| displacement[axis] - place[axis]);
        }
        if is_matched(row) && place.iter().chain(&displacement).all(|value| value.is_finite()) {
            points.0.push(place);
            points.1.push(displacement);
        }
    }
    let (places, displacements) = points;
    if places.is_empty() {
        return Err(FileFault::NoPoint);
    }
    let label = |order: usize| columns[all[order]].label.clone();
    Ok(FieldFile {
        program: naming.program,
        columns: [0, 1, 2, 3, 4, 5].map(label),
        missing: rows - places.len(),
        places,
        displacements,
        annotations,
    })
}

/// Brings a column without a unit to that of the caller; any other must be a length.
fn in_metres(column: &mut Column, options: &FieldOptions) -> Result<(), FileFault> {
    let name = || column.label.clone();
    if let Some(unit) = &column.unit {
        let unit = unit.clone();
        return match unit.measures(Length::DIMENSION) {
            true => Ok(()),
            false => Err(FileFault::NotALength { column: name(), unit: unit.symbol().to_owned() }),
        };
    }
    if let Some(unit) = ColumnName::read(&column.label).unknown_unit {
        return Err(FileFault::NotALength { column: name(), unit });
    }
    let unit = options.unit.ok_or_else(|| FileFault::NoUnit { column: name() })?;
    column.values.iter_mut().for_each(|value| *value *= unit);
    Ok(())
}

/// The table with the names of the last comment that has one for each column, where the file has no other header.
fn with_names_of_comment(mut table: Table) -> Table {
    let is_numbered = |(place, column): (usize, &Column)| column.label == format!("column {}", place + 1);
    if !table.columns.iter().enumerate().all(is_numbered) {
        return table;
    }
    let count = table.columns.len();
    let split = |comment: &String, separator: char| -> Option<Vec<ColumnName>> {
        let names: Vec<&str> = match separator {
            ' ' => comment.split_whitespace().collect(),
            other => comment.trim_end_matches(other).split(other).collect(),
        };
        (names.len() == count).then(|| names.into_iter().map(ColumnName::read).collect())
    };
    let names = |comment: &String| [';', '\t', ',', ' '].into_iter().find_map(|separator| split(comment, separator));
    if let Some(names) = table.annotations.comments().iter().rev().find_map(names) {
        for (column, ColumnName { name, label, unit, .. }) in table.columns.iter_mut().zip(names) {
            if let Some(unit) = &unit {
                column.values.iter_mut().for_each(|value| *value = unit.to_si(*value));
            }
            *column = Column { name, label, unit, values: std::mem::take(&mut column.values) };
        }
    }
    table
}
