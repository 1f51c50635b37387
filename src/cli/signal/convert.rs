//! `droptower signal convert`: a recording in another format.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use serde::Serialize;

use super::input::FileArgs;
use super::output::{self, Failure};
use crate::cli::output::ends_in;
use crate::cli::{BAD_INPUT, Shared, print, print_json, report};
use crate::diagnostic::{Diagnostic, shown_path};
use crate::signal::file::Selection;
use crate::signal::isomme::{self, WriteError};

#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// The recording: CSV or ISO-MME
    pub path: PathBuf,
    /// Channels to take; all where it is left out
    #[arg(long, value_name = "NAME")]
    pub column: Vec<String>,
    #[command(flatten)]
    pub file: FileArgs,
    /// A table (.csv), or a test (.mme) with its folder Channel; values in SI
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Replace the table where it is there already; a test never is
    #[arg(long)]
    pub force: bool,
}

/// What was written.
#[derive(Serialize)]
struct Converted {
    path: String,
    out: String,
    channels: Vec<String>,
    notes: Vec<String>,
}

pub fn run(args: &ConvertArgs, shared: &Shared) -> ExitCode {
    let done = match converted(args) {
        Ok(done) => done,
        Err((status, mistake)) => {
            report(&[mistake]);
            return ExitCode::from(status);
        }
    };
    if shared.json {
        return print_json(&done);
    }
    if shared.quiet {
        return ExitCode::SUCCESS;
    }
    let notes: String = done.notes.iter().map(|note| format!("  note: {note}\n")).collect();
    print(&format!("{}\n{notes}  {}: {}", done.path, done.out, done.channels.join(", ")))
}

fn converted(args: &ConvertArgs) -> Result<Converted, Failure> {
    let bad = |mistake| (BAD_INPUT, mistake);
    let as_test = ends_in(&args.out, "mme");
    if !as_test && !ends_in(&args.out, "csv") {
        return Err(bad(Diagnostic::new(format!("{} is neither .csv nor .mme", shown_path(&args.out)))));
    }
    if !as_test {
        output::check_table(&args.out, &args.path, args.force)?;
    }
    let channels = match &args.column[..] {
        [] => Selection::All,
        names => Selection::Named(names.to_vec()),
    };
    let found = args.file.read(&args.path, channels).map_err(bad)?;
    if as_test {
        isomme::write(&args.out, &found).map_err(|error| match error {
            WriteError::Write { .. } => output::failed(&args.out, &error),
            _ => bad(Diagnostic::new(error.to_string())),
        })?;
    } else {
        let several = || {
            let mistake = format!("{}: its channels do not share one time axis", shown_path(&args.path));
            bad(Diagnostic::new(mistake).hint("take those that do: --column NAME --column NAME"))
        };
        output::write_csv(&args.out, &found.notes, &found.recording().ok_or_else(several)?)?;
    }
    Ok(Converted {
        path: shown_path(&args.path),
        out: shown_path(&args.out),
        channels: found.channels.into_iter().map(|channel| channel.name).collect(),
        notes: found.notes,
    })
}
