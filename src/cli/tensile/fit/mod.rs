//! `droptower tensile fit`: a law fitted to measured stresses, or a relaxation to a measured modulus.

mod args;

pub(super) use args::FitArgs;

use crate::cli::{Failure, Shared};
use crate::diagnostic::Diagnostic;

pub(super) fn run(args: &FitArgs, _shared: &Shared) -> Result<(), Failure> {
    match &args.law {
        Some(law) => Err(Diagnostic::new(format!("fits of `{law}` are not supported yet")).into()),
        None => Err(Diagnostic::new("fits of relaxation are not supported yet").into()),
    }
}
