//! `droptower new`: a commented scenario or material to start from, with the scripts that it needs.

mod material;
mod test;

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, Shared, print};
use crate::diagnostic::{Diagnostic, shown_path};

#[derive(Debug, Args)]
pub(super) struct NewArgs {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, clap::Subcommand)]
enum Kind {
    #[command(flatten)]
    Test(test::Test),
    /// A material file of one layer of film
    Material(material::MaterialArgs),
}

/// Where a template is written.
#[derive(Debug, Args)]
struct Target {
    /// The file to write; an existing file is not replaced. Scripts are written beside it
    path: PathBuf,
}

/// A script that is written beside a scenario: its file and its text.
type Script = (&'static str, &'static str);

/// A file to start from.
struct Template {
    text: &'static str,
    scripts: &'static [Script],
}

pub(super) fn run(args: &NewArgs, shared: &Shared) -> Result<(), Failure> {
    let (template, path, next) = match &args.kind {
        Kind::Test(test) => {
            let path = &test.target().path;
            (test.template(), path, test.next(path))
        }
        Kind::Material(args) => {
            let path = &args.target.path;
            (args.kind.template(), path, format!("droptower check {}", shown_path(path)))
        }
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let scripts: Vec<(PathBuf, &str)> =
        template.scripts.iter().map(|(name, text)| (folder.join(name), *text)).collect();
    // What cannot be written is found before anything is.
    if let Some((path, _)) = scripts.iter().find(|(path, text)| is_other(path, text)) {
        return Err(exists(path, "the template needs a script of this name: choose another folder"));
    }
    write_new(path, template.text)?;
    for (path, text) in scripts.iter().filter(|(path, _)| !path.exists()) {
        write_new(path, text)?;
    }
    if shared.quiet {
        return Ok(());
    }
    let beside: Vec<String> = scripts.iter().map(|(path, _)| shown_path(path).to_string()).collect();
    let files = [&[shown_path(path).to_string()], &beside[..]].concat().join(", ");
    print(&format!("wrote {files}; try: {next}"))
}

/// Whether there is something else than `text` at `path`.
fn is_other(path: &Path, text: &str) -> bool {
    path.exists() && fs::read(path).map_or(true, |found| found != text.as_bytes())
}

fn exists(path: &Path, hint: &str) -> Failure {
    Diagnostic::new(format!("{} already exists", shown_path(path))).hint(hint).into()
}

fn write_new(path: &Path, text: &str) -> Result<(), Failure> {
    let written =
        OpenOptions::new().write(true).create_new(true).open(path).and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => exists(path, "give another name, or remove it first"),
        _ => Failure::output(Diagnostic::new(format!("cannot write {}: {error}", shown_path(path)))),
    })
}
