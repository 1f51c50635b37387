//! Fits of film laws to measured stresses: which laws there are, the tests that they are fitted to, and the fit.
//!
//! Laws are energies of rubber-like film ([`hyperelastic`]).

mod data_set;
pub mod hyperelastic;
mod options;
mod reading;
mod result;
mod test_kind;
mod warning;

pub use data_set::{BiaxialPoint, DataSet, Measured, range};
pub use hyperelastic::fit_law;
pub use options::{FitOptions, Weighting};
pub use reading::StressReader;
pub use result::{Coefficient, LawFit, Quality, TestFit};
pub use test_kind::TestKind;
pub use warning::{CODES, Warning};
