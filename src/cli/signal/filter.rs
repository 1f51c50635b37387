//! `droptower signal filter`: a channel through its frequency class.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::input::{self, Chosen, Input};
use super::output;
use super::remarks::Remarks;
use crate::{Failure, Shared, faults, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::units::{Dimension, Frequency};
use lab::Error;
use lab::signal::filter::{self, Standard};
use lab::signal::{Channel, MeasuredChannel, Recording, Series, Warning, resample};

#[derive(Debug, Args)]
pub(crate) struct FilterArgs {
    #[command(flatten)]
    pub input: Input,
    /// Channel frequency class: 1000 or CFC1000, 600, 180, 60 (a name, not hertz)
    #[arg(long, value_name = "CFC", value_parser = input::class)]
    pub class: f64,
    /// The standard; the two differ in one constant
    #[arg(long, value_enum, default_value = "iso")]
    pub standard: Named,
    /// Resample uneven samples to this rate first, e.g. "10 kHz"
    #[arg(long, value_name = "RATE", value_parser = rate)]
    pub resample: Option<f64>,
    /// The file to write: a description in lines with `#`, then the columns time_s and value (SI)
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Replace the file where it exists
    #[arg(long)]
    pub force: bool,
}

/// The standards by their short names.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Named {
    /// ISO 6487
    Iso,
    /// SAE J211-1
    Sae,
}

/// A recording after the filter.
#[derive(Serialize)]
struct Filtered {
    path: String,
    channel: String,
    class: f64,
    standard: &'static str,
    samples: usize,
    unit: Option<String>,
    largest_before: Option<f64>,
    largest_after: Option<f64>,
    smallest_before: Option<f64>,
    smallest_after: Option<f64>,
    out: String,
    #[serde(flatten)]
    remarks: Remarks,
}

pub(super) fn run(args: &FilterArgs, shared: &Shared) -> Result<(), Failure> {
    let done = filtered(args)?;
    print_figures(shared, &done, || text(&done))
}

fn filtered(args: &FilterArgs) -> Result<Filtered, Failure> {
    output::check_table(&args.out, &args.input.path, args.force)?;
    let Chosen { channel, mut annotations } = args.input.read()?;
    annotations.warnings.extend(input::filtered_before(&channel));
    annotations.warnings.extend(input::unusual_class(args.class));
    let even = even(args, &channel.series)?;
    annotations.warnings.extend(aliasing(&channel.series, &even));
    let series = filter::channel(&even, args.class, args.standard.into()).map_err(|error| mistake(args, &error))?;
    let values = Channel { name: "value".into(), values: series.values().to_vec() };
    let recording = Recording { time: series.time().to_vec(), channels: vec![values] };
    let comments: Vec<String> =
        origin(args, &channel).into_iter().chain(annotations.comments().iter().cloned()).collect();
    output::write_csv(&args.out, &comments, &recording)?;
    let value = |extreme: Option<[f64; 2]>| extreme.map(|[_, value]| value);
    Ok(Filtered {
        path: shown_path(&args.input.path),
        channel: channel.name.clone(),
        class: args.class,
        standard: args.standard.text(),
        samples: series.len(),
        unit: channel.value_unit(),
        largest_before: value(channel.series.largest()),
        largest_after: value(series.largest()),
        smallest_before: value(channel.series.smallest()),
        smallest_after: value(series.smallest()),
        out: shown_path(&args.out),
        remarks: (&annotations).into(),
    })
}

/// The description of the output: the quantity, its source, and how it was filtered.
fn origin(args: &FilterArgs, channel: &MeasuredChannel) -> Vec<String> {
    let unit = channel.value_unit().unwrap_or_else(|| "unknown, as written".into());
    vec![
        format!("value: {} of {}", channel.label, shown_path(&args.input.path)),
        format!("unit of value: {unit}"),
        format!("filtered by droptower: CFC {} ({})", args.class, args.standard.text()),
    ]
}

/// The series on equal steps, resampled only where the user asks for it.
fn even(args: &FilterArgs, series: &Series) -> Result<Series, Diagnostic> {
    let Some(rate) = args.resample else {
        return Ok(series.clone());
    };
    let name = shown_path(&args.input.path);
    filter::check_complete(series).map_err(|error| mistake(args, &error))?;
    resample::uniform(series, 1.0 / rate).map_err(|error| Diagnostic::new(format!("{name}: {error}")))
}

/// The report of samples that are left out: frequencies above half the new rate fold into lower ones.
fn aliasing(before: &Series, after: &Series) -> Option<Warning> {
    (after.len() < before.len()).then_some(Warning::Aliasing { before: before.len(), after: after.len() })
}

fn mistake(args: &FilterArgs, error: &Error) -> Diagnostic {
    faults::content(&args.input.path, error)
}

fn text(done: &Filtered) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| "-".into(), |value| format!("{value:.6}"));
    let unit = done.unit.as_deref().unwrap_or("(unit unknown)");
    let remarks = done.remarks.lines();
    let extremes =
        [("largest", done.largest_before, done.largest_after), ("smallest", done.smallest_before, done.smallest_after)];
    let extremes = extremes.map(|(word, before, after)| {
        format!("  {word:8}  {} {unit} before, {} {unit} after\n", number(before), number(after))
    });
    let head = format!("{}: `{}` through CFC {} ({})", done.path, done.channel, done.class, done.standard);
    let samples = if done.samples == 1 { "sample" } else { "samples" };
    format!("{head}\n{}{remarks}  {}: {} {samples}", extremes.concat(), done.out, done.samples)
}

/// A rate in Hz, or with its unit.
fn rate(text: &str) -> Result<f64, String> {
    let dimension: Dimension = Frequency::DIMENSION;
    let rate = text.parse::<f64>().ok().map_or_else(|| dimension.parse(text).map_err(|error| error.to_string()), Ok)?;
    if rate > 0.0 && rate.is_finite() { Ok(rate) } else { Err(format!("a rate of {rate} Hz is not positive")) }
}

impl Named {
    fn text(self) -> &'static str {
        match self {
            Named::Iso => "ISO 6487",
            Named::Sae => "SAE J211-1",
        }
    }
}

impl From<Named> for Standard {
    fn from(named: Named) -> Standard {
        match named {
            Named::Iso => Standard::Iso6487,
            Named::Sae => Standard::SaeJ211,
        }
    }
}
