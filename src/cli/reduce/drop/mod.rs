//! `droptower reduce drop`: contact, speed, travel and energies of drop tests.

mod reduce;
mod several;

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::args::{quantity, quantity_with_error};
use crate::failure::{all, refuse};
use crate::reduce::drop::reduce::Reducer;
use crate::scenarios::expanded;
use crate::shell::command_line;
use crate::signal::{self, TableArgs};
use crate::{Failure, Shared, output, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::units::{Acceleration, Force, Length, Mass, Time, Velocity};
use lab::experiment::drop::Figures;
use lab::signal::format::{FolderContents, folder_contents};
use lab::signal::{Annotations, VIRTUAL_RECORDING};
use plot::{braille, thinned};
use report::{DropPage, DropTest, drop_page};

pub(crate) fn run(args: &DropArgs, shared: &Shared) -> Result<(), Failure> {
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
fn refuse_own_times(args: &DropArgs, count: usize) -> Result<(), Failure> {
    let given = [("--contact-time", args.contact_time.is_some()), ("--mask", !args.mask.is_empty())];
    refuse(given.into_iter().filter(|(_, is_given)| *is_given).map(|(option, _)| {
        let message = format!("{option} is a time on the clock of one recording, and {count} are given");
        Diagnostic::new(message).hint("reduce that recording alone")
    }))
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
        (Ok(drop), Some(tower), Some(figures)) => reduce::figure_rows(tower, drop, figures),
        _ => vec![],
    };
    if let (Some(out), Ok(drop)) = (&args.out, &test.outcome) {
        let origin =
            format!("reduced from {} by droptower reduce drop; time from first contact", shown_path(&test.path));
        let comments: Vec<String> = std::iter::once(origin).chain(notes(&test)).collect();
        signal::write_csv(out, &comments, &drop.signals)?;
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
    let rows: String = rows.iter().map(|(name, value)| format!("  {name:<23} {value}\n")).collect();
    let written = [&args.out, &args.page].into_iter().flatten();
    let written: String = written.map(|path| format!("  {}\n", shown_path(path))).collect();
    let remarks = signal::remark_lines(&comments, &test.findings);
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
        let check = |(input, _): &(PathBuf, bool)| signal::check_table(out, input, args.force);
        inputs.iter().try_for_each(check)
    });
    // A page holds nothing that is not computed again.
    let page = args.page.iter().map(|page| {
        let check = |(input, _): &(PathBuf, bool)| output::check_page(page, Some(input));
        inputs.iter().try_for_each(check)
    });
    all(table.chain(page)).map(drop)
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

#[derive(Debug, Args)]
pub(crate) struct DropArgs {
    /// Recordings, globs or folders of them, each from the rest before the release on; `droptower explain formats` lists
    /// what is read. Several, and folders, give a table
    #[arg(required = true, value_name = "RECORDING")]
    pub recordings: Vec<PathBuf>,
    /// Mass of the impactor, e.g. "10.72 kg" [default: as a line `mass: …` of the file's header states it]
    #[arg(long, value_parser = |text: &str| quantity(Mass::DIMENSION, text))]
    pub mass: Option<f64>,
    /// Height of fall, with its standard deviation where it is known, e.g. "1 m" or "1 m +- 2 mm" [default: likewise,
    /// `height: …`; half a per cent of it]
    #[arg(long, value_parser = |text: &str| quantity_with_error(Length::DIMENSION, text))]
    pub height: Option<(f64, Option<f64>)>,
    /// Impact speed where it is known, e.g. "4.16 m/s", in place of the height or beside it
    #[arg(long, value_name = "SPEED", value_parser = |text: &str| quantity(Velocity::DIMENSION, text))]
    pub speed: Option<f64>,
    /// Time of first contact on the recording's clock where it is known, e.g. "617.3 ms"
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = |text: &str| quantity(Time::DIMENSION, text))]
    pub contact_time: Option<f64>,
    /// Friction of the guide where it was measured, with its standard deviation, e.g. "2 N +- 0.3 N"; without that, a
    /// tenth of it
    #[arg(long, value_name = "FORCE", value_parser = |text: &str| quantity_with_error(Force::DIMENSION, text))]
    pub guide_friction: Option<(f64, Option<f64>)>,
    /// Bridge gaps of the acceleration that last no longer than this by straight lines, e.g. "5 ms"
    #[arg(long, value_name = "TIME", value_parser = |text: &str| quantity(Time::DIMENSION, text))]
    pub bridge: Option<f64>,
    /// Replace the acceleration between two times by a straight line, e.g. "212 ms..215 ms"; several times
    #[arg(long, value_name = "FROM..TO", value_parser = interval, allow_hyphen_values = true)]
    pub mask: Vec<[f64; 2]>,
    /// The channel of the accelerometer, where there are several
    #[arg(long, value_name = "NAME")]
    pub column: Option<String>,
    /// The accelerometer reads a deceleration as negative: turn it round
    #[arg(long)]
    pub invert: bool,
    /// The channel of the laser, where there are several lengths: upward from the film's upper face
    #[arg(long, value_name = "NAME")]
    pub laser: Option<String>,
    /// Ignore the laser
    #[arg(long, conflicts_with = "laser")]
    pub without_laser: bool,
    #[command(flatten)]
    pub table: TableArgs,
    /// The accelerometer's unit where the file states none; g is standard gravity
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
    /// Gravity
    #[arg(long, value_name = "ACCELERATION", default_value = "9.81 m/s2", value_parser = |text: &str| quantity(Acceleration::DIMENSION, text))]
    pub gravity: f64,
    /// Channel frequency class of the filtered acceleration (ISO 6487); 1000 or the highest that the rate of the samples
    /// allows, unless the file states that it was filtered before
    #[arg(long, value_name = "CFC", value_parser = signal::class)]
    pub class: Option<f64>,
    /// How the low frequencies that AC coupling removes are restored
    #[arg(long, value_enum, default_value_t = Method::Coupling)]
    pub correction: Method,
    /// Time constant of the accelerometer's coupling where it is known, e.g. "150 ms"
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = |text: &str| quantity(Time::DIMENSION, text))]
    pub time_constant: Option<f64>,
    /// Table to write, FILE.csv: of one recording its reduced signals from contact on, of several a row each
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Page to write, FILE.html, with plots, figures and findings; of a recording that cannot be reduced with what was
    /// found in it
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// Replace the table where it exists
    #[arg(long, requires = "out")]
    pub force: bool,
}

/// The corrections by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Method {
    /// The exact inverse of AC coupling
    Coupling,
    /// The release, mirrored and added after contact
    Ramp,
}

/// Two times, s: `212 ms..215 ms`.
fn interval(text: &str) -> Result<[f64; 2], String> {
    let expected = || format!("expected two times such as \"212 ms..215 ms\", found \"{text}\"");
    let (from, to) = text.split_once("..").ok_or_else(expected)?;
    let [from, to] = [quantity(Time::DIMENSION, from)?, quantity(Time::DIMENSION, to)?];
    if from < to { Ok([from, to]) } else { Err(format!("{}; the second is the later one", expected())) }
}

/// The recordings of a call.
pub(crate) struct Recordings {
    /// Each once, in the order of the arguments; whether a folder was searched for it.
    pub paths: Vec<(PathBuf, bool)>,
    /// Whether they are a list: several arguments, a glob or a folder of recordings.
    pub is_list: bool,
    /// What else is in the folders.
    pub left_out: Vec<String>,
}

impl Recordings {
    /// The recordings that files, globs and folders name, without the table that is written.
    pub(crate) fn from_args(args: &DropArgs) -> Result<Recordings, Failure> {
        let mut found = Recordings { paths: vec![], is_list: args.recordings.len() > 1, left_out: vec![] };
        all(args.recordings.iter().map(|argument| found.add(argument, args.out.as_deref())))?;
        let mut seen = HashSet::new();
        found.paths.retain(|(path, _)| seen.insert(fs::canonicalize(path).unwrap_or_else(|_| path.clone())));
        Ok(found)
    }

    fn add(&mut self, argument: &Path, out: Option<&Path>) -> Result<(), Diagnostic> {
        if argument.is_dir() {
            return self.add_folder(argument, out);
        }
        let paths = match argument.to_str() {
            Some(pattern) => expanded(pattern)?,
            None => vec![argument.to_owned()],
        };
        self.is_list |= paths != [argument.to_owned()];
        self.paths.extend(paths.into_iter().map(|path| (path, false)));
        Ok(())
    }

    fn add_folder(&mut self, place: &Path, out: Option<&Path>) -> Result<(), Diagnostic> {
        let contents = folder_contents(place);
        let FolderContents { recordings, others } =
            contents.map_err(|error| Diagnostic::new(format!("cannot list {}: {error}", shown_path(place))))?;
        if recordings == [place.to_owned()] {
            self.paths.push((place.to_owned(), false));
            return Ok(());
        }
        let out = out.and_then(|out| fs::canonicalize(out).ok());
        let is_own = |path: &PathBuf| out.is_some() && fs::canonicalize(path).ok() == out;
        let (own, recordings): (Vec<PathBuf>, Vec<PathBuf>) = recordings.into_iter().partition(is_own);
        if recordings.is_empty() {
            let message = format!("{} holds no recordings", shown_path(place));
            return Err(Diagnostic::new(message).hint("they are known by their endings: `droptower explain formats`"));
        }
        self.is_list = true;
        self.left_out.extend(others.iter().chain(&own).map(|path| shown_path(path)));
        self.paths.extend(recordings.into_iter().map(|path| (path, true)));
        Ok(())
    }
}
