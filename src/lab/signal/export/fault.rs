//! Faults in an export, and where they are.

use std::fmt::{self, Display};
use std::path::PathBuf;

use thiserror::Error;

use crate::signal::channel_fault::MOST_VALUES;
use crate::signal::text::{self, TextError};
use base::diagnostic::listed;

/// A fault, and its place.
#[derive(Debug)]
pub struct Mistake {
    /// Row, counted from one; zero where it is at none.
    pub row: usize,
    /// Column, counted from one.
    pub column: Option<usize>,
    /// The fault.
    pub fault: Fault,
}

/// Why rows are no export of specimens.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file cannot be read as text.
    #[error(transparent)]
    Text(#[from] TextError),
    /// There are too many numbers.
    #[error("more than {MOST_VALUES} cells")]
    TooLarge,
    /// There are too many rows of texts.
    #[error("more than {most} rows that are not of numbers")]
    ManyTexts {
        /// Most that are read.
        most: usize,
    },
    /// A row has more cells than the header has names.
    #[error("expected at most {expected} cells, found {found}")]
    RowLength {
        /// Names of the header.
        expected: usize,
        /// Cells of the row.
        found: usize,
    },
    /// A row among those of numbers holds something else.
    #[error("expected a number, found `{found}`")]
    NotANumber {
        /// The cell.
        found: String,
    },
    /// A head states a quantity twice.
    #[error("the head states `{key}` of {specimen} twice: {first} and {second}")]
    StatedTwice {
        /// What is stated, as the head writes it.
        key: String,
        /// The specimen.
        specimen: String,
        /// As it is written first.
        first: String,
        /// And then.
        second: String,
    },
    /// The values of a quantity are not as many as specimens.
    #[error("the head states {found} values of `{key}` for {} specimens: {}", specimens.len(), listed(specimens))]
    Values {
        /// What is stated, as the head writes it.
        key: String,
        /// Values.
        found: usize,
        /// The specimens.
        specimens: Vec<String>,
    },
}

impl Mistake {
    /// A mistake of reading the text.
    pub fn from_text(mistake: text::Mistake<TextError>) -> Mistake {
        Mistake { row: mistake.line, column: Some(mistake.column), fault: mistake.fault.into() }
    }
}

/// A mistake in a file.
#[derive(Debug, Error)]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// The sheet, of a file that has sheets.
    pub sheet: Option<String>,
    /// Fault and place.
    pub mistake: Box<Mistake>,
}

impl Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ReadError { path, sheet, mistake } = self;
        let Mistake { row, column, fault } = &**mistake;
        match sheet {
            Some(_) => write!(f, "{}: {}", path.display(), self.in_file()),
            None if *row == 0 => write!(f, "{}: {fault}", path.display()),
            None => write!(f, "{}:{row}:{}: {fault}", path.display(), column.unwrap_or(1)),
        }
    }
}

impl ReadError {
    /// The fault and its place within the file.
    pub fn in_file(&self) -> String {
        let Mistake { row, fault, .. } = &*self.mistake;
        let sheet = self.sheet.as_ref().map(|sheet| format!("sheet `{sheet}`, ")).unwrap_or_default();
        format!("{sheet}row {row}: {fault}")
    }

    /// File, line and column, of a text.
    pub fn place(&self) -> Option<(PathBuf, usize, usize)> {
        let is_line = self.sheet.is_none() && self.mistake.row > 0;
        // The column is that of cells, not of letters: the line is what a diagnostic shows.
        is_line.then(|| (self.path.clone(), self.mistake.row, 1))
    }

    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self.mistake.fault {
            Fault::Values { .. } => Some("state one value, or one a specimen"),
            Fault::StatedTwice { .. } => Some("leave one of them"),
            Fault::NotANumber { .. } => Some("put a blank line and a name before the next specimen"),
            _ => None,
        }
    }
}
