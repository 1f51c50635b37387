//! `droptower signal`: recordings without a simulation.

pub(super) mod input;

mod acceleration;
mod clip;
mod convert;
mod filter;
mod hic;
mod info;
pub(crate) mod output;
mod rate;
pub(crate) mod remarks;

use clap::Subcommand;

use super::{Failure, Shared};

#[derive(Debug, Subcommand)]
pub(super) enum SignalCommand {
    /// Show the content of recordings: channels, units, sampling, gaps
    Info(info::InfoArgs),
    /// Filter a channel by its frequency class
    Filter(filter::FilterArgs),
    /// Write a recording in another format
    Convert(convert::ConvertArgs),
    /// Head injury criterion of an acceleration
    Hic(hic::HicArgs),
    /// Level that an acceleration holds for 3 ms
    Clip(clip::ClipArgs),
    /// Rate one recording against another (ISO/TS 18571)
    Rate(rate::RateArgs),
}

pub(super) fn run(command: &SignalCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        SignalCommand::Info(args) => info::run(args, shared),
        SignalCommand::Filter(args) => filter::run(args, shared),
        SignalCommand::Convert(args) => convert::run(args, shared),
        SignalCommand::Hic(args) => hic::run(args, shared),
        SignalCommand::Clip(args) => clip::run(args, shared),
        SignalCommand::Rate(args) => rate::run(args, shared),
    }
}
