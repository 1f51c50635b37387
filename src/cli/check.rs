//! `droptower check`: everything that is wrong with scenarios, at once.

use std::process::ExitCode;

use clap::Args;
use serde::Serialize;

use super::scenarios::Selection;
use super::{BAD_INPUT, Shared, print, print_json, report};
use crate::diagnostic::{Diagnostic, shown_path};

#[derive(Debug, Args)]
pub struct CheckArgs {
    #[command(flatten)]
    pub selection: Selection,
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
    let found = match args.selection.verdicts() {
        Ok(found) => found,
        Err(mistakes) => return report(&mistakes),
    };
    let found: Vec<(String, Vec<Diagnostic>)> =
        found.into_iter().map(|(file, verdict)| (shown_path(&file), verdict.err().unwrap_or_default())).collect();
    let wrong: Vec<Diagnostic> = found.iter().flat_map(|(_, mistakes)| mistakes.clone()).collect();
    if shared.json {
        let printed = print_json(&found.iter().map(|(path, mistakes)| verdict(path, mistakes)).collect::<Vec<_>>());
        return if wrong.is_empty() { printed } else { ExitCode::from(BAD_INPUT) };
    }
    let good = found.iter().filter(|(_, mistakes)| mistakes.is_empty());
    let good: Vec<String> = good.map(|(path, _)| format!("ok  {path}")).collect();
    if !shared.quiet && !good.is_empty() {
        print(&good.join("\n"));
    }
    if wrong.is_empty() { ExitCode::SUCCESS } else { report(&wrong) }
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
