//! `droptower sweep`: many runs of a scenario whose keys vary.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde_json::json;

use crate::args::Changes;
use crate::batch::{self, BatchArgs, Ends};
use crate::failure::{both, hinted, preparing, refuse};
use crate::folder::{self, Files, ResultPlace};
use crate::live_page::LivePage;
use crate::progress::SweepBar;
use crate::run::run_all;
use crate::scenarios;
use crate::{Failure, Shared, print_figures, shell, terminal};
use base::diagnostic::{Diagnostic, shown_path};
use base::number::time_taken;
use base::shell::quoted;
use report::SweepPage;
use scene::scenario::Document;
use study::evaluate::{EvaluationError, Evaluations};
use study::post::{self, ranking_figure};
use study::script::Row;
use study::store::evaluations::Share;
use study::store::{Draft, Origin, ProgressFolder, STOPPED, STOPPED_TABLE, StoreError, run_files};
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
    /// Also write the run folders of these runs: worst:3, all, or numbers (4,17)
    #[arg(long, value_name = "WHICH")]
    pub keep: Option<String>,
    /// Figure by which runs are ranked: the largest is the worst, of figures such as a depth by size
    #[arg(long, value_name = "FIGURE")]
    pub figure: Option<String>,
    #[command(flatten)]
    pub batch: BatchArgs,
    /// Compute nothing: gather what all processes have done
    #[arg(long, conflicts_with_all = ["shard", "stop_after"])]
    pub merge: bool,
}

/// The sweep that the arguments ask for, checked.
struct Task<'a> {
    args: &'a SweepArgs,
    shared: &'a Shared,
    begin: Instant,
    sweep: Sweep,
    document: Document,
    evaluations: Evaluations,
    place: ResultPlace,
    keep: Keep,
    stop: Stop,
    page: LivePage,
}

pub(crate) fn run(args: &SweepArgs, shared: &Shared) -> Result<(), Failure> {
    let task = task(args, shared)?;
    let page = &task.page;
    let (ends, told) = (task.ends(), page.clone());
    batch::end_on_signals(ends, move || told.stopping())?;
    let swept = page.during(|| task.swept());
    if let Err(failure) = &swept {
        // No more than the first end of a page counts: results may be stored, and runs have failed.
        if task.ends().is_over() { page.stopped() } else { page.failed(failure) }
    }
    swept
}

/// All arguments checked, or all their mistakes.
fn task<'a>(args: &'a SweepArgs, shared: &'a Shared) -> Result<Task<'a>, Failure> {
    let begin = Instant::now();
    let ((keep, share), (deadline, assignments)) =
        both(both(keep(args), args.batch.share()), both(args.batch.deadline(begin), args.changes.assignments()))?;
    let document = Document::read(&args.scenario)?.with(&assignments);
    let samples = args.samples.map(|samples| samples as usize);
    let sweep = Sweep::prepare(&document, samples).map_err(|error| refused(&error, &document))?;
    check_changes(args, &sweep)?;
    keep.check(sweep.len())?;
    let name = &sweep.model().name;
    let place = args.batch.results.place(&format!("{name}.sweep"), Origin::of_sweep(&args.scenario))?;
    let replaced = folder::replaced_scenario(&place.folder, "a sweep", &document.resolved());
    if let Some(note) = replaced.filter(|_| !place.force && share == Share::WHOLE) {
        tell(["replaces", &place.folder.display().to_string(), &note], shared.json, shared.quiet);
    }
    let page = page(name, ProgressFolder::new(&place.folder, share), shared);
    let evaluations = args.batch.evaluations(share, &page);
    let stop = Stop { deadline, ..Stop::default() };
    Ok(Task { args, shared, begin, sweep, document, evaluations, place, keep, stop, page })
}

/// The page of the sweep; where it is, is a note, or an event for a program.
fn page(name: &str, folder: ProgressFolder, shared: &Shared) -> LivePage {
    let (events, quiet, path) = (shared.json, shared.quiet, folder.page().display().to_string());
    LivePage::new(name, folder, move |line| tell(["page", &path, line], events, quiet))
}

/// Prints a note about the `path` on standard error, as an event for a program; nothing if `quiet`.
fn tell([event, path, text]: [&str; 3], events: bool, quiet: bool) {
    match events {
        _ if quiet => {}
        true => crate::tell_event(&json!({ "event": event, "path": path, "text": text })),
        false => crate::tell(&format!("note: {text}")),
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

impl Task<'_> {
    /// What signals end.
    fn ends(&self) -> Ends {
        Ends { stop: self.stop.requested.clone(), given_up: self.stop.given_up.clone() }
    }

    /// Computes the runs, and stores the results.
    fn swept(&self) -> Result<(), Failure> {
        let Task { args, sweep, evaluations, stop, page, .. } = self;
        if !args.merge {
            page.begin_sweep(args.figure.as_deref().unwrap_or(ranking_figure(sweep.model())));
        }
        let progress = SweepBar::new(sweep.len(), page, self.shared);
        let is_part = evaluations.share() != Share::WHOLE;
        let work = Work { sweep, evaluations, waits: !is_part, stop, gather: args.merge };
        let done = work.run(&|event| {
            page.note_sweep(&event, evaluations);
            progress.show(&event);
        });
        progress.finish();
        let done = done.map_err(|error| failed(&error))?;
        if done.len() < sweep.len() {
            return self.unfinished(&done);
        }
        if is_part {
            page.discard();
            let (name, computed, runs) = (&sweep.model().name, done.computed, sweep.len());
            return self.print_part(&done, || format!("{name}: {computed} of {runs} runs computed here, all are done"));
        }
        let mut found = self.results(&done)?;
        found.findings.extend(terminal::findings_of_runs(&found.run_findings(), &found.findings));
        self.store(&found)
    }

    /// The results of the runs that are known.
    fn results(&self, done: &Done) -> Result<SweepResults, Failure> {
        SweepResults::from_evaluations(&self.sweep, done, &self.evaluations).map_err(|error| failed(&error))
    }

    /// Prints what a process computed of a sweep of which it is one, or which is not complete.
    fn print_part(&self, done: &Done, text: impl FnOnce() -> String) -> Result<(), Failure> {
        let runs = self.sweep.len();
        let figures = json!({
            "scenario": self.sweep.model().name,
            "runs": runs,
            "reused": done.cache_hits,
            "computed": done.computed,
            "missing": runs - done.len(),
            "engine_s": done.engine_s,
        });
        print_figures(self.shared, &figures, text)
    }

    /// A sweep that has runs left is not stored: a table of a part would be taken for the whole.
    fn unfinished(&self, done: &Done) -> Result<(), Failure> {
        let Task { args, sweep, evaluations, page, .. } = self;
        let (name, missing) = (&sweep.model().name, sweep.len() - done.len());
        if evaluations.share() != Share::WHOLE {
            page.stopped();
            return self.print_part(done, || {
                format!("{name}: {} runs computed here, {missing} of {} are not done yet", done.computed, sweep.len())
            });
        }
        if !args.merge {
            self.store_stopped(done)?;
            page.stopped();
        }
        self.print_part(done, String::new)?;
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

    /// Writes the results, and shows them.
    fn store(&self, found: &SweepResults) -> Result<(), Failure> {
        let Task { args, sweep, place, keep, document, .. } = self;
        let seconds = self.begin.elapsed().as_secs_f64();
        let figure = figure_of(sweep, found, args.figure.as_deref())?;
        let kept = keep.places(found, figure);
        let summary = found.summary(sweep, seconds);
        let [command, single] = [command(args, "sweep"), command(args, "run")];
        let page = SweepPage { sweep, results: found, summary: &summary, command: &command, single: &single, figure };
        let answer = report::sweep_answer(&page);
        let summary =
            Row::from_iter(std::iter::once(("answer".to_owned(), answer.clone().into())).chain(summary.clone()));
        let page = SweepPage { summary: &summary, ..page };
        let origin = place.origin.line(&place.folder);
        let scenario = format!("# droptower {}\n{origin}{}", env!("CARGO_PKG_VERSION"), document.resolved());
        let others = |files: &mut Files<'_>| {
            files.write(run_files::SCENARIO, scenario.into_bytes())?;
            files.write(run_files::TABLE, table(found, &place.folder.join(run_files::TABLE))?)
        };
        let (_, files) = place.store(&summary, others, report::sweep_page(&page), Draft::publish)?;
        self.page.ended(&sweep.model().name);
        let checked = |run| Ok((scenarios::of_document(sweep.document(run))?, run_place(&place.folder, run)));
        let runs = kept.into_iter().map(checked).collect::<Result<Vec<_>, Failure>>()?;
        let failure = run_all(runs, self.shared);
        let printed = print_figures(self.shared, &summary, || text(sweep, found, &answer, seconds, &files));
        let failed = failed_runs(sweep, found);
        Failure::all([failure, failed].into_iter().flatten()).map_or(printed, Err)
    }

    /// Writes what is known of a sweep that was stopped: counts, statistics, and the table of the runs that are done.
    fn store_stopped(&self, done: &Done) -> Result<(), Failure> {
        let found = self.results(done)?;
        let mut summary = serde_json::Map::from_iter([("stopped".to_owned(), true.into())]);
        summary.extend(found.summary(&self.sweep, 0.0).into_iter().filter(|(name, _)| name != "seconds"));
        let folder = self.page.folder();
        let write = || -> Result<(), StoreError> {
            folder.write(STOPPED, &folder::json(&summary)?)?;
            folder.write(STOPPED_TABLE, &table(&found, &folder.path().join(STOPPED_TABLE))?)
        };
        write().map_err(|error| Failure::unstored(&error))
    }
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

/// The runs as the text of the file at `path`.
fn table(found: &SweepResults, path: &Path) -> Result<Vec<u8>, StoreError> {
    base::table::to_csv(&found.table.columns).map_err(|error| StoreError::write(path, error))
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
        let [median, range] = [reading.text(of.p50), reading.with_unit(&range)];
        Some(vec![name.clone(), format!("median {median}"), format!("9 of 10 runs {range}")])
    };
    let rows: Vec<Vec<String>> = found.effects.iter().filter_map(of_figure).collect();
    terminal::in_columns(&rows, 3).collect()
}

/// Failed runs are in the table; the exit status tells that there are some.
fn failed_runs(sweep: &Sweep, found: &SweepResults) -> Option<Failure> {
    let cause = (0..found.table.rows()).find_map(|row| found.table.failure(row))?;
    let name = &sweep.model().name;
    let mistake = Diagnostic::new(format!("{name}: {} of {} runs failed: {cause}", found.failed, sweep.len()));
    Some(Failure::numerical(mistake.hint("table.csv has the cause of each")))
}
