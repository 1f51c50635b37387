//! `droptower signal`: what is done to recordings without a simulation.

pub mod input;

mod info;

use std::process::ExitCode;

use clap::Subcommand;

use super::Shared;

#[derive(Debug, Subcommand)]
pub enum SignalCommand {
    /// Say what recordings hold: channels, units, sampling, gaps
    Info(info::InfoArgs),
}

pub fn run(command: &SignalCommand, shared: &Shared) -> ExitCode {
    match command {
        SignalCommand::Info(args) => info::run(args, shared),
    }
}
