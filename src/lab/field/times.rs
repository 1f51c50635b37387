//! The times of the files of a field, from a table.

use std::path::Path;

use super::fault::{FieldError, FileFault};
use crate::signal::ReadOptions;
use crate::signal::column_name::ColumnName;
use crate::signal::csv::Column;
use crate::signal::file;
use base::units::Time;

/// The times (s) in the table at `path`: its column of time, or its only column; in seconds where it states no unit.
///
/// # Errors
/// It is no table, has no column of time, or times do not increase.
pub fn read_times(path: &Path) -> Result<Vec<f64>, FieldError> {
    let columns = file::columns(path, &ReadOptions::default())?.columns;
    let refused = |fault| FieldError::in_file(path, fault);
    let is_time = |column: &&Column| {
        column.unit.as_ref().is_none_or(|unit| unit.measures(Time::DIMENSION))
            && ColumnName::read(&column.label).is_time()
    };
    let found = columns.iter().find(is_time).or(match &columns[..] {
        [only] if only.unit.as_ref().is_none_or(|unit| unit.measures(Time::DIMENSION)) => Some(only),
        _ => None,
    });
    let labels = || columns.iter().map(|column| column.label.clone()).collect();
    let times =
        found.map(|column| column.values.clone()).ok_or_else(|| refused(FileFault::NoTime { found: labels() }))?;
    let mut latest = f64::NEG_INFINITY;
    for (place, time) in times.iter().enumerate() {
        if time.is_nan() || *time <= latest {
            return Err(refused(FileFault::TimeNotIncreasing { number: place + 1 }));
        }
        latest = *time;
    }
    Ok(times)
}
