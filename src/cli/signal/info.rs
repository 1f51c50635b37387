//! `droptower signal info`: what recordings hold.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use serde::Serialize;

use super::input::FileArgs;
use crate::cli::{Shared, faults, print, print_json, report};
use crate::diagnostic::{Diagnostic, shown_path};
use crate::signal::file::{self, Selection, Wanted};
use crate::signal::{Measured, csv, resample};

#[derive(Debug, Args)]
pub struct InfoArgs {
    /// The recordings: CSV or ISO-MME
    #[arg(required = true)]
    pub paths: Vec<PathBuf>,
    #[command(flatten)]
    pub file: FileArgs,
}

/// What one file holds.
#[derive(Serialize)]
struct Contents {
    path: String,
    channels: Vec<Contained>,
    notes: Vec<String>,
}

/// One channel of a file; values in `unit`.
#[derive(Serialize)]
struct Contained {
    name: String,
    /// As the file writes it.
    label: String,
    /// As the file writes it; none where it is not known.
    written_unit: Option<String>,
    /// Of the figures below.
    unit: Option<String>,
    /// The channel frequency class that it went through, as the file says.
    filtered: Option<f64>,
    #[serde(flatten)]
    samples: Figures,
    /// None where the file has no time.
    #[serde(flatten)]
    time: Option<Sampling>,
}

#[derive(Serialize)]
struct Figures {
    samples: usize,
    /// Samples that were not measured.
    gaps: usize,
    smallest: Option<f64>,
    largest: Option<f64>,
}

#[derive(Serialize)]
struct Sampling {
    start_s: Option<f64>,
    end_s: Option<f64>,
    /// None where the steps differ.
    step_s: Option<f64>,
    time_of_smallest_s: Option<f64>,
    time_of_largest_s: Option<f64>,
}

pub fn run(args: &InfoArgs, shared: &Shared) -> ExitCode {
    let found: Vec<Result<Contents, Diagnostic>> = args.paths.iter().map(|path| contents(path, &args.file)).collect();
    let (found, mistakes): (Vec<_>, Vec<_>) = found.into_iter().partition(Result::is_ok);
    let mistakes: Vec<Diagnostic> = mistakes.into_iter().filter_map(Result::err).collect();
    if !mistakes.is_empty() {
        return report(&mistakes);
    }
    let found: Vec<Contents> = found.into_iter().filter_map(Result::ok).collect();
    if shared.json {
        return print_json(&found);
    }
    if shared.quiet {
        return ExitCode::SUCCESS;
    }
    print(found.iter().map(text).collect::<Vec<_>>().join("\n").trim_end())
}

fn contents(path: &Path, file: &FileArgs) -> Result<Contents, Diagnostic> {
    let wanted = file.wanted(Selection::All)?;
    match file::read(path, &wanted) {
        Ok(found) => Ok(Contents {
            path: shown_path(path),
            channels: found.channels.iter().map(contained).collect(),
            notes: found.notes,
        }),
        Err(file::ReadError::Csv(error)) if matches!(error.fault, csv::Fault::NoTime { .. }) => columns(path, &wanted),
        Err(error) => Err(faults::recording(&error)),
    }
}

/// What a table without time holds, e.g. stress over strain.
fn columns(path: &Path, wanted: &Wanted) -> Result<Contents, Diagnostic> {
    let csv::Table { columns, mut notes } = file::columns(path, wanted).map_err(|error| faults::recording(&error))?;
    notes.push("there is no column of time".into());
    let channels = columns.into_iter().map(|csv::Column { name, label, unit, values }| {
        let written_unit = unit.as_ref().map(|unit| unit.symbol().to_owned());
        let samples = Figures::of(&values);
        let si = unit.map(|unit| unit.si_symbol());
        Contained { name, label, written_unit, unit: si, filtered: None, samples, time: None }
    });
    Ok(Contents { path: shown_path(path), channels: channels.collect(), notes })
}

fn contained(channel: &Measured) -> Contained {
    let Measured { name, label, unit, filtered, series } = channel;
    let time_of = |extreme: Option<[f64; 2]>| extreme.map(|[time, _]| time);
    let time = Sampling {
        start_s: series.time().first().copied(),
        end_s: series.time().last().copied(),
        step_s: resample::common_step(series.time()),
        time_of_smallest_s: time_of(series.smallest()),
        time_of_largest_s: time_of(series.largest()),
    };
    Contained {
        name: name.clone(),
        label: label.clone(),
        written_unit: unit.as_ref().map(|unit| unit.symbol().to_owned()),
        unit: channel.value_unit(),
        filtered: *filtered,
        samples: Figures::of(series.values()),
        time: Some(time),
    }
}

impl Figures {
    fn of(values: &[f64]) -> Figures {
        let measured = || values.iter().copied().filter(|value| value.is_finite());
        Figures {
            samples: values.len(),
            gaps: values.len() - measured().count(),
            smallest: measured().reduce(f64::min),
            largest: measured().reduce(f64::max),
        }
    }
}

fn text(contents: &Contents) -> String {
    let header =
        ["channel", "unit", "samples", "gaps", "from s", "to s", "step s", "smallest", "at s", "largest", "at s"];
    let rows = contents.channels.iter().map(row);
    let lines: Vec<Vec<String>> = std::iter::once(header.map(str::to_owned).to_vec()).chain(rows).collect();
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: &Vec<String>| {
        let name = format!("{:1$}", cells[0], widths[0]);
        let others = cells.iter().zip(&widths).skip(1).map(|(cell, width)| format!("  {cell:>width$}"));
        format!("  {name}{}\n", others.collect::<String>())
    };
    let notes = contents.notes.iter().map(|note| format!("  note: {note}\n"));
    format!("{}\n{}{}", contents.path, lines.iter().map(line).collect::<String>(), notes.collect::<String>())
}

fn row(channel: &Contained) -> Vec<String> {
    let Contained { name, unit, samples, time, .. } = channel;
    let at = |of: fn(&Sampling) -> Option<f64>| match time.as_ref().and_then(of) {
        Some(value) => format!("{value:.7}"),
        None => "-".into(),
    };
    let step = match time {
        Some(Sampling { step_s: None, .. }) => "uneven".into(),
        _ => at(|time| time.step_s),
    };
    let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.5e}"));
    vec![
        name.clone(),
        unit.clone().unwrap_or_else(|| "unknown".into()),
        samples.samples.to_string(),
        samples.gaps.to_string(),
        at(|time| time.start_s),
        at(|time| time.end_s),
        step,
        figure(samples.smallest),
        at(|time| time.time_of_smallest_s),
        figure(samples.largest),
        at(|time| time.time_of_largest_s),
    ]
}
