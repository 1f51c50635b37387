//! `droptower new`: a commented scenario, material, study or array job to start from, with the scripts that it needs.

mod materials;

use std::borrow::Cow;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::Value;

use crate::{Failure, Shared, output, print_unless_quiet, shell, sweep};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::scratch;
use base::shell::quoted;
use scene::scenario::{Document, FileKind};
use study::store;
use study::sweep::Sweep;

#[derive(Debug, Args)]
pub(crate) struct NewArgs {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, clap::Subcommand)]
enum Kind {
    #[command(flatten)]
    Test(Test),
    /// A test: a folder with a scenario and what its run must give, for `droptower test`
    #[command(name = "test")]
    Case(CaseArgs),
    /// A material file of one layer of film: a law to fill in, or a film by name
    Material(materials::MaterialArgs),
    /// A study that calibrates a film with several tests, for `droptower calibrate`
    Study(Target),
    /// An array job of Slurm that computes a sweep, for `sbatch`
    Slurm(SlurmArgs),
}

/// Where a template is written.
#[derive(Debug, Args)]
struct Target {
    /// The file to write; an existing file is not replaced. Scripts are written beside it
    path: PathBuf,
}

const STUDY: &str = include_str!("templates/study.toml");

/// A script that is written beside a scenario: its file and its text.
type Script = (&'static str, &'static str);

/// A file to start from.
struct Template {
    text: Cow<'static, str>,
    scripts: &'static [Script],
}

pub(crate) fn run(args: &NewArgs, shared: &Shared) -> Result<(), Failure> {
    let (kind, template, path, next) = match &args.kind {
        Kind::Case(args) => return write_case(args, shared),
        Kind::Study(Target { path }) => return write_study(path, shared),
        Kind::Slurm(args) => return write_slurm(args, shared),
        Kind::Test(test) => {
            let (Target { path }, text, scripts, next) = test.parts();
            (FileKind::Scenario, Template { text: text.into(), scripts }, path, next(&shown_path(path)))
        }
        Kind::Material(args) => {
            let Some((template, path)) = args.template() else { return materials::list(shared) };
            (FileKind::Material, template, path, format!("droptower check {}", shown_path(path)))
        }
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let scripts: Vec<(PathBuf, &str)> =
        template.scripts.iter().map(|(name, text)| (folder.join(name), *text)).collect();
    // What cannot be written is found before anything is.
    if let Some((path, _)) = scripts.iter().find(|(path, text)| is_other(path, text)) {
        return Err(exists(path, "the template needs a script of this name: choose another folder"));
    }
    check_new(path)?;
    for (path, text) in scripts.iter().filter(|(path, _)| !path.exists()) {
        write_new(path, text)?;
    }
    write_with_schema(kind, path, &template.text)?;
    let beside: Vec<String> = scripts.iter().map(|(path, _)| shown_path(path).to_string()).collect();
    let files = [&[shown_path(path).to_string()], &beside[..]].concat().join(", ");
    print_unless_quiet(shared, &format!("wrote {files}; try: {next}"))
}

/// Writes a study.
fn write_study(path: &Path, shared: &Shared) -> Result<(), Failure> {
    if path.extension().is_none_or(|ending| ending != "toml") {
        let mistake = Diagnostic::new(format!("{} does not end in .toml", shown_path(path)));
        return Err(mistake.hint("a study is a TOML file; docs/calibration.md has the same in a script").into());
    }
    check_new(path)?;
    write_new(path, STUDY)?;
    let path = shown_path(path);
    print_unless_quiet(shared, &format!("wrote {path}; name your scenarios in it, then: droptower calibrate {path}"))
}

/// Writes a new file whose first line names the schema beside it, by which editors know its keys.
fn write_with_schema(kind: FileKind, path: &Path, text: &str) -> Result<(), Failure> {
    check_new(path)?;
    // The file comes last: it would be in the way of the next try, should the disk be full before.
    write_schema(kind, &path.with_file_name(kind.schema_file()))?;
    write_new(path, &format!("#:schema {}\n{text}", kind.schema_file()))
}

/// Refuses a path that is taken, before anything is written.
fn check_new(path: &Path) -> Result<(), Failure> {
    match path.exists() {
        true => Err(exists(path, "give another name, or remove it first")),
        false => Ok(()),
    }
}

/// Writes the schema; that of another version is replaced, a file of the user's is left as it is.
fn write_schema(kind: FileKind, path: &Path) -> Result<(), Failure> {
    let schema = kind.schema();
    let is_ours = |found: Value| found["title"] == schema["title"];
    let is_free = match fs::read(path) {
        Ok(found) => serde_json::from_slice(&found).is_ok_and(is_ours),
        Err(error) => error.kind() == ErrorKind::NotFound,
    };
    if !is_free {
        return Ok(());
    }
    output::write(path, |file| serde_json::to_writer_pretty(file, &schema).map_err(std::io::Error::other))
}

/// Whether there is something else than `text` at `path`.
fn is_other(path: &Path, text: &str) -> bool {
    path.exists() && fs::read(path).map_or(true, |found| found != text.as_bytes())
}

fn exists(path: &Path, hint: &str) -> Failure {
    Diagnostic::new(format!("{} already exists", shown_path(path))).hint(hint).into()
}

fn write_new(path: &Path, text: &str) -> Result<(), Failure> {
    let written = scratch::file(folder_of(path)).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        // Whole or not at all: what a full disk took of it would be in the way of the next try.
        file.persist_noclobber(path).map(drop).map_err(|error| error.error)
    });
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => exists(path, "give another name, or remove it first"),
        _ => Failure::output(Diagnostic::new(format!("cannot write {}: {error}", shown_path(path)))),
    })
}

/// The tests.
#[derive(Debug, Subcommand)]
enum Test {
    /// A sphere on a wound film, as in the LLDPE study
    Drop(Target),
    /// A falling dart on a clamped disc, ASTM D1709 method A; its failure mass by a script
    #[command(name = "d1709-a", alias = "dart")]
    D1709A(Target),
    /// The same with a larger dart from a greater height, method B
    #[command(name = "d1709-b")]
    D1709B(Target),
    /// High-speed puncture of a film, ASTM D7192
    #[command(name = "d7192")]
    D7192(Target),
    /// Protrusion puncture of stretch wrap film by a slow probe, ASTM D5748
    #[command(name = "d5748")]
    D5748(Target),
    /// Instrumented puncture, ISO 7765-2
    #[command(name = "iso7765-2")]
    Iso7765(Target),
    /// Puncture of packaging film by a fine, slow probe, EN 14477
    #[command(name = "en14477")]
    En14477(Target),
    /// A tensile coupon between two jaws
    Coupon(Target),
    /// A slow probe into a clamped disc
    Indent(Target),
    /// A clamped disc inflated by pressure
    Pressure(Target),
    /// A clamped disc of rubber inflated by gas, beyond its largest pressure
    Volume(Target),
}

/// The post script of the puncture tests.
const PUNCTURE: &[Script] = &[("puncture.rhai", include_str!("../../../scripts/post/puncture.rhai"))];

/// What gives the figure of a test whose scenario is at a path.
type Next = fn(&str) -> String;

const CHECK: Next = |scenario| format!("droptower check {scenario}");

const FAILURE_MASS: Next =
    |scenario| format!("droptower script failure-mass --scenario {scenario}   (the failure mass)");

const FORCE: Next = |scenario| {
    format!(
        "droptower run {scenario}   (force, travel and energy of the puncture); droptower sweep {scenario}   (the same for both \
         ends of what coupons do not tell)"
    )
};

impl Test {
    /// Where its template is written, its scenario and scripts, and the command that comes next.
    fn parts(&self) -> (&Target, &'static str, &'static [Script], Next) {
        match self {
            Test::Drop(target) => (target, include_str!("templates/drop.toml"), &[], CHECK),
            Test::D1709A(target) => (target, include_str!("templates/d1709-a.toml"), PUNCTURE, FAILURE_MASS),
            Test::D1709B(target) => (target, include_str!("templates/d1709-b.toml"), PUNCTURE, FAILURE_MASS),
            Test::D7192(target) => (target, include_str!("templates/d7192.toml"), PUNCTURE, FORCE),
            Test::D5748(target) => (target, include_str!("templates/d5748.toml"), PUNCTURE, FORCE),
            Test::Iso7765(target) => (target, include_str!("templates/iso7765-2.toml"), PUNCTURE, FORCE),
            Test::En14477(target) => (target, include_str!("templates/en14477.toml"), PUNCTURE, FORCE),
            Test::Coupon(target) => (target, include_str!("templates/coupon.toml"), &[], CHECK),
            Test::Indent(target) => (target, include_str!("templates/indent.toml"), &[], CHECK),
            Test::Pressure(target) => (target, include_str!("templates/pressure.toml"), &[], CHECK),
            Test::Volume(target) => (target, include_str!("templates/volume.toml"), &[], CHECK),
        }
    }
}

#[derive(Debug, Args)]
struct CaseArgs {
    /// The folder to write; files in it are not replaced
    folder: PathBuf,
    /// The scenario that the test extends; left out, a drop test to change
    #[arg(long, value_name = "SCENARIO")]
    scenario: Option<PathBuf>,
}

const EXPECTATIONS: &str = include_str!("templates/expect.toml");
const SCENARIO: &str = include_str!("templates/drop.toml");

fn write_case(args: &CaseArgs, shared: &Shared) -> Result<(), Failure> {
    let scenario = match &args.scenario {
        Some(base) => {
            Document::read(base)?;
            extended(&args.folder, base)
        }
        None => SCENARIO.to_owned(),
    };
    let files = [
        (FileKind::Scenario, "scenario.toml", scenario.as_str()),
        (FileKind::Expectations, "expect.toml", EXPECTATIONS),
    ];
    let files = files.map(|(kind, name, text)| (kind, args.folder.join(name), text));
    if let Some((_, path, _)) = files.iter().find(|(_, path, _)| path.exists()) {
        return Err(exists(path, "give another folder, or remove it first"));
    }
    fs::create_dir_all(&args.folder).map_err(|error| {
        Failure::output(Diagnostic::new(format!("cannot create {}: {error}", shown_path(&args.folder))))
    })?;
    files.iter().try_for_each(|(kind, path, text)| write_with_schema(*kind, path, text))?;
    let [scenario, expectations] = files.map(|(_, path, _)| shown_path(&path).to_string());
    let folder = shown_path(&args.folder);
    print_unless_quiet(shared, &format!("wrote {scenario}, {expectations}; try: droptower test {folder} --bless"))
}

/// A scenario in `folder` that extends another one.
fn extended(folder: &Path, base: &Path) -> String {
    let base = toml::Value::from(store::path_from(folder, base));
    format!(
        "extends = {base}\n\n# Coarse and short, so that the test takes seconds:\n# specimen.mesh.size = \"20 mm\"\n"
    )
}

#[derive(Debug, Args)]
struct SlurmArgs {
    /// The file to write; an existing file is not replaced
    path: PathBuf,
    /// The scenario, with a table [variation]
    #[arg(long, value_name = "SCENARIO", add = shell::scenarios())]
    scenario: PathBuf,
    /// Number of runs, in place of `variation.samples`
    #[arg(short = 'n', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,
    /// Number of tasks, which share the runs
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    tasks: u32,
}

fn write_slurm(args: &SlurmArgs, shared: &Shared) -> Result<(), Failure> {
    let SlurmArgs { path, scenario, samples, tasks } = args;
    check_new(path)?;
    let document = Document::read(scenario)?;
    let samples = samples.map(|samples| samples as usize);
    Sweep::prepare(&document, samples).map_err(|error| sweep::refused(&error, &document))?;
    let runs = samples.map(|samples| format!(" -n {samples}")).unwrap_or_default();
    write_new(path, &script(&format!("{}{runs}", quoted(&scenario.display().to_string())), *tasks))?;
    let path = shown_path(path);
    print_unless_quiet(
        shared,
        &format!("wrote {path}; try: sbatch {path}   (computes the runs); sh {path}   (then writes the results)"),
    )
}

/// The script: `sweep` is the scenario and the number of runs, as words of the shell. Nothing of it stands in a comment, which a
/// line break in a name would end.
fn script(sweep: &str, tasks: u32) -> String {
    format!(
        r#"#!/bin/sh
# A sweep of droptower as an array job of Slurm. In this folder, which the nodes must see too:
#   sbatch FILE   computes the runs; submitted again, those that are missing
#   sh FILE       gathers the results, once no task is left in `squeue --me`
#SBATCH --job-name=droptower
#SBATCH --array=1-{tasks}             # number of tasks; each takes runs that nobody has begun
#SBATCH --cpus-per-task=16      # cores of a task, all on one node
#SBATCH --nodes=1
#SBATCH --time=60               # minutes; short tasks start sooner
##SBATCH --account=film-lab     # who pays, if the centre asks; remove one # to use it
##SBATCH --partition=standard   # the queue; `sinfo` lists them
#SBATCH --requeue               # a task goes on after its node failed
#SBATCH --open-mode=append
set -- sweep {sweep}
if [ -n "$SLURM_ARRAY_TASK_ID" ]; then
    exec droptower "$@" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_MAX" --threads "$SLURM_CPUS_PER_TASK"
fi
exec droptower "$@" --merge
"#
    )
}
