//! `droptower man`: manual pages.

use std::fs;
use std::path::PathBuf;

use clap::Args;

use super::{Failure, print};
use base::diagnostic::{Diagnostic, shown_path};

#[derive(Debug, Args)]
pub(super) struct ManArgs {
    /// Write the pages of all commands to this folder, in place of printing that of the program
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

pub(super) fn run(args: &ManArgs) -> Result<(), Failure> {
    let command = super::command();
    let Some(folder) = &args.folder else {
        let mut page = Vec::new();
        let written = clap_mangen::Man::new(command).render(&mut page);
        written.map_err(|error| Failure::output(Diagnostic::new(error.to_string())))?;
        return print(String::from_utf8_lossy(&page).trim_end());
    };
    let written = || {
        fs::create_dir_all(folder)?;
        clap_mangen::generate_to(command, folder)
    };
    written().map_err(|error| Failure::output(Diagnostic::new(format!("cannot write {}: {error}", shown_path(folder)))))
}
