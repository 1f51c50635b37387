//! Relaxation of film: Prony series of a modulus over time, master curves of several temperatures, and the laws of their
//! shift factors.

mod master;
mod prony;
mod reading;
mod shift;
mod warning;

pub use master::{Master, MasterError, Relaxation, ShiftFactor};
pub use prony::{Prony, PronyError, PronyFit, fit_prony};
pub use reading::{RelaxationData, RelaxationFault, RelaxationReadingError, read_relaxation, read_shift_factors};
pub use shift::{Arrhenius, GAS_CONSTANT, ShiftFits, ShiftLaw, ShiftLawFit, Wlf, fit_shift};
pub use warning::{CODES, Warning};

/// Zero of the Celsius scale, K.
pub const ZERO_CELSIUS: f64 = 273.15;
