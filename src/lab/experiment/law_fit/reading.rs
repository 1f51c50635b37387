//! Files of measured stresses over stretches.

use std::path::Path;

use super::{BiaxialPoint, DataSet, Measured, TestKind};
use crate::error::{Error, Kind};
use crate::signal::file::{self, ChannelSelection, ReadOptions};
use crate::signal::{MeasuredChannel, Measurement};
use base::units::{Dimension, Pressure, Strain};

/// How files of measured stresses are read.
#[derive(Clone, Debug, Default)]
pub struct StressReader {
    /// Kind of the test, in place of what the file states.
    pub kind: Option<TestKind>,
    /// How the tables are read.
    pub table: ReadOptions,
}

impl StressReader {
    /// Reads the test at `path`; see [`TestKind::of_file`] for how its kind is found.
    pub fn read(&self, path: &Path) -> Result<DataSet, Error> {
        let options = ReadOptions { channels: ChannelSelection::All, ..self.table.clone() };
        let table = file::columns(path, &options)?.over_samples();
        self.data_set(path, &table).map_err(|error| error.in_file(path))
    }

    fn data_set(&self, path: &Path, table: &Measurement) -> Result<DataSet, Error> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let kind = TestKind::of_file(&name, table.annotations.comments(), self.kind)?;
        let measured = match kind {
            TestKind::Tension(tension) => {
                let stretches = stretches(table, "stretch", "strain")?;
                let stresses = stresses(table, "stress")?;
                Measured::Tension(tension, stretches.into_iter().zip(stresses).map(|(s, p)| [s, p]).collect())
            }
            TestKind::Biaxial => {
                let [l1, l2] = [stretches(table, "stretch_1", "strain_1")?, stretches(table, "stretch_2", "strain_2")?];
                let [p1, p2] = [stresses(table, "stress_1")?, stresses(table, "stress_2")?];
                let point = |i: usize| BiaxialPoint { stretches: [l1[i], l2[i]], stresses: [p1[i], p2[i]] };
                Measured::Biaxial((0..l1.len()).map(point).collect())
            }
        };
        Ok(DataSet { is_virtual: table.annotations.is_virtual(), ..DataSet::new(name, measured)? })
    }
}

/// Stretches of the column `stretch`, which may have no unit, or of engineering strains.
fn stretches(table: &Measurement, stretch: &str, strain: &str) -> Result<Vec<f64>, Error> {
    let ratios = |channel: &MeasuredChannel| match channel.unit {
        None => Ok(channel.series.values().to_vec()),
        Some(_) => values(channel, Strain::DIMENSION),
    };
    match table.channel(stretch) {
        Ok(channel) => ratios(channel),
        Err(missing) => {
            let strains = ratios(table.channel(strain).map_err(|_| with_columns(missing))?)?;
            Ok(strains.into_iter().map(|strain| 1.0 + strain).collect())
        }
    }
}

fn stresses(table: &Measurement, name: &str) -> Result<Vec<f64>, Error> {
    values(table.channel(name).map_err(with_columns)?, Pressure::DIMENSION)
}

fn values(channel: &MeasuredChannel, dimension: Dimension) -> Result<Vec<f64>, Error> {
    let series = channel.quantity(dimension).map_err(|error| match error.kind().clone() {
        Kind::NoUnit { name, unit } => error
            .with_hint(format!("write its unit into the header, e.g. `{name} [{unit}]`, or give --unit {name}=MPa")),
        _ => error,
    })?;
    Ok(series.values().to_vec())
}

/// The refusal of a missing column, with those that a test has.
fn with_columns(error: Error) -> Error {
    error.with_hint(
        "a test has the columns `stretch` (or `strain`) and `stress`, a biaxial one `stretch_1`, `stretch_2`, `stress_1` and \
         `stress_2`; --columns names them",
    )
}
