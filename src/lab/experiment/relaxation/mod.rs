//! Relaxation of film: Prony series of a modulus over time.

mod prony;
mod reading;

pub use prony::{CODES, Prony, PronyError, PronyFit, Warning, fit_prony};
pub use reading::{RelaxationFault, RelaxationReadingError, read_relaxation};
