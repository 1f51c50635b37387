//! A channel as its file lists it.

use super::Fault;
use crate::signal::column_name::ColumnName;
use base::units::Unit;

/// A channel as its file lists it, before its values are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Group in which it is; empty where the file has none.
    pub group: String,
    /// Name and unit; its label has the group before it: `GROUP/CHANNEL`.
    pub column: ColumnName,
    /// Number of samples.
    pub samples: u64,
    /// Times of the samples.
    pub axis: Axis,
    /// Why its values cannot be read, where they cannot.
    pub unread: Option<String>,
}

/// How a file gives the times of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum Axis {
    /// By their start and increment, s.
    Steps {
        /// Time of the first sample, s.
        start: f64,
        /// From sample to sample, s.
        step: f64,
    },
    /// By another channel, at this place in the list.
    Channel(usize),
    /// Not at all; a channel of its group may be named like a time.
    Unknown,
}

impl Entry {
    /// The channel `name` of a `group`, with the unit that the file states of it; without samples and times as yet.
    ///
    /// # Errors
    /// Its name states another unit.
    pub fn new(group: &str, name: &str, unit: Option<&str>) -> Result<Entry, Fault> {
        let mut column = ColumnName::read(name);
        column.label = if group.is_empty() { name.to_owned() } else { format!("{group}/{name}") };
        match unit.map(str::trim).filter(|unit| !unit.is_empty()).map(|unit| (unit, Unit::parse(unit))) {
            Some((stated, Ok(unit))) => {
                if let Some(named) = column.unit.as_ref().filter(|named| **named != unit) {
                    let (named, stated) = (named.symbol().to_owned(), stated.to_owned());
                    return Err(Fault::MixedUnits { channel: column.label, named, stated });
                }
                column.unit = Some(unit);
                column.unknown_unit = None;
            }
            Some((stated, Err(_))) if column.unit.is_none() => column.unknown_unit = Some(stated.to_owned()),
            _ => {}
        }
        Ok(Entry { group: group.to_owned(), column, samples: 0, axis: Axis::Unknown, unread: None })
    }

    /// The name with the group before it.
    pub fn label(&self) -> &str {
        &self.column.label
    }
}
