//! `droptower sweep`: many runs of a scenario whose keys vary.

mod progress;
mod results;

use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use super::changes::Changes;
use super::complete;
use super::farm::{self, Ends, ShardArgs};
use super::faults::{preparing, storing};
use super::live_page::LivePage;
use super::scenarios::both;
use super::{Failure, Shared, findings, print_figures};
use base::diagnostic::{Diagnostic, printable, printable_json, shown_path};
use progress::Progress;
use results::Keep;
use scene::scenario::Document;
use study::evaluate::{EvaluationError, Evaluations};
use study::post::ranking_figure;
use study::store::evaluations::Share;
use study::store::{self, Origin, ProgressFolder};
use study::sweep::{Done, Stop, Sweep, SweepError, SweepResults, Work};

#[derive(Debug, Args)]
pub(super) struct SweepArgs {
    /// The scenario, with a table [variation]
    #[arg(add = complete::scenarios())]
    pub scenario: PathBuf,
    /// Number of runs, in place of `variation.samples`
    #[arg(short = 'n', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: Option<u32>,
    #[command(flatten)]
    pub changes: Changes,
    /// Folder for the results, in place of runs/<name of the scenario>.sweep
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace results of another scenario or script in the same folder
    #[arg(long)]
    pub force: bool,
    /// Also write the run folders of these runs: worst:3, all, or numbers (4,17)
    #[arg(long, value_name = "WHICH")]
    pub keep: Option<String>,
    /// Figure by which runs are ranked: the largest is the worst, of figures such as a depth by size
    #[arg(long, value_name = "FIGURE")]
    pub figure: Option<String>,
    #[command(flatten)]
    pub farm: ShardArgs,
    /// Compute nothing: gather what all processes have done
    #[arg(long, conflicts_with_all = ["shard", "stop_after"])]
    pub merge: bool,
    /// Folder of the evaluations that are never computed twice
    #[arg(long, value_name = "DIR", default_value = store::EVALUATIONS)]
    pub store: PathBuf,
}

/// The sweep that the arguments ask for, checked.
struct Task {
    sweep: Sweep,
    document: Document,
    evaluations: Evaluations,
    place: PathBuf,
    keep: Keep,
    stop: Stop,
    page: LivePage,
}

impl Task {
    /// What signals end.
    fn ends(&self) -> Ends {
        Ends { stop: self.stop.requested.clone(), given_up: self.stop.given_up.clone() }
    }
}

pub(super) fn run(args: &SweepArgs, shared: &Shared) -> Result<(), Failure> {
    let begin = Instant::now();
    let task = task(args, shared, begin)?;
    let page = &task.page;
    let (ends, told) = (task.ends(), page.clone());
    farm::end_on_signals(ends, move || told.stopping())?;
    let swept = page.during(|| swept(&task, args, shared, begin));
    if let Err(failure) = &swept {
        // No more than the first end of a page counts: results may be stored, and runs have failed.
        if task.ends().is_over() { page.stopped() } else { page.failed(failure) }
    }
    swept
}

/// Computes the runs, and stores the results.
fn swept(task: &Task, args: &SweepArgs, shared: &Shared, begin: Instant) -> Result<(), Failure> {
    let Task { sweep, evaluations, stop, page, .. } = task;
    if !args.merge {
        page.begin_sweep(args.figure.as_deref().unwrap_or(ranking_figure(sweep.model())));
    }
    let progress = Progress::new(sweep.len(), shared);
    let is_part = evaluations.share() != Share::WHOLE;
    let work = Work { sweep, evaluations, waits: !is_part, stop, gather: args.merge };
    let done = work.run(&|event| {
        progress.show(&event);
        page.note_sweep(&event, evaluations);
    });
    progress.finish();
    let done = done.map_err(|error| failed(&error))?;
    if done.len() < sweep.len() {
        return unfinished(task, &done, args, shared);
    }
    if is_part {
        page.discard();
        return print_figures(shared, &partly(&done, sweep), || shard_text(&done, sweep));
    }
    let mut found = SweepResults::from_evaluations(sweep, &done, evaluations).map_err(|error| failed(&error))?;
    found.findings.extend(findings::of_runs(&found.run_findings()));
    results::store(task, &found, args, shared, begin.elapsed().as_secs_f64())
}

/// All arguments checked, or all their mistakes.
fn task(args: &SweepArgs, shared: &Shared, begin: Instant) -> Result<Task, Failure> {
    let ((keep, share), (deadline, assignments)) =
        both(both(keep(args), args.farm.share()), both(args.farm.deadline(begin), args.changes.assignments()))?;
    let document = Document::read(&args.scenario)?.with(&assignments);
    let samples = args.samples.map(|samples| samples as usize);
    let sweep = Sweep::prepare(&document, samples).map_err(|error| refused(&error, &document))?;
    check_changes(args, &sweep)?;
    keep.check(sweep.len())?;
    let place = place(args, &sweep.model().name)?;
    let page = page(&sweep.model().name, ProgressFolder::new(&place, share), shared);
    let runs = page.clone();
    let evaluations = Evaluations::open(&args.store).map_err(|error| failed(&error))?.with_share(share);
    let evaluations = evaluations.with_observer(move |event| runs.note_run(&event));
    let stop = Stop { deadline, ..Stop::default() };
    Ok(Task { sweep, document, evaluations, place, keep, stop, page })
}

/// The page of the sweep; where it is, is a note, or an event for a program.
fn page(name: &str, folder: ProgressFolder, shared: &Shared) -> LivePage {
    let (events, quiet, path) = (shared.json, shared.quiet, folder.page().display().to_string());
    LivePage::new(name, folder, move |line| {
        let line = match events {
            true => {
                printable_json(&serde_json::json!({ "event": "page", "path": path, "text": line }).to_string()).into()
            }
            false => printable(&format!("note: {line}")).to_string(),
        };
        if !quiet {
            // Whoever follows may have gone.
            let _ = writeln!(io::stderr(), "{line}");
        }
    })
}

/// Refuses to change a key that varies: each run would give it another value.
fn check_changes(args: &SweepArgs, sweep: &Sweep) -> Result<(), Vec<Diagnostic>> {
    let is_part =
        |path: &str, of: &str| path.strip_prefix(of).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    let changed = args.changes.set.iter().filter_map(|change| change.split('=').next()).map(str::trim);
    let mistake = |path: &str| {
        let factors = &sweep.variation().factors;
        let varied = &factors.iter().find(|factor| is_part(path, &factor.path))?.path;
        let mistake = Diagnostic::new(format!("`{varied}` varies, so --set {path}=… would change nothing"));
        Some(mistake.hint(format!("give it one value: --set 'variation.\"{varied}\"=[…]'")))
    };
    let mistakes: Vec<Diagnostic> = changed.filter_map(mistake).collect();
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes) }
}

fn place(args: &SweepArgs, name: &str) -> Result<PathBuf, Failure> {
    let place = match &args.out {
        Some(folder) => folder.clone(),
        None => store::default_place(&format!("{name}.sweep")).map_err(|error| storing(&error))?,
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

pub(super) fn refused(error: &SweepError, document: &Document) -> Failure {
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
    let hint = error.hint().map(str::to_owned);
    Failure::output(Diagnostic { hint, ..Diagnostic::new(error.to_string()) })
}

/// The object that a process prints of a sweep that is not complete.
fn partly(done: &Done, sweep: &Sweep) -> serde_json::Value {
    serde_json::json!({
        "scenario": sweep.model().name,
        "runs": sweep.len(),
        "reused": done.cache_hits,
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
    let Task { sweep, evaluations, page, .. } = task;
    let (name, missing) = (&sweep.model().name, sweep.len() - done.len());
    if evaluations.share() != Share::WHOLE {
        page.stopped();
        return print_figures(shared, &partly(done, sweep), || {
            format!("{name}: {} runs computed here, {missing} of {} are not done yet", done.computed, sweep.len())
        });
    }
    if !args.merge {
        results::store_stopped(task, done)?;
        page.stopped();
    }
    print_figures(shared, &partly(done, sweep), String::new)?;
    let mistake = Diagnostic::new(format!("{name}: {missing} of {} runs are not done", sweep.len()));
    let hint = match args.merge {
        true => "run `droptower sweep` without --merge: it computes what is missing".to_owned(),
        false => format!(
            "what is done stays, and the same command goes on from there; {} has it so far",
            shown_path(page.folder().path())
        ),
    };
    Err(Failure::output(mistake.hint(hint)))
}
