//! `droptower signal`: recordings without a simulation.

mod convert;
mod info;
mod measures;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::{Value, json};

use crate::{Failure, Shared, failure, output, terminal};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::units::{Dimension, Unit};
use lab::signal::file::{self, ChannelSelection, ReadOptions};
use lab::signal::filter::CLASSES;
use lab::signal::{Annotations, MeasuredChannel, Measurement, Recording, Warning, csv, isomme};

#[derive(Debug, Subcommand)]
pub(crate) enum SignalCommand {
    /// Show the content of recordings: channels, units, sampling, gaps
    Info(info::InfoArgs),
    /// Filter a channel by its frequency class
    Filter(convert::FilterArgs),
    /// Write a recording in another format
    Convert(convert::ConvertArgs),
    /// Head injury criterion of an acceleration
    Hic(measures::HicArgs),
    /// Level that an acceleration holds for 3 ms
    Clip(measures::ClipArgs),
    /// Rate one recording against another (ISO/TS 18571)
    Rate(measures::RateArgs),
}

pub(crate) fn run(command: &SignalCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        SignalCommand::Info(args) => info::run(args, shared),
        SignalCommand::Filter(args) => convert::filter(args, shared),
        SignalCommand::Convert(args) => convert::convert(args, shared),
        SignalCommand::Hic(args) => measures::hic(args, shared),
        SignalCommand::Clip(args) => measures::clip_command(args, shared),
        SignalCommand::Rate(args) => measures::rate(args, shared),
    }
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Input {
    /// The recording; `droptower explain formats` lists what is read
    pub path: PathBuf,
    /// The channel, where there are several
    #[arg(long, value_name = "NAME")]
    pub column: Option<String>,
    #[command(flatten)]
    pub table: TableArgs,
    /// The channel's unit where the file states none; g is standard gravity
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
}

/// What a table may not state.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct TableArgs {
    /// The column of time, where its name does not show it
    #[arg(long, value_name = "NAME")]
    pub time: Option<String>,
    /// Names of all columns in place of the file's, with their units: "time [ms],accel [g]"
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
}

/// How a file is read of which several channels are used.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct FileArgs {
    #[command(flatten)]
    pub table: TableArgs,
    /// The unit of a channel where the file states none: NAME=UNIT, several times
    #[arg(long, value_name = "NAME=UNIT")]
    pub unit: Vec<String>,
}

/// A channel that was read.
#[derive(Clone, Debug)]
pub(crate) struct Chosen {
    pub channel: MeasuredChannel,
    /// Comments of its file, and what its reading reports.
    pub annotations: Annotations,
}

impl TableArgs {
    /// `options` with what the user states about the table.
    pub(crate) fn over(&self, options: ReadOptions) -> ReadOptions {
        ReadOptions { time: self.time.clone(), names: self.columns.clone(), ..options }
    }
}

impl FileArgs {
    /// The `channels` of the file at `path`.
    pub(crate) fn read(&self, path: &Path, channels: ChannelSelection) -> Result<Measurement, Diagnostic> {
        file::read(path, &self.options(channels)?).map_err(|error| failure::recording(&error))
    }

    /// The options to read the `channels` of a file with.
    pub(crate) fn options(&self, channels: ChannelSelection) -> Result<ReadOptions, Diagnostic> {
        Ok(self.table.over(ReadOptions { channels, units: self.units()?, ..ReadOptions::default() }))
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
    /// The requested channel, in SI where its unit is known.
    pub(crate) fn read(&self) -> Result<Chosen, Diagnostic> {
        let unit = self.unit.as_deref().map(unit).transpose()?;
        let options = ReadOptions { unit, ..ReadOptions::one(self.column.as_deref()) };
        let found = file::read(&self.path, &self.table.over(options)).map_err(|error| failure::recording(&error))?;
        let Measurement { channels, annotations } = found;
        let channel = channels.into_iter().next();
        let channel = channel.ok_or_else(|| Diagnostic::new(format!("{}: no channel", shown_path(&self.path))))?;
        Ok(Chosen { channel, annotations })
    }

    /// The requested channel in the SI unit of `dimension`.
    pub(crate) fn read_as(&self, dimension: Dimension) -> Result<Chosen, Diagnostic> {
        let chosen = self.read()?;
        chosen.channel.quantity(dimension).map_err(|error| failure::content(&self.path, &error))?;
        Ok(chosen)
    }
}

/// A channel frequency class as the user wrote it: `1000`, `CFC1000`, `CFC 1000`.
pub(crate) fn class(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let digits = match text.get(..3) {
        Some(word) if word.eq_ignore_ascii_case("CFC") => text[3..].trim_start_matches([' ', '_', '-']),
        _ => text,
    };
    let class = digits.parse::<f64>().ok().filter(|class| class.is_finite() && *class > 0.0);
    class.ok_or_else(|| "expected a channel frequency class such as 1000 or CFC1000".into())
}

/// The report of a filter that the channel passed before.
pub(crate) fn filtered_before(channel: &MeasuredChannel) -> Option<Warning> {
    channel.filtered.map(|class| Warning::FilteredBefore { channel: channel.name.clone(), class })
}

/// The report of a class that the standards do not define; it is used nevertheless.
pub(crate) fn unusual_class(class: f64) -> Option<Warning> {
    (!CLASSES.contains(&class)).then_some(Warning::UnusualFilterClass { class })
}

/// The unit that the user wrote.
pub(crate) fn unit(text: &str) -> Result<Unit, Diagnostic> {
    let hint = "known are e.g. g, m/s2, N, kN, lbf, MPa, psi, mm, in, s, ms, -, %";
    Unit::parse(text).map_err(|error| Diagnostic::new(error.to_string()).hint(hint))
}

/// Figures of a file with its notes, which are comments and messages of findings, and its findings.
fn with_notes(mut figures: Value, annotations: &Annotations) -> Value {
    figures["notes"] = json!(annotations.notes());
    figures["findings"] = json!(annotations.findings());
    figures
}

/// Findings and free comments of a file.
fn remarks(annotations: &Annotations) -> String {
    remark_lines(&annotations.free_comments().cloned().collect::<Vec<_>>(), &annotations.findings())
}

/// One line a finding, then one a comment, each ending with a line break.
pub(crate) fn remark_lines<'f>(comments: &[String], findings: impl IntoIterator<Item = &'f Finding>) -> String {
    let comments: String = comments.iter().map(|comment| format!("  comment: {comment}\n")).collect();
    [terminal::findings("  ", findings), comments].concat()
}

/// Refuses a table whose name does not end in .csv, that would replace the input or, without `force`, anything that is
/// there.
pub(crate) fn check_table(out: &Path, input: &Path, force: bool) -> Result<(), Failure> {
    if isomme::is_part(out) {
        let message = format!("{} is the name of ISO-MME, but a table is written", shown_path(out));
        return Err(Diagnostic::new(message).hint("name it .csv").into());
    }
    output::check(out, "csv", Some(input), Some(force))
}

/// Writes `recording` with `comments` before it, whole or not at all.
pub(crate) fn write_csv(out: &Path, comments: &[String], recording: &Recording) -> Result<(), Failure> {
    output::write(out, |text| {
        for line in comments {
            writeln!(text, "# {}", line.replace(char::is_control, " "))?;
        }
        csv::write(recording, text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_written_with_and_without_their_name() {
        for text in ["1000", "CFC1000", "cfc 1000", "CFC_1000", " 1e3 "] {
            assert_eq!(class(text), Ok(1000.0), "{text}");
        }
        for text in ["", "CFC", "CFC x", "-60", "CFC-", "NaN", "inf", "0", "ÄÖ1000"] {
            assert!(class(text).is_err(), "{text}");
        }
        assert_eq!(unusual_class(180.0), None);
        assert_eq!(
            unusual_class(999.0).map(|warning| warning.to_string()).as_deref(),
            Some("CFC 999 is none of the standards' classes (1000, 600, 180, 60)")
        );
    }
}
