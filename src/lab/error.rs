//! The error of the laboratory: what is refused, where, and what helps.

use std::fmt;
use std::path::{Path, PathBuf};

use base::file::FileError;

/// Why something is refused.
#[derive(Clone, PartialEq, thiserror::Error)]
pub struct Error(Box<Refusal>);

#[derive(Clone, Debug, Default, PartialEq)]
struct Refusal {
    message: String,
    path: Option<PathBuf>,
    /// Counted from one; zero where the whole file is refused.
    line: usize,
    /// In characters, counted from one.
    column: usize,
    hint: Option<String>,
    kind: Kind,
}

/// What callers decide by.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Kind {
    /// A refusal that no caller treats of its own.
    #[default]
    Other,
    /// A table has no column of time, or a channel no time.
    NoTime,
    /// A table has no rows of numbers.
    NoRows,
    /// Two columns of a table have one name, as those of several specimens have.
    EqualNames,
    /// The head of a machine's export contradicts itself.
    ExportHead,
    /// Neither the file nor the caller gives the unit of a channel.
    NoUnit {
        /// The channel.
        name: String,
        /// Unit of the quantity that is asked for.
        unit: &'static str,
    },
    /// Neither the file nor the caller states direction or speed of a coupon.
    NoLabel,
    /// Strain goes back at a sample of a curve, counted from one.
    GoesBack(usize),
    /// A series has a gap.
    Gap,
    /// A reading falls in no release; the time of its impact, s.
    NoRelease(f64),
    /// A reading has no rest before its release; the time of that, s.
    NoRest(f64),
}

impl Error {
    /// A refusal with this message; a hint and a place may follow.
    pub fn new(message: impl Into<String>) -> Error {
        Error(Box::new(Refusal { message: message.into(), column: 1, ..Refusal::default() }))
    }

    /// With what helps.
    pub fn with_hint(mut self, hint: impl Into<String>) -> Error {
        self.0.hint = Some(hint.into());
        self
    }

    /// With what callers decide by.
    pub fn with_kind(mut self, kind: Kind) -> Error {
        self.0.kind = kind;
        self
    }

    /// With a message that begins with the quantity or the part that it is about.
    pub fn about(mut self, what: impl fmt::Display) -> Error {
        self.0.message = format!("{what}: {}", self.0.message);
        self
    }

    /// At a line and a column (in characters) of a file, both counted from one, unless its place is known.
    pub fn at(mut self, line: usize, column: usize) -> Error {
        if self.0.line == 0 {
            (self.0.line, self.0.column) = (line, column);
        }
        self
    }

    /// In the file at `path`, unless it is in another.
    pub fn in_file(mut self, path: &Path) -> Error {
        self.0.path.get_or_insert_with(|| path.to_owned());
        self
    }

    /// The message without its place.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// What helps, where that is known.
    pub fn hint(&self) -> Option<&str> {
        self.0.hint.as_deref()
    }

    /// What callers decide by.
    pub fn kind(&self) -> &Kind {
        &self.0.kind
    }

    /// The line within its file; zero where it is at none.
    pub fn line(&self) -> usize {
        self.0.line
    }

    /// File, line and column, where it is at such a place.
    pub fn place(&self) -> Option<(&Path, usize, usize)> {
        let Refusal { path, line, column, .. } = &*self.0;
        path.as_deref().filter(|_| *line > 0).map(|path| (path, *line, *column))
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Refusal { path, line, column, message, .. } = &*self.0;
        match path {
            Some(path) if *line > 0 => write!(f, "{}:{line}:{column}: {message}", path.display()),
            Some(path) => write!(f, "{}: {message}", path.display()),
            None => f.write_str(message),
        }
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Error {
        refusal!("cannot be read: {error}")
    }
}

/// An [`Error`] whose message is a format with its arguments.
macro_rules! refusal {
    ($($message:tt)*) => { $crate::error::Error::new(format!($($message)*)) };
}
pub(crate) use refusal;
