//! `droptower signal`: what is done to recordings without a simulation.

pub mod input;

mod drop;
mod info;
mod output;

use std::process::ExitCode;

use clap::Subcommand;

use super::Shared;

#[derive(Debug, Subcommand)]
pub enum SignalCommand {
    /// Say what recordings hold: channels, units, sampling, gaps
    Info(info::InfoArgs),
    /// Contact, speed, travel, energies and absorption of a drop test
    Drop(drop::DropArgs),
}

pub fn run(command: &SignalCommand, shared: &Shared) -> ExitCode {
    match command {
        SignalCommand::Info(args) => info::run(args, shared),
        SignalCommand::Drop(args) => drop::run(args, shared),
    }
}
