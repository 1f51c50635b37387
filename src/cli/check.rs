//! `droptower check`: everything that is wrong with scenarios, at once.

use std::process::ExitCode;

use clap::Args;
use serde::Serialize;

use super::{BAD_INPUT, Shared, print, print_json, report, scenarios};
use crate::diagnostic::{Diagnostic, shown_path};

#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Scenario files or globs
    #[arg(required = true, value_name = "SCENARIO")]
    pub scenarios: Vec<String>,
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
    let files = match scenarios::files(&args.scenarios) {
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
        let mistakes = scenarios::check(file, &assignments).err().unwrap_or_default();
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
