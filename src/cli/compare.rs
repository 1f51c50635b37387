//! `droptower compare`: several runs compared with the first.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use crate::failure::{all, both, hinted, recording, refuse};
use crate::folder::{ResultArgs, ResultPlace};
use crate::scenarios;
use crate::{Failure, Shared, print_figures, terminal};
use base::diagnostic::{Diagnostic, shown_path};
use report::compare_page;
use scene::expectation::{Expectations, Given, Outside, Recorded};
use study::post::{ComparedRun, FAILED_RUN, RunComparison};
use study::store::{self, Draft, Origin, StoredRun, StoredRunError, run_files};

#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    /// Run folders, or files of signals; each is compared with the first
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    #[command(flatten)]
    pub results: ResultArgs,
    /// Compare this signal alone, by its name in signals.csv; may be given several times
    #[arg(long, value_name = "NAME")]
    pub signal: Vec<String>,
    /// Bounds for signals, figures and findings (as in expect.toml): a run that is outside fails, exit status 1
    #[arg(long, value_name = "FILE")]
    pub within: Option<PathBuf>,
    /// Print every figure, also where all runs agree
    #[arg(long)]
    pub all: bool,
}

pub(super) fn run(args: &CompareArgs, shared: &Shared) -> Result<(), Failure> {
    let bounds = args.within.as_deref().map(|path| scenarios::expectations(path, true)).transpose();
    let (runs, bounds) = both(stored(&args.runs), bounds)?;
    check_signals(&runs, &args.signal)?;
    let comparison = RunComparison::from_runs(&runs, &args.signal);
    let place = place(args, &comparison)?;
    let outside = bounds.as_ref().map(|bounds| outside(bounds, &runs, &comparison));
    let mut summary = comparison.summary();
    summary.insert("answer".into(), compare_page::sentence(&comparison).into());
    summary.insert(run_files::WORKING_FOLDER.into(), store::path_from(&place.folder, Path::new(".")).into());
    summary.extend(outside.as_deref().map(|outside| ("outside".to_owned(), json!(outside))));
    let page = compare_page::compare_page(&comparison, outside.as_deref());
    let (_, files) = place.store(&summary, |_| Ok(()), page, Draft::publish)?;
    print_figures(shared, &summary, || {
        let verdict = outside.as_deref().map(verdict).unwrap_or_default();
        [text(&comparison, args.all), verdict, files].concat()
    })?;
    match outside.unwrap_or_default().iter().filter(|run| !run.differences.is_empty()).count() {
        0 => Ok(()),
        _ if shared.json => Err(Failure::quiet()),
        count => {
            let others = runs.len() - 1;
            Err(Failure::output(Diagnostic::new(format!("{count} of {others} runs are outside of the bounds"))))
        }
    }
}

/// How each run but the first differs from it by more than the bounds allow.
fn outside(bounds: &Expectations, runs: &[StoredRun], comparison: &RunComparison) -> Vec<Outside> {
    let Some((first, others)) = runs.split_first() else { return vec![] };
    let recorded = Recorded { signals: Some(first.signals.clone()), figures: first.summary.clone() };
    let names = comparison.runs.iter().skip(1).map(|run| run.name.clone());
    let of = |(run, name): (&StoredRun, String)| {
        let given = Given { signals: &run.signals, figures: &run.summary };
        Outside { run: name, differences: bounds.differences(&recorded, &given) }
    };
    others.iter().zip(names).map(of).collect()
}

fn verdict(outside: &[Outside]) -> String {
    let mut lines = Vec::new();
    for Outside { run, differences } in outside {
        lines.push(format!("{run}: {}", if differences.is_empty() { "within the bounds" } else { "outside" }));
        lines.extend(differences.iter().map(|difference| format!("  {difference}")));
    }
    lines.join("\n") + "\n"
}

/// The stored runs; at least two, each once.
fn stored(places: &[PathBuf]) -> Result<Vec<StoredRun>, Failure> {
    let run = |(index, place): (usize, &PathBuf)| match places[..index].iter().any(|before| is_same(before, place)) {
        true => Err(Diagnostic::new(format!("{} is given twice", shown_path(place)))),
        false => StoredRun::read(place).map_err(|error| unreadable(&error)),
    };
    let alone = (places.len() < 2).then(|| {
        let mistake = Diagnostic::new("expected two or more runs, found one");
        mistake.hint("compare them like this: droptower compare runs/a runs/b")
    });
    let (runs, ()) = both(all(places.iter().enumerate().map(run)), refuse(alone))?;
    Ok(runs)
}

fn unreadable(error: &StoredRunError) -> Diagnostic {
    match error {
        StoredRunError::Signals(error) => recording(error),
        StoredRunError::NoSamples(error) => Diagnostic::new(error.to_string()).hint(FAILED_RUN.remedy),
        StoredRunError::Refused(error) => hinted(error, error.hint()),
    }
}

/// The folder of the results, which replace neither files of the user nor any of the runs, nor those of other runs or of a script.
fn place(args: &CompareArgs, comparison: &RunComparison) -> Result<ResultPlace, Failure> {
    // A name may have folders, and that of a file an extension.
    let name = |run: &ComparedRun| {
        let name = Path::new(&run.name);
        let name = if run.place.is_dir() { name.into() } else { name.with_extension("") };
        name.to_string_lossy().replace(['/', '\\'], "_")
    };
    let names: Vec<String> = comparison.runs.iter().take(2).map(name).collect();
    let out = args.results.folder(&format!("{}.compare", names.join("-")))?;
    store::check_places(std::slice::from_ref(&out))?;
    let replaced = args.runs.iter().find(|run| is_same(run, &out) || run.starts_with(&out));
    // A run folder has signals, the folder of a comparison has none.
    let is_run = || out.join(run_files::SIGNALS).exists();
    let message = match replaced {
        Some(run) => format!("the results would replace {}, which is compared", shown_path(run)),
        None if is_run() => format!("the results would replace the run {}", shown_path(&out)),
        None => return ResultPlace::new(out, Origin::of_comparison(&args.runs), args.results.force),
    };
    Err(Diagnostic::new(message).hint("give another --out").into())
}

fn is_same(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => one == other,
    }
}

/// Checks that every signal that is asked for is one of a run.
fn check_signals(runs: &[StoredRun], wanted: &[String]) -> Result<(), Diagnostic> {
    let there: Vec<&str> =
        runs.iter().flat_map(|run| &run.signals.channels).map(|channel| channel.name.as_str()).collect();
    let missing = wanted.iter().find(|name| !there.contains(&name.as_str()));
    missing.map_or(Ok(()), |name| {
        let nearest = there.iter().min_by_key(|known| strsim::damerau_levenshtein(known, name));
        let hint = nearest.map(|nearest| format!("did you mean `{nearest}`?"));
        Err(Diagnostic::new(format!("no run has a signal `{name}`")).hint_if(hint))
    })
}

/// The differences between the scenarios, then figures, errors of signals and findings; every line ends with a line
/// break.
fn text(comparison: &RunComparison, all: bool) -> String {
    let names: Vec<&str> = comparison.runs.iter().map(|run| run.name.as_str()).collect();
    let part = |words: &str, rows: Vec<Vec<String>>| {
        if rows.is_empty() {
            return String::new();
        }
        terminal::table(1, std::iter::once(words).chain(names.iter().copied()), rows) + "\n"
    };
    let figures = match all {
        true => compare_page::figures(comparison.figures.iter()),
        false => compare_page::figures(comparison.key_figures()),
    };
    [
        terminal::sentences(&compare_page::sentence(comparison)) + "\n",
        part(
            "scenario",
            compare_page::keys(comparison).into_iter().map(|row| row.into_iter().map(cut).collect()).collect(),
        ),
        part("figure", compare_page::film(comparison).into_iter().chain(figures).collect()),
        part("signal, RMS of the difference over that of the first", compare_page::errors(comparison)),
        terminal::findings("  ", &comparison.findings),
    ]
    .concat()
}

/// Most characters of a cell.
const LONGEST: usize = 40;

fn cut(cell: String) -> String {
    if cell.chars().count() <= LONGEST {
        return cell;
    }
    cell.chars().take(LONGEST - 1).chain(['…']).collect()
}
