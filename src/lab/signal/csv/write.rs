//! Writing a recording as a table.

use std::io::{self, Write};

use csv::WriterBuilder;

use crate::signal::Recording;
use crate::signal::column_name::TIME;
use base::number::clean_time;

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
