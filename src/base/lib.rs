//! The vocabulary of every part of droptower: numbers and units, diagnostics and findings, files and tables.
#![warn(missing_docs)]

pub mod number;
pub mod units;
pub mod written;
pub mod diagnostic;
pub mod markup;
pub mod scratch;
pub mod file;
pub mod finding;
pub mod shell;
pub mod cancellation;
pub mod budget;
pub mod periodic;
pub mod table;
pub mod removed;
