//! Files of relaxation moduli.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::signal::file::{self, ChannelSelection, ReadOptions};
use crate::signal::{ChannelError, MeasuredChannel, Measurement, QuantityError};
use base::units::{Pressure, Time};

/// Difference of temperatures of two rows, K, from which on they are of two relaxations.
const NEXT_TEMPERATURE: f64 = 2.0;

/// Why a file holds no relaxation.
#[derive(Debug, Error)]
pub enum RelaxationReadingError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] file::ReadError),
    /// The file is read, but holds something else.
    #[error("{}: {fault}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Its fault.
        fault: Box<RelaxationFault>,
    },
}

/// A fault of a file that could be read.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RelaxationFault {
    /// A column is missing.
    #[error(transparent)]
    Column(#[from] ChannelError),
    /// A column is in another unit.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
    /// The rows are of several temperatures.
    #[error("`{label}` changes: the file holds relaxations at several temperatures")]
    SeveralTemperatures {
        /// Of the column.
        label: String,
    },
    /// A number is missing.
    #[error("row {row} lacks a number")]
    NotFinite {
        /// Row, counted from one.
        row: usize,
    },
}

impl RelaxationReadingError {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        let fault = match self {
            RelaxationReadingError::Read(error) => return error.hint(),
            RelaxationReadingError::Content { fault, .. } => fault,
        };
        Some(match &**fault {
            RelaxationFault::Column(_) => {
                "a relaxation has the columns `time` and `modulus`; --columns names them".into()
            }
            RelaxationFault::Quantity(QuantityError::NoUnit { name, expected }) => {
                format!("write its unit into the header, e.g. `{name} [{}]`, or give --unit", expected.unit)
            }
            RelaxationFault::SeveralTemperatures { .. } => {
                "give one of them, or the master curve that the program of the DMA makes of them".into()
            }
            _ => return None,
        })
    }
}

/// Reads the relaxation at `path`, with the columns `time` and `modulus`: time (s) and modulus (Pa) of each row.
pub fn read_relaxation(path: &Path, options: &ReadOptions) -> Result<Vec<[f64; 2]>, RelaxationReadingError> {
    let all = ReadOptions { channels: ChannelSelection::All, ..options.clone() };
    let table = file::columns(path, &all)?.over_samples();
    points(&table, options.time.as_deref())
        .map_err(|fault| RelaxationReadingError::Content { path: path.into(), fault: Box::new(fault) })
}

fn points(table: &Measurement, time: Option<&str>) -> Result<Vec<[f64; 2]>, RelaxationFault> {
    let times = table.channel(time.unwrap_or("time"))?.quantity(Time::DIMENSION)?.values();
    let moduli = table.channel("modulus")?.quantity(Pressure::DIMENSION)?.values();
    let is_temperature = |channel: &&MeasuredChannel| channel.name.starts_with("temperature") || channel.name == "T";
    if let Some(channel) = table.channels.iter().find(is_temperature)
        && let (Some(least), Some(most)) = (channel.series.smallest(), channel.series.largest())
        && most[1] - least[1] > NEXT_TEMPERATURE
    {
        return Err(RelaxationFault::SeveralTemperatures { label: channel.label.clone() });
    }
    let rows: Vec<[f64; 2]> = times.iter().zip(moduli).map(|(time, modulus)| [*time, *modulus]).collect();
    match rows.iter().position(|row| row.iter().any(|value| !value.is_finite())) {
        Some(row) => Err(RelaxationFault::NotFinite { row: row + 1 }),
        None => Ok(rows),
    }
}
