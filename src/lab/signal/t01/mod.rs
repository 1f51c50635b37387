//! Time histories of OpenRadioss (`filmT01`, and `film_0001.thy` where `/TH/VERS` asks for a format with units): the motion of nodes, energies, impulses of rigid bodies.
//!
//! Source: OpenRadioss, `engine/source/output/th/hist1.F` and `hist2.F`, which write them.

mod file;

use thiserror::Error;

pub use file::T01;

/// A fault of a time history, and where it is.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file ends within its head.
    #[error("byte {at}: the file ends within {what}")]
    Ends {
        /// Place in the file.
        at: usize,
        /// What is incomplete.
        what: &'static str,
    },
    /// A record is not as long as it must be, or does not end with its length.
    #[error("byte {at}: {what} has {found} bytes, expected {expected}")]
    Length {
        /// Place in the file.
        at: usize,
        /// What must be there.
        what: &'static str,
        /// Its bytes.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// A number that counts something is none.
    #[error("byte {at}: {found} is no number of {what}")]
    Count {
        /// Place in the file.
        at: usize,
        /// Of what.
        what: &'static str,
        /// As written.
        found: i32,
    },
    /// The factors of the units are no positive numbers.
    #[error("byte {at}: the units of the file are no positive multiples of SI units")]
    Units {
        /// Place in the file.
        at: usize,
    },
    /// The file has no instant.
    #[error("the file ends before its first instant")]
    NoInstant,
}

/// Whether the first bytes are those of a file: a record of a number and 80 characters, and one of 80 characters.
pub fn is_own(first: &[u8]) -> bool {
    let at = |place: usize| first.get(place..place + 4).and_then(|bytes| bytes.try_into().ok()).map(u32::from_be_bytes);
    at(0) == Some(84) && at(88) == Some(84) && at(92) == Some(80)
}

/// The comment by which a motion is known as computed, here and in tables.
pub const COMPUTED: &str = "VIRTUAL: computed by OpenRadioss";
