//! `droptower export`: films and whole tests in the formats of other solvers.

pub(crate) mod card;
mod deck;

use clap::Subcommand;

use super::{Failure, Shared};

#[derive(Debug, Subcommand)]
pub(super) enum ExportCommand {
    /// Write the film of a material, a scenario or a run as a card of another solver
    Card(card::CardArgs),
    /// Write a drop test as a deck of LS-DYNA or OpenRadioss
    Deck(deck::DeckArgs),
}

pub(super) fn run(command: &ExportCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        ExportCommand::Card(args) => card::run(args, shared),
        ExportCommand::Deck(args) => deck::run(args, shared),
    }
}
