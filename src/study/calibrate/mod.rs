//! Calibration: the parameters for which several tests and their recordings agree, what the tests tell of each, and what
//! follows for other scenarios (docs/methods.md, section 28).
//!
//! A script lists tests and parameters; [`register`] offers it `calibrate`. A `Plan` is that list, checked. The
//! objective of its search has independent residuals of unit variance, because each signal is compared through its
//! `ErrorModel`. Its linearization gives a verdict on each parameter, its posterior is sampled on
//! surrogates of the tests, and predictions take their parameters from that.

mod angles;
mod bindings;
mod candidates;
mod distance;
mod error_model;
mod file;
mod fit;
mod left_out;
mod mesh;
mod objective;
mod outcome;
mod parameter;
mod plan;
mod posterior;
mod pulled;
mod prediction;
mod recorded_test;
mod rows;
mod verdict;
mod warning;

pub use bindings::register;
pub use file::{StudyFile, rule, schema};
pub use warning::CODES;
