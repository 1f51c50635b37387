//! `droptower signal info`: what recordings hold.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use serde::Serialize;

use super::input::TableArgs;
use crate::cli::{Shared, faults, print, print_json, report};
use crate::diagnostic::{Diagnostic, shown_path};
use crate::signal::file::{self, Wanted};
use crate::signal::{Measured, resample};

#[derive(Debug, Args)]
pub struct InfoArgs {
    /// The recordings: CSV or ISO-MME
    #[arg(required = true)]
    pub paths: Vec<PathBuf>,
    #[command(flatten)]
    pub table: TableArgs,
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
    samples: usize,
    /// Samples that were not measured.
    gaps: usize,
    start_s: Option<f64>,
    end_s: Option<f64>,
    /// None where the steps differ.
    step_s: Option<f64>,
    smallest: Option<f64>,
    time_of_smallest_s: Option<f64>,
    largest: Option<f64>,
    time_of_largest_s: Option<f64>,
}

pub fn run(args: &InfoArgs, shared: &Shared) -> ExitCode {
    let found: Vec<Result<Contents, Diagnostic>> = args.paths.iter().map(|path| contents(path, &args.table)).collect();
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

fn contents(path: &Path, table: &TableArgs) -> Result<Contents, Diagnostic> {
    let found = file::read(path, &table.over(Wanted::default())).map_err(|error| faults::recording(&error))?;
    let channels = found.channels.iter().map(contained).collect();
    Ok(Contents { path: shown_path(path), channels, notes: found.notes })
}

fn contained(channel: &Measured) -> Contained {
    let Measured { name, label, unit, series, .. } = channel;
    let (smallest, largest) = (series.smallest(), series.largest());
    Contained {
        name: name.clone(),
        label: label.clone(),
        written_unit: unit.as_ref().map(|unit| unit.symbol().to_owned()),
        unit: channel.value_unit(),
        samples: series.len(),
        gaps: series.values().iter().filter(|value| value.is_nan()).count(),
        start_s: series.time().first().copied(),
        end_s: series.time().last().copied(),
        step_s: resample::common_step(series.time()),
        smallest: smallest.map(|[_, value]| value),
        time_of_smallest_s: smallest.map(|[time, _]| time),
        largest: largest.map(|[_, value]| value),
        time_of_largest_s: largest.map(|[time, _]| time),
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
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.7}"));
    let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.5e}"));
    vec![
        channel.name.clone(),
        channel.unit.clone().unwrap_or_else(|| "unknown".into()),
        channel.samples.to_string(),
        channel.gaps.to_string(),
        number(channel.start_s),
        number(channel.end_s),
        channel.step_s.map_or_else(|| "uneven".into(), |step| format!("{step:.7}")),
        figure(channel.smallest),
        number(channel.time_of_smallest_s),
        figure(channel.largest),
        number(channel.time_of_largest_s),
    ]
}
