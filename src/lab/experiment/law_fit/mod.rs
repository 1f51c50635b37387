//! Fits of film laws to measured stresses: which laws there are, the tests that they are fitted to, and the fit.
//!
//! Laws are energies of rubber-like film ([`hyperelastic`]).

mod data_set;
pub mod hyperelastic;
mod intervals;
mod options;
mod quality;
mod reading;
mod result;
mod test_kind;
mod warning;
mod weighting;

pub use data_set::{BiaxialPoint, DataError, DataSet, Measured, range};
pub use hyperelastic::fit_law;
pub use options::{FitError, FitOptions};
pub use quality::Quality;
pub use reading::{StressFault, StressReader, StressReadingError};
pub use result::{Coefficient, LawFit, TestFit};
pub use test_kind::{TestKind, TestKindError};
pub use warning::{CODES, Warning};
pub use weighting::{Weighting, WeightingError};
