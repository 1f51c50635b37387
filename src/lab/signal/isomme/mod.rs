//! Recordings as ISO-MME (ISO/TS 13499): a text file a channel, headers of keys and values, a list of the channels, and
//! a file about the test. They are read, not written.
//!
//! A whole container is `<test>.mme` beside a folder `Channel` with `<test>.chn` and `<test>.001`, …; files are found
//! however their names are capitalised. Read are also a list without its test, a channel on its own, and a zip archive
//! that holds a container, at its top or in a folder.

mod archive;
mod channel;
mod container;
mod fault;
mod files;
mod header;

pub use archive::ArchiveFault;
pub use container::measure;
pub use fault::{Fault, ReadError};
pub use files::is_part;
pub use header::{Entry, Header};
