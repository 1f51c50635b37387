//! What is wrong with a text file, and where.

use std::fmt::{self, Display};
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a file cannot be read as text.
#[derive(Debug, Error)]
pub enum TextError {
    #[error("cannot be read: {0}")]
    Open(io::Error),
    #[error("cannot be read on: {0}")]
    Read(io::Error),
    #[error("the line is longer than a mebibyte")]
    LineTooLong,
    #[error("neither UTF-8 nor Windows-1252 text")]
    NotText,
}

/// What is wrong with a file, and where.
#[derive(Debug, Error)]
pub struct ReadError<F> {
    pub path: PathBuf,
    /// Counted from one; zero where the mistake is at no line.
    pub line: usize,
    /// In characters, counted from one.
    pub column: usize,
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
    pub column: usize,
    pub fault: F,
}

impl<F> Mistake<F> {
    /// A mistake of the file as a whole.
    pub fn whole(fault: F) -> Mistake<F> {
        Mistake { line: 0, column: 1, fault }
    }

    /// The mistake as one of the file at `path`.
    pub fn of(self, path: &Path) -> ReadError<F> {
        ReadError { path: path.into(), line: self.line, column: self.column, fault: self.fault }
    }
}
