//! `droptower tensile fit`: a law fitted to measured stresses, or a series to a relaxation modulus.

mod args;
mod fitted;
mod law;
mod law_figures;
mod law_page;
mod relaxation;
mod relaxation_figures;
mod relaxation_page;
mod written;

pub(super) use args::FitArgs;

use crate::cli::{Failure, Shared};

pub(super) fn run(args: &FitArgs, shared: &Shared) -> Result<(), Failure> {
    match args.law {
        Some(law) => law::run(law, args, shared),
        None => relaxation::run(args, shared),
    }
}
