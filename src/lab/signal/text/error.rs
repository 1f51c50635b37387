//! Faults in a text file, and where they are.

use std::fmt::{self, Display};
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use base::file::FileError;

/// Why a file cannot be read as text.
#[derive(Debug, Error)]
pub enum TextError {
    /// The file cannot be opened.
    #[error("cannot be read: {0}")]
    Open(FileError),
    /// Reading failed within the file.
    #[error("cannot be read further: {0}")]
    Read(io::Error),
    /// A line is longer than any that is read.
    #[error("the line is longer than a mebibyte")]
    LineTooLong,
    /// The bytes are not text.
    #[error("text neither in UTF-8, nor in UTF-16 with its byte order mark, nor in GBK or Windows-1252")]
    NotText,
}

/// A fault of a file, and its place.
#[derive(Debug, Error)]
pub struct ReadError<F> {
    /// The file.
    pub path: PathBuf,
    /// Counted from one; zero where the mistake is at no line.
    pub line: usize,
    /// In characters, counted from one.
    pub column: usize,
    /// The fault.
    pub fault: F,
}

impl<F: Display> Display for ReadError<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        match self.line {
            0 => write!(f, "{path}: {}", self.fault),
            line => write!(f, "{path}:{line}:{}: {}", self.column, self.fault),
        }
    }
}

impl<F> ReadError<F> {
    /// File, line and column, where the mistake is at such a place.
    pub fn place(&self) -> Option<(PathBuf, usize, usize)> {
        (self.line > 0).then(|| (self.path.clone(), self.line, self.column))
    }
}

/// A fault with its place in the file that is being read.
#[derive(Debug)]
pub struct Mistake<F> {
    /// Zero where it is at no line.
    pub line: usize,
    /// In characters, counted from one.
    pub column: usize,
    /// The fault.
    pub fault: F,
}

impl<F> Mistake<F> {
    /// A mistake of the file as a whole.
    pub fn whole(fault: F) -> Mistake<F> {
        Mistake { line: 0, column: 1, fault }
    }

    /// The mistake as one of the file at `path`.
    pub fn locate(self, path: &Path) -> ReadError<F> {
        ReadError { path: path.into(), line: self.line, column: self.column, fault: self.fault }
    }
}
