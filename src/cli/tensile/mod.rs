//! `droptower tensile`: coupon tests, and fits of laws.

mod args;
mod figures;
mod fit;
mod material;
mod output;
mod reduce;

use clap::Subcommand;

use super::{Failure, Shared};

#[derive(Debug, Subcommand)]
pub(super) enum TensileCommand {
    /// Reduce recordings of coupons to moduli, yield points, strength and break, and write them as a material
    Reduce(args::ReduceArgs),
    /// Fit a law, or a relaxation, to measured data, and write it as a material
    Fit(fit::FitArgs),
}

pub(super) fn run(command: &TensileCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        TensileCommand::Reduce(args) => reduce::run(args, shared),
        TensileCommand::Fit(args) => fit::run(args, shared),
    }
}
