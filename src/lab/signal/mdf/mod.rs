//! Recordings in ASAM MDF 4 (`.mf4`): channel groups, sorted or not, with packed data and linear, rational and tabulated
//! conversions.
//!
//! Source: ASAM MDF 4.1.0, as the blocks of files of `asammdf` show it. The crate `mdf4-rs` needs a newer compiler than
//! droptower.

mod block;
mod conversion;
mod data;
mod fault;
mod file;
mod record;

pub use fault::Fault;
pub use file::Mdf;

/// Whether the first bytes are those of version 4.
pub fn is_own(first: &[u8]) -> bool {
    first.starts_with(b"MDF     4")
}
