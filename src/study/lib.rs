//! Runs and their figures, and what starts many of them: scripts, searches, sweeps.
#![warn(missing_docs)]

pub mod store;
pub mod script;
pub mod functions;
pub mod field_comparison;
pub mod post;
pub mod evaluate;
pub mod scenario_functions;
pub mod identify;
pub mod sweep;
pub mod calibrate;
pub mod codes;
pub mod reference;
