//! `droptower check`: everything that is wrong with scenarios and materials, at once.

use std::path::Path;
use std::process::ExitCode;

use clap::Args;
use serde::Serialize;

use super::{BAD_INPUT, Shared, print, print_json, report, scenarios};
use crate::diagnostic::{Diagnostic, shown_path};
use crate::model;
use crate::scenario::{Assignment, Document};

#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Scenario files, material files or globs
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<String>,
    /// Change a key: key.path=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// What was found in one file.
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

pub fn run(args: &CheckArgs, shared: &Shared) -> ExitCode {
    let files = match scenarios::files(&args.files) {
        Ok(files) => files,
        Err(mistakes) => return report(&mistakes),
    };
    let assignments = match scenarios::assignments(&args.set) {
        Ok(assignments) => assignments,
        Err(mistakes) => return report(&mistakes),
    };
    let mut wrong = Vec::new();
    let mut verdicts = Vec::new();
    for file in &files {
        let mistakes = mistakes(file, &assignments);
        verdicts.push(verdict(shown_path(file), &mistakes));
        wrong.extend(mistakes);
    }
    if shared.json {
        print_json(&verdicts);
    } else if !shared.quiet {
        let good = verdicts.iter().filter(|verdict| verdict.ok);
        let lines: Vec<String> = good.map(|verdict| format!("ok  {}", verdict.path)).collect();
        if !lines.is_empty() {
            print(&lines.join("\n"));
        }
    }
    match (wrong.is_empty(), shared.json) {
        (true, _) => ExitCode::SUCCESS,
        (false, true) => ExitCode::from(BAD_INPUT),
        (false, false) => report(&wrong),
    }
}

/// What is wrong with the file, as the scenario or the material that it is.
fn mistakes(path: &Path, assignments: &[Assignment]) -> Vec<Diagnostic> {
    let is_material = Document::read(path).is_ok_and(|document| document.is_material());
    if !is_material {
        return scenarios::check(path, assignments).err().unwrap_or_default();
    }
    let material = Document::read_material(path).map(|document| document.with(assignments));
    material.and_then(|material| model::check_material(&material)).err().unwrap_or_default()
}

fn verdict(path: String, mistakes: &[Diagnostic]) -> Verdict {
    Verdict { path, ok: mistakes.is_empty(), mistakes: mistakes.iter().map(mistake).collect() }
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
