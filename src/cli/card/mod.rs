//! `droptower card`: films in the formats of other solvers.

pub(super) mod explain;
mod read;
pub(crate) mod request;
pub(crate) mod source;
mod write;

use std::path::Path;

use clap::Subcommand;

use super::{Failure, Shared};
use ::card::read::Mistake;
use base::diagnostic::{Diagnostic, Source, Span};

#[derive(Debug, Subcommand)]
pub(super) enum CardCommand {
    /// Write the film of a material, a scenario or a run as a card of another solver
    Write(write::WriteArgs),
    /// Read the film of a card as a material
    Read(read::ReadArgs),
}

pub(super) fn run(command: &CardCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        CardCommand::Write(args) => write::run(args, shared),
        CardCommand::Read(args) => read::run(args, shared),
    }
}

/// A mistake in the `text` of a file of another solver, with its line.
pub(crate) fn misread(path: &Path, text: &str, mistake: &Mistake) -> Diagnostic {
    let line = text.lines().nth(mistake.place.line - 1).unwrap_or_default().to_owned();
    let source = Source::excerpt(path, mistake.place.line, line);
    Diagnostic::new(mistake.fault.to_string()).at(&Span::position(&source, 1, mistake.place.column))
}
