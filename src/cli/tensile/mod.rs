//! `droptower tensile`: coupon tests.

mod args;
mod figures;
mod material;
mod output;
mod reduce;

use clap::Subcommand;

use super::{Failure, Shared};

#[derive(Debug, Subcommand)]
pub(super) enum TensileCommand {
    /// Reduce recordings of coupons to moduli, yield points, strength and break, and write them as a material
    Reduce(args::ReduceArgs),
}

pub(super) fn run(command: &TensileCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        TensileCommand::Reduce(args) => reduce::run(args, shared),
    }
}
