//! `droptower tensile fit`: a law fitted to measured stresses, or a series to a relaxation modulus.

mod args;
mod law;
mod relaxation;
mod written;

use crate::{Failure, Shared};
use base::diagnostic::Diagnostic;

pub(super) use args::FitArgs;

pub(super) fn run(args: &FitArgs, shared: &Shared) -> Result<(), Failure> {
    match args.law {
        Some(_) if args.poisson.is_some() => {
            Err(Diagnostic::new("--poisson is an option of relaxation").hint("leave it out").into())
        }
        Some(law) => law::run(law, args, shared),
        None => relaxation::run(args, shared),
    }
}
