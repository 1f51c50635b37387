//! `droptower sweep`: many runs of a scenario whose keys vary.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use crate::args::Changes;
use crate::failure::{both, hinted, preparing, refuse};
use crate::farm::{self, Ends, ShardArgs};
use crate::live_page::LivePage;
use crate::progress::SweepBar;
use crate::run::run_all;
use crate::scenarios;
use crate::{Failure, Shared, folder, print_figures, shell, terminal};
use base::diagnostic::{Diagnostic, printable, printable_json, shown_path};
use base::number::time_taken;
use base::shell::quoted;
use report::SweepPage;
use scene::scenario::Document;
use study::evaluate::{EvaluationError, Evaluations};
use study::post::{self, ranking_figure};
use study::script::Row;
use study::store::evaluations::Share;
use study::store::{self, Draft, Origin, ProgressFolder, STOPPED, STOPPED_TABLE, StoreError};
use study::sweep::{Done, Effects, Stop, Sweep, SweepError, SweepResults, Work};

#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    /// The scenario, with a table [variation]
    #[arg(add = shell::scenarios())]
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

pub(crate) fn run(args: &SweepArgs, shared: &Shared) -> Result<(), Failure> {
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
    let progress = SweepBar::new(sweep.len(), shared);
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
    found.findings.extend(terminal::findings_of_runs(&found.run_findings(), &found.findings));
    store(task, &found, args, shared, begin.elapsed().as_secs_f64())
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
    let replaced = folder::replaced_scenario(&place, "a sweep", &document.resolved());
    if let Some(note) = replaced.filter(|_| !args.force && share == Share::WHOLE) {
        tell(["replaces", &place.display().to_string(), &note], shared.json, shared.quiet);
    }
    let page = page(&sweep.model().name, ProgressFolder::new(&place, share), shared);
    let runs = page.clone();
    let evaluations = Evaluations::new(&args.store).with_share(share);
    let evaluations = evaluations.with_observer(move |event| runs.note_run(&event));
    let stop = Stop { deadline, ..Stop::default() };
    Ok(Task { sweep, document, evaluations, place, keep, stop, page })
}

/// The page of the sweep; where it is, is a note, or an event for a program.
fn page(name: &str, folder: ProgressFolder, shared: &Shared) -> LivePage {
    let (events, quiet, path) = (shared.json, shared.quiet, folder.page().display().to_string());
    LivePage::new(name, folder, move |line| tell(["page", &path, line], events, quiet))
}

/// Prints a note about the `path` on standard error, as an event for a program; nothing if `quiet`.
fn tell([event, path, text]: [&str; 3], events: bool, quiet: bool) {
    let line = match events {
        true => {
            printable_json(&serde_json::json!({ "event": event, "path": path, "text": text }).to_string()).to_string()
        }
        false => printable(&format!("note: {text}")).to_string(),
    };
    if !quiet {
        // Whoever follows may have gone.
        let _ = writeln!(io::stderr(), "{line}");
    }
}

/// Refuses to change a key that varies: each run would give it another value.
fn check_changes(args: &SweepArgs, sweep: &Sweep) -> Result<(), Failure> {
    let is_part =
        |path: &str, of: &str| path.strip_prefix(of).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    let changed = args.changes.set.iter().filter_map(|change| change.split('=').next()).map(str::trim);
    let mistake = |path: &str| {
        let factors = &sweep.variation().factors;
        let varied = &factors.iter().find(|factor| is_part(path, &factor.path))?.path;
        let mistake = Diagnostic::new(format!("`{varied}` varies, so --set {path}=… would change nothing"));
        Some(mistake.hint(format!("give it one value: --set 'variation.\"{varied}\"=[…]'")))
    };
    refuse(changed.filter_map(mistake))
}

fn place(args: &SweepArgs, name: &str) -> Result<PathBuf, Failure> {
    folder::place(args.out.as_deref(), &format!("{name}.sweep"), args.force, &Origin::of_sweep(&args.scenario))
}

fn keep(args: &SweepArgs) -> Result<Keep, Diagnostic> {
    let Some(text) = &args.keep else { return Ok(Keep::None) };
    Keep::parse(text).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("expected worst:3, all, or numbers of runs, found \"{text}\""));
        mistake.hint("--keep worst:3 writes the folders of the three worst runs")
    })
}

pub(crate) fn refused(error: &SweepError, document: &Document) -> Failure {
    match error {
        SweepError::Scenario(mistakes) => mistakes.clone().into(),
        SweepError::NothingVaries => {
            let mistake = Diagnostic::new(format!("{} has no table [variation]", shown_path(document.path())));
            mistake.hint("write which keys vary: `droptower explain variation`").into()
        }
        SweepError::Points(mistake) => mistake.clone().at(&document.key_span("variation")).into(),
        SweepError::Prepare(error) => preparing(error).into(),
    }
}

fn failed(error: &EvaluationError) -> Failure {
    Failure::output(hinted(error, error.hint()))
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
        store_stopped(task, done)?;
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

/// Which runs have folders of their own.
#[derive(Clone, Debug, PartialEq)]
enum Keep {
    None,
    All,
    /// So many of the worst.
    Worst(usize),
    /// The runs of these numbers, from one.
    Numbers(Vec<usize>),
}

impl Keep {
    pub(crate) fn parse(text: &str) -> Option<Keep> {
        if text == "all" {
            return Some(Keep::All);
        }
        if let Some(count) = text.strip_prefix("worst:") {
            return count.parse().ok().filter(|count| *count > 0).map(Keep::Worst);
        }
        let numbers: Option<Vec<usize>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        numbers.filter(|numbers| numbers.iter().all(|number| *number > 0)).map(Keep::Numbers)
    }

    /// Refuses numbers that a sweep of so many runs does not have.
    pub(crate) fn check(&self, runs: usize) -> Result<(), Diagnostic> {
        let Keep::Numbers(numbers) = self else { return Ok(()) };
        match numbers.iter().find(|number| **number > runs) {
            Some(number) => Err(Diagnostic::new(format!("--keep: there is no run {number} of {runs}"))),
            None => Ok(()),
        }
    }

    /// The places of the runs, from zero, each once.
    fn places(&self, found: &SweepResults, figure: &str) -> Vec<usize> {
        match self {
            Keep::None => vec![],
            Keep::All => (0..found.table.rows()).collect(),
            Keep::Worst(count) => found.worst(figure, *count),
            Keep::Numbers(numbers) => {
                let places: BTreeSet<usize> = numbers.iter().map(|number| number - 1).collect();
                places.into_iter().collect()
            }
        }
    }
}

/// The figure by which runs are ranked: the one that is asked for, which the runs must have if any has figures.
fn figure_of<'a>(sweep: &Sweep, found: &SweepResults, asked: Option<&'a str>) -> Result<&'a str, Diagnostic> {
    let figure = asked.unwrap_or(ranking_figure(sweep.model()));
    let figures = found.table.figures();
    let is_known = figures.is_empty() || figures.iter().any(|column| column.name == figure);
    if asked.is_none() || is_known {
        return Ok(figure);
    }
    let names: Vec<&str> = found.statistics.iter().map(|(name, _)| name.as_str()).collect();
    let mistake = Diagnostic::new(format!("the runs have no figure `{figure}`"));
    Err(mistake.hint(format!("give one of these by --figure: {}", names.join(", "))))
}

/// Writes the results, and shows them.
fn store(task: &Task, found: &SweepResults, args: &SweepArgs, shared: &Shared, seconds: f64) -> Result<(), Failure> {
    let Task { sweep, place, keep, document, .. } = task;
    let figure = figure_of(sweep, found, args.figure.as_deref())?;
    let kept = keep.places(found, figure);
    let summary = found.summary(sweep, seconds);
    let [command, single] = [command(args, "sweep"), command(args, "run")];
    let page = SweepPage { sweep, results: found, summary: &summary, command: &command, single: &single, figure };
    let answer = report::sweep_answer(&page);
    let summary = Row::from_iter(std::iter::once(("answer".to_owned(), answer.clone().into())).chain(summary.clone()));
    let page = SweepPage { summary: &summary, ..page };
    let origin = Origin::of_sweep(&args.scenario);
    let scenario = format!("# droptower {}\n{}{}", env!("CARGO_PKG_VERSION"), origin.line(place), document.resolved());
    let write = || -> Result<Vec<String>, StoreError> {
        let draft = Draft::begin(place, origin, args.force)?;
        let files = folder::fill_sweep(&draft, &page, &scenario)?;
        draft.publish()?;
        Ok(files)
    };
    let files = write().map_err(|error| Failure::unstored(&error))?;
    task.page.ended(&sweep.model().name);
    let checked = |run| Ok((scenarios::of_document(sweep.document(run))?, run_place(place, run)));
    let runs = kept.into_iter().map(checked).collect::<Result<Vec<_>, Failure>>()?;
    let failure = run_all(runs, shared);
    let printed =
        print_figures(shared, &summary, || text(sweep, found, &answer, seconds, &folder::listing(place, &files)));
    let failed = failed_runs(sweep, found);
    Failure::all([failure, failed].into_iter().flatten()).map_or(printed, Err)
}

/// Writes what is known of a sweep that was stopped: counts, statistics, and the table of the runs that are done.
fn store_stopped(task: &Task, done: &Done) -> Result<(), Failure> {
    let Task { sweep, evaluations, page, .. } = task;
    let found = SweepResults::from_evaluations(sweep, done, evaluations).map_err(|error| failed(&error))?;
    let mut summary = serde_json::Map::from_iter([("stopped".to_owned(), true.into())]);
    summary.extend(found.summary(sweep, 0.0).into_iter().filter(|(name, _)| name != "seconds"));
    let folder = page.folder();
    let write = || -> Result<(), StoreError> {
        folder.write(STOPPED, &folder::json(&summary)?)?;
        let table = base::table::to_csv(&found.table.columns);
        folder
            .write(STOPPED_TABLE, &table.map_err(|error| StoreError::write(folder.path().join(STOPPED_TABLE), error))?)
    };
    write().map_err(|error| Failure::unstored(&error))
}

/// The folder of a run of a sweep in `place`.
fn run_place(place: &Path, run: usize) -> PathBuf {
    let mut name = place.file_name().unwrap_or_default().to_owned();
    name.push(".runs");
    place.with_file_name(name).join(format!("{}", run + 1))
}

/// The command that repeats the sweep, or, as `run`, the scenario as it is written.
fn command(args: &SweepArgs, verb: &str) -> String {
    let mut words = vec![format!("droptower {verb}"), quoted(&args.scenario.display().to_string())];
    words.extend(args.samples.filter(|_| verb == "sweep").map(|samples| format!("-n {samples}")));
    words.extend(args.changes.words().map(|word| quoted(&word)));
    words.join(" ")
}

fn text(sweep: &Sweep, found: &SweepResults, answer: &str, seconds: f64, folder: &str) -> String {
    let runs = format!(
        "{}: {} runs, {} of them taken from earlier ones, {} failed, {}",
        sweep.model().name,
        found.table.rows(),
        found.reused,
        found.failed,
        time_taken(seconds)
    );
    let mut lines = vec![format!("{}{runs}", terminal::sentences(answer))];
    lines.extend(medians(found));
    if found.effects.is_empty() && found.table.rows() > 0 {
        lines.push("  no effects: too few runs, or figures that do not vary; the page has their quantiles".into());
    }
    lines.push(terminal::findings_of_run("  ", &found.findings) + folder);
    lines.join("\n")
}

/// Median and range of each figure that varies, in the unit in which a person reads it.
fn medians(found: &SweepResults) -> Vec<String> {
    let of_figure = |effects: &Effects| {
        let (name, of) = found.statistics.iter().find(|(own, _)| *own == effects.figure)?;
        let reading = post::reading(name, of.p50.abs().max(of.p05.abs()).max(of.p95.abs())).1;
        let range = [of.p05, of.p95].map(|value| reading.digits(value)).join(" to ");
        Some([name.clone(), reading.text(of.p50), reading.with_unit(&range)])
    };
    let rows: Vec<[String; 3]> = found.effects.iter().filter_map(of_figure).collect();
    let widths = [0, 1].map(|at| rows.iter().map(|row| row[at].chars().count()).max().unwrap_or_default());
    let line = |[name, median, range]: &[String; 3]| {
        format!("  {name:0$}  median {median:1$}  9 of 10 runs {range}", widths[0], widths[1])
    };
    rows.iter().map(line).collect()
}

/// Failed runs are in the table; the exit status tells that there are some.
fn failed_runs(sweep: &Sweep, found: &SweepResults) -> Option<Failure> {
    let cause = (0..found.table.rows()).find_map(|row| found.table.failure(row))?;
    let name = &sweep.model().name;
    let mistake = Diagnostic::new(format!("{name}: {} of {} runs failed: {cause}", found.failed, sweep.len()));
    Some(Failure::numerical(mistake.hint("table.csv has the cause of each")))
}
