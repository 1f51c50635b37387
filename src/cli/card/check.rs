//! `droptower card check`: one element of a film in another solver, beside the same element here.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;
use serde::Serialize;

use super::request::poisson;
use super::source::{self, Source};
use crate::argument::number;
use crate::faults::storing;
use crate::{Failure, Shared, digest, findings, print_figures, table as text_table};
use ::card::check::{Comparison, Difference, Element, Mode, Options, Solver, element};
use ::card::{Film, Refusal};
use base::diagnostic::{Diagnostic, printable, shown_path};
use base::file;
use base::finding::Finding;
use base::table::{self, Column};
use base::units::percentage;
use plot::{Curve, Plot};
use study::store::{self, Draft, Origin, StoreError, run_files};

/// Longest file that a solver leaves, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// The picture of both.
const PICTURE: &str = "check.svg";

/// The stresses of both.
const TABLE: &str = "check.csv";

/// The options of `card check`.
#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// A material, a scenario, or the folder of a run
    pub film: PathBuf,
    /// The solver that is run: calculix, felupe or kratos
    #[arg(long = "for", value_name = "SOLVER", value_parser = solver)]
    pub solver: Solver,
    /// Program of the solver; of felupe and kratos a Python that has their packages [default: ccx or python3]
    #[arg(long, value_name = "PATH")]
    pub program: Option<PathBuf>,
    /// Largest difference; a larger one is exit status 1
    #[arg(long, value_name = "SHARE", default_value = "0.5 %", value_parser = share)]
    pub within: f64,
    /// Stretch up to which the element is pulled [default: 3, of plastic film 2, or as far as the law is valid]
    #[arg(long, value_name = "NUMBER", value_parser = stretch)]
    pub stretch: Option<f64>,
    /// The tests: uniaxial, equibiaxial, planar
    #[arg(long, value_name = "MODES", value_delimiter = ',', value_parser = mode, default_value = "uniaxial,equibiaxial,planar")]
    pub modes: Vec<Mode>,
    /// The face of a scenario with several, counted from 1
    #[arg(long, value_name = "N")]
    pub face: Option<usize>,
    /// Most points of a curve of the card
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u16).range(2..=10_000))]
    pub points: u16,
    /// Poisson's ratio of incompressible film
    #[arg(long, value_name = "NUMBER", default_value = "0.49999", value_parser = poisson)]
    pub poisson: f64,
    /// Folder for the results [default: runs/check/NAME-SOLVER]
    #[arg(long, short, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace the check of another film in the same folder
    #[arg(long)]
    pub force: bool,
}

fn solver(text: &str) -> Result<Solver, String> {
    let found = Solver::ALL.into_iter().find(|solver| solver.key() == text);
    found.ok_or_else(|| format!("expected one of {}", Solver::ALL.map(Solver::key).join(", ")))
}

fn mode(text: &str) -> Result<Mode, String> {
    let found = Mode::ALL.into_iter().find(|mode| mode.key() == text);
    found.ok_or_else(|| format!("expected some of {}", Mode::ALL.map(Mode::key).join(", ")))
}

fn share(text: &str) -> Result<f64, String> {
    let found = percentage(text).filter(|share| *share > 0.0);
    found.ok_or_else(|| format!("expected a share, such as \"0.5 %\", found \"{text}\""))
}

fn stretch(text: &str) -> Result<f64, String> {
    let found = number(text)?;
    let is_possible = found > 1.0 && found <= 20.0;
    is_possible.then_some(found).ok_or_else(|| format!("expected a stretch above 1 and up to 20, found {text}"))
}

/// The figures, for `--json` and in the folder.
#[derive(Serialize)]
struct Summary {
    check: Check,
    within: f64,
    tests: Vec<Test>,
    findings: Vec<Finding>,
    files: Vec<String>,
}

#[derive(Serialize)]
struct Check {
    film: String,
    solver: &'static str,
    program: String,
    /// The file that the film was read from, by its path from the folder.
    file: String,
}

#[derive(Serialize)]
struct Test {
    mode: &'static str,
    to_stretch: f64,
    #[serde(flatten)]
    difference: Difference,
}

impl Test {
    fn new(comparison: &Comparison) -> Test {
        let to_stretch = comparison.stretches.last().copied().unwrap_or(1.0);
        Test { mode: comparison.mode.key(), to_stretch, difference: comparison.difference() }
    }
}

pub(super) fn run(args: &CheckArgs, shared: &Shared) -> Result<(), Failure> {
    let Source { name, material, origin, file, .. } = source::read(&args.film, args.face)?;
    let film = Film { name: &name, material: &material, origin: &origin };
    // Each once, in their order.
    let modes = Mode::ALL.into_iter().filter(|mode| args.modes.contains(mode)).collect();
    let options = Options { modes, stretch: args.stretch, poisson: args.poisson, points: args.points.into() };
    let element = element(&film, args.solver, &options).map_err(|refusal| refused(&refusal, &args.film))?;
    let place = place(args, &file).map_err(|error| storing(&error))?;
    let origin = Origin::of_check(&file);
    store::check_places(std::slice::from_ref(&place)).map_err(|error| storing(&error))?;
    if !args.force {
        origin.check(&place).map_err(|error| storing(&error))?;
    }
    let program = args.program.as_deref().map_or_else(|| args.solver.program().into(), program);
    let scratch = tempfile::tempdir().map_err(|error| unwritable(&error))?;
    let ran = calculated(&element, args.solver, &program, scratch.path());
    let summary = |tests, files| Summary {
        check: Check {
            film: name.clone(),
            solver: args.solver.name(),
            program: program.to_string_lossy().into_owned(),
            file: store::path_from(&place, &file),
        },
        within: args.within,
        tests,
        findings: element.losses.iter().map(Finding::new).collect(),
        files,
    };
    let stored = |comparisons: &[Comparison]| -> Result<(PathBuf, Summary), StoreError> {
        let draft = Draft::begin(&place, origin.clone(), args.force)?;
        let mut files = copied(scratch.path(), &draft, &element)?;
        if !comparisons.is_empty() {
            draft.write(PICTURE, plot::svg(&picture(&name, args.solver, comparisons)))?;
            let table = table::to_csv(&columns(comparisons));
            draft.write(TABLE, table.map_err(|error| StoreError::write(draft.path().join(TABLE), error))?)?;
            files.extend([PICTURE, TABLE].map(String::from));
        }
        let summary = summary(comparisons.iter().map(Test::new).collect(), files);
        let text = serde_json::to_string_pretty(&summary).expect("numbers and texts");
        draft.write(run_files::SUMMARY, text)?;
        Ok((draft.publish()?, summary))
    };
    let store = |comparisons: &[Comparison]| stored(comparisons).map_err(|error| Failure::output(storing(&error)));
    match ran {
        Err(mistake) => {
            let (place, _) = store(&[])?;
            let message = format!("{}; its input is in {}", mistake.message, shown_path(&place));
            Err(Failure::output(Diagnostic { message, ..mistake }))
        }
        Ok(comparisons) => {
            let (place, summary) = store(&comparisons)?;
            print_figures(shared, &summary, || text(&summary, &place))?;
            verdict(&summary, shared)
        }
    }
}

fn refused(refusal: &Refusal, film: &Path) -> Diagnostic {
    let mistake = Diagnostic::new(format!("{}: {refusal}", shown_path(film)));
    match refusal {
        Refusal::NoLaw { .. } | Refusal::TooManyTerms { .. } => mistake.hint(
            "calculix has elastic, rubber-like and plastic film, felupe elastic and rubber-like, kratos elastic film",
        ),
        Refusal::ManyRates { .. } | Refusal::OtherRate { .. } => mistake.hint("an element is stretched at no rate"),
    }
}

/// The folder of the results.
fn place(args: &CheckArgs, file: &Path) -> Result<PathBuf, StoreError> {
    match &args.out {
        Some(out) => Ok(out.clone()),
        None => {
            let stem = file.file_stem().unwrap_or(OsStr::new("film")).to_string_lossy();
            store::default_place(&format!("check/{stem}-{}", args.solver.key()))
        }
    }
}

/// The program as it is named, of a path with folders by its full path, since it runs in another folder.
fn program(named: &Path) -> OsString {
    let is_bare = named.components().count() == 1;
    let full = if is_bare { None } else { std::path::absolute(named).ok() };
    full.map_or_else(|| named.into(), PathBuf::into_os_string)
}

fn unwritable(error: &io::Error) -> Failure {
    Failure::output(Diagnostic::new(format!("cannot write the input of the solver: {error}")))
}

/// Writes the input into `folder`, runs the solver there, and reads what it left.
fn calculated(
    element: &Element,
    solver: Solver,
    program: &OsStr,
    folder: &Path,
) -> Result<Vec<Comparison>, Diagnostic> {
    let failed = |error: io::Error| Diagnostic::new(format!("cannot write the input of {}: {error}", solver.name()));
    for (name, text) in &element.input.files {
        fs::write(folder.join(name), text).map_err(failed)?;
    }
    for (name, arguments) in &element.input.calls {
        let log = File::create(folder.join(log(name))).map_err(failed)?;
        let both = log.try_clone().map_err(failed)?;
        let status = Command::new(program)
            .args(arguments)
            .current_dir(folder)
            // More threads than elements only wait for each other.
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stdout(log)
            .stderr(both)
            .status()
            .map_err(|error| not_started(solver, program, &error))?;
        if !status.success() {
            let last = last_words(&folder.join(self::log(name)));
            let mistake = Diagnostic::new(format!("{} failed in the test {name} ({status}): {last}", solver.name()));
            return Err(mistake.hint(solver.installation()));
        }
    }
    let read = |name: &str| file::read_text(&folder.join(name), MOST_BYTES).map_err(|error| error.to_string());
    element.compared(read).map_err(|error| Diagnostic::new(format!("{}: {error}", solver.name())))
}

fn log(name: &str) -> String {
    format!("{name}.log")
}

/// The last line that a solver printed.
fn last_words(log: &Path) -> String {
    let text = file::read(log, MOST_BYTES).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let last = text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("it printed nothing");
    printable(last.trim()).into_owned()
}

fn not_started(solver: Solver, program: &OsStr, error: &io::Error) -> Diagnostic {
    let shown = shown_path(Path::new(program));
    let message = match error.kind() {
        io::ErrorKind::NotFound => format!("{} was not run: there is no program `{shown}`", solver.name()),
        _ => format!("{} was not run: `{shown}` cannot be started: {error}", solver.name()),
    };
    Diagnostic::new(message).hint(solver.installation())
}

/// Copies input, logs and results, and gives their names.
fn copied(folder: &Path, draft: &Draft, element: &Element) -> Result<Vec<String>, StoreError> {
    let inputs = element.input.files.iter().map(|(name, _)| name.clone());
    let logs = element.input.calls.iter().map(|(name, _)| log(name));
    let mut files = Vec::new();
    for name in inputs.chain(logs).chain(element.results()) {
        // A solver that fails leaves less.
        if let Ok(content) = file::read(&folder.join(&name), MOST_BYTES) {
            draft.write(&name, content)?;
            files.push(name);
        }
    }
    Ok(files)
}

/// Both over each other, here as lines.
fn picture(name: &str, solver: Solver, comparisons: &[Comparison]) -> Plot {
    let curves = comparisons.iter().flat_map(|comparison| {
        let Comparison { mode, stretches, ours, theirs } = comparison;
        let points = |rows: &[[f64; 2]], axis: usize| -> Vec<[f64; 2]> {
            stretches.iter().zip(rows).map(|(stretch, row)| [*stretch, 1e-6 * row[axis]]).collect()
        };
        let sides: &[(usize, &str)] = if *mode == Mode::Planar { &[(0, ""), (1, ", across")] } else { &[(0, "")] };
        let pair = |&(axis, words): &(usize, &str)| {
            let name = |who: &str| format!("{}{words}, {who}", mode.key());
            [
                Curve::line(name("droptower"), points(ours, axis)),
                Curve::line(name(solver.name()), points(theirs, axis)).dashed(),
            ]
        };
        sides.iter().flat_map(pair).collect::<Vec<_>>()
    });
    let title = format!("{name}: one element in droptower and {}", solver.name());
    Plot::new(title, ["stretch", "nominal stress (MPa)"], curves.collect())
}

fn columns(comparisons: &[Comparison]) -> Vec<Column> {
    let rows = |comparison: &Comparison| comparison.stretches.len();
    let modes: Vec<serde_json::Value> =
        comparisons.iter().flat_map(|each| std::iter::repeat_n(each.mode.key().into(), rows(each))).collect();
    let modes: Vec<Option<&serde_json::Value>> = modes.iter().map(Some).collect();
    let stresses = |name: &str, axis: usize, rows: fn(&Comparison) -> &Vec<[f64; 2]>| {
        Column::of_numbers(name, comparisons.iter().flat_map(|each| rows(each).iter().map(|row| row[axis])))
    };
    vec![
        Column::of_json("test", &modes),
        Column::of_numbers("stretch", comparisons.iter().flat_map(|each| each.stretches.iter().copied())),
        stresses("along_Pa", 0, |each| &each.ours),
        stresses("along_there_Pa", 0, |each| &each.theirs),
        stresses("across_Pa", 1, |each| &each.ours),
        stresses("across_there_Pa", 1, |each| &each.theirs),
    ]
}

fn text(summary: &Summary, place: &Path) -> String {
    let rows = summary.tests.iter().map(|test| {
        let reach = format!("to the stretch {:.3}", test.to_stretch);
        vec![format!("  {}", test.mode), reach, format!("off by {}", test.difference)]
    });
    let files: Vec<String> = std::iter::once(run_files::SUMMARY.to_owned()).chain(summary.files.clone()).collect();
    [
        format!("{} in {}\n", summary.check.film, summary.check.solver),
        text_table::aligned(&rows.collect::<Vec<_>>(), 3),
        "\n".to_owned(),
        findings::lines("  ", &summary.findings),
        digest::folder(place, &files),
    ]
    .concat()
}

/// A failure where a test is off by more than is allowed.
fn verdict(summary: &Summary, shared: &Shared) -> Result<(), Failure> {
    let worst = summary.tests.iter().max_by(|one, other| one.difference.share.total_cmp(&other.difference.share));
    match worst.filter(|worst| worst.difference.share > summary.within) {
        None => Ok(()),
        Some(_) if shared.json => Err(Failure::quiet()),
        Some(Test { mode, difference, .. }) => {
            let message = format!("{mode} tension is off by {difference}, more than {:.3} %", 100.0 * summary.within);
            Err(Failure::output(Diagnostic::new(message)))
        }
    }
}
