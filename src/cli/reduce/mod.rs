//! `droptower reduce`: measured drops and coupons, reduced to figures and to a material.

mod biaxial;
pub(crate) mod coupon;
mod drop;

use clap::Subcommand;

use crate::{Failure, Shared};

#[derive(Debug, Subcommand)]
pub(super) enum ReduceCommand {
    /// Contact, speed, travel, energies and absorption of drop tests
    Drop(drop::DropArgs),
    /// Moduli, yield points, strength and break of coupons, and their material file
    Coupon(coupon::ReduceCouponArgs),
    /// Stress over strain in both directions, and the coupling of MD and TD, from bulges: pressure and height
    Bulge(biaxial::BulgeArgs),
    /// The same from coupons that are wide for their length, so that their width is held
    Wide(biaxial::WideArgs),
}

pub(super) fn run(command: &ReduceCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        ReduceCommand::Drop(args) => drop::run(args, shared),
        ReduceCommand::Coupon(args) => coupon::run(args, shared),
        ReduceCommand::Bulge(args) => biaxial::bulge(args, shared),
        ReduceCommand::Wide(args) => biaxial::wide(args, shared),
    }
}
