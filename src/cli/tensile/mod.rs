//! `droptower tensile`: coupon tests, and fits of laws.

mod args;
mod bulge;
mod coupling;
mod figures;
mod fit;
mod material;
mod output;
mod reduce;
mod wide;

use clap::Subcommand;

use super::{Failure, Shared};

#[derive(Debug, Subcommand)]
pub(super) enum TensileCommand {
    /// Reduce recordings of coupons to moduli, yield points, strength and break, and write them as a material
    Reduce(args::ReduceArgs),
    /// Reduce recordings of bulges, pressure and height, to stress over strain in both directions, and to the coupling of MD and TD
    Bulge(args::BulgeArgs),
    /// Reduce recordings of coupons that are wide for their length, so that their width is held, likewise
    Wide(args::WideArgs),
    /// Fit a law, or a relaxation, to measured data, and write it as a material
    Fit(fit::FitArgs),
}

pub(super) fn run(command: &TensileCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        TensileCommand::Reduce(args) => reduce::run(args, shared),
        TensileCommand::Bulge(args) => bulge::run(args, shared),
        TensileCommand::Wide(args) => wide::run(args, shared),
        TensileCommand::Fit(args) => fit::run(args, shared),
    }
}
