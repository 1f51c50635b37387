//! A test as it is written, as it is checked, and as it is simulated.
#![warn(missing_docs)]

pub mod mesh;
pub mod scenario;
pub mod model;
pub mod simulate;
pub mod expectation;
