//! `droptower signal`: what is done to recordings without a simulation.

pub mod input;

mod convert;
mod filter;
mod info;
mod output;

use std::process::ExitCode;

use clap::Subcommand;

use super::Shared;

#[derive(Debug, Subcommand)]
pub enum SignalCommand {
    /// Say what recordings hold: channels, units, sampling, gaps
    Info(info::InfoArgs),
    /// Filter a channel by its frequency class
    Filter(filter::FilterArgs),
    /// Write a recording in another format
    Convert(convert::ConvertArgs),
}

pub fn run(command: &SignalCommand, shared: &Shared) -> ExitCode {
    match command {
        SignalCommand::Info(args) => info::run(args, shared),
        SignalCommand::Filter(args) => filter::run(args, shared),
        SignalCommand::Convert(args) => convert::run(args, shared),
    }
}
