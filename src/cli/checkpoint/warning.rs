//! What is reported of the checkpoint that a run resumes from.

use std::fmt;
use std::path::PathBuf;

use serde_json::{Map, Value};

use super::file_name;
use base::codes;
use base::diagnostic::shown_path;
use base::finding::{Code, Report};

codes! {
    NO_CHECKPOINT = "no-checkpoint", Note,
        "a batch resumes, and this run has no checkpoint: it had not started, or its results are of another state of its \
         scenario, so it starts from its beginning",
        "leave its scenario out where its results are to stay";
    COMPLETE = "already-complete", Note,
        "a batch resumes, and the results of this run are those of its scenario as it is now: they are left as they are",
        "none is needed; without --resume the run is repeated";
    DAMAGED_CHECKPOINT = "damaged-checkpoint", Note,
        "the newest checkpoint of a run is damaged, so the run resumes from the one before it",
        "none is needed; what was computed between the two is computed again, with the same result";
}

/// What is reported before a run resumes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Warning {
    /// The run starts from its beginning.
    NoCheckpoint {
        /// Its name.
        run: String,
        /// The folder without checkpoints.
        folder: PathBuf,
        /// The folder of results that will be replaced, where it exists.
        replaced: Option<PathBuf>,
    },
    /// The run is not repeated.
    Complete {
        /// Its name.
        run: String,
        /// The folder of its results.
        folder: PathBuf,
    },
    /// A checkpoint is damaged.
    Damaged {
        /// Name of the run.
        run: String,
        /// The checkpoint.
        damaged: PathBuf,
        /// The one before it.
        used: PathBuf,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::NoCheckpoint { run, folder, replaced } => {
                write!(f, "{run} starts from its beginning: there is no checkpoint in {}", shown_path(folder))?;
                match replaced.as_deref().map(shown_path) {
                    Some(results) => {
                        write!(f, "; its results in {results} will be replaced: leave the scenario out to keep them")
                    }
                    None => Ok(()),
                }
            }
            Warning::Complete { run, folder } => write!(f, "{run} is complete: {}", shown_path(folder)),
            Warning::Damaged { run, damaged, used } => {
                let (damaged, used) = (shown_path(damaged), file_name(used));
                write!(f, "{run}: {damaged} is damaged; the run resumes from {used}, the one before it")
            }
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::NoCheckpoint { .. } => &NO_CHECKPOINT,
            Warning::Complete { .. } => &COMPLETE,
            Warning::Damaged { .. } => &DAMAGED_CHECKPOINT,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let figures = match self {
            Warning::NoCheckpoint { run, folder, replaced } => vec![
                ("run", run.as_str().into()),
                ("folder", shown_path(folder).into()),
                ("replaced", replaced.as_deref().map(shown_path).into()),
            ],
            Warning::Complete { run, folder } => {
                vec![("run", run.as_str().into()), ("folder", shown_path(folder).into())]
            }
            Warning::Damaged { run, damaged, used } => vec![
                ("run", run.as_str().into()),
                ("damaged", shown_path(damaged).into()),
                ("used", shown_path(used).into()),
            ],
        };
        figures.into_iter().map(|(name, value)| (name.into(), value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_of_results_is_named_where_it_is_replaced() {
        let of = |replaced| Warning::NoCheckpoint { run: "drop".into(), folder: "a.checkpoint".into(), replaced };
        let text = "drop starts from its beginning: there is no checkpoint in a.checkpoint";
        assert_eq!(of(None).to_string(), text);
        assert!(of(Some("a".into())).to_string().starts_with(&format!("{text}; its results in a will be replaced")));
        assert_eq!((&of(None).figures()["run"], &of(None).figures()["replaced"]), (&"drop".into(), &Value::Null));
    }

    #[test]
    fn a_damaged_checkpoint_is_named_with_the_one_in_its_place() {
        let (damaged, used) = ("a.checkpoint/2.state".into(), "a.checkpoint/1.state".into());
        let warning = Warning::Damaged { run: "drop".into(), damaged, used };
        let expected = "drop: a.checkpoint/2.state is damaged; the run resumes from 1.state, the one before it";
        assert_eq!((warning.to_string().as_str(), warning.code().name), (expected, "damaged-checkpoint"));
    }
}
