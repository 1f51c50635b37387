//! The cases in a folder: scenarios with what their runs must give beside them.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::expectations;
use crate::scenarios;
pub(super) use crate::scenarios::Checked;
use crate::search;
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::file;
use lab::signal::csv;
use scene::expectation::{Expectations, Recorded};

/// Files of a case in a folder of its own.
const SCENARIO: &str = "scenario.toml";
const EXPECTATIONS: &str = "expect.toml";
const SIGNALS: &str = "expected.csv";
const FIGURES: &str = "expected.json";

/// End of the name of a scenario that is a case beside others.
const ENDING: &str = ".test.toml";

/// A scenario and what its run must give, checked.
pub(super) struct Case {
    /// Path of its folder or of its scenario.
    pub name: String,
    pub checked: Checked,
    pub expectations: Expectations,
    pub recorded: Recorded,
    files: Files,
}

/// The files of a case.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Files {
    name: PathBuf,
    scenario: PathBuf,
    expectations: PathBuf,
    signals: PathBuf,
    figures: PathBuf,
}

impl Files {
    /// The files of a case that is a folder.
    fn of_folder(folder: &Path) -> Files {
        let [scenario, expectations, signals, figures] =
            [SCENARIO, EXPECTATIONS, SIGNALS, FIGURES].map(|name| folder.join(name));
        Files { name: folder.into(), scenario, expectations, signals, figures }
    }

    /// The files of a case whose scenario is called `<stem>.test.toml`.
    fn of_scenario(scenario: &Path, stem: &str) -> Files {
        let beside = |ending: &str| scenario.with_file_name(format!("{stem}.{ending}"));
        let [expectations, signals, figures] = [EXPECTATIONS, SIGNALS, FIGURES].map(beside);
        Files { name: scenario.into(), scenario: scenario.into(), expectations, signals, figures }
    }
}

/// The cases below the paths whose names contain the filter, checked.
pub(super) fn all(paths: &[PathBuf], filter: Option<&str>) -> Result<Vec<Case>, Vec<Diagnostic>> {
    let mut found = BTreeSet::new();
    let mut mistakes = Vec::new();
    for path in paths {
        match below(path) {
            Ok(files) => found.extend(files),
            Err(of_path) => mistakes.extend(of_path),
        }
    }
    let is_wanted = |files: &Files| filter.is_none_or(|filter| shown_path(&files.name).contains(filter));
    let wanted: Vec<Files> = found.iter().filter(|files| is_wanted(files)).cloned().collect();
    if wanted.is_empty() && mistakes.is_empty() {
        mistakes.push(none(paths, filter, found.len()));
    }
    let mut cases = Vec::new();
    for files in wanted {
        match Case::read(files) {
            Ok(case) => cases.push(case),
            Err(of_case) => mistakes.extend(of_case),
        }
    }
    if mistakes.is_empty() { Ok(cases) } else { Err(mistakes) }
}

/// The mistake of arguments that name no case.
fn none(paths: &[PathBuf], filter: Option<&str>, all: usize) -> Diagnostic {
    let places: Vec<String> = paths.iter().map(|path| shown_path(path).to_string()).collect();
    let places = places.join(", ");
    match filter {
        Some(filter) if all > 0 => {
            Diagnostic::new(format!("none of the {all} tests in {places} has \"{filter}\" in its path"))
        }
        _ => Diagnostic::new(format!("no tests in {places}"))
            .hint("a test is a folder with scenario.toml and expect.toml: `droptower new test FOLDER` writes one"),
    }
}

/// The cases in a folder and those below it, or the one that a path names.
fn below(path: &Path) -> Result<Vec<Files>, Vec<Diagnostic>> {
    let as_case = |file: &Path| {
        let name = file.file_name()?.to_str()?;
        if name == EXPECTATIONS || name == SCENARIO {
            return Some(Files::of_folder(folder_of(file)));
        }
        name.strip_suffix(ENDING).map(|stem| Files::of_scenario(file, stem))
    };
    if path.is_file() {
        let hint = "a test is a folder with scenario.toml and expect.toml, or a file called *.test.toml";
        return as_case(path)
            .map(|files| vec![files])
            .ok_or_else(|| vec![Diagnostic::new(format!("{} is no test", shown_path(path))).hint(hint)]);
    }
    if !path.is_dir() {
        return Err(vec![Diagnostic::new(format!("there is no {}", shown_path(path)))]);
    }
    let (files, mistakes) = search::below(path, |name| name == EXPECTATIONS || name.ends_with(ENDING));
    if mistakes.is_empty() { Ok(files.iter().filter_map(|file| as_case(file)).collect()) } else { Err(mistakes) }
}

impl Case {
    fn read(files: Files) -> Result<Case, Vec<Diagnostic>> {
        let checked = scenarios::check(&files.scenario, &[]);
        let scripts_report = checked.as_ref().map_or(true, |checked| checked.plan.script().is_some());
        let expectations = || {
            if !files.expectations.is_file() {
                let mistake = Diagnostic::new(format!("{} is missing", shown_path(&files.expectations)));
                return Err(vec![mistake.hint("it says what the run must give: `droptower explain expect`")]);
            }
            expectations::read(&files.expectations, scripts_report)
        };
        let (checked, expectations) = scenarios::both(checked, expectations())?;
        let recorded = Recorded::read(&files.signals, &files.figures).map_err(|mistake| vec![mistake])?;
        Ok(Case { name: shown_path(&files.name).to_string(), checked, expectations, recorded, files })
    }

    /// Records what was given; whether that is another than before.
    pub(super) fn bless(&self, recorded: &Recorded) -> Result<bool, (PathBuf, io::Error)> {
        let signals = recorded.signals.as_ref().map(|signals| {
            let mut text = Vec::new();
            csv::write(signals, &mut text).map(|()| text)
        });
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |error| (path, error)
        };
        let signals = signals.transpose().map_err(|error| (self.files.signals.clone(), io::Error::other(error)))?;
        let figures = match recorded.figures.is_empty() {
            true => None,
            false => Some(serde_json::to_vec_pretty(&recorded.figures).map_err(io::Error::other)),
        };
        let figures = figures.transpose().map_err(failed(&self.files.figures))?;
        let renew = |path: &Path, content: Option<Vec<u8>>| {
            let before = fs::read(path).ok();
            match &content {
                Some(content) if before.as_ref() != Some(content) => file::replace(path, content)?,
                None if before.is_some() => fs::remove_file(path)?,
                _ => return Ok(false),
            }
            Ok(true)
        };
        let of_signals = renew(&self.files.signals, signals).map_err(failed(&self.files.signals))?;
        let of_figures = renew(&self.files.figures, figures).map_err(failed(&self.files.figures))?;
        Ok(of_signals || of_figures)
    }
}
