//! Changes of scenarios that the arguments ask for.

use clap::Args;

use super::complete;
use base::diagnostic::Diagnostic;
use scene::scenario::Assignment;

/// `--set` and `--unset`.
#[derive(Clone, Debug, Args)]
pub(super) struct Changes {
    /// Change a key of the scenario: key.path=value
    #[arg(long, value_name = "KEY=VALUE", add = complete::changes())]
    pub set: Vec<String>,
    /// Leave out a key that the scenario gives or inherits: key.path
    #[arg(long, value_name = "KEY", add = complete::keys())]
    pub unset: Vec<String>,
}

impl Changes {
    /// The changes to the scenario's keys, those that leave keys out first.
    ///
    /// # Errors
    /// All mistakes in the arguments.
    pub(super) fn assignments(&self) -> Result<Vec<Assignment>, Vec<Diagnostic>> {
        let mut assignments: Vec<Assignment> =
            self.unset.iter().map(|path| Assignment::unset(path, "--unset")).collect();
        let mut mistakes = Vec::new();
        for argument in &self.set {
            match Assignment::from_argument(argument) {
                Ok(assignment) => assignments.push(assignment),
                Err(found) => mistakes.extend(found),
            }
        }
        if mistakes.is_empty() { Ok(assignments) } else { Err(mistakes) }
    }

    /// These changes, and one more.
    pub(super) fn and(&self, change: String) -> Changes {
        let mut all = self.clone();
        all.set.push(change);
        all
    }

    /// The arguments that ask for the same: names of options and values in turn.
    pub(super) fn words(&self) -> impl Iterator<Item = String> + '_ {
        let left_out = self.unset.iter().map(|key| ("--unset", key));
        let changed = self.set.iter().map(|change| ("--set", change));
        left_out.chain(changed).flat_map(|(option, value)| [option.to_owned(), value.clone()])
    }
}
