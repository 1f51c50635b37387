//! `droptower check`: scenarios and materials checked without running them, all mistakes at once.

use std::path::Path;

use clap::Args;
use serde::Serialize;

use super::scenarios::{self, Selection};
use super::{Failure, Shared, findings, print, print_json};
use crate::diagnostic::{Diagnostic, shown_path};
use crate::finding::Finding;
use crate::model;
use crate::scenario::{Assignment, Document};

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    pub selection: Selection,
}

/// The mistakes of one file, or what is reported of it without them.
#[derive(Serialize)]
struct Verdict {
    path: String,
    ok: bool,
    mistakes: Vec<Mistake>,
    findings: Vec<Finding>,
}

/// Findings of a file, or its mistakes.
type Checked = Result<Vec<Finding>, Vec<Diagnostic>>;

#[derive(Serialize)]
struct Mistake {
    message: String,
    file: Option<String>,
    line: Option<usize>,
    column: Option<usize>,
    hint: Option<String>,
}

pub(super) fn run(args: &CheckArgs, shared: &Shared) -> Result<(), Failure> {
    let found = args.selection.each(check)?.into_iter();
    let found: Vec<(String, Checked)> = found.map(|(file, checked)| (shown_path(&file), checked)).collect();
    let mistakes = found.iter().filter_map(|(_, checked)| checked.as_ref().err());
    let wrong: Vec<Diagnostic> = mistakes.flatten().cloned().collect();
    if shared.json {
        print_json(&found.into_iter().map(verdict).collect::<Vec<_>>())?;
        return if wrong.is_empty() { Ok(()) } else { Err(Failure::from(vec![])) };
    }
    let good = found.iter().filter_map(|(path, checked)| Some((path, checked.as_ref().ok()?)));
    let good: String = good.map(|(path, found)| format!("ok  {path}\n{}", findings::lines("  ", found))).collect();
    if !shared.quiet && !good.is_empty() {
        print(good.trim_end())?;
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.into()) }
}

/// Checks a scenario or a material.
fn check(path: &Path, assignments: &[Assignment]) -> Checked {
    let is_material = Document::read(path).is_ok_and(|document| document.is_material());
    if !is_material {
        return Ok(scenarios::check(path, assignments)?.plan.findings().to_vec());
    }
    let material = Document::read_material(path)?.with(assignments);
    model::check_material(&material)?;
    let implausible = material.implausible().into_iter();
    Ok(implausible.map(|value| Finding::new(&model::Warning::Value(value))).collect())
}

fn verdict((path, checked): (String, Checked)) -> Verdict {
    match checked {
        Ok(findings) => Verdict { path, ok: true, mistakes: vec![], findings },
        Err(mistakes) => {
            let mistakes = mistakes.iter().map(mistake).collect();
            Verdict { path, ok: false, mistakes, findings: vec![] }
        }
    }
}

fn mistake(found: &Diagnostic) -> Mistake {
    let start = found.span.as_ref().map(|span| span.start());
    Mistake {
        message: found.message.clone(),
        file: found.span.as_ref().map(|span| span.source.name.clone()),
        line: start.map(|(line, _)| line),
        column: start.map(|(_, column)| column),
        hint: found.hint.clone(),
    }
}
