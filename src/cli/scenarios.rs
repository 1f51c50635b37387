//! The scenarios that the arguments name.

use std::cell::RefCell;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use clap::Args;

use super::changes::Changes;
use super::complete;
use super::faults::preparing;
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use scene::model::{self, Model};
use scene::scenario::{Assignment, Document};
use scene::simulate;
use study::post::Plan;

/// Scenarios, and changes of their keys.
#[derive(Debug, Args)]
pub(super) struct Selection {
    /// Scenario files or globs
    #[arg(required = true, value_name = "SCENARIO", add = complete::scenarios())]
    pub scenarios: Vec<String>,
    #[command(flatten)]
    pub changes: Changes,
}

/// A scenario as written and as checked, with the plan of its results.
#[derive(Clone, Debug)]
pub(super) struct Checked {
    pub document: Document,
    pub model: Model,
    pub plan: Plan,
}

impl Selection {
    /// The scenarios, checked.
    ///
    /// # Errors
    /// The mistakes of all scenarios at once.
    pub(super) fn checked(&self) -> Result<Vec<Checked>, Vec<Diagnostic>> {
        let (mut checked, mut mistakes) = (Vec::new(), Vec::new());
        let known = RefCell::default();
        let check =
            |path: &Path, assignments: &[Assignment]| known_plan(changed(path, assignments)?, &mut known.borrow_mut());
        for (_, verdict) in self.each(check)? {
            match verdict {
                Ok(scenario) => checked.push(scenario),
                Err(found) => mistakes.extend(found),
            }
        }
        if mistakes.is_empty() { Ok(checked) } else { Err(mistakes) }
    }

    /// Every file with what `check` gives for it.
    ///
    /// # Errors
    /// Mistakes in the arguments themselves.
    pub(super) fn each<T>(
        &self,
        check: impl Fn(&Path, &[Assignment]) -> T,
    ) -> Result<Vec<(PathBuf, T)>, Vec<Diagnostic>> {
        let (files, assignments) = both(files(&self.scenarios), self.changes.assignments())?;
        let checked = |file: PathBuf| {
            let found = check(&file, &assignments);
            (file, found)
        };
        Ok(files.into_iter().map(checked).collect())
    }
}

/// A checked scenario, or its mistakes.
pub(super) type Verdict = Result<Checked, Vec<Diagnostic>>;

/// Checks the scenario at `path` with `assignments` applied.
pub(super) fn check(path: &Path, assignments: &[Assignment]) -> Verdict {
    of_document(changed(path, assignments)?)
}

/// The scenario at `path` with `assignments` applied.
pub(super) fn changed(path: &Path, assignments: &[Assignment]) -> Result<Document, Vec<Diagnostic>> {
    let document = Document::read(path)?;
    if document.is_material() {
        return Err(vec![material(path)]);
    }
    Ok(document.with(assignments))
}

/// Checks a scenario that was read.
pub(super) fn of_document(document: Document) -> Verdict {
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
fn files(patterns: &[String]) -> Result<Vec<PathBuf>, Vec<Diagnostic>> {
    let (mut files, mut known, mut mistakes) = (Vec::new(), HashSet::new(), Vec::new());
    for pattern in patterns {
        match matches(pattern) {
            Ok(found) => files.extend(found.into_iter().filter(|file| known.insert(file.clone()))),
            Err(mistake) => mistakes.push(mistake),
        }
    }
    if mistakes.is_empty() { Ok(files) } else { Err(mistakes) }
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
pub(super) fn expanded(pattern: &str) -> Result<Vec<PathBuf>, Diagnostic> {
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

/// Both values, or the mistakes of both.
pub(super) fn both<A, B>(
    a: Result<A, Vec<Diagnostic>>,
    b: Result<B, Vec<Diagnostic>>,
) -> Result<(A, B), Vec<Diagnostic>> {
    match (a, b) {
        (Ok(a), Ok(b)) => Ok((a, b)),
        (Err(a), Err(b)) => Err(a.into_iter().chain(b).collect()),
        (Err(mistakes), _) | (_, Err(mistakes)) => Err(mistakes),
    }
}
