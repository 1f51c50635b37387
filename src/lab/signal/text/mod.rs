//! Text files of unknown length: their lines, and mistakes at a place in them.

mod error;
mod line;

pub use error::{Mistake, ReadError, TextError};
pub use line::{Line, Lines, open};
