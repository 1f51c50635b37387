//! Fits of film laws to measured stresses: which laws there are, the tests that they are fitted to, and the fit.
//!
//! Laws are energies of rubber-like film ([`hyperelastic`]).

mod data_set;
pub mod hyperelastic;
mod result;
mod warning;

pub use data_set::{BiaxialPoint, DataSet, Measured, StressReader, TestKind, range};
pub use hyperelastic::fit_law;
pub use result::{Coefficient, FitOptions, LawFit, Quality, TestFit, Weighting};
pub use warning::{CODES, Warning};
