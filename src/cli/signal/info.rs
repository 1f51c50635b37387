//! `droptower signal info`: the content of recordings.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};

use crate::failure::split;
use crate::signal::{FileArgs, remarks, with_notes};
use crate::{Failure, Shared, failure, print_figures, terminal};
use base::diagnostic::{Diagnostic, shown_path};
use base::group;
use base::number::{clean_time, significant};
use lab::error::Kind;
use lab::signal::file::{self, ChannelSelection, ReadOptions};
use lab::signal::gap::{self, Gap};
use lab::signal::{Annotations, MeasuredChannel, Warning, resample};

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// The recordings, of any format of `droptower explain formats`; nothing is printed unless all can be read
    #[arg(required = true)]
    pub paths: Vec<PathBuf>,
    #[command(flatten)]
    pub file: FileArgs,
}

/// The content of one file.
#[derive(Serialize)]
struct Contents {
    path: String,
    channels: Vec<Contained>,
    #[serde(skip)]
    annotations: Annotations,
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
    /// The channel frequency class that it was filtered with before, as the file states.
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
    /// Samples that were not measured: without value, or missing altogether.
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
    /// Where samples are missing altogether.
    holes: Vec<Hole>,
}

#[derive(Clone, PartialEq, Serialize)]
struct Hole {
    after_s: f64,
    duration_s: f64,
}

pub(super) fn run(args: &InfoArgs, shared: &Shared) -> Result<(), Failure> {
    let (found, failure) = split(args.paths.iter().map(|path| contents(path, &args.file)));
    if let Some(mut failure) = failure {
        failure.diagnostics.extend(silence(&found));
        return Err(failure);
    }
    let figures: Vec<Value> = found.iter().map(|one| with_notes(json!(one), &one.annotations)).collect();
    print_figures(shared, &figures, || found.iter().map(text).collect::<Vec<_>>().join("\n"))
}

/// The report that readable files are not printed, where others cannot be read: the output is complete or empty.
fn silence(found: &[Contents]) -> Option<Diagnostic> {
    let paths: Vec<&str> = found.iter().map(|contents| contents.path.as_str()).collect();
    let unprinted = || Diagnostic::new(format!("{}: readable, but not printed", paths.join(", ")));
    (!found.is_empty()).then(|| unprinted().hint("leave out what cannot be read"))
}

fn contents(path: &Path, file: &FileArgs) -> Result<Contents, Diagnostic> {
    let options = file.options(ChannelSelection::All)?;
    match file::read(path, &options) {
        Ok(found) => Ok(Contents {
            path: shown_path(path),
            channels: found.channels.iter().map(contained).collect(),
            annotations: found.annotations,
        }),
        Err(error) if *error.kind() == Kind::NoTime => columns(path, &options),
        Err(error) => Err(failure::recording(&error)),
    }
}

/// The content of a table without time, e.g. stress over strain.
fn columns(path: &Path, options: &ReadOptions) -> Result<Contents, Diagnostic> {
    let mut found = file::columns(path, options).map_err(|error| failure::recording(&error))?;
    found.annotations.warnings.push(Warning::NoTimeColumn);
    let channels = found.channels.iter().map(|channel| {
        let samples = Figures::from_values(channel.series.values());
        Contained { samples, time: None, ..contained(channel) }
    });
    Ok(Contents { path: shown_path(path), channels: channels.collect(), annotations: found.annotations })
}

fn contained(channel: &MeasuredChannel) -> Contained {
    let MeasuredChannel { name, label, unit, filtered, series } = channel;
    let time_of = |extreme: Option<[f64; 2]>| extreme.map(|[time, _]| time);
    let time = Sampling {
        start_s: series.time().first().copied(),
        end_s: series.time().last().copied(),
        step_s: resample::common_step(series.time()),
        time_of_smallest_s: time_of(series.smallest()),
        time_of_largest_s: time_of(series.largest()),
        holes: gap::holes(series.time()).filter_map(hole).collect(),
    };
    let missing: usize = gap::holes(series.time()).map(|gap| gap.missing()).sum();
    let of_values = Figures::from_values(series.values());
    Contained {
        name: name.clone(),
        label: label.clone(),
        written_unit: unit.as_ref().map(|unit| unit.symbol().to_owned()),
        unit: channel.value_unit(),
        filtered: *filtered,
        samples: Figures { gaps: of_values.gaps + missing, ..of_values },
        time: Some(time),
    }
}

fn hole(found: Gap) -> Option<Hole> {
    match found {
        Gap::Hole { from, to, .. } => Some(Hole { after_s: from, duration_s: clean_time(to - from) }),
        Gap::Sample { .. } => None,
    }
}

impl Figures {
    fn from_values(values: &[f64]) -> Figures {
        let measured = || values.iter().copied().filter(|value| value.is_finite());
        Figures {
            samples: values.len(),
            gaps: values.len() - measured().count(),
            smallest: measured().reduce(f64::min),
            largest: measured().reduce(f64::max),
        }
    }
}

/// The columns that are printed of a channel.
const COLUMNS: [&str; 13] = [
    "channel",
    "written as",
    "unit",
    "class",
    "samples",
    "gaps",
    "from s",
    "to s",
    "step s",
    "smallest",
    "at s",
    "largest",
    "at s",
];

fn text(contents: &Contents) -> String {
    let rows = contents.channels.iter().map(row);
    let mut lines: Vec<Vec<String>> = std::iter::once(COLUMNS.map(str::to_owned).to_vec()).chain(rows).collect();
    // What the file calls a channel is shown only where that is more than its name.
    let has_labels = contents.channels.iter().any(|channel| channel.label != channel.name);
    if !has_labels {
        lines.iter_mut().for_each(|line| drop(line.remove(1)));
    }
    let lines = terminal::in_columns(&lines, if has_labels { 2 } else { 1 });
    let holes = holes(contents).into_iter().map(|hole| format!("  {hole}"));
    let lines: String = lines.chain(holes).map(|line| line + "\n").collect();
    format!("{}\n{lines}{}", contents.path, remarks(&contents.annotations))
}

/// Most holes that are printed one by one; all of them are in the JSON.
const MOST_HOLES: usize = 5;

/// Where samples are missing, once for the channels that share it.
fn holes(contents: &Contents) -> Vec<String> {
    let with_holes = contents.channels.iter().filter_map(|channel| {
        let holes = channel.time.as_ref().map(|time| &time.holes).filter(|holes| !holes.is_empty());
        Some((holes?, channel.label.as_str()))
    });
    let mut lines = Vec::new();
    for (holes, names) in group::by_key(with_holes) {
        let whose =
            if names.len() == contents.channels.len() { String::new() } else { format!(" in {}", names.join(", ")) };
        let one = |hole: &Hole| {
            format!(
                "hole of {} ms after {} s{whose}",
                significant(1e3 * hole.duration_s, 6),
                significant(hole.after_s, 6)
            )
        };
        lines.extend(holes.iter().take(MOST_HOLES).map(one));
        if holes.len() > MOST_HOLES {
            lines.push(format!("and {} more holes{whose}", holes.len() - MOST_HOLES));
        }
    }
    lines
}

fn row(channel: &Contained) -> Vec<String> {
    let Contained { name, label, unit, filtered, samples, time, .. } = channel;
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
        label.clone(),
        unit.clone().unwrap_or_else(|| "unknown".into()),
        filtered.map_or_else(|| "-".into(), |class| format!("CFC {class}")),
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
