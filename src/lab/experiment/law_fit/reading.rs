//! Files of measured stresses over stretches.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{BiaxialPoint, DataError, DataSet, Measured, TestKind, TestKindError};
use crate::signal::file::{self, ChannelSelection, ReadOptions};
use crate::signal::{ChannelError, Measurement, QuantityError};
use base::units::{Pressure, Strain};

/// How files of measured stresses are read.
#[derive(Clone, Debug, Default)]
pub struct StressReader {
    /// Kind of the test, in place of what the file states.
    pub kind: Option<TestKind>,
    /// How the tables are read.
    pub table: ReadOptions,
}

/// Why a file is no test.
#[derive(Debug, Error)]
pub enum StressReadingError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] file::ReadError),
    /// The file is read, but holds no test.
    #[error("{}: {fault}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Its fault.
        fault: Box<StressFault>,
    },
}

/// A fault of a file that could be read.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StressFault {
    /// The kind of test is not known.
    #[error(transparent)]
    Kind(#[from] TestKindError),
    /// A column is missing.
    #[error(transparent)]
    Column(#[from] ChannelError),
    /// A column is in another unit.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
    /// The numbers are no test.
    #[error(transparent)]
    Data(#[from] DataError),
}

impl StressReadingError {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        let fault = match self {
            StressReadingError::Read(error) => return error.hint(),
            StressReadingError::Content { fault, .. } => fault,
        };
        match &**fault {
            StressFault::Kind(error) => Some(error.hint().into()),
            StressFault::Column(_) => Some(
                "a test has the columns `stretch` (or `strain`) and `stress`, a biaxial one `stretch_1`, `stretch_2`, \
                 `stress_1` and `stress_2`; --columns names them"
                    .into(),
            ),
            StressFault::Quantity(QuantityError::NoUnit { name, expected }) => Some(format!(
                "write its unit into the header, e.g. `{name} [{}]`, or give --unit {name}=MPa",
                expected.unit
            )),
            _ => None,
        }
    }
}

impl StressReader {
    /// Reads the test at `path`; see [`TestKind::of_file`] for how its kind is found.
    pub fn read(&self, path: &Path) -> Result<DataSet, StressReadingError> {
        let options = ReadOptions { channels: ChannelSelection::All, ..self.table.clone() };
        let table = file::columns(path, &options)?.over_samples();
        self.data_set(path, &table)
            .map_err(|fault| StressReadingError::Content { path: path.into(), fault: Box::new(fault) })
    }

    fn data_set(&self, path: &Path, table: &Measurement) -> Result<DataSet, StressFault> {
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
fn stretches(table: &Measurement, stretch: &str, strain: &str) -> Result<Vec<f64>, StressFault> {
    match table.channel(stretch) {
        Ok(channel) if channel.unit.is_none() => Ok(channel.series.values().to_vec()),
        Ok(channel) => Ok(channel.quantity(Strain::DIMENSION)?.values().to_vec()),
        Err(missing) => {
            let channel = table.channel(strain).map_err(|_| missing)?;
            let strains = match &channel.unit {
                None => &channel.series,
                Some(_) => channel.quantity(Strain::DIMENSION)?,
            };
            Ok(strains.values().iter().map(|strain| 1.0 + strain).collect())
        }
    }
}

fn stresses(table: &Measurement, name: &str) -> Result<Vec<f64>, StressFault> {
    Ok(table.channel(name)?.quantity(Pressure::DIMENSION)?.values().to_vec())
}
