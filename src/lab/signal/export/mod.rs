//! Exports of tensile machines: several specimens in one table, side by side or below each other, with what was entered
//! about each in a head.
//!
//! Written after descriptions and printed examples of the exports of Zwick (testXpert), Instron (Bluehill), MTS
//! (TestSuite) and Shimadzu (Trapezium); their makers publish no format.

mod blocks;
mod columns;
mod fault;
mod head;
mod rows;
mod stated;
#[cfg(test)]
mod tests;
mod words;

use std::path::Path;

use crate::signal::text::{self, TextError};

pub use fault::{Fault, Mistake, ReadError};
pub use rows::{Content, Count, Row, Rows, of_text};
pub use stated::{Export, Specimen, Stated, Statement};
pub use words::{is_displacement, is_force};

/// The specimens in `rows`; one that is not named in them is called after the `sheet`, or numbered.
pub fn read_sheet(rows: &Rows, sheet: Option<&str>) -> Result<Vec<Specimen>, Mistake> {
    blocks::specimens(rows, sheet)
}

/// The specimens of the text at `path`; none where it holds no force over displacement.
pub fn read_text(path: &Path) -> Result<Option<Export>, ReadError> {
    let read = || {
        let mut lines = text::open::<TextError>(path).map_err(Mistake::from_text)?;
        let Some(rows) = rows::of_text(&mut lines)? else { return Ok(None) };
        let specimens = read_sheet(&rows, None)?;
        Ok((!specimens.is_empty()).then_some(Export { specimens, comments: rows.comments }))
    };
    read().map_err(|mistake| ReadError { path: path.into(), sheet: None, mistake: Box::new(mistake) })
}
