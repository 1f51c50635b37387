//! Files of relaxation moduli and of shift factors.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{Relaxation, ShiftFactor, ZERO_CELSIUS};
use crate::signal::file::{self, ChannelSelection, ReadOptions};
use crate::signal::{ChannelError, MeasuredChannel, Measurement, QuantityError};
use base::units::{Pressure, Time};

/// Difference of temperatures of two rows, K, from which on they are of two relaxations.
const NEXT_TEMPERATURE: f64 = 2.0;

/// Content of a file of relaxation moduli.
#[derive(Clone, Debug, PartialEq)]
pub enum RelaxationData {
    /// Time (s) and modulus (Pa): one relaxation, or a master curve.
    Curve(Vec<[f64; 2]>),
    /// Relaxations at several temperatures.
    Raw(Vec<Relaxation>),
}

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
    /// The unit of the temperature is not known.
    #[error("the unit of `{label}` is not known")]
    TemperatureUnit {
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
            RelaxationFault::Column(_) => "a relaxation has the columns `time` and `modulus`, several have \
                `temperature_degC` too, and shift factors `temperature_degC` and `log_shift`; --columns names them"
                .into(),
            RelaxationFault::Quantity(QuantityError::NoUnit { name, expected }) => {
                format!("write its unit into the header, e.g. `{name} [{}]`, or give --unit", expected.unit)
            }
            RelaxationFault::TemperatureUnit { .. } => "write `temperature_degC` or `temperature_K`".into(),
            _ => return None,
        })
    }
}

/// Reads the relaxation at `path`: columns `time` and `modulus`, and of several temperatures `temperature_degC` or
/// `temperature_K` and, where rows of one temperature are not together, `set`.
pub fn read_relaxation(path: &Path, options: &ReadOptions) -> Result<RelaxationData, RelaxationReadingError> {
    let table = table(path, options)?;
    data(&table, options.time.as_deref())
        .map_err(|fault| RelaxationReadingError::Content { path: path.into(), fault: Box::new(fault) })
}

/// Reads the shift factors at `path`: columns `temperature_degC` or `temperature_K`, and `log_shift` (log₁₀ a_T).
pub fn read_shift_factors(path: &Path) -> Result<Vec<ShiftFactor>, RelaxationReadingError> {
    let table = table(path, &ReadOptions::default())?;
    let factors = || {
        let temperatures = temperatures(&table)?.ok_or(RelaxationFault::Column(ChannelError::Missing {
            name: "temperature_degC".into(),
            known: table.channels.iter().map(|channel| channel.name.clone()).collect(),
        }))?;
        let logs = table.channel("log_shift")?.series.values();
        all_finite(&[&temperatures, logs])?;
        let pair = |(temperature, log): (f64, &f64)| ShiftFactor { temperature, log_shift: *log };
        Ok(temperatures.into_iter().zip(logs).map(pair).collect())
    };
    factors().map_err(|fault| RelaxationReadingError::Content { path: path.into(), fault: Box::new(fault) })
}

fn table(path: &Path, options: &ReadOptions) -> Result<Measurement, file::ReadError> {
    let options = ReadOptions { channels: ChannelSelection::All, ..options.clone() };
    Ok(file::columns(path, &options)?.over_samples())
}

fn data(table: &Measurement, time: Option<&str>) -> Result<RelaxationData, RelaxationFault> {
    let times = table.channel(time.unwrap_or("time"))?.quantity(Time::DIMENSION)?.values();
    let moduli = table.channel("modulus")?.quantity(Pressure::DIMENSION)?.values();
    let points = || times.iter().zip(moduli).map(|(time, modulus)| [*time, *modulus]);
    let Some(temperatures) = temperatures(table)? else {
        all_finite(&[times, moduli])?;
        return Ok(RelaxationData::Curve(points().collect()));
    };
    let sets = table.channel("set").ok().map(|channel| channel.series.values().to_vec());
    all_finite(&[times, moduli, &temperatures])?;
    let mut groups: Vec<(f64, Vec<f64>, Vec<[f64; 2]>)> = Vec::new();
    for (row, point) in points().enumerate() {
        let (temperature, key) = (temperatures[row], sets.as_ref().map_or(temperatures[row], |sets| sets[row]));
        let is_same = |other: f64| {
            if sets.is_some() { other == key } else { (other - key).abs() < NEXT_TEMPERATURE }
        };
        match groups.iter_mut().find(|(other, ..)| is_same(*other)) {
            Some((_, temperatures, points)) => {
                temperatures.push(temperature);
                points.push(point);
            }
            None => groups.push((key, vec![temperature], vec![point])),
        }
    }
    let relaxation = |(_, temperatures, mut points): (f64, Vec<f64>, Vec<[f64; 2]>)| {
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Relaxation { temperature: temperatures.iter().sum::<f64>() / temperatures.len() as f64, points }
    };
    Ok(RelaxationData::Raw(groups.into_iter().map(relaxation).collect()))
}

/// The column of temperature in K, where there is one.
fn temperatures(table: &Measurement) -> Result<Option<Vec<f64>>, RelaxationFault> {
    let is_temperature = |channel: &&MeasuredChannel| channel.name.starts_with("temperature") || channel.name == "T";
    let Some(channel) = table.channels.iter().find(is_temperature) else { return Ok(None) };
    let values = channel.series.values();
    let label = channel.label.as_str();
    let ends = |units: &[&str]| units.iter().any(|unit| label.ends_with(unit));
    if channel.unit.is_some() || ends(&["_K", "[K]", "(K)"]) {
        Ok(Some(values.to_vec()))
    } else if ends(&["_degC", "[degC]", "[°C]", "(degC)", "(°C)", "[C]"]) {
        Ok(Some(values.iter().map(|celsius| celsius + ZERO_CELSIUS).collect()))
    } else {
        Err(RelaxationFault::TemperatureUnit { label: label.into() })
    }
}

fn all_finite(columns: &[&[f64]]) -> Result<(), RelaxationFault> {
    let rows = columns.first().map_or(0, |column| column.len());
    let missing = (0..rows).find(|row| columns.iter().any(|column| !column[*row].is_finite()));
    missing.map_or(Ok(()), |row| Err(RelaxationFault::NotFinite { row: row + 1 }))
}
