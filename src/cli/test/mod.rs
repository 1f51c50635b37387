//! `droptower test`: scenarios against what their runs must give.

mod cases;
mod junit;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::faults::{evaluating, storing};
use super::{Failure, Shared, folder, output, print_figures};
use base::diagnostic::{Diagnostic, printable, shown_path};
use base::number::time_taken;
use cases::Case;
use scene::expectation::{Difference, Given, Verdict};
use scene::simulate::{self, Cancellation, RunError, RunOptions};
use study::post::{Results, failure_message};
use study::store::{self, Draft, Origin};

#[derive(Debug, Args)]
pub(super) struct TestArgs {
    /// Folders to search for cases, folders of cases, or files called *.test.toml
    #[arg(value_name = "PATH", default_value = ".")]
    pub paths: Vec<PathBuf>,
    /// Record signals and figures of the runs anew, in place of comparing them
    #[arg(long)]
    pub bless: bool,
    /// Only cases whose path contains this text
    #[arg(long, value_name = "TEXT")]
    pub filter: Option<String>,
    /// Also write the verdicts as JUnit XML
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Folder for the page with recorded and new signals
    #[arg(long, value_name = "DIR", default_value = "runs/test")]
    pub out: PathBuf,
    /// Replace results of tests of other paths or of something else in the same folder, and a file of something else by --junit
    #[arg(long)]
    pub force: bool,
}

pub(super) fn run(args: &TestArgs, shared: &Shared) -> Result<(), Failure> {
    let begin = Instant::now();
    free(args)?;
    let cases = cases::all(&args.paths, args.filter.as_deref())?;
    let verdicts: Vec<Verdict> = cases.par_iter().map(|case| verdict(case, args, shared)).collect::<Result<_, _>>()?;
    let seconds = begin.elapsed().as_secs_f64();
    let summary = summary(args, &verdicts, seconds);
    let files = store(args, &verdicts, &summary)?;
    print_figures(shared, &summary, || [text(&verdicts, seconds), files].concat())?;
    match verdicts.iter().filter(|verdict| !verdict.has_passed()).count() {
        0 => Ok(()),
        _ if shared.json => Err(Failure::quiet()),
        failed => {
            let mistake = Diagnostic::new(format!("{failed} of {} tests failed", verdicts.len()));
            let page = shown_path(&args.out.join(store::run_files::REPORT));
            let hint = match args.bless {
                true => format!("the records are those of these runs; see {page} for what they are not to be"),
                false => format!("{page} shows new over recorded; if the new is right: droptower test --bless"),
            };
            Err(Failure::output(mistake.hint(hint)))
        }
    }
}

/// Checks that the results replace nothing of the user's.
fn free(args: &TestArgs) -> Result<(), Failure> {
    if let Some(file) = &args.junit {
        junit::check(file, args.force)?;
    }
    store::check_places(std::slice::from_ref(&args.out)).map_err(|error| storing(&error))?;
    if !args.force {
        Origin::of_tests(&args.paths).check(&args.out).map_err(|error| storing(&error))?;
    }
    Ok(())
}

/// Runs a case, and tells at once where it fails.
fn verdict(case: &Case, args: &TestArgs, shared: &Shared) -> Result<Verdict, Failure> {
    let begin = Instant::now();
    let mut verdict = Verdict {
        name: case.name.clone(),
        expectations: case.expectations.clone(),
        differences: vec![],
        recorded: case.recorded.clone(),
        signals: None,
        seconds: 0.0,
        blessed: false,
    };
    match results(case) {
        Ok(results) => {
            let figures = results.summary(&case.checked.model);
            let given = Given { signals: &results.signals, figures: &figures };
            if args.bless {
                let recorded = case.expectations.recorded(&given);
                verdict.blessed = case.bless(&recorded).map_err(|(path, error)| output::failed(&path, &error))?;
                verdict.recorded = recorded;
            }
            verdict.differences = case.expectations.differences(&verdict.recorded, &given);
            verdict.signals = Some(results.signals);
        }
        Err(cause) => verdict.differences = vec![Difference::RunFailed { cause }],
    }
    verdict.seconds = begin.elapsed().as_secs_f64();
    if !shared.quiet && !shared.json {
        let line = told(&verdict);
        let _ = writeln!(io::stderr(), "{}", printable(&line));
    }
    Ok(verdict)
}

/// The results of a run of the case, or why there are none.
fn results(case: &Case) -> Result<Results, String> {
    let cases::Checked { model, plan, .. } = &case.checked;
    let options = RunOptions { cancellation: Cancellation::default(), ..RunOptions::default() };
    let outcome = simulate::run_with(model, options, &mut |_| {}).map_err(|error| match error {
        RunError::Failure(failure) => failure_message(&failure, model),
        error => error.to_string(),
    })?;
    plan.evaluate(model, &outcome).map_err(|error| evaluating(&error).message)
}

/// The line that a case leaves when it ends.
fn told(verdict: &Verdict) -> String {
    let time = time_taken(verdict.seconds);
    match (verdict.has_passed(), verdict.blessed) {
        (true, true) => format!("recorded  {}  {time}", verdict.name),
        (true, false) => format!("ok        {}  {time}", verdict.name),
        (false, _) => format!("FAILED    {}  {time}", verdict.name),
    }
}

fn summary(args: &TestArgs, verdicts: &[Verdict], seconds: f64) -> Map<String, Value> {
    let failed = verdicts.iter().filter(|verdict| !verdict.has_passed()).count();
    let entries: Vec<_> = verdicts.iter().map(Verdict::entry).collect();
    let figures = json!({
        "droptower": env!("CARGO_PKG_VERSION"),
        "passed": verdicts.len() - failed,
        "failed": failed,
        "seconds": seconds,
        "cases": entries,
        "paths": args.paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
        store::run_files::WORKING_FOLDER: store::path_from(&args.out, Path::new(".")),
    });
    match figures {
        Value::Object(figures) => figures,
        _ => Map::new(),
    }
}

fn text(verdicts: &[Verdict], seconds: f64) -> String {
    let mut lines = Vec::new();
    for verdict in verdicts.iter().filter(|verdict| !verdict.has_passed()) {
        lines.push(verdict.name.clone());
        lines.extend(verdict.differences.iter().map(|difference| format!("  {difference}")));
    }
    let failed = verdicts.iter().filter(|verdict| !verdict.has_passed()).count();
    let passed = verdicts.len() - failed;
    lines.push(format!("{passed} passed, {failed} failed, {}", time_taken(seconds)));
    lines.join("\n") + "\n"
}

/// Writes the page, the summary and the JUnit file; the lines that name them.
fn store(args: &TestArgs, verdicts: &[Verdict], summary: &Map<String, Value>) -> Result<String, Failure> {
    let stored = Draft::begin(&args.out, Origin::of_tests(&args.paths), args.force).and_then(|draft| {
        let files = folder::fill_tests(&draft, verdicts, summary)?;
        Ok((draft.publish()?, files))
    });
    let (place, files) = stored.map_err(|error| Failure::output(storing(&error)))?;
    if let Some(junit) = &args.junit {
        output::write(junit, |file| junit::write(file, verdicts))?;
    }
    Ok(super::digest::folder(Path::new(&place), &files))
}
