//! `droptower new`: a commented scenario, material, study or array job to start from, with the scripts that it needs.

mod case;
mod films;
mod material;
mod slurm;
mod test;

use std::borrow::Cow;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::{Failure, Shared, output, print};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::scratch;
use scene::scenario::FileKind;

#[derive(Debug, Args)]
pub(super) struct NewArgs {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, clap::Subcommand)]
enum Kind {
    #[command(flatten)]
    Test(test::Test),
    /// A test: a folder with a scenario and what its run must give, for `droptower test`
    #[command(name = "test")]
    Case(case::CaseArgs),
    /// A material file of one layer of film: a law to fill in, or a film by name
    Material(material::MaterialArgs),
    /// A study that calibrates a film with several tests, for `droptower calibrate`
    Study(Target),
    /// An array job of Slurm that computes a sweep, for `sbatch`
    Slurm(slurm::SlurmArgs),
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

pub(super) fn run(args: &NewArgs, shared: &Shared) -> Result<(), Failure> {
    let (kind, template, path, next) = match &args.kind {
        Kind::Case(args) => return case::write(args, shared),
        Kind::Study(Target { path }) => return write_study(path, shared),
        Kind::Slurm(args) => return slurm::write(args, shared),
        Kind::Test(test) => {
            let path = &test.target().path;
            (FileKind::Scenario, test.template(), path, test.next(path))
        }
        Kind::Material(args) => {
            let Some((template, path)) = args.template() else { return material::list(shared) };
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
    if shared.quiet {
        return Ok(());
    }
    let beside: Vec<String> = scripts.iter().map(|(path, _)| shown_path(path).to_string()).collect();
    let files = [&[shown_path(path).to_string()], &beside[..]].concat().join(", ");
    print(&format!("wrote {files}; try: {next}"))
}

/// Writes a study.
fn write_study(path: &Path, shared: &Shared) -> Result<(), Failure> {
    if path.extension().is_none_or(|ending| ending != "toml") {
        let mistake = Diagnostic::new(format!("{} does not end in .toml", shown_path(path)));
        return Err(mistake.hint("a study is a TOML file; docs/calibration.md has the same in a script").into());
    }
    check_new(path)?;
    write_new(path, STUDY)?;
    if shared.quiet {
        return Ok(());
    }
    let path = shown_path(path);
    print(&format!("wrote {path}; name your scenarios in it, then: droptower calibrate {path}"))
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
