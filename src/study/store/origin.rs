//! The origin of results: those of another scenario or script are replaced only where that was asked for.
//!
//! A folder names its scenario and script by their paths from itself, so that a project which is moved or copied as a
//! whole still owns its results, and equal names in two projects do not. Results that were moved without their scenario
//! are those of another.

use std::fmt;
use std::fs;
use std::path::{Component, Path, PathBuf};

use serde_json::Value;

use super::{StoreError, is_run, run_files};
use base::diagnostic::{folder_of, shown_path, tidy_path};
use base::file;

/// Begins the line of a stored scenario that names the file it was read from.
const SCENARIO_LINE: &str = "# scenario: ";

/// Begins the line of the results of a sweep that names the file it was read from.
const SWEEP_LINE: &str = "# sweep of: ";

/// Lines of a stored scenario among which that one is.
const FEW_LINES: usize = 4;

/// The files that results were made from. Paths are absolute and without links.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A run.
    Run {
        /// File of its scenario.
        scenario: PathBuf,
    },
    /// Many runs of a scenario.
    Sweep {
        /// File of the scenario.
        scenario: PathBuf,
    },
    /// The output of a script.
    Script {
        /// File of the script.
        script: PathBuf,
        /// File of the scenario that the script was given.
        scenario: Option<PathBuf>,
    },
    /// A comparison of runs.
    Comparison {
        /// Their folders or files of signals, in their order.
        runs: Vec<PathBuf>,
    },
    /// Verdicts of tests.
    Tests {
        /// Where the tests were searched for.
        paths: Vec<PathBuf>,
    },
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Origin::Run { scenario } => write!(f, "the run of {}", shown_path(scenario)),
            Origin::Sweep { scenario } => write!(f, "the sweep of {}", shown_path(scenario)),
            Origin::Script { script, scenario: None } => write!(f, "the results of {}", shown_path(script)),
            Origin::Script { script, scenario: Some(scenario) } => {
                write!(f, "the results of {} with {}", shown_path(script), shown_path(scenario))
            }
            Origin::Comparison { runs } => write!(f, "the comparison of {}", listed(runs)),
            Origin::Tests { paths } => write!(f, "the verdicts of the tests in {}", listed(paths)),
        }
    }
}

impl Origin {
    /// Of a run of the scenario at `path`; that of a run folder is the scenario which was run first.
    pub fn of_run(path: &Path) -> Origin {
        let is_stored = path.file_name().is_some_and(|name| name == run_files::SCENARIO) && is_run(folder_of(path));
        Origin::Run { scenario: first_of(path, is_stored, SCENARIO_LINE) }
    }

    /// Of a sweep of the scenario at `path`; that of the folder of a sweep is the scenario which was swept first.
    pub fn of_sweep(path: &Path) -> Origin {
        let is_stored = path.file_name().is_some_and(|name| name == run_files::SCENARIO);
        Origin::Sweep { scenario: first_of(path, is_stored, SWEEP_LINE) }
    }

    /// Of a script at `script` that was given the scenario at `scenario`.
    pub fn of_script(script: &Path, scenario: Option<&Path>) -> Origin {
        Origin::Script { script: full(script), scenario: scenario.map(full) }
    }

    /// Of a comparison of these runs.
    pub fn of_comparison(runs: &[PathBuf]) -> Origin {
        Origin::Comparison { runs: runs.iter().map(|run| full(run)).collect() }
    }

    /// Of the tests that are searched for at these paths.
    pub fn of_tests(paths: &[PathBuf]) -> Origin {
        Origin::Tests { paths: paths.iter().map(|path| full(path)).collect() }
    }

    /// The line that names the scenario in its stored text, by its path from the run folder `place`; empty of other
    /// results.
    pub fn line(&self, place: &Path) -> String {
        match self {
            Origin::Run { scenario } => format!("{SCENARIO_LINE}{}\n", path_from(place, scenario)),
            Origin::Sweep { scenario } => format!("{SWEEP_LINE}{}\n", path_from(place, scenario)),
            _ => String::new(),
        }
    }

    /// Of the results in `folder`, which are to be read as if they were at `place`; none where they do not state it.
    fn stored(folder: &Path, place: &Path) -> Option<Origin> {
        let place = full(place);
        let scenario = folder.join(run_files::SCENARIO);
        if scenario.is_file() {
            let named = |line| Some(full(&place.join(line_after(&scenario, line)?)));
            let run = named(SCENARIO_LINE).map(|scenario| Origin::Run { scenario });
            return run.or_else(|| Some(Origin::Sweep { scenario: named(SWEEP_LINE)? }));
        }
        let text = file::read(&folder.join(run_files::SUMMARY), run_files::MOST_BYTES).ok()?;
        let summary: Value = serde_json::from_slice(&text).ok()?;
        // Files are named from the working folder of the call.
        let call = summary.get("study").unwrap_or(&summary);
        let called_in = place.join(call[run_files::WORKING_FOLDER].as_str()?);
        let file = |name: &Value| name.as_str().map(|name| full(&called_in.join(name)));
        if let Some(script) = file(&call["script"]) {
            return Some(Origin::Script { script, scenario: file(&call["scenario"]) });
        }
        if let Some(paths) = call["paths"].as_array() {
            return Some(Origin::Tests { paths: paths.iter().filter_map(file).collect() });
        }
        let runs = call["runs"].as_array()?;
        Some(Origin::Comparison { runs: runs.iter().filter_map(|run| file(&run["path"])).collect() })
    }

    /// Whether results of `stored` are earlier ones of the same: of tests also a part of them, or more.
    fn is_that_of(&self, stored: &Origin) -> bool {
        let is_below =
            |all: &[PathBuf], of: &[PathBuf]| all.iter().all(|path| of.iter().any(|of| path.starts_with(of)));
        match (self, stored) {
            (Origin::Tests { paths }, Origin::Tests { paths: stored }) => {
                is_below(paths, stored) || is_below(stored, paths)
            }
            _ => self == stored,
        }
    }

    /// Checks that `place` is free, or holds results of the same scenario or script, or some that do not state theirs.
    pub fn check(&self, place: &Path) -> Result<(), StoreError> {
        self.check_moved(place, place)
    }

    /// Checks the results in `folder`, which were moved there from `place`, as [`Origin::check`] does.
    pub(super) fn check_moved(&self, folder: &Path, place: &Path) -> Result<(), StoreError> {
        match Origin::stored(folder, place) {
            Some(stored) if !self.is_that_of(&stored) => {
                let why = format!("holds {stored} and is not replaced; give another --out, or --force");
                Err(StoreError::kept(place, why))
            }
            _ => Ok(()),
        }
    }
}

/// The scenario that a stored one names in the line which begins so; else the one at `path` itself.
fn first_of(path: &Path, is_stored: bool, start: &str) -> PathBuf {
    let first = is_stored.then(|| line_after(path, start)).flatten();
    first.map_or_else(|| full(path), |first| full(&full(folder_of(path)).join(first)))
}

/// The first of the paths, and the number of the others.
fn listed(paths: &[PathBuf]) -> String {
    let Some((first, others)) = paths.split_first() else { return "nothing".into() };
    let others = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
    format!("{}{others}", shown_path(first))
}

/// The path of `file` from the folder `place`, with `/` between its parts; absolute where no such path exists.
pub fn path_from(place: &Path, file: &Path) -> String {
    let (place, file) = (full(place), full(file));
    let (from, to): (Vec<Component>, Vec<Component>) = (place.components().collect(), file.components().collect());
    let common = from.iter().zip(&to).take_while(|(one, other)| one == other).count();
    if common == 0 {
        return file.display().to_string();
    }
    let up = from[common..].iter().map(|_| "..".into());
    let down = to[common..].iter().map(|part| part.as_os_str().to_string_lossy());
    let parts: Vec<_> = up.chain(down).collect();
    if parts.is_empty() { ".".into() } else { parts.join("/") }
}

/// The rest of the line that begins with `start`, among the first lines of a file.
fn line_after(path: &Path, start: &str) -> Option<String> {
    let text = file::read_text(path, run_files::MOST_BYTES).ok()?;
    text.lines().take(FEW_LINES).find_map(|line| line.strip_prefix(start)).map(String::from)
}

/// The absolute path without links, as far as the folders on it exist.
fn full(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.into());
    let there = absolute.ancestors().find_map(|ancestor| Some((ancestor, fs::canonicalize(ancestor).ok()?)));
    match there.and_then(|(ancestor, there)| Some(there.join(absolute.strip_prefix(ancestor).ok()?))) {
        // Joined with an empty path, a path would end in a separator.
        Some(path) => tidy_path(&path),
        None => tidy_path(&absolute),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_another_scenario_or_script_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["a.toml", "b.toml", "a.rhai", "b.rhai"] {
            fs::write(path(name), "").unwrap();
        }
        let place = path("out");
        let study =
            |script: &str, scenario: Option<&str>| Origin::of_script(&path(script), scenario.map(path).as_deref());
        let summary = |origin: &Origin| match origin {
            Origin::Script { script, scenario } => {
                let study = serde_json::json!({ "script": script, "scenario": scenario, "folder": ".." });
                serde_json::json!({ "study": study }).to_string()
            }
            Origin::Comparison { runs } => {
                let runs: Vec<_> = runs.iter().map(|run| serde_json::json!({ "path": run })).collect();
                serde_json::json!({ "runs": runs, "folder": ".." }).to_string()
            }
            Origin::Tests { paths } => serde_json::json!({ "paths": paths, "folder": ".." }).to_string(),
            Origin::Run { .. } | Origin::Sweep { .. } => "{}".into(),
        };
        let origins = [
            Origin::of_run(&path("a.toml")),
            Origin::of_run(&path("b.toml")),
            study("a.rhai", None),
            study("b.rhai", None),
            study("a.rhai", Some("a.toml")),
            study("a.rhai", Some("b.toml")),
            Origin::of_comparison(&[path("a"), path("b")]),
            Origin::of_comparison(&[path("b"), path("a")]),
            Origin::of_comparison(&[path("a"), path("b"), path("c")]),
            Origin::of_tests(&[path("a")]),
            Origin::of_tests(&[path("b")]),
        ];
        for stored in &origins {
            let _ = fs::remove_dir_all(&place);
            fs::create_dir(&place).unwrap();
            assert!(stored.check(&place).is_ok(), "an empty folder");
            match stored {
                Origin::Run { .. } => {
                    fs::write(place.join("scenario.toml"), format!("# droptower\n{}", stored.line(&place))).unwrap();
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
        let tests = |names: &[&str]| Origin::of_tests(&names.iter().map(|name| path(name)).collect::<Vec<_>>());
        fs::write(place.join("summary.json"), summary(&tests(&["a", "b/c"]))).unwrap();
        for (names, is_same) in [(&["a/d"][..], true), (&["b", "a"], true), (&["b/c", "b/d"], false), (&["b"], false)] {
            assert_eq!(tests(names).check(&place).is_ok(), is_same, "{names:?}");
        }
    }

    #[test]
    fn a_project_owns_its_results_wherever_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let store = |place: &Path, origin: &Origin| {
            fs::create_dir_all(place).unwrap();
            fs::write(place.join("scenario.toml"), format!("# droptower\n{}", origin.line(place))).unwrap();
        };
        for project in ["one", "other"] {
            fs::create_dir(path(project)).unwrap();
            fs::write(path(project).join("film.toml"), "").unwrap();
        }
        let origin = |project: &str| Origin::of_run(&path(project).join("film.toml"));
        let (shared, own) = (path("shared"), path("one/runs/film"));
        for place in [&shared, &own] {
            store(place, &origin("one"));
            assert!(origin("one").check(place).is_ok());
            assert!(origin("other").check(place).is_err(), "the same name in another project");
        }
        fs::rename(path("one"), path("moved")).unwrap();
        assert!(origin("moved").check(&path("moved/runs/film")).is_ok(), "moved as a whole");
        assert!(origin("moved").check(&shared).is_err(), "moved without its results");
    }

    #[test]
    fn paths_lead_from_a_folder_to_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for (place, file, expected) in [
            ("runs/drop/1008", "scenarios/1008.toml", "../../../scenarios/1008.toml"),
            ("runs", "runs/a.toml", "a.toml"),
            ("runs/1008", "", "../.."),
            ("runs", "runs", "."),
        ] {
            assert_eq!(path_from(&path(place), &path(file)), expected, "{file} from {place}");
        }
    }
}
