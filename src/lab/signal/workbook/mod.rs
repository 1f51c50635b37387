//! Recordings in workbooks of Excel (`.xlsx`): each sheet is a table, with the same recognition of header and units as one in
//! text.

mod fault;
mod sheet;
mod machine;
mod table;

pub use fault::Fault;
pub use machine::specimens;
pub use table::Workbook;

/// Whether the first bytes are those of an archive in zip, which a workbook is.
pub fn is_own(first: &[u8]) -> bool {
    first.starts_with(b"PK\x03\x04")
}
