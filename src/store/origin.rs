//! What results were made from: those of another scenario or script are replaced only where that was asked for.

use std::fmt;
use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{StoreError, is_run, run_files};
use crate::diagnostic::{folder_of, shown_path};
use crate::file;

/// Begins the line of a stored scenario that names the file it was read from.
const SCENARIO_LINE: &str = "# scenario: ";

/// Lines of a stored scenario among which that one is.
const FEW_LINES: usize = 4;

/// What results were made from. Paths are as they were given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A run.
    Run {
        /// File of its scenario.
        scenario: String,
    },
    /// The output of a script.
    Study {
        /// File of the script.
        script: String,
        /// File of the scenario that the script was given.
        scenario: Option<String>,
    },
    /// A comparison of runs.
    Comparison,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Origin::Run { scenario } => write!(f, "the run of {scenario}"),
            Origin::Study { script, scenario: None } => write!(f, "the results of {script}"),
            Origin::Study { script, scenario: Some(scenario) } => write!(f, "the results of {script} with {scenario}"),
            Origin::Comparison => write!(f, "a comparison of runs"),
        }
    }
}

impl Origin {
    /// Of a run of the scenario at `path`; that of a run folder is the scenario which was run first.
    pub fn of_run(path: &Path) -> Origin {
        let is_stored = path.file_name().is_some_and(|name| name == run_files::SCENARIO) && is_run(folder_of(path));
        let first = is_stored.then(|| scenario_line(path)).flatten();
        Origin::Run { scenario: first.unwrap_or_else(|| shown_path(path)) }
    }

    /// The line that names the scenario in its stored text; empty of other results.
    pub fn line(&self) -> String {
        match self {
            Origin::Run { scenario } => format!("{SCENARIO_LINE}{scenario}\n"),
            _ => String::new(),
        }
    }

    /// Of the results in `folder`; none where they do not state it.
    fn stored(folder: &Path) -> Option<Origin> {
        let scenario = folder.join(run_files::SCENARIO);
        if scenario.is_file() {
            return scenario_line(&scenario).map(|scenario| Origin::Run { scenario });
        }
        let text = file::read(&folder.join(run_files::SUMMARY), run_files::MOST_BYTES).ok()?;
        let summary: Value = serde_json::from_slice(&text).ok()?;
        if summary.get("runs").is_some() && summary.get("study").is_none() {
            return Some(Origin::Comparison);
        }
        let text = |name: &str| summary["study"][name].as_str().map(String::from);
        text("script").map(|script| Origin::Study { script, scenario: text("scenario") })
    }

    /// Whether two folders state that their results are of different scenarios or scripts.
    pub(super) fn differ(one: &Path, other: &Path) -> bool {
        matches!((Origin::stored(one), Origin::stored(other)), (Some(one), Some(other)) if !one.is_same(&other))
    }

    /// Whether both are of the same scenario and script.
    fn is_same(&self, other: &Origin) -> bool {
        match (self, other) {
            (Origin::Run { scenario: one }, Origin::Run { scenario: other }) => is_same_file(one, other),
            (Origin::Study { script, scenario }, Origin::Study { script: other_script, scenario: other_scenario }) => {
                is_same_file(script, other_script)
                    && match (scenario, other_scenario) {
                        (Some(one), Some(other)) => is_same_file(one, other),
                        (one, other) => one == other,
                    }
            }
            (Origin::Comparison, Origin::Comparison) => true,
            _ => false,
        }
    }

    /// Checks that `place` is free, or holds results of the same scenario or script, or some that do not state theirs.
    pub fn check(&self, place: &Path) -> Result<(), StoreError> {
        match Origin::stored(place) {
            Some(stored) if !self.is_same(&stored) => {
                Err(StoreError::OfAnother { path: place.into(), stored: stored.to_string() })
            }
            _ => Ok(()),
        }
    }
}

fn scenario_line(path: &Path) -> Option<String> {
    let text = file::read_text(path, run_files::MOST_BYTES).ok()?;
    text.lines().take(FEW_LINES).find_map(|line| line.strip_prefix(SCENARIO_LINE)).map(String::from)
}

/// Whether two paths name one file; where one is not found from here they must be the same text.
fn is_same_file(one: &str, other: &str) -> bool {
    let [one, other] = [one, other].map(Path::new);
    match (fs::canonicalize(one), fs::canonicalize(other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => one == other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_another_scenario_or_script_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let text = |name: &str| path(name).to_str().unwrap().to_owned();
        for name in ["a.toml", "b.toml", "a.rhai", "b.rhai"] {
            fs::write(path(name), "").unwrap();
        }
        let place = path("out");
        let study =
            |script: &str, scenario: Option<&str>| Origin::Study { script: text(script), scenario: scenario.map(text) };
        let summary = |origin: &Origin| match origin {
            Origin::Study { script, scenario } => {
                serde_json::json!({ "study": { "script": script, "scenario": scenario } }).to_string()
            }
            _ => r#"{"runs": []}"#.into(),
        };
        let origins = [
            Origin::of_run(&path("a.toml")),
            Origin::of_run(&path("b.toml")),
            study("a.rhai", None),
            study("b.rhai", None),
            study("a.rhai", Some("a.toml")),
            study("a.rhai", Some("b.toml")),
            Origin::Comparison,
        ];
        for stored in &origins {
            let _ = fs::remove_dir_all(&place);
            fs::create_dir(&place).unwrap();
            assert!(stored.check(&place).is_ok(), "an empty folder");
            match stored {
                Origin::Run { .. } => {
                    fs::write(place.join("scenario.toml"), format!("# droptower\n{}", stored.line())).unwrap();
                    fs::write(place.join("summary.json"), "{}").unwrap();
                    assert_eq!(Origin::of_run(&place.join("scenario.toml")), *stored);
                }
                other => fs::write(place.join("summary.json"), summary(other)).unwrap(),
            }
            for origin in &origins {
                assert_eq!(origin.check(&place).is_ok(), origin == stored, "{origin} over {stored}");
            }
        }
        fs::write(place.join("summary.json"), "{}").unwrap();
        assert!(origins[0].check(&place).is_ok(), "results that do not state what they were made from");
    }
}
