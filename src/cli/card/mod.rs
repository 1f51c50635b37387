//! `droptower card`: films in the formats of other solvers.

pub(super) mod explain;
mod read;
pub(crate) mod request;
pub(crate) mod source;
mod write;

use clap::Subcommand;

use super::{Failure, Shared};

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
