//! The files of a call, checked before a recording is read.

use std::path::PathBuf;

use super::args::DropArgs;
use crate::{Failure, output};
use report::{DropPage, drop_page};

/// Refuses a table or a page that may not be written.
pub(super) fn check(args: &DropArgs, inputs: &[(PathBuf, bool)]) -> Result<(), Failure> {
    let table = args.out.iter().map(|out| {
        let check = |(input, _): &(PathBuf, bool)| crate::signal::output::check_table(out, input, args.force);
        inputs.iter().try_for_each(check)
    });
    // A page holds nothing that is not computed again.
    let page = args.page.iter().map(|page| {
        let check = |(input, _): &(PathBuf, bool)| output::check_page(page, Some(input));
        inputs.iter().try_for_each(check)
    });
    Failure::all(table.chain(page).filter_map(Result::err)).map_or(Ok(()), Err)
}

/// Writes the page where one is asked for.
pub(super) fn write_page(args: &DropArgs, page: &DropPage<'_>) -> Result<(), Failure> {
    match &args.page {
        Some(path) => output::write(path, |file| file.write_all(drop_page(page).as_bytes())),
        None => Ok(()),
    }
}
