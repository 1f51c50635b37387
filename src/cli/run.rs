//! `droptower run`: simulate, compare, record, report.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::{Shared, report, scenarios};

#[derive(Debug, Args)]
pub struct RunArgs {
    /// Scenario files or globs
    #[arg(required = true, value_name = "SCENARIO")]
    pub scenarios: Vec<String>,
    /// Change a key: key.path=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Folder for the results, in place of runs/<name of the scenario>
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

pub fn run(args: &RunArgs, _shared: &Shared) -> ExitCode {
    match scenarios::checked(&args.scenarios, &args.set) {
        Ok(_) => ExitCode::SUCCESS,
        Err(mistakes) => report(&mistakes),
    }
}
