//! Exports of tensile machines: several specimens in one table, side by side or below each other, with what was entered
//! about each in a head.
//!
//! Written after descriptions and printed examples of the exports of Zwick (testXpert), Instron (Bluehill), MTS
//! (TestSuite) and Shimadzu (Trapezium); their makers publish no format.

mod blocks;
mod columns;
mod head;
mod rows;
mod sheet;
mod specimen;
#[cfg(test)]
mod tests;
mod words;

pub use head::{Stated, Statement};
pub use rows::{Content, Count, Row, Rows, of_text};
pub use sheet::{Fault, Mistake, ReadError, read_sheet, read_text};
pub use specimen::{Export, Specimen};
pub use words::{is_displacement, is_force};
