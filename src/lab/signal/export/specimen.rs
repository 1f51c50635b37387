//! Specimens of an export.

use super::stated::Stated;
use crate::signal::column_name::ColumnName;

/// The specimens of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Export {
    /// In the order of the file.
    pub specimens: Vec<Specimen>,
    /// Comments of the file: lines that start with `#`.
    pub comments: Vec<String>,
}

/// One specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct Specimen {
    /// As the file names it, or else its sheet or its number.
    pub name: String,
    /// Where its header is: the sheet, and the row counted from one.
    pub place: (Option<String>, usize),
    /// Names and units of its columns.
    pub columns: Vec<ColumnName>,
    /// As many as columns, each as long as the others; as the file writes them, `NaN` for an empty cell.
    pub values: Vec<Vec<f64>>,
    /// What the head states of it.
    pub stated: Stated,
}

impl Export {
    /// Whether the file is more than one table without a head, which any reader of tables reads.
    pub fn is_of_machine(&self) -> bool {
        self.specimens.len() > 1 || self.specimens.iter().any(|specimen| !specimen.stated.is_empty())
    }
}

impl Specimen {
    /// Leaves out rows behind the last that has a value: those of longer specimens beside it.
    pub fn trim(&mut self) {
        let filled = |values: &Vec<f64>| values.iter().rposition(|value| !value.is_nan()).map_or(0, |last| last + 1);
        let rows = self.values.iter().map(filled).max().unwrap_or(0);
        self.values.iter_mut().for_each(|values| values.truncate(rows));
    }
}
