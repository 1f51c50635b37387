//! `droptower signal convert`: a recording in another format.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::input::FileArgs;
use super::output;
use super::remarks::Remarks;
use crate::output::ends_in;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::removed;
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
    /// A table (.csv); values in SI
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Replace the table where it exists
    #[arg(long)]
    pub force: bool,
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
    if !ends_in(&args.out, "csv") {
        let ending = format!(".{}", args.out.extension().unwrap_or_default().to_string_lossy());
        let gone = removed::command(&["signal".into(), "convert".into(), ending]);
        let mistake = Diagnostic::new(format!("{} does not end in .csv", shown_path(&args.out)));
        return Err(mistake.hint(gone.map_or("name it .csv".into(), |(_, instead)| instead)).into());
    }
    output::check_table(&args.out, &args.path, args.force)?;
    let channels = match &args.column[..] {
        [] => ChannelSelection::All,
        names => ChannelSelection::Named(names.to_vec()),
    };
    let found = args.file.read(&args.path, channels)?;
    output::write_csv(&args.out, &comments(&found), &shared_axis(&found, &args.path)?)?;
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
