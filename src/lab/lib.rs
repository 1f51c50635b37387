//! The laboratory: recordings as signals and fields, their reduction to curves, figures and laws, and how well these are known.
#![warn(missing_docs)]

pub mod signal;
pub mod field;
pub mod confidence;
pub mod experiment;
