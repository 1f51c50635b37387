//! Exports of tensile machines: several specimens in one table, side by side or below each other, with what was entered
//! about each in a head.
//!
//! Written after descriptions and printed examples of the exports of Zwick (testXpert), Instron (Bluehill), MTS
//! (TestSuite) and Shimadzu (Trapezium); their makers publish no format.

mod blocks;
mod columns;
mod fault;
mod head;
mod reader;
mod rows;
mod specimen;
mod stated;
#[cfg(test)]
mod tests;
mod words;

pub use fault::{Fault, Mistake, ReadError};
pub use reader::{read_sheet, read_text};
pub use rows::{Content, Count, Row, Rows, of_text};
pub use specimen::{Export, Specimen};
pub use stated::{Stated, Statement};
pub use words::{is_displacement, is_force};
