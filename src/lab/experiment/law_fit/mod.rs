//! Fits of film laws to measured stresses: which laws there are, the tests that they are fitted to, and the fit.
//!
//! A family of laws is one module with an arm in [`LawChoice`] and in [`fit_law`]; tests, weights, figures, intervals
//! and findings are common to all.

mod choice;
mod data_set;
mod fit;
pub mod hyperelastic;
mod intervals;
mod options;
mod quality;
mod reading;
mod result;
mod test_kind;
mod warning;
mod weighting;

pub use choice::{LawChoice, LawChoiceError};
pub use data_set::{BiaxialPoint, DataError, DataSet, Measured, range};
pub use fit::fit_law;
pub use options::{FitError, FitOptions};
pub use quality::Quality;
pub use reading::{StressFault, StressReader, StressReadingError};
pub use result::{Coefficient, LawFit, TestFit};
pub use test_kind::{TestKind, TestKindError};
pub use warning::{CODES, Warning};
pub use weighting::{Weighting, WeightingError};
