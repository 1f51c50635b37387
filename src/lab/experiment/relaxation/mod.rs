//! Relaxation of film: Prony series of a modulus over time.

mod prony;
mod reading;
mod warning;

pub use prony::{Prony, PronyError, PronyFit, fit_prony};
pub use reading::{RelaxationFault, RelaxationReadingError, read_relaxation};
pub use warning::{CODES, Warning};
