//! The values that the arguments give a script: its scenario, its constants and changes of scenarios.

use clap::Args;

use super::changes::Changes;
use super::complete;
use base::diagnostic::Diagnostic;
use study::script::argument_value;

/// `--scenario`, `--arg`, `--set` and `--unset` of scripts.
#[derive(Clone, Debug, Args)]
pub(super) struct Given {
    /// The scenario that the script finds in args.scenario
    #[arg(long, value_name = "SCENARIO", add = complete::scenarios())]
    pub scenario: Option<String>,
    /// A value that the script finds in args: key=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub arg: Vec<String>,
    #[command(flatten)]
    pub changes: Changes,
}

impl Given {
    /// The constant `args` of the script: numbers, booleans and text.
    ///
    /// # Errors
    /// All mistakes in the arguments.
    pub(super) fn values(&self) -> Result<rhai::Map, Vec<Diagnostic>> {
        let mut map = rhai::Map::new();
        let mut mistakes = Vec::new();
        for argument in &self.arg {
            match argument.split_once('=') {
                Some((key, value)) => drop(map.insert(key.trim().into(), argument_value(value.trim()))),
                None => mistakes.push(Diagnostic::new(format!("expected key=value after --arg, found `{argument}`"))),
            }
        }
        if let Some(scenario) = &self.scenario {
            map.insert("scenario".into(), scenario.into());
        }
        if mistakes.is_empty() { Ok(map) } else { Err(mistakes) }
    }
}
