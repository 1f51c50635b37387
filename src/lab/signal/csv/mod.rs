//! Recordings as tables in text: a header of names, then a row a sample.
//!
//! Separator (comma, semicolon, tab, blanks), decimal mark, encoding, header, units and the column of time are
//! detected. Lines that start with `#` are comments; those before the numbers become notes. An empty cell means that
//! nothing was measured. Lines are read one by one with their place, for which the crate `csv` is not suited: it needs
//! the separator beforehand and supports neither blanks nor positions within a line.

mod cell;
mod fault;
mod layout;
mod table;
#[cfg(test)]
mod tests;
mod write;

pub use super::column_name::TIME;
pub(in crate::signal) use cell::{Mark, Separator};
pub use fault::{Fault, ReadError};
pub(in crate::signal) use table::Lined;
pub use table::{Column, Table, columns, measure, read};
pub use write::write;
