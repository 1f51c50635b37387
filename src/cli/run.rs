//! `droptower run`: runs scenarios and writes their run folders.

use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;
use serde_json::Value;

use crate::args::{Choice, ViewerArgs, choice};
use crate::checkpoint::{self, CheckpointPolicy, CheckpointWriter};
use crate::failure::{all, both, evaluating, hinted};
use crate::folder::{self, Contents, ResultArgs};
use crate::live::{Show, Viewer};
use crate::progress::{Bar, Forecast};
use crate::scenarios::{Checked, Selection};
use crate::{Failure, Shared, batch, print_json, print_unless_quiet};
use base::diagnostic::{Diagnostic, printable, shown_path};
use base::file;
use base::number::duration;
use membrane::lane::Width;
use report::RunPage;
use scene::simulate::{
    self, Cancellation, Checkpoint, Checkpoints, Outcome, Progress, RunError, RunOptions, SnapshotEvent,
};
use study::evaluate::{EvaluationError, Evaluations};
use study::post::{self, EvaluateError};
use study::store::{self, Draft, Origin, run_files};

#[derive(Debug, Args)]
pub(super) struct RunArgs {
    #[command(flatten)]
    pub selection: Selection,
    #[command(flatten)]
    pub results: ResultArgs,
    /// Write a checkpoint after every such simulated time ("5 ms"), from which --resume continues an interrupted run
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub checkpoint_every: Option<String>,
    /// Resume an interrupted run from its newest checkpoint; the results are the same to the bit. A complete run is left
    /// as it is; of several begun scenarios, those without a checkpoint start from their beginning
    #[arg(long)]
    pub resume: bool,
    #[command(flatten)]
    pub viewer: ViewerArgs,
    /// Vector instructions of the kernels; left out, the widest that the processor has. Results are the same to the bit
    #[arg(long, value_name = "WIDTH", value_parser = choice(&WIDTHS))]
    pub width: Option<Width>,
    /// Also write the snapshots for ParaView: film.pvd, impactor.pvd, frame.pvd (the bars) and springs.pvd, with strain, stress
    /// and thickness
    #[arg(long)]
    pub vtu: bool,
}

/// Vector instructions that a run may have, by word.
const WIDTHS: [Choice<Width>; 3] = [
    ("baseline", "Those that every processor of the platform has", Width::Baseline),
    ("avx2", "256 bits", Width::Avx2),
    ("avx512", "512 bits", Width::Avx512),
];

/// Refuses instructions that the processor does not have.
fn check_width(width: Width) -> Result<Width, Diagnostic> {
    let name = match width {
        _ if width.supported() == width => return Ok(width),
        Width::Baseline => "baseline instructions",
        Width::Avx2 => "AVX2",
        Width::Avx512 => "AVX-512",
    };
    let mistake = Diagnostic::new(format!("this processor does not have {name}"));
    Err(mistake.hint("leave `--width` out for the widest instructions that it has"))
}

/// A scenario and the folder of its results, checked before the first run starts.
struct Job {
    checked: Checked,
    place: PathBuf,
    /// Its checkpoints, if it has any.
    writer: Option<CheckpointWriter>,
    /// Whether snapshots are also written for ParaView.
    vtu: bool,
    /// Whether results of another scenario are replaced.
    force: bool,
    /// Its vector instructions, where they are chosen.
    width: Option<Width>,
    /// Ends the run.
    cancellation: Cancellation,
}

/// The result of a job, for the terminal.
#[derive(Default)]
pub(super) struct Done {
    pub text: String,
    pub summary: Option<Value>,
    pub failure: Option<Failure>,
    /// Whether the results are on the disk.
    stored: bool,
}

pub(super) fn run(args: &RunArgs, shared: &Shared) -> Result<(), Failure> {
    let apart =
        args.viewer.live.as_ref().and_then(|_| args.selection.scenarios.iter().find(|given| given.contains("://")));
    if let Some(address) = apart {
        let mistake = Diagnostic::new(format!("{} is an address, not a scenario", printable(address)));
        let hint = format!("write the address without a space: --live={}", printable(address));
        return Err(mistake.hint(hint).into());
    }
    let stop = Cancellation::default();
    let (viewer, Runs { jobs, complete }) = both(args.viewer.viewer(), runs(args, &stop))?;
    batch::cancel_on_interrupt(stop)?;
    let bar = Bar::new(jobs.len(), shared.quiet);
    complete.iter().for_each(|left| bar.report(&left.warning));
    let warnings = jobs.iter().filter_map(|job| job.writer.as_ref()).flat_map(|writer| &writer.warnings);
    warnings.for_each(|warning| bar.report(warning));
    for Checked { model, plan, .. } in jobs.iter().map(|job| &job.checked) {
        plan.findings().iter().for_each(|finding| bar.finding(&model.name, finding));
    }
    let computed = compute(jobs, &bar, viewer.as_ref(), shared);
    let failure = Failure::all(computed.iter().filter_map(|done| done.failure.clone()));
    let left = complete.into_iter().map(|left| Done { summary: Some(left.summary), ..Done::default() });
    let printed = show(&left.chain(computed).collect::<Vec<_>>(), shared);
    failure.map_or(printed, Err)
}

/// Runs checked scenarios, each into the folder beside it, whatever was there; why one failed, if so.
pub(super) fn run_all(runs: Vec<(Checked, PathBuf)>, shared: &Shared) -> Option<Failure> {
    let jobs: Vec<Job> =
        runs.into_iter().map(|(checked, place)| Job::plain(checked, place, Cancellation::default())).collect();
    let bar = Bar::new(jobs.len(), shared.quiet);
    Failure::all(compute(jobs, &bar, None, shared).into_iter().filter_map(|done| done.failure))
}

/// The results of jobs, whose progress `bar` shows.
fn compute(jobs: Vec<Job>, bar: &Bar, viewer: Option<&Viewer>, shared: &Shared) -> Vec<Done> {
    // Each is dropped once it is done: a batch takes no more memory for the runs that are behind it.
    let run = |(index, job): (usize, Job)| {
        let done = job.run(bar, index, viewer);
        Done { summary: done.summary.filter(|_| shared.json), ..done }
    };
    // One run has all threads to itself; several share them.
    let computed = match jobs.len() {
        1 => jobs.into_iter().enumerate().map(run).collect(),
        _ => jobs.into_par_iter().enumerate().map(run).collect(),
    };
    bar.finish();
    computed
}

/// Runs a checked scenario into the folder, until it is cancelled.
pub(super) fn one(
    checked: Checked,
    place: &Path,
    cancellation: &Cancellation,
    viewer: Option<&Viewer>,
    shared: &Shared,
) -> Done {
    let bar = Bar::new(1, shared.quiet);
    let done = Job::plain(checked, place.to_owned(), cancellation.clone()).run(&bar, 0, viewer);
    bar.finish();
    done
}

/// The runs of a command.
struct Runs {
    jobs: Vec<Job>,
    /// The runs that `--resume` need not repeat.
    complete: Vec<Complete>,
}

/// A run that is complete already.
struct Complete {
    warning: checkpoint::Warning,
    /// Its stored figures.
    summary: Value,
}

/// All scenarios checked, each with the folder of its results, or all their mistakes.
fn runs(args: &RunArgs, stop: &Cancellation) -> Result<Runs, Failure> {
    let every = args.checkpoint_every.as_deref().map(checkpoint::interval).transpose();
    let width = args.width.map(check_width).transpose();
    let ((every, width), scenarios) = both(both(every, width), args.selection.checked())?;
    let several = scenarios.len() > 1;
    let ResultArgs { out, force } = &args.results;
    let places = scenarios.iter().map(|checked| place(out.as_deref(), &checked.model.name, several));
    let places: Vec<PathBuf> = places.collect::<Result<_, _>>()?;
    store::check_places(&places)?;
    let origin = |(checked, place): (&Checked, &PathBuf)| Origin::of_run(checked.document.path()).check(place);
    all(scenarios.iter().zip(&places).filter(|_| !force).map(origin))?;
    // An interrupted batch leaves complete runs, runs with checkpoints, and runs that had not started.
    let (mut complete, mut rest) = (vec![], vec![]);
    for (checked, place) in scenarios.into_iter().zip(places) {
        if args.resume
            && let Some(summary) = complete_summary(&checked, &place, args.vtu)
        {
            let warning = checkpoint::Warning::Complete { run: checked.model.name, folder: place };
            complete.push(Complete { warning, summary });
        } else {
            rest.push((checked, place));
        }
    }
    let is_begun = !complete.is_empty() || rest.iter().any(|(_, place)| checkpoint::are_beside(place));
    let or_start = args.resume && several && is_begun;
    let policy = CheckpointPolicy { every, resume: args.resume, or_start, detailed: args.vtu };
    let job = |(checked, place): (Checked, PathBuf)| -> Result<Job, Diagnostic> {
        let may_begin = or_start || checkpoint::are_beside(&place);
        if args.resume && !may_begin && complete_summary(&checked, &place, false).is_some() {
            let message = format!("{} is complete without ParaView files: {}", checked.model.name, shown_path(&place));
            return Err(Diagnostic::new(message).hint("run it without --resume for its ParaView files"));
        }
        let writer = CheckpointWriter::new(policy, &checked, &place)?;
        Ok(Job { checked, place, writer, vtu: args.vtu, force: *force, width, cancellation: stop.clone() })
    };
    let mut jobs = all(rest.into_iter().map(job))?;
    let every = jobs.iter().find_map(|job| job.writer.as_ref()?.every());
    for Job { checked, writer, .. } in &mut jobs {
        if let (Some(every), Some(writer)) = (every, writer) {
            writer.default_interval(every, checked.model.run_time());
        }
    }
    Ok(Runs { jobs, complete })
}

/// The figures in the folder `place`, where it holds the results of the scenario and of the files that it reads as they
/// are now, with the files for ParaView where these are wanted.
fn complete_summary(checked: &Checked, place: &Path, vtu: bool) -> Option<Value> {
    let read = |name: &str| file::read_text(&place.join(name), run_files::MOST_BYTES).ok();
    let stored = read(run_files::SCENARIO)?;
    let is_same = resolved(checked, place).is_ok_and(|now| now == stored);
    let is_whole = is_same && (!vtu || place.join(run_files::FILM_SERIES).exists());
    serde_json::from_str(&read(run_files::SUMMARY).filter(|_| is_whole)?).ok()
}

/// The scenario as the folder `place` holds it, with the digest of all that decides its results.
///
/// # Errors
/// A mesh or the reference cannot be read.
fn resolved(checked: &Checked, place: &Path) -> Result<String, EvaluationError> {
    let Checked { document, model, plan } = checked;
    Ok(format!(
        "# droptower {}\n{}# digest: {}\n{}",
        env!("CARGO_PKG_VERSION"),
        Origin::of_run(document.path()).line(place),
        Evaluations::keys(model, plan)?.figures,
        document.resolved_beside_script(run_files::POST_SCRIPT)
    ))
}

fn place(out: Option<&Path>, name: &str, several: bool) -> Result<PathBuf, store::StoreError> {
    match out {
        Some(folder) if !several => Ok(folder.into()),
        Some(folder) => store::place(folder, name),
        None => store::default_place(name),
    }
}

/// A run that ended before its time, or whose post script failed.
struct Unfinished<'a> {
    outcome: &'a Outcome,
    /// Why, in the words of its folder and page.
    cause: String,
    mistake: Diagnostic,
    /// The failure of the command with this mistake.
    failure: fn(Diagnostic) -> Failure,
}

impl Job {
    /// A run without checkpoints, whatever is in its folder.
    fn plain(checked: Checked, place: PathBuf, cancellation: Cancellation) -> Job {
        Job { checked, place, writer: None, vtu: false, force: true, width: None, cancellation }
    }

    fn run(&self, bar: &Bar, index: usize, viewer: Option<&Viewer>) -> Done {
        let scenario = match resolved(&self.checked, &self.place) {
            Ok(scenario) => scenario,
            Err(error) => {
                let mistake = Diagnostic::new(format!("{}: {error}", self.checked.model.name));
                return Done::failed(mistake.into());
            }
        };
        self.note_replaced(&scenario, bar);
        let mut show = Show::begin(viewer, &self.checked, &scenario, bar);
        let done = match self.simulate(bar, index, &mut show) {
            Err(failure) => return Done::failed(failure),
            Ok(Ok(outcome)) => self.store(&outcome, &scenario, show),
            Ok(Err(RunError::Cancelled)) => Done::failed(Failure::output(self.stopped())),
            Ok(Err(RunError::Failure(failure))) => self.store_failed(&failure, &scenario, show),
            Ok(Err(error)) => {
                Done::failed(hinted(&format!("{}: {error}", self.checked.model.name), error.hint()).into())
            }
        };
        // The last checkpoint stays where the results could not be stored or the post script failed: a run resumed from
        // it gives them again.
        if let Some(writer) = self.writer.as_ref().filter(|_| done.stored) {
            writer.clear();
        }
        done
    }

    /// A run that Ctrl-C stopped: what of it is kept.
    fn stopped(&self) -> Diagnostic {
        let mistake = Diagnostic::new(format!("{} was stopped before its end", self.checked.model.name));
        mistake.hint(match checkpoint::are_beside(&self.place) {
            true => "its checkpoints are kept: the same command with --resume goes on from the last",
            false => "nothing of it is kept; --checkpoint-every keeps what is computed",
        })
    }

    /// Says which keys of a run that is about to be replaced were others.
    fn note_replaced(&self, scenario: &str, bar: &Bar) {
        if let Some(note) = folder::replaced_scenario(&self.place, "a run", scenario).filter(|_| !self.force) {
            bar.note(&note);
        }
    }

    /// The run itself, from its checkpoint where it resumes, with its progress shown by `bar`.
    fn simulate(&self, bar: &Bar, index: usize, show: &mut Show) -> Result<Result<Outcome, RunError>, Failure> {
        let model = &self.checked.model;
        let mut restart = None;
        if let Some(writer) = &self.writer {
            restart = writer.start()?;
            writer.create_folder().map_err(Failure::output)?;
        }
        if let Some(restart) = &restart {
            bar.note(&format!("{} resumes at {}", model.name, duration(restart.time())));
            bar.start_at(index, restart.time() / model.run_time());
        }
        let every = self.writer.as_ref().and_then(CheckpointWriter::every);
        let mut forecast = Forecast::default();
        let mut progress = |progress: Progress| {
            bar.show(index, progress);
            if let Some(left) = forecast.update(&progress, bar.elapsed()) {
                bar.note(&left.message(model, every.is_some()));
            }
        };
        let mut lost = 0_usize;
        let mut write = |checkpoint: &Checkpoint<'_>| {
            if let Some(mistake) = self.writer.as_ref().and_then(|writer| writer.write(checkpoint).err()) {
                // A full disk stays full: one message is enough.
                if lost == 0 {
                    bar.error(&mistake.hint("the run continues; its last complete checkpoint stays"));
                }
                lost += 1;
            }
        };
        let checkpoints = every.map(|every| Checkpoints { every, write: &mut write });
        let is_on = show.is_on();
        let mut update = |event: &SnapshotEvent<'_>| show.update(event);
        let on_snapshot = is_on.then_some(&mut update as &mut dyn FnMut(&SnapshotEvent<'_>));
        let cancellation = self.cancellation.clone();
        let options = RunOptions {
            restart,
            checkpoints,
            on_snapshot,
            cancellation,
            width: self.width,
            detailed: self.vtu,
            ..RunOptions::default()
        };
        let outcome = simulate::run_with(model, options, &mut progress);
        if lost > 1 {
            bar.error(&Diagnostic::new(format!("{}: {lost} checkpoints could not be written", model.name)));
        }
        Ok(outcome)
    }

    fn store(&self, outcome: &Outcome, scenario: &str, show: Show) -> Done {
        let model = &self.checked.model;
        let results = match self.checked.plan.evaluate(model, outcome) {
            Ok(results) => results,
            Err(error) => {
                let mistake = evaluating(&error);
                let cause = match &error {
                    EvaluateError::Script(fault) => fault.to_string(),
                    EvaluateError::Filter(_) => mistake.message.clone(),
                };
                let failure = if error.may_pass() { Failure::output } else { Failure::from };
                let done = self.store_unfinished(&Unfinished { outcome, cause, mistake, failure }, scenario, show);
                // Another post script may follow from the last checkpoint.
                return Done { stored: false, ..done };
            }
        };
        let contents = Contents { results: Some(&results), failure: None, ..self.contents(outcome, scenario) };
        let stored = Draft::begin(&self.place, self.origin(), self.force).and_then(|draft| {
            let files = folder::fill(&draft, &contents)?;
            Ok((draft.publish()?, files))
        });
        // The viewer may be slow: it gets the results after they are stored.
        show.finish(Some(&RunPage { model, outcome, results: &results, scenario, failure: None, files: &[] }));
        match stored {
            Ok((place, files)) => {
                let text = [folder::summary_of_run(model, outcome, &results), folder::listing(&place, &files)].concat();
                Done { text, summary: Some(results.summary(model).into()), failure: None, stored: true }
            }
            Err(error) => Done::failed(Failure::unstored(&error)),
        }
    }

    fn store_failed(&self, failure: &simulate::Failure, scenario: &str, show: Show) -> Done {
        let cause = post::failure_message(failure, &self.checked.model);
        let mistake = Diagnostic::new(format!("{}: {cause}", self.checked.model.name));
        let outcome = &failure.so_far;
        self.store_unfinished(&Unfinished { outcome, cause, mistake, failure: Failure::numerical }, scenario, show)
    }

    /// Stores a run that has no whole results beside those of its folder.
    fn store_unfinished(&self, run: &Unfinished<'_>, scenario: &str, show: Show) -> Done {
        let Unfinished { outcome, cause, mistake, failure } = run;
        let model = &self.checked.model;
        // It may be too short or too irregular to be measured; then only its signals are written.
        let results = self.checked.plan.measure(model, outcome).ok();
        let contents = Contents { results: results.as_ref(), failure: Some(cause), ..self.contents(outcome, scenario) };
        let stored = Draft::begin(&self.place, self.origin(), self.force).and_then(|draft| {
            folder::fill(&draft, &contents)?;
            draft.publish_failed()
        });
        let page = |results| RunPage { model, outcome, results, scenario, failure: Some(cause), files: &[] };
        show.finish(results.as_ref().map(page).as_ref());
        let text = results.as_ref().map_or_else(String::new, |results| folder::summary_of_failed(model, results));
        match stored {
            Ok(place) => {
                let kept = format!("what was computed before is in {}", place.display());
                let hint = mistake.hint.iter().chain([&kept]).map(String::as_str).collect::<Vec<_>>().join("; ");
                Done { stored: true, text, ..Done::failed(failure(mistake.clone().hint(hint))) }
            }
            Err(error) => {
                let failures = [failure(mistake.clone()), Failure::unstored(&error)];
                Done { text, failure: Failure::all(failures), ..Done::default() }
            }
        }
    }

    /// What is stored of a run, without results.
    fn contents<'a>(&'a self, outcome: &'a Outcome, scenario: &'a str) -> Contents<'a> {
        let Checked { model, plan, .. } = &self.checked;
        Contents { model, outcome, results: None, scenario, script: plan.script(), failure: None, vtu: self.vtu }
    }

    fn origin(&self) -> Origin {
        Origin::of_run(self.checked.document.path())
    }
}

impl Done {
    fn failed(failure: Failure) -> Done {
        Done { failure: Some(failure), ..Done::default() }
    }
}

fn show(done: &[Done], shared: &Shared) -> Result<(), Failure> {
    if shared.json {
        return match done {
            [Done { summary: Some(summary), .. }] => print_json(summary),
            [_] => Ok(()),
            several => print_json(&several.iter().map(|done| &done.summary).collect::<Vec<_>>()),
        };
    }
    let text = done.iter().map(|done| done.text.as_str()).collect::<Vec<_>>().concat();
    if text.is_empty() { Ok(()) } else { print_unless_quiet(shared, text.trim_end()) }
}
