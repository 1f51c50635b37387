//! `droptower signal filter` and `convert`: recordings written anew.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use crate::args::{Choice, choice, words_of};
use crate::output::ends_in;
use crate::signal::{self, Chosen, FileArgs, Input, remarks, with_notes};
use crate::{Failure, Shared, failure, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::removed;
use base::units::{Dimension, Frequency};
use lab::signal::file::ChannelSelection;
use lab::signal::filter::{self, Standard};
use lab::signal::{Annotations, Channel, MeasuredChannel, Measurement, Recording, Series, Warning, gap, resample};

#[derive(Debug, Args)]
pub(crate) struct FilterArgs {
    #[command(flatten)]
    pub input: Input,
    /// Channel frequency class: 1000 or CFC1000, 600, 180, 60 (a name, not hertz)
    #[arg(long, value_name = "CFC", value_parser = signal::class)]
    pub class: f64,
    /// The standard; the two differ in one constant
    #[arg(long, value_parser = choice(&STANDARDS), default_value = "iso")]
    pub standard: Standard,
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
const STANDARDS: [Choice<Standard>; 2] =
    [("iso", "ISO 6487", Standard::Iso6487), ("sae", "SAE J211-1", Standard::SaeJ211)];

pub(crate) fn filter(args: &FilterArgs, shared: &Shared) -> Result<(), Failure> {
    signal::check_table(&args.out, &args.input.path, args.force)?;
    let Chosen { channel, mut annotations } = args.input.read()?;
    annotations.warnings.extend(signal::filtered_before(&channel));
    annotations.warnings.extend(signal::unusual_class(args.class));
    let even = even(args, &channel.series)?;
    annotations.warnings.extend(aliasing(&channel.series, &even));
    let series = filter::channel(&even, args.class, args.standard)
        .map_err(|error| failure::content(&args.input.path, &error))?;
    let values = Channel { name: "value".into(), values: series.values().to_vec() };
    let recording = Recording { time: series.time().to_vec(), channels: vec![values] };
    let [_, standard] = words_of(&STANDARDS, &args.standard);
    let comments: Vec<String> =
        origin(args, &channel, standard).into_iter().chain(annotations.comments().iter().cloned()).collect();
    signal::write_csv(&args.out, &comments, &recording)?;
    let ends =
        |of: fn(&Series) -> Option<[f64; 2]>| [&channel.series, &series].map(|one| of(one).map(|[_, value]| value));
    let (largest, smallest) = (ends(Series::largest), ends(Series::smallest));
    let [path, out] = [&args.input.path, &args.out].map(|path| shown_path(path));
    let (class, samples, unit) = (args.class, series.len(), channel.value_unit());
    let figures = json!({
        "path": path,
        "channel": channel.name,
        "class": class,
        "standard": standard,
        "samples": samples,
        "unit": unit,
        "largest_before": largest[0],
        "largest_after": largest[1],
        "smallest_before": smallest[0],
        "smallest_after": smallest[1],
        "out": out,
    });
    print_figures(shared, &with_notes(figures, &annotations), || {
        let unit = unit.as_deref().unwrap_or("(unit unknown)");
        let number = |value: Option<f64>| value.map_or_else(|| "-".into(), |value| format!("{value:.6}"));
        let extremes = [("largest", largest), ("smallest", smallest)].map(|(word, ends)| {
            let [before, after] = ends.map(number);
            format!("  {word:8}  {before} {unit} before, {after} {unit} after\n")
        });
        let samples = if samples == 1 { "1 sample".to_owned() } else { format!("{samples} samples") };
        let (channel, extremes, remarks) = (&channel.name, extremes.concat(), remarks(&annotations));
        format!("{path}: `{channel}` through CFC {class} ({standard})\n{extremes}{remarks}  {out}: {samples}")
    })
}

/// The description of the output: the quantity, its source, and how it was filtered.
fn origin(args: &FilterArgs, channel: &MeasuredChannel, standard: &str) -> Vec<String> {
    let unit = channel.value_unit().unwrap_or_else(|| "unknown, as written".into());
    vec![
        format!("value: {} of {}", channel.label, shown_path(&args.input.path)),
        format!("unit of value: {unit}"),
        format!("filtered by droptower: CFC {} ({standard})", args.class),
    ]
}

/// The series on equal steps, resampled only where the user asks for it.
fn even(args: &FilterArgs, series: &Series) -> Result<Series, Diagnostic> {
    let Some(rate) = args.resample else {
        return Ok(series.clone());
    };
    let even = gap::check(series).map_err(lab::Error::from).and_then(|()| resample::uniform(series, 1.0 / rate));
    even.map_err(|error| failure::content(&args.input.path, &error))
}

/// The report of samples that are left out: frequencies above half the new rate fold into lower ones.
fn aliasing(before: &Series, after: &Series) -> Option<Warning> {
    (after.len() < before.len()).then_some(Warning::Aliasing { before: before.len(), after: after.len() })
}

/// A rate in Hz, or with its unit.
fn rate(text: &str) -> Result<f64, String> {
    let dimension: Dimension = Frequency::DIMENSION;
    let rate = text.parse::<f64>().ok().map_or_else(|| dimension.parse(text).map_err(|error| error.to_string()), Ok)?;
    if rate > 0.0 && rate.is_finite() { Ok(rate) } else { Err(format!("a rate of {rate} Hz is not positive")) }
}

#[derive(Debug, Args)]
pub(crate) struct ConvertArgs {
    /// The recording; `droptower explain formats` lists what is read
    pub path: PathBuf,
    /// Channels to write [default: all]
    #[arg(long, value_name = "NAME")]
    pub column: Vec<String>,
    #[command(flatten)]
    pub file: FileArgs,
    /// A table (.csv); values in SI
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Replace the table where it exists
    #[arg(long)]
    pub force: bool,
}

pub(crate) fn convert(args: &ConvertArgs, shared: &Shared) -> Result<(), Failure> {
    if !ends_in(&args.out, "csv") {
        let ending = format!(".{}", args.out.extension().unwrap_or_default().to_string_lossy());
        let gone = removed::command(&["signal".into(), "convert".into(), ending]);
        let mistake = Diagnostic::new(format!("{} does not end in .csv", shown_path(&args.out)));
        return Err(mistake.hint(gone.map_or("name it .csv".into(), |(_, instead)| instead)).into());
    }
    signal::check_table(&args.out, &args.path, args.force)?;
    let channels = match &args.column[..] {
        [] => ChannelSelection::All,
        names => ChannelSelection::Named(names.to_vec()),
    };
    let found = args.file.read(&args.path, channels)?;
    signal::write_csv(&args.out, &comments(&found), &shared_axis(&found, &args.path)?)?;
    let [path, out] = [&args.path, &args.out].map(|path| shown_path(path));
    let names: Vec<&str> = found.channels.iter().map(|channel| channel.name.as_str()).collect();
    let figures = json!({ "path": path, "out": out, "channels": names });
    print_figures(shared, &with_notes(figures, &found.annotations), || {
        let called = found.channels.iter().map(called).collect::<Vec<_>>().join(", ");
        format!("{path}\n{}  {out}: {called}", remarks(&found.annotations))
    })
}

/// The channels over their one time axis.
fn shared_axis(found: &Measurement, path: &Path) -> Result<Recording, Diagnostic> {
    found.recording().ok_or_else(|| {
        let mistake = format!("{}: its channels do not share one time axis", shown_path(path));
        Diagnostic::new(mistake).hint("take those that do: --column NAME --column NAME")
    })
}

/// The comments of the file, the long names of codes, and the classes of filters. What reading it assumed is explicit in the table.
fn comments(found: &Measurement) -> Vec<String> {
    let is_new = |channel: &&MeasuredChannel| !channel.label.starts_with(&channel.name);
    let names = found.channels.iter().filter(is_new);
    let names: Vec<String> = names.map(|channel| Annotations::name_comment(&channel.name, &channel.label)).collect();
    let class = |channel: &MeasuredChannel| Some(Annotations::filter_comment(&channel.name, channel.filtered?));
    let classes = found.channels.iter().filter(|channel| found.annotations.filter_class(&channel.name).is_none());
    let classes: Vec<String> = classes.filter_map(class).collect();
    found.annotations.comments().iter().cloned().chain(names).chain(classes).collect()
}

/// A channel by its name, and by its long name where that is another.
fn called(channel: &MeasuredChannel) -> String {
    let MeasuredChannel { name, label, .. } = channel;
    if label.starts_with(name.as_str()) { name.clone() } else { format!("{name} ({label})") }
}
