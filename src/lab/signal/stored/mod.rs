//! Recordings in files that list their channels before the values: each with a group, a unit, and a time of its own or
//! one that several share.

mod catalogue;
mod columns;
mod entry;
mod fault;
#[cfg(test)]
mod tests;

pub use catalogue::{Catalogue, columns, measure};
pub use columns::Columns;
pub use entry::{Axis, Entry};
pub use fault::{Fault, ReadError};
