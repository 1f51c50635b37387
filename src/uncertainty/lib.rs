//! Inputs that vary and what follows for outputs (docs/methods.md, section 26): pure mathematics that knows nothing else of
//! droptower.
//!
//! [`distribution`] says how an input varies, [`design`] which points of the unit cube a study evaluates, and
//! [`correlation`] couples them. [`effects`] and [`surrogate`] tell which inputs matter.
//!
//! Every design and every estimate is decided by its seed, with the same bits on every machine: random numbers are of
//! ChaCha8, elementary functions of `libm`, and no matrix product depends on the processor. Compiled and tested alone:
//! `cargo test --release -p droptower-uncertainty`.
#![warn(missing_docs)]

pub mod normal;
pub mod random;
pub mod distribution;
pub mod design;
pub mod correlation;
pub mod statistics;
pub mod surrogate;
pub mod effects;
pub mod reliability;
pub mod staircase;
pub mod ensemble;

#[cfg(test)]
mod functions;
