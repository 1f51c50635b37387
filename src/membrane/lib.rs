//! Explicit finite elements of membranes: arithmetic in lanes, constitutive laws, elements, contact with a rigid body.
//!
//! [`engine`] steps films, [`material`] has their laws, [`lane`] computes with several elements at once. Nothing here
//! knows scenarios, files or output, so that a law is compiled and tested alone:
//! `cargo test --release -p droptower-membrane`.
#![warn(missing_docs)]

pub mod lane;
pub mod material;
pub mod engine;
