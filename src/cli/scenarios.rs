//! The scenarios that the arguments name, and files that say what a run must give.

use std::cell::RefCell;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::args::Changes;
use crate::explain::{finding, misspelt_finding, similar_finding};
use crate::failure::{all, both, preparing, refuse};
use crate::{Failure, shell};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use scene::expectation::Expectations;
use scene::model::{self, Model};
use scene::scenario::{Assignment, Document};
use scene::simulate;
use study::post::Plan;

/// Scenarios, and changes of their keys.
#[derive(Debug, Args)]
pub(crate) struct Selection {
    /// Scenario files or globs
    #[arg(required = true, value_name = "SCENARIO", add = shell::scenarios())]
    pub scenarios: Vec<String>,
    #[command(flatten)]
    pub changes: Changes,
}

/// A scenario as written and as checked, with the plan of its results.
#[derive(Clone, Debug)]
pub(crate) struct Checked {
    pub document: Document,
    pub model: Model,
    pub plan: Plan,
}

impl Selection {
    /// The scenarios, checked.
    ///
    /// # Errors
    /// The mistakes of all scenarios at once.
    pub(crate) fn checked(&self) -> Result<Vec<Checked>, Failure> {
        let known = RefCell::default();
        let check =
            |path: &Path, assignments: &[Assignment]| known_plan(changed(path, assignments)?, &mut known.borrow_mut());
        all(self.each(check)?.into_iter().map(|(_, verdict)| verdict))
    }

    /// Every file with what `check` gives for it.
    ///
    /// # Errors
    /// Mistakes in the arguments themselves.
    pub(crate) fn each<T>(&self, check: impl Fn(&Path, &[Assignment]) -> T) -> Result<Vec<(PathBuf, T)>, Failure> {
        let (files, assignments) = both(files(&self.scenarios), self.changes.assignments())?;
        let checked = |file: PathBuf| {
            let found = check(&file, &assignments);
            (file, found)
        };
        Ok(files.into_iter().map(checked).collect())
    }
}

/// A checked scenario, or its mistakes.
pub(crate) type Verdict = Result<Checked, Failure>;

/// Checks the scenario at `path` with `assignments` applied.
pub(crate) fn check(path: &Path, assignments: &[Assignment]) -> Verdict {
    of_document(changed(path, assignments)?)
}

/// The scenario at `path` with `assignments` applied.
pub(crate) fn changed(path: &Path, assignments: &[Assignment]) -> Result<Document, Failure> {
    let document = Document::read(path)?;
    if document.is_material() {
        return Err(material(path).into());
    }
    Ok(document.with(assignments))
}

/// Checks a scenario that was read.
pub(crate) fn of_document(document: Document) -> Verdict {
    known_plan(document, &mut Vec::new())
}

/// Checks a scenario that was read. References and scripts that it has in common with one of the `known` are theirs: a batch
/// of hundreds mostly has the same.
fn known_plan(document: Document, known: &mut Vec<(Model, Plan)>) -> Verdict {
    let model = model::check(&document)?;
    simulate::check(&document, &model)?;
    let plan = match known.iter().find(|(other, _)| Plan::is_common(&model, other)) {
        Some((_, plan)) => plan.clone(),
        None => {
            let plan = Plan::prepare(&model).map_err(|error| preparing(&error))?;
            known.push((model.clone(), plan.clone()));
            plan
        }
    };
    let warnings = model::warnings(&document, &model);
    let plan = plan.with_findings(warnings.iter().map(Finding::new).collect());
    Ok(Checked { document, model, plan })
}

fn material(path: &Path) -> Diagnostic {
    let shown = shown_path(path);
    let mistake = Diagnostic::new(format!("{shown} is a material, not a scenario"));
    mistake.hint(format!("name it in a scenario under [specimen]: material = \"{shown}\""))
}

/// The files that paths and globs name, each once, in the order of the arguments. A shell expands globs
/// itself; elsewhere, and in quotes, they are expanded here.
fn files(patterns: &[String]) -> Result<Vec<PathBuf>, Failure> {
    each_once(patterns.iter().map(|pattern| matches(pattern)))
}

/// The files that paths and globs name, each once, in the order of the arguments.
pub(crate) fn paths(patterns: &[String]) -> Result<Vec<PathBuf>, Failure> {
    each_once(patterns.iter().map(|pattern| expanded(pattern)))
}

fn each_once(files: impl Iterator<Item = Result<Vec<PathBuf>, Diagnostic>>) -> Result<Vec<PathBuf>, Failure> {
    let mut known = HashSet::new();
    let mut files = all(files)?.concat();
    files.retain(|file| known.insert(file.clone()));
    Ok(files)
}

fn matches(pattern: &str) -> Result<Vec<PathBuf>, Diagnostic> {
    let path = Path::new(pattern);
    if path.is_dir() {
        let mistake = Diagnostic::new(format!("{} is a folder", shown_path(path)));
        return Err(mistake.hint(format!("its scenarios are \"{}\"", shown_path(&path.join("*.toml")))));
    }
    if path.extension().is_some_and(|extension| extension == "rhai") {
        let mistake = Diagnostic::new(format!("{} is a script", shown_path(path)));
        return Err(mistake.hint(format!("run it with `droptower script {}`", shown_path(path))));
    }
    expanded(pattern)
}

/// The files that a path or a glob names.
pub(crate) fn expanded(pattern: &str) -> Result<Vec<PathBuf>, Diagnostic> {
    if Path::new(pattern).exists() || !pattern.contains(['*', '?', '[']) {
        return Ok(vec![PathBuf::from(pattern)]);
    }
    let paths = glob::glob(pattern).map_err(|error| Diagnostic::new(format!("`{pattern}`: {error}")))?;
    let files: Vec<PathBuf> = paths.filter_map(Result::ok).filter(|path| path.is_file()).collect();
    if files.is_empty() {
        return Err(Diagnostic::new(format!("no file matches `{pattern}`")));
    }
    Ok(files)
}

/// The expectations in the file at `path`. A code that no finding has would never come: it is a mistake, unless scripts may
/// report codes of their own and it is not close to a known one.
pub(crate) fn expectations(path: &Path, scripts_report: bool) -> Result<Expectations, Failure> {
    let document = Document::read_expectations(path)?;
    let expectations = Expectations::check(&document)?;
    let lists = [("must", &expectations.must), ("must_not", &expectations.must_not)];
    let mut mistakes = Vec::new();
    for (key, codes) in lists {
        let unknown = codes.iter().filter(|code| *code != "*" && finding(code).is_none());
        for code in unknown.filter(|code| !scripts_report || misspelt_finding(code).is_some()) {
            let mistake =
                Diagnostic::new(format!("there is no finding `{code}`")).at(&document.span_of(&["warnings", key]));
            let hint = similar_finding(code).unwrap_or_else(|| "`droptower explain findings` lists them".into());
            mistakes.push(mistake.hint(hint));
        }
    }
    refuse(mistakes).map(|()| expectations)
}
