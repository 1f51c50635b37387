//! The specimens of one text or sheet.

use std::path::Path;

use super::blocks;
use super::fault::{Mistake, ReadError};
use super::rows::{self, Rows};
use super::specimen::{Export, Specimen};
use crate::signal::text::{self, TextError};

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
