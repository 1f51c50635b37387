//! Recordings in HDF5, of h5py, pandas and others, and in MAT-files of version 7.3: data sets, columns of matrices and fields
//! of records, each called by the groups that it is in.

mod fault;
mod file;
mod number;

pub use fault::Fault;
pub use file::Hdf5;

/// The first bytes of a file, or of what follows a block of its user.
const TAG: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Whether the first bytes are those of HDF5. The block of MATLAB has 512 bytes.
pub fn is_own(first: &[u8]) -> bool {
    first.starts_with(TAG) || first.get(512..).is_some_and(|rest| rest.starts_with(TAG))
}
