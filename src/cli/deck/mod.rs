//! `droptower deck`: whole tests for other solvers, and meshes of theirs.

mod folder;
mod read;
mod scene;
mod write;

use clap::Subcommand;

use super::{Failure, Shared};

#[derive(Debug, Subcommand)]
pub(super) enum DeckCommand {
    /// Write a drop test as a deck of LS-DYNA, OpenRadioss or CalculiX
    Write(write::WriteArgs),
    /// Read the mesh of a part as a VTU file for `specimen.shape.mesh`
    Read(read::ReadArgs),
}

pub(super) fn run(command: &DeckCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        DeckCommand::Write(args) => write::run(args, shared),
        DeckCommand::Read(args) => read::run(args, shared),
    }
}
