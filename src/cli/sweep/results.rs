//! The results of a sweep: its folder, the folders of single runs, and what the terminal shows.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::{SweepArgs, Task, failed};
use crate::faults::storing;
use crate::{Failure, Shared, digest, findings, folder, print_figures, run, scenarios};
use base::diagnostic::Diagnostic;
use base::number::time_taken;
use base::shell::quoted;
use base::written::{Reading, digits};
use report::SweepPage;
use study::post::ranking_figure;
use study::store::{Draft, Origin, STOPPED, STOPPED_TABLE, StoreError};
use study::sweep::{Done, Effects, Sweep, SweepResults};

/// Which runs have folders of their own.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Keep {
    None,
    All,
    /// So many of the worst.
    Worst(usize),
    /// The runs of these numbers, from one.
    Numbers(Vec<usize>),
}

impl Keep {
    pub(super) fn parse(text: &str) -> Option<Keep> {
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
    pub(super) fn check(&self, runs: usize) -> Result<(), Diagnostic> {
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
pub(super) fn store(
    task: &Task,
    found: &SweepResults,
    args: &SweepArgs,
    shared: &Shared,
    seconds: f64,
) -> Result<(), Failure> {
    let Task { sweep, place, keep, document, .. } = task;
    let figure = figure_of(sweep, found, args.figure.as_deref())?;
    let kept = keep.places(found, figure);
    let summary = found.summary(sweep, seconds);
    let [command, single] = [command(args, "sweep"), command(args, "run")];
    let page = SweepPage { sweep, results: found, summary: &summary, command: &command, single: &single, figure };
    let origin = Origin::of_sweep(&args.scenario);
    let scenario = format!("# droptower {}\n{}{}", env!("CARGO_PKG_VERSION"), origin.line(place), document.resolved());
    let write = || -> Result<Vec<String>, StoreError> {
        let draft = Draft::begin(place, origin, args.force)?;
        let files = folder::fill_sweep(&draft, &page, &scenario)?;
        draft.publish()?;
        Ok(files)
    };
    let files = write().map_err(|error| Failure::output(storing(&error)))?;
    task.page.ended(&sweep.model().name);
    let checked = |run| Ok((scenarios::of_document(sweep.document(run))?, run_place(place, run)));
    let runs = kept.into_iter().map(checked).collect::<Result<Vec<_>, Vec<Diagnostic>>>()?;
    let failure = run::all(runs, shared);
    let printed = print_figures(shared, &summary, || text(sweep, found, seconds, &digest::folder(place, &files)));
    let failed = failed_runs(sweep, found);
    Failure::all([failure, failed].into_iter().flatten()).map_or(printed, Err)
}

/// Writes what is known of a sweep that was stopped: counts, statistics, and the table of the runs that are done.
pub(super) fn store_stopped(task: &Task, done: &Done) -> Result<(), Failure> {
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
    write().map_err(|error| Failure::output(storing(&error)))
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

fn text(sweep: &Sweep, found: &SweepResults, seconds: f64, folder: &str) -> String {
    let mut lines = vec![format!(
        "{}: {} runs, {} of them taken from earlier ones, {} failed, {}",
        sweep.model().name,
        found.table.rows(),
        found.reused,
        found.failed,
        time_taken(seconds)
    )];
    lines.extend(medians(found));
    if found.effects.is_empty() && found.table.rows() > 0 {
        lines.push("  no effects: too few runs, or figures that do not vary; the page has their quantiles".into());
    }
    if let Some((probability, [low, high])) = found.rupture {
        let [probability, low, high] = [probability, low, high].map(|share| digits(100.0 * share));
        lines.push(format!("  the film ruptures in {probability} % of the runs (interval of 95 %: {low} to {high} %)"));
    }
    lines.push(findings::lines("  ", &found.findings) + folder);
    lines.join("\n")
}

/// Median and range of each figure that varies, in the unit in which a person reads it.
fn medians(found: &SweepResults) -> Vec<String> {
    let of_figure = |effects: &Effects| {
        let (name, of) = found.statistics.iter().find(|(own, _)| *own == effects.figure)?;
        let reading = Reading::of_name(name, of.p50.abs().max(of.p05.abs()).max(of.p95.abs())).1;
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
