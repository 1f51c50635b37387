//! `droptower tensile fit`: a law fitted to measured stresses, or a series to a relaxation modulus.

mod args;
mod fitted;
mod law;
mod law_figures;
mod law_page;
mod plastic;
mod relaxation;
mod relaxation_figures;
mod relaxation_page;
mod written;

pub(super) use args::FitArgs;

use args::FittedLaw;

use crate::{Failure, Shared};
use base::diagnostic::Diagnostic;

pub(super) fn run(args: &FitArgs, shared: &Shared) -> Result<(), Failure> {
    match args.law {
        Some(FittedLaw::Plastic(form)) => plastic::run(form, args, shared),
        Some(FittedLaw::Stresses(law)) => {
            refuse(args.poisson.is_some(), "--poisson", "plastic laws and of relaxation")?;
            refuse(!args.plastic.directions.is_empty(), "--directions", "plastic laws")?;
            law::run(law, args, shared)
        }
        None => relaxation::run(args, shared),
    }
}

/// Refuses an option that is given but without effect.
fn refuse(is_given: bool, option: &str, of: &str) -> Result<(), Diagnostic> {
    if is_given { Err(Diagnostic::new(format!("{option} is an option of {of}")).hint("leave it out")) } else { Ok(()) }
}
