//! `droptower signal convert`: a recording in another format.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::input::FileArgs;
use super::output;
use super::remarks::Remarks;
use crate::output::{check, ends_in, write};
use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::removed;
use base::table;
use lab::signal::file::ChannelSelection;
use lab::signal::{Annotations, MeasuredChannel, Measurement, Recording};

#[derive(Debug, Args)]
pub(crate) struct ConvertArgs {
    /// The recording; `droptower explain formats` lists what is read
    pub path: PathBuf,
    /// Channels to write [default: all]
    #[arg(long, value_name = "NAME")]
    pub column: Vec<String>,
    #[command(flatten)]
    pub file: FileArgs,
    /// A table (.csv, .parquet); values in SI
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Replace the table where it exists
    #[arg(long)]
    pub force: bool,
}

/// The format that a recording is converted to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    Table,
    /// A table in Apache Parquet.
    Parquet,
}

impl Format {
    /// By the ending of the file.
    fn from_path(out: &Path) -> Result<Format, Diagnostic> {
        let endings = [("csv", Format::Table), ("parquet", Format::Parquet)];
        let found = endings.into_iter().find(|(ending, _)| ends_in(out, ending)).map(|(_, format)| format);
        found.ok_or_else(|| {
            let mistake = Diagnostic::new(format!("{} ends in none of .csv and .parquet", shown_path(out)));
            let ending = format!(".{}", out.extension().unwrap_or_default().to_string_lossy());
            let gone = removed::command(&["signal".into(), "convert".into(), ending]);
            mistake.hint(gone.map_or("the ending names the format".into(), |(_, instead)| instead))
        })
    }
}

/// The channels that were written.
#[derive(Serialize)]
struct Converted {
    path: String,
    out: String,
    channels: Vec<String>,
    /// Names with the long names of codes, for the terminal.
    #[serde(skip)]
    called: Vec<String>,
    #[serde(flatten)]
    remarks: Remarks,
}

pub(super) fn run(args: &ConvertArgs, shared: &Shared) -> Result<(), Failure> {
    let done = converted(args)?;
    print_figures(shared, &done, || {
        format!("{}\n{}  {}: {}", done.path, done.remarks.lines(), done.out, done.called.join(", "))
    })
}

fn converted(args: &ConvertArgs) -> Result<Converted, Failure> {
    let format = Format::from_path(&args.out)?;
    match format {
        Format::Table => output::check_table(&args.out, &args.path, args.force)?,
        Format::Parquet => check(&args.out, "parquet", Some(&args.path), Some(args.force))?,
    }
    let channels = match &args.column[..] {
        [] => ChannelSelection::All,
        names => ChannelSelection::Named(names.to_vec()),
    };
    let found = args.file.read(&args.path, channels)?;
    match format {
        Format::Table => output::write_csv(&args.out, &comments(&found), &shared_axis(&found, &args.path)?)?,
        Format::Parquet => {
            let columns = shared_axis(&found, &args.path)?.columns();
            write(&args.out, |out| out.write_all(&table::to_parquet(&columns, &comments(&found))?))?;
        }
    }
    Ok(Converted {
        path: shown_path(&args.path),
        out: shown_path(&args.out),
        called: found.channels.iter().map(called).collect(),
        remarks: (&found.annotations).into(),
        channels: found.channels.into_iter().map(|channel| channel.name).collect(),
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
