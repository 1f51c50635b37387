//! Fits of film laws to measured stresses: which laws there are, the tests that they are fitted to, and the fit.
//!
//! A family of laws is one module with an arm in [`LawChoice`]; tests, weights, figures and findings are common to all.

mod choice;
pub mod hyperelastic;

pub use choice::{LawChoice, LawChoiceError};
