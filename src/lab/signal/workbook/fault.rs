//! Faults in a workbook.

use calamine::XlsxError;
use thiserror::Error;

use crate::signal::csv;
use base::file::FileError;

/// A fault of a workbook.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Open(#[from] FileError),
    /// The archive is damaged, or none.
    #[error("not a readable zip archive: {0}")]
    Zip(#[from] zip::result::ZipError),
    /// The archive holds no workbook of Excel.
    #[error("a zip archive without a workbook of Excel in it")]
    NoWorkbook,
    /// The archive holds a document of another program.
    #[error("a workbook of {of}, which is not read")]
    Other {
        /// What it is.
        of: &'static str,
    },
    /// The workbook is damaged.
    #[error("{0}")]
    Xlsx(Box<XlsxError>),
    /// A part of it unpacks to more than is read.
    #[error("its parts beside the sheets unpack to more than {limit} bytes")]
    TooLarge {
        /// Most bytes that are unpacked.
        limit: u64,
    },
    /// A sheet has more cells than are read.
    #[error("sheet `{sheet}` has more than {limit} cells")]
    ManyCells {
        /// The sheet.
        sheet: String,
        /// Most cells.
        limit: usize,
    },
    /// A sheet is no table.
    #[error("sheet `{sheet}`{}: {fault}", row_text(*row))]
    Sheet {
        /// The sheet.
        sheet: String,
        /// Counted from one; zero where the fault is at none.
        row: usize,
        /// As of a table in text.
        fault: Box<csv::Fault>,
    },
}

fn row_text(row: usize) -> String {
    if row > 0 { format!(", row {row}") } else { String::new() }
}

impl From<XlsxError> for Fault {
    fn from(error: XlsxError) -> Fault {
        Fault::Xlsx(Box::new(error))
    }
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        match self {
            Fault::NoWorkbook => Some("of an ISO-MME test, let its name end in .zip".into()),
            Fault::Other { .. } => Some("save it as .xlsx, or each sheet as CSV".into()),
            Fault::Sheet { fault, .. } => fault.hint(),
            _ => None,
        }
    }
}
