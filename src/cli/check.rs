//! `droptower check`: scenarios and materials checked without running them, all mistakes at once.

use std::path::Path;

use clap::Args;
use serde::Serialize;

use super::scenarios::{self, Selection};
use super::{Failure, Shared, print, print_json};
use crate::diagnostic::{Diagnostic, shown_path};
use crate::model;
use crate::scenario::{Assignment, Document};

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    pub selection: Selection,
}

/// The mistakes of one file.
#[derive(Serialize)]
struct Verdict {
    path: String,
    ok: bool,
    mistakes: Vec<Mistake>,
}

#[derive(Serialize)]
struct Mistake {
    message: String,
    file: Option<String>,
    line: Option<usize>,
    column: Option<usize>,
    hint: Option<String>,
}

pub(super) fn run(args: &CheckArgs, shared: &Shared) -> Result<(), Failure> {
    let found = args.selection.each(mistakes)?.into_iter();
    let found: Vec<(String, Vec<Diagnostic>)> = found.map(|(file, mistakes)| (shown_path(&file), mistakes)).collect();
    let wrong: Vec<Diagnostic> = found.iter().flat_map(|(_, mistakes)| mistakes.clone()).collect();
    if shared.json {
        print_json(&found.iter().map(|(path, mistakes)| verdict(path, mistakes)).collect::<Vec<_>>())?;
        return if wrong.is_empty() { Ok(()) } else { Err(Failure::from(vec![])) };
    }
    let good = found.iter().filter(|(_, mistakes)| mistakes.is_empty());
    let good: Vec<String> = good.map(|(path, _)| format!("ok  {path}")).collect();
    if !shared.quiet && !good.is_empty() {
        print(&good.join("\n"))?;
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.into()) }
}

/// The mistakes of a scenario or a material.
fn mistakes(path: &Path, assignments: &[Assignment]) -> Vec<Diagnostic> {
    let is_material = Document::read(path).is_ok_and(|document| document.is_material());
    if !is_material {
        return scenarios::check(path, assignments).err().unwrap_or_default();
    }
    let material = Document::read_material(path).map(|document| document.with(assignments));
    material.and_then(|material| model::check_material(&material)).err().unwrap_or_default()
}

fn verdict(path: &str, mistakes: &[Diagnostic]) -> Verdict {
    Verdict { path: path.into(), ok: mistakes.is_empty(), mistakes: mistakes.iter().map(mistake).collect() }
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
