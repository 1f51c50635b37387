//! `droptower reduce drop`: contact, speed, travel and energies of drop tests.

mod args;
mod reduce;
mod several;
mod text;

use std::path::PathBuf;

use plot::{braille, thinned};
use serde::Serialize;

pub(super) use self::args::DropArgs;
use self::args::Recordings;
use self::reduce::Reducer;
use crate::command_line::command_line;
use crate::signal::{output as table, remarks};
use crate::{Failure, Shared, output, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use lab::experiment::drop::Figures;
use lab::signal::{Annotations, VIRTUAL_RECORDING};
use report::{DropPage, DropTest, drop_page};

pub(super) fn run(args: &DropArgs, shared: &Shared) -> Result<(), Failure> {
    let reducer = Reducer::new(args)?;
    let recordings = Recordings::from_args(args)?;
    check(args, &recordings.paths)?;
    match &recordings.paths[..] {
        [(path, _)] if !recordings.is_list => one(args, reducer.reduced(path).test, shared),
        several => {
            refuse_own_times(args, several.len())?;
            several::run(args, &reducer, recordings, shared)
        }
    }
}

/// Refuses times on the clock of one recording where there are several.
fn refuse_own_times(args: &DropArgs, count: usize) -> Result<(), Vec<Diagnostic>> {
    let given = [("--contact-time", args.contact_time.is_some()), ("--mask", !args.mask.is_empty())];
    let refused = given.into_iter().filter(|(_, is_given)| *is_given).map(|(option, _)| {
        let message = format!("{option} is a time on the clock of one recording, and {count} are given");
        Diagnostic::new(message).hint("reduce that recording alone")
    });
    let refused: Vec<Diagnostic> = refused.collect();
    if refused.is_empty() { Ok(()) } else { Err(refused) }
}

/// The object that `--json` prints of one recording.
#[derive(Serialize)]
struct Printed {
    mass_kg: Option<f64>,
    height_m: Option<f64>,
    #[serde(flatten)]
    figures: Option<Figures>,
    findings: Vec<Finding>,
}

/// Writes and prints what one recording gives.
fn one(args: &DropArgs, test: DropTest, shared: &Shared) -> Result<(), Failure> {
    let rows = match (&test.outcome, &test.tower, &test.figures) {
        (Ok(drop), Some(tower), Some(figures)) => text::rows(tower, drop, figures),
        _ => vec![],
    };
    if let (Some(out), Ok(drop)) = (&args.out, &test.outcome) {
        let origin =
            format!("reduced from {} by droptower reduce drop; time from first contact", shown_path(&test.path));
        let comments: Vec<String> = std::iter::once(origin).chain(notes(&test)).collect();
        table::write_csv(out, &comments, &drop.signals)?;
    }
    if is_shown(&test) {
        let tests = std::slice::from_ref(&test);
        let command = command_line();
        let page = DropPage { tests, is_list: false, scatter: &[], figures: &rows, left_out: &[], command: &command };
        write_page(args, &page)?;
    }
    if let Err(mistake) = &test.outcome {
        return Err(failure(args, mistake, &test, shared));
    }
    let printed = Printed {
        mass_kg: test.tower.map(|tower| tower.body.mass),
        height_m: test.height(),
        figures: test.figures.clone().map(|figures| Figures { notes: notes(&test), ..figures }),
        findings: test.findings.clone(),
    };
    print_figures(shared, &printed, || printed_text(args, &test, &rows))
}

/// Whether page and drawing have something to show: the reduction was tried, though it may have failed.
fn is_shown(test: &DropTest) -> bool {
    test.channels.is_some() && test.tower.is_some()
}

/// Comments of the file and messages of findings.
fn notes(test: &DropTest) -> Vec<String> {
    let comments = test.channels.iter().flat_map(|channels| channels.annotations.comments()).cloned();
    // The mark of a virtual recording is one of the comments.
    let others = test.findings.iter().filter(|finding| finding.code != VIRTUAL_RECORDING.name);
    comments.chain(others.map(|finding| finding.message.clone())).collect()
}

fn printed_text(args: &DropArgs, test: &DropTest, rows: &[(&str, String)]) -> String {
    let comments = |annotations: &Annotations| annotations.free_comments().cloned().collect::<Vec<String>>();
    let comments = test.channels.as_ref().map(|channels| comments(&channels.annotations)).unwrap_or_default();
    let rows: String = rows.iter().map(|(name, value)| format!("  {name:<18} {value}\n")).collect();
    let written = [&args.out, &args.page].into_iter().flatten();
    let written: String = written.map(|path| format!("  {}\n", shown_path(path))).collect();
    let remarks = remarks::lines(&comments, &test.findings);
    format!("{}\n{rows}{}{remarks}{written}", shown_path(&test.path), picture(test))
}

/// The failure of a recording that cannot be reduced, with a drawing of it.
fn failure(args: &DropArgs, mistake: &Diagnostic, test: &DropTest, shared: &Shared) -> Failure {
    let page = args.page.as_ref().filter(|_| is_shown(test));
    let shows = page.map(|page| format!("{} shows the recording and what was found in it", shown_path(page)));
    let hints: Vec<String> = mistake.hint.iter().cloned().chain(shows).collect();
    let hint = (!hints.is_empty()).then(|| hints.join("; "));
    let drawing = (is_shown(test) && !shared.quiet).then(|| picture(test));
    Failure { drawing, ..Failure::from(Diagnostic { hint, ..mistake.clone() }) }
}

/// Refuses a table or a page that may not be written.
fn check(args: &DropArgs, inputs: &[(PathBuf, bool)]) -> Result<(), Failure> {
    let table = args.out.iter().map(|out| {
        let check = |(input, _): &(PathBuf, bool)| table::check_table(out, input, args.force);
        inputs.iter().try_for_each(check)
    });
    // A page holds nothing that is not computed again.
    let page = args.page.iter().map(|page| {
        let check = |(input, _): &(PathBuf, bool)| output::check_page(page, Some(input));
        inputs.iter().try_for_each(check)
    });
    Failure::all(table.chain(page).filter_map(Result::err)).map_or(Ok(()), Err)
}

/// Writes the page where one is asked for.
fn write_page(args: &DropArgs, page: &DropPage<'_>) -> Result<(), Failure> {
    match &args.page {
        Some(path) => output::write(path, |file| file.write_all(drop_page::drop_page(page).as_bytes())),
        None => Ok(()),
    }
}

/// Characters across and down.
const SIZE: [usize; 2] = [72, 12];

/// Most points of the curve: several a dot.
const MOST_POINTS: usize = 4000;

/// The acceleration as it was read, with the landmarks that were found below it and their times; every line ends with a
/// line break. Empty of a recording that could not be read.
fn picture(test: &DropTest) -> String {
    let plots = thinned(drop_page::reading(test).into_iter().collect(), MOST_POINTS);
    let drawn: String = plots.iter().map(|plot| braille(plot, SIZE)).collect();
    if drawn.is_empty() {
        return drawn;
    }
    let times: Vec<String> =
        test.landmarks.named().into_iter().map(|(name, time)| format!("{name} {time:.4} s")).collect();
    let times = if times.is_empty() { "no landmark was found".into() } else { times.join(", ") };
    format!("{drawn}  {times}\n")
}
