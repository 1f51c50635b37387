//! `droptower signal drop`: contact, speed, travel and energies of drop tests.

mod args;
mod outputs;
mod picture;
mod places;
mod reduce;
mod scatter;
mod several;
mod text;

pub(super) use args::DropArgs;

use serde::Serialize;

use super::{output, remarks};
use crate::command_line::command_line;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use lab::experiment::drop::Figures;
use lab::signal::{Annotations, VIRTUAL_RECORDING};
use places::Recordings;
use reduce::Reducer;
use report::{DropPage, DropTest};

pub(super) fn run(args: &DropArgs, shared: &Shared) -> Result<(), Failure> {
    let reducer = Reducer::new(args)?;
    let recordings = Recordings::from_args(args)?;
    outputs::check(args, &recordings.paths)?;
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
            format!("reduced from {} by droptower signal drop; time from first contact", shown_path(&test.path));
        let comments: Vec<String> = std::iter::once(origin).chain(notes(&test)).collect();
        output::write_csv(out, &comments, &drop.signals)?;
    }
    if is_shown(&test) {
        let tests = std::slice::from_ref(&test);
        let command = command_line();
        let page = DropPage { tests, is_list: false, scatter: &[], figures: &rows, left_out: &[], command: &command };
        outputs::write_page(args, &page)?;
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
    format!("{}\n{rows}{}{remarks}{written}", shown_path(&test.path), picture::picture(test))
}

/// The failure of a recording that cannot be reduced, with a drawing of it.
fn failure(args: &DropArgs, mistake: &Diagnostic, test: &DropTest, shared: &Shared) -> Failure {
    let page = args.page.as_ref().filter(|_| is_shown(test));
    let shows = page.map(|page| format!("{} shows the recording and what was found in it", shown_path(page)));
    let hints: Vec<String> = mistake.hint.iter().cloned().chain(shows).collect();
    let hint = (!hints.is_empty()).then(|| hints.join("; "));
    let drawing = (is_shown(test) && !shared.quiet).then(|| picture::picture(test));
    Failure { drawing, ..Failure::from(Diagnostic { hint, ..mistake.clone() }) }
}
