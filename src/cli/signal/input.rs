//! The one channel that a command works on.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::faults;
use crate::diagnostic::{Diagnostic, shown_path};
use crate::signal::file::{self, Selection, Wanted};
use crate::signal::{Measured, Measurement};
use crate::units::{Dimension, Unit};

#[derive(Clone, Debug, Args)]
pub struct Input {
    /// The recording: CSV or ISO-MME
    pub path: PathBuf,
    /// The channel, where there are several
    #[arg(long, value_name = "NAME")]
    pub column: Option<String>,
    #[command(flatten)]
    pub table: TableArgs,
    /// The channel's unit where the file does not say; g is standard gravity
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
}

/// What a table may leave open.
#[derive(Clone, Debug, Default, Args)]
pub struct TableArgs {
    /// The column of time, where it is not called so
    #[arg(long, value_name = "NAME")]
    pub time: Option<String>,
    /// Names of all columns in place of the file's, with their units: "time [ms],accel [g]"
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
}

/// What is said of a file of which several channels are read.
#[derive(Clone, Debug, Default, Args)]
pub struct FileArgs {
    #[command(flatten)]
    pub table: TableArgs,
    /// The unit of a channel where the file does not say: NAME=UNIT, several times
    #[arg(long, value_name = "NAME=UNIT")]
    pub unit: Vec<String>,
}

/// A channel that was read, and what was noted while reading.
#[derive(Clone, Debug)]
pub struct Chosen {
    pub channel: Measured,
    pub notes: Vec<String>,
}

impl TableArgs {
    /// `wanted` with what the user says of the table.
    pub fn over(&self, wanted: Wanted) -> Wanted {
        Wanted { time: self.time.clone(), names: self.columns.clone(), ..wanted }
    }
}

impl FileArgs {
    /// The `channels` of the file at `path`.
    pub fn read(&self, path: &Path, channels: Selection) -> Result<Measurement, Diagnostic> {
        file::read(path, &self.wanted(channels)?).map_err(|error| faults::recording(&error))
    }

    /// What is wanted of the file besides its `channels`.
    pub fn wanted(&self, channels: Selection) -> Result<Wanted, Diagnostic> {
        Ok(self.table.over(Wanted { channels, units: self.units()?, ..Wanted::default() }))
    }

    fn units(&self) -> Result<Vec<(String, Unit)>, Diagnostic> {
        let pair = |text: &String| {
            let (name, symbol) = text.split_once('=').ok_or_else(|| {
                Diagnostic::new(format!("expected a channel and its unit, found `{text}`")).hint("write NAME=UNIT")
            })?;
            Ok((name.trim().to_owned(), unit(symbol)?))
        };
        self.unit.iter().map(pair).collect()
    }
}

impl Input {
    /// The channel asked for, whatever it measures; in SI where its unit is known.
    pub fn read(&self) -> Result<Chosen, Diagnostic> {
        let unit = self.unit.as_deref().map(unit).transpose()?;
        let wanted = Wanted { unit, ..Wanted::one(self.column.as_deref()) };
        let found = file::read(&self.path, &self.table.over(wanted)).map_err(|error| faults::recording(&error))?;
        let notes = found.notes;
        let channel = found.channels.into_iter().next();
        let channel = channel.ok_or_else(|| Diagnostic::new(format!("{}: no channel", shown_path(&self.path))))?;
        Ok(Chosen { channel, notes })
    }

    /// The channel asked for in the SI unit, once it is sure to be a `dimension`.
    pub fn read_as(&self, dimension: Dimension) -> Result<Chosen, Diagnostic> {
        let chosen = self.read()?;
        chosen.channel.quantity(dimension).map_err(|error| faults::quantity(&self.path, &error))?;
        Ok(chosen)
    }
}

/// The number in SI of a quantity with its unit, for clap.
pub fn quantity(dimension: Dimension, text: &str) -> Result<f64, String> {
    dimension.parse(text).map_err(|error| format!("{error}; {}", error.hint()))
}

/// The unit that the user wrote.
pub fn unit(text: &str) -> Result<Unit, Diagnostic> {
    let hint = "known are e.g. g, m/s2, N, kN, lbf, MPa, psi, mm, in, s, ms, -, %";
    Unit::parse(text).map_err(|error| Diagnostic::new(error.to_string()).hint(hint))
}
