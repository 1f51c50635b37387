//! `droptower run`: simulate, compare, record, report.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use rayon::prelude::*;
use serde_json::Value;

use super::faults::{WRITE_FAILURE, evaluating, storing};
use super::folder::{self, Contents, SCRIPT};
use super::progress::Bar;
use super::scenarios::{Checked, Selection};
use super::{BAD_INPUT, NUMERICAL_FAILURE, Shared, digest, print, print_json, report};
use crate::diagnostic::Diagnostic;
use crate::simulate::{self, Failure, Outcome, Progress, RunError};
use crate::store::{self, Draft};

#[derive(Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub selection: Selection,
    /// Folder for the results, in place of runs/<name of the scenario>
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// A scenario and where its results go, proved before the first run starts.
struct Job {
    checked: Checked,
    place: PathBuf,
}

/// What the terminal shows of a job.
struct Done {
    status: u8,
    text: String,
    summary: Option<Value>,
    mistakes: Vec<Diagnostic>,
}

pub fn run(args: &RunArgs, shared: &Shared) -> ExitCode {
    let jobs = match jobs(args) {
        Ok(jobs) => jobs,
        Err(mistakes) => return report(&mistakes),
    };
    let bar = Bar::new(jobs.len(), shared.quiet);
    let run = |(index, job): (usize, &Job)| job.run(&mut |progress| bar.show(index, progress));
    // One run has all threads to itself; several share them.
    let done: Vec<Done> = match jobs.as_slice() {
        [job] => vec![run((0, job))],
        jobs => jobs.par_iter().enumerate().map(run).collect(),
    };
    bar.finish();
    show(&done, shared);
    ExitCode::from(done.iter().map(|done| done.status).max().unwrap_or(0))
}

/// Checks and places of all scenarios, or all their mistakes.
fn jobs(args: &RunArgs) -> Result<Vec<Job>, Vec<Diagnostic>> {
    let scenarios = args.selection.checked()?;
    let several = scenarios.len() > 1;
    let (mut jobs, mut mistakes) = (Vec::new(), Vec::new());
    for checked in scenarios {
        match place(args.out.as_deref(), &checked.model.name, several) {
            Ok(place) => jobs.push(Job { checked, place }),
            Err(error) => mistakes.push(storing(&error)),
        }
    }
    let places: Vec<PathBuf> = jobs.iter().map(|job| job.place.clone()).collect();
    mistakes.extend(store::check_places(&places).err().map(|error| storing(&error)));
    if mistakes.is_empty() { Ok(jobs) } else { Err(mistakes) }
}

fn place(out: Option<&Path>, name: &str, several: bool) -> Result<PathBuf, store::StoreError> {
    match out {
        Some(folder) if !several => Ok(folder.into()),
        Some(folder) => store::place(folder, name),
        None => store::place(Path::new("runs"), name),
    }
}

impl Job {
    fn run(&self, progress: &mut dyn FnMut(Progress)) -> Done {
        match simulate::run(&self.checked.model, progress) {
            Ok(outcome) => self.keep(&outcome).unwrap_or_else(|(status, mistake)| self.broken(status, mistake)),
            Err(RunError::Failure(failure)) => self.keep_failed(&failure),
            Err(error) => self.broken(BAD_INPUT, Diagnostic::new(format!("{}: {error}", self.checked.model.name))),
        }
    }

    fn keep(&self, outcome: &Outcome) -> Result<Done, (u8, Diagnostic)> {
        let model = &self.checked.model;
        let results =
            self.checked.plan.evaluate(model, outcome, |_| {}).map_err(|error| (BAD_INPUT, evaluating(&error)))?;
        let contents = Contents {
            model,
            outcome,
            results: Some(&results),
            scenario: &self.resolved(),
            script: self.checked.plan.script(),
            failure: None,
        };
        let stored = Draft::begin(&self.place).and_then(|draft| {
            let files = folder::fill(&draft, &contents)?;
            Ok((draft.publish()?, files))
        });
        let (place, files) = stored.map_err(|error| (WRITE_FAILURE, storing(&error)))?;
        let text = [digest::run(model, outcome, &results), digest::folder(&place, &files)].concat();
        Ok(Done { status: 0, text, summary: Some(results.summary(model).into()), mistakes: Vec::new() })
    }

    fn keep_failed(&self, failure: &Failure) -> Done {
        let (model, outcome) = (&self.checked.model, &failure.so_far);
        // What broke off may be too short or too wild to be measured; then its signals stand alone.
        let results = self.checked.plan.measure(model, outcome).ok();
        let scenario = self.resolved();
        let cause = failure.cause.to_string();
        let script = self.checked.plan.script();
        let contents =
            Contents { model, outcome, results: results.as_ref(), scenario: &scenario, script, failure: Some(&cause) };
        let stored = Draft::begin(&self.place).and_then(|draft| {
            folder::fill(&draft, &contents)?;
            draft.publish_failed()
        });
        let mistake = Diagnostic::new(format!("{}: {cause}", model.name));
        match stored {
            Ok(place) => {
                let hint = format!("what was computed so far is in {}", place.display());
                self.broken(NUMERICAL_FAILURE, mistake.hint(hint))
            }
            Err(error) => {
                let mut done = self.broken(NUMERICAL_FAILURE, mistake);
                done.mistakes.push(storing(&error));
                done
            }
        }
    }

    fn broken(&self, status: u8, mistake: Diagnostic) -> Done {
        Done { status, text: String::new(), summary: None, mistakes: vec![mistake] }
    }

    fn resolved(&self) -> String {
        format!("# droptower {}\n{}", env!("CARGO_PKG_VERSION"), self.checked.document.resolved_beside_script(SCRIPT))
    }
}

fn show(done: &[Done], shared: &Shared) {
    let mistakes: Vec<Diagnostic> = done.iter().flat_map(|done| done.mistakes.clone()).collect();
    if !mistakes.is_empty() {
        report(&mistakes);
    }
    if shared.json {
        match done {
            [Done { summary: Some(summary), .. }] => drop(print_json(summary)),
            [_] => {}
            several => drop(print_json(&several.iter().map(|done| &done.summary).collect::<Vec<_>>())),
        }
        return;
    }
    let text = done.iter().map(|done| done.text.as_str()).collect::<Vec<_>>().concat();
    if !shared.quiet && !text.is_empty() {
        print(text.trim_end());
    }
}
