//! `droptower script`: a Rhai script over scenarios.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::{Shared, report, scenarios};

#[derive(Debug, Args)]
pub struct ScriptArgs {
    /// The Rhai script
    pub path: PathBuf,
    /// The scenario that the script finds in args.scenario
    #[arg(long, value_name = "SCENARIO")]
    pub scenario: Option<String>,
    /// A value that the script finds in args: key=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub arg: Vec<String>,
    /// Change a key of every scenario: key.path=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Folder for the results, in place of runs/<name of the script>
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

pub fn run(args: &ScriptArgs, _shared: &Shared) -> ExitCode {
    match scenarios::assignments(&args.set) {
        Ok(_) => ExitCode::SUCCESS,
        Err(mistakes) => report(&mistakes),
    }
}
