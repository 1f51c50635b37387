//! Recordings as tables in text: a header of names, then a row a sample.
//!
//! Separator (comma, semicolon, tab, blanks), decimal mark, encoding, header, units and the column of time are
//! detected. Lines that start with `#` are comments; those before the numbers become notes. An empty cell means that
//! nothing was measured. Lines are read one by one with their place, for which the crate `csv` is not suited: it needs
//! the separator beforehand and supports neither blanks nor positions within a line.

mod cell;
mod fault;
mod layout;
mod table;
#[cfg(test)]
mod tests;

use std::io::{self, Write};

use csv::WriterBuilder;

use crate::signal::Recording;
use base::number::clean_time;

pub use super::column_name::TIME;
pub(in crate::signal) use cell::{Mark, Separator};
pub use fault::{Fault, ReadError};
pub(in crate::signal) use table::Lined;
pub use table::{Column, Table, columns, measure, read};

/// Writes `recording`, numbers in the shortest form that reads back to the same bits; times without the noise of their
/// last digits (see [`clean_time`]).
pub fn write(recording: &Recording, out: impl Write) -> io::Result<()> {
    let mut rows = WriterBuilder::new().from_writer(out);
    let names = recording.channels.iter().map(|channel| channel.name.as_str());
    rows.write_record(std::iter::once(TIME).chain(names))?;
    for (index, time) in recording.time.iter().enumerate() {
        let values = recording.channels.iter().map(|channel| channel.values[index]);
        rows.write_record(std::iter::once(clean_time(*time)).chain(values).map(cell))?;
    }
    rows.flush()
}

fn cell(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}
