//! Recordings of National Instruments as TDMS: groups of channels, in segments that follow each other as they were
//! recorded.
//!
//! Source: National Instruments, *TDMS File Format Internal Structure*; what that leaves open (raw data of DAQmx, scales)
//! is read as `npTDMS` does. Little- and big-endian files, interleaved and DAQmx data, chained scales and truncated ends
//! are read; the file of an index (`.tdms_index`) is not needed.

mod bytes;
mod chunks;
mod fault;
mod file;
mod index;
mod kind;
mod objects;
mod property;
mod scale;
mod segment;

pub use fault::Fault;
pub use file::Tdms;

/// The first bytes of a file.
const TAG: &[u8] = b"TDSm";

/// The first bytes of the file of an index.
const INDEX_TAG: &[u8] = b"TDSh";

/// Whether the first bytes are those of a file, or of its index.
pub fn is_own(first: &[u8]) -> bool {
    first.starts_with(TAG) || first.starts_with(INDEX_TAG)
}
