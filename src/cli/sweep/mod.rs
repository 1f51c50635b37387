//! `droptower sweep`: many runs of a scenario whose keys vary.

mod progress;
mod results;
mod signals;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;

use super::faults::{preparing, storing};
use super::scenarios::{both, changes};
use super::{Failure, Shared, print_figures};
use crate::diagnostic::{Diagnostic, Source, Span, shown_path};
use crate::post::{EvaluationError, Evaluations};
use crate::scenario::Document;
use crate::store::{self, Origin};
use crate::sweep::{Done, Share, Stop, Sweep, SweepError, SweepResults, Work};
use crate::units::Time;
use progress::Progress;
use results::Keep;

#[derive(Debug, Args)]
pub(super) struct SweepArgs {
    /// The scenario, with a table [variation]
    pub scenario: PathBuf,
    /// Number of runs, in place of `variation.samples`
    #[arg(short = 'n', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: Option<u32>,
    /// Change a key: key.path=value
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Leave out a key that the scenario gives or inherits: key.path
    #[arg(long, value_name = "KEY")]
    pub unset: Vec<String>,
    /// Folder for the results, in place of runs/<name of the scenario>.sweep
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace results of another scenario or script in the same folder
    #[arg(long)]
    pub force: bool,
    /// Also write the run folders of these runs: worst:3, all, or numbers (4,17)
    #[arg(long, value_name = "WHICH")]
    pub keep: Option<String>,
    /// The figure by which runs are the worst: the largest
    #[arg(long, value_name = "FIGURE")]
    pub figure: Option<String>,
    /// Take this part of the runs first, then what no other process has begun: 3/16
    #[arg(long, value_name = "K/N")]
    pub shard: Option<String>,
    /// Stop before this wall time is over ("50min"); what is done stays
    #[arg(long, value_name = "TIME")]
    pub stop_after: Option<String>,
    /// Compute nothing: gather what all processes have done
    #[arg(long, conflicts_with_all = ["shard", "stop_after"])]
    pub merge: bool,
    /// Folder of the evaluations that are never computed twice
    #[arg(long, value_name = "DIR", default_value = store::EVALUATIONS)]
    pub store: PathBuf,
}

/// What the arguments say, checked.
struct Task {
    sweep: Sweep,
    document: Document,
    evaluations: Evaluations,
    place: PathBuf,
    keep: Keep,
    share: Share,
    stop: Stop,
}

pub(super) fn run(args: &SweepArgs, shared: &Shared) -> Result<(), Failure> {
    let begin = Instant::now();
    let task = task(args, begin)?;
    let Task { sweep, evaluations, share, stop, .. } = &task;
    signals::cancel_on_termination(&stop.requested)?;
    let progress = Progress::new(sweep.len(), shared);
    let work = Work { sweep, evaluations, share: *share, stop, gather: args.merge };
    let done = work.run(&|event| progress.show(&event));
    progress.finish();
    let done = done.map_err(|error| failed(&error))?;
    if done.len() < sweep.len() {
        return unfinished(&task, &done, args, shared);
    }
    if *share != Share::WHOLE {
        return print_figures(shared, &partly(&done, sweep), || shard_text(&done, sweep));
    }
    let found = SweepResults::of(sweep, &done, evaluations).map_err(|error| failed(&error))?;
    results::store(&task, &found, args, shared, begin.elapsed().as_secs_f64())
}

/// All arguments checked, or all their mistakes.
fn task(args: &SweepArgs, begin: Instant) -> Result<Task, Failure> {
    let ((keep, share), (deadline, assignments)) =
        both(both(keep(args), share(args)), both(deadline(args, begin), changes(&args.set, &args.unset)))?;
    let document = Document::read(&args.scenario)?.with(&assignments);
    let samples = args.samples.map(|samples| samples as usize);
    let sweep = Sweep::prepare(&document, samples).map_err(|error| refused(&error, &document))?;
    let place = place(args, &sweep.model().name)?;
    let evaluations = Evaluations::open(&args.store).map_err(|error| failed(&error))?;
    let stop = Stop { deadline, ..Stop::default() };
    Ok(Task { sweep, document, evaluations, place, keep, share, stop })
}

fn place(args: &SweepArgs, name: &str) -> Result<PathBuf, Failure> {
    let place = match &args.out {
        Some(folder) => folder.clone(),
        None => store::place(Path::new("runs"), &format!("{name}.sweep")).map_err(|error| storing(&error))?,
    };
    store::check_places(std::slice::from_ref(&place)).map_err(|error| storing(&error))?;
    if !args.force {
        Origin::of_sweep(&args.scenario).check(&place).map_err(|error| storing(&error))?;
    }
    Ok(place)
}

fn keep(args: &SweepArgs) -> Result<Keep, Vec<Diagnostic>> {
    let Some(text) = &args.keep else { return Ok(Keep::None) };
    Keep::parse(text).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("expected worst:3, all, or numbers of runs, found \"{text}\""));
        vec![mistake.hint("--keep worst:3 writes the folders of the three worst runs")]
    })
}

fn share(args: &SweepArgs) -> Result<Share, Vec<Diagnostic>> {
    let Some(text) = &args.shard else { return Ok(Share::WHOLE) };
    Share::parse(text).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("expected a part of the runs, found \"{text}\""));
        vec![mistake.hint("the third of sixteen processes is --shard 3/16")]
    })
}

/// Latest time at which a run may end.
fn deadline(args: &SweepArgs, begin: Instant) -> Result<Option<Instant>, Vec<Diagnostic>> {
    let Some(text) = &args.stop_after else { return Ok(None) };
    let source = Source::unfiled("--stop-after", text.clone());
    let mistake = |message: String, hint: String| {
        vec![Diagnostic::new(message).at(&Span::new(&source, 0..text.len())).hint(hint)]
    };
    let seconds = Time::DIMENSION.parse(text).map_err(|error| mistake(error.to_string(), error.hint()))?;
    let limit = Duration::try_from_secs_f64(seconds).ok().and_then(|limit| begin.checked_add(limit));
    match limit {
        Some(limit) if seconds > 0.0 => Ok(Some(limit)),
        _ => Err(mistake(format!("no run ends within {text}"), "write it like \"50 min\"".into())),
    }
}

fn refused(error: &SweepError, document: &Document) -> Failure {
    match error {
        SweepError::Scenario(mistakes) => mistakes.clone().into(),
        SweepError::NothingVaries => {
            let mistake = Diagnostic::new(format!("{} has no table [variation]", shown_path(document.path())));
            mistake.hint("write which keys vary: `droptower explain variation`").into()
        }
        SweepError::Points(error) => {
            let mistake = Diagnostic::new(error.to_string()).at(&document.key_span("variation"));
            Diagnostic { hint: error.hint().map(str::to_owned), ..mistake }.into()
        }
        SweepError::Prepare(error) => preparing(error).into(),
    }
}

fn failed(error: &EvaluationError) -> Failure {
    Failure::output(Diagnostic::new(error.to_string()))
}

/// What a process says of a sweep that is not complete.
fn partly(done: &Done, sweep: &Sweep) -> serde_json::Value {
    serde_json::json!({
        "scenario": sweep.model().name,
        "runs": sweep.len(),
        "reused": done.taken,
        "computed": done.computed,
        "missing": sweep.len() - done.len(),
        "engine_s": done.engine_s,
    })
}

fn shard_text(done: &Done, sweep: &Sweep) -> String {
    format!("{}: {} of {} runs computed here, all are done", sweep.model().name, done.computed, sweep.len())
}

/// A sweep that has runs left is not stored: a table of a part would be taken for the whole.
fn unfinished(task: &Task, done: &Done, args: &SweepArgs, shared: &Shared) -> Result<(), Failure> {
    let Task { sweep, share, .. } = task;
    let (name, missing) = (&sweep.model().name, sweep.len() - done.len());
    if *share != Share::WHOLE {
        return print_figures(shared, &partly(done, sweep), || {
            format!("{name}: {} runs computed here, {missing} of {} are not done yet", done.computed, sweep.len())
        });
    }
    print_figures(shared, &partly(done, sweep), String::new)?;
    let mistake = Diagnostic::new(format!("{name}: {missing} of {} runs are not done", sweep.len()));
    let hint = match args.merge {
        true => "run `droptower sweep` without --merge: it computes what is missing",
        false => "what is done stays: the same command goes on from there",
    };
    Err(Failure::output(mistake.hint(hint)))
}
