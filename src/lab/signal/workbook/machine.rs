//! Specimens of machines' exports in workbooks.

use std::path::Path;

use super::sheet;
use crate::signal::export::{self, Count, Export, Mistake, ReadError, Rows};
use crate::signal::stored;

/// The specimens of a machine's export in the workbook at `path`; none where no sheet holds force over displacement.
pub fn specimens(path: &Path) -> Result<Option<Export>, stored::ReadError> {
    let at = |fault: stored::Fault| stored::ReadError::new(path, fault);
    let mut export = Export::default();
    for sheet in sheet::read(path).map_err(|fault| at(fault.into()))? {
        let read = || -> Result<_, Mistake> {
            let (mut rows, mut count) = (Rows::default(), Count::default());
            for (number, cells) in sheet.rows {
                rows.push(number, cells, &mut count)?;
            }
            export::read_sheet(&rows, Some(&sheet.name))
        };
        let found = read().map_err(|mistake| {
            let fault = ReadError { path: path.into(), sheet: Some(sheet.name.clone()), mistake: Box::new(mistake) };
            at(stored::Fault::Export(Box::new(fault)))
        });
        export.specimens.extend(found?);
    }
    Ok((!export.specimens.is_empty()).then_some(export))
}
