//! The laboratory: recordings as signals and fields, their reduction to curves, figures and laws, and how well these are known.
#![warn(missing_docs)]

pub mod error;
pub mod signal;
pub mod dic;
pub mod confidence;
pub mod experiment;

pub use error::Error;
