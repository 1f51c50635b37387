//! `droptower new`: a commented scenario to start from, with the scripts that it needs.

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{Failure, Shared, print};
use crate::diagnostic::{Diagnostic, shown_path};

#[derive(Debug, Args)]
pub(super) struct NewArgs {
    /// What to simulate
    pub kind: Kind,
    /// The file to write; an existing file is not replaced. Scripts are written beside it
    pub path: PathBuf,
}

/// The tests for which there is a template.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Kind {
    /// A sphere on a wound film, as in the LLDPE study
    Drop,
    /// A falling dart on a clamped disc, ASTM D1709 method A; its failure mass by a script
    #[value(name = "d1709-a", alias = "dart")]
    D1709A,
    /// The same with a larger dart from a greater height, method B
    #[value(name = "d1709-b")]
    D1709B,
    /// High-speed puncture of a film, ASTM D7192
    #[value(name = "d7192")]
    D7192,
    /// Protrusion puncture of stretch wrap film by a slow probe, ASTM D5748
    #[value(name = "d5748")]
    D5748,
    /// Instrumented puncture, ISO 7765-2
    #[value(name = "iso7765-2")]
    Iso7765,
    /// Puncture of packaging film by a fine, slow probe, EN 14477
    #[value(name = "en14477")]
    En14477,
    /// A tensile coupon between two jaws
    Coupon,
    /// A slow probe into a clamped disc
    Indent,
    /// A clamped disc inflated by pressure
    Pressure,
}

/// A script that is written beside a scenario: its file and its text.
type Script = (&'static str, &'static str);

/// The post script of the puncture tests.
const PUNCTURE: Script = ("puncture.rhai", include_str!("../../scripts/post/puncture.rhai"));
/// The search for the failure mass of a dart test.
const FAILURE_MASS: Script = ("failure-mass.rhai", include_str!("../../scripts/failure-mass.rhai"));

impl Kind {
    fn template(self) -> &'static str {
        match self {
            Kind::Drop => include_str!("templates/drop.toml"),
            Kind::D1709A => include_str!("templates/d1709-a.toml"),
            Kind::D1709B => include_str!("templates/d1709-b.toml"),
            Kind::D7192 => include_str!("templates/d7192.toml"),
            Kind::D5748 => include_str!("templates/d5748.toml"),
            Kind::Iso7765 => include_str!("templates/iso7765-2.toml"),
            Kind::En14477 => include_str!("templates/en14477.toml"),
            Kind::Coupon => include_str!("templates/coupon.toml"),
            Kind::Indent => include_str!("templates/indent.toml"),
            Kind::Pressure => include_str!("templates/pressure.toml"),
        }
    }

    fn scripts(self) -> &'static [Script] {
        match self {
            Kind::D1709A | Kind::D1709B => &[PUNCTURE, FAILURE_MASS],
            Kind::D7192 | Kind::D5748 | Kind::Iso7765 | Kind::En14477 => &[PUNCTURE],
            Kind::Drop | Kind::Coupon | Kind::Indent | Kind::Pressure => &[],
        }
    }

    /// The command that gives the figure of the test.
    fn next(self, scenario: &str, folder: &Path) -> String {
        match self {
            Kind::D1709A | Kind::D1709B => {
                let script = folder.join(FAILURE_MASS.0);
                format!("droptower script {} --scenario {scenario}   (the failure mass)", shown_path(&script))
            }
            Kind::D7192 | Kind::D5748 | Kind::Iso7765 | Kind::En14477 => {
                format!("droptower run {scenario}   (force, travel and energy of the puncture)")
            }
            Kind::Drop | Kind::Coupon | Kind::Indent | Kind::Pressure => format!("droptower check {scenario}"),
        }
    }
}

pub(super) fn run(args: &NewArgs, shared: &Shared) -> Result<(), Failure> {
    let folder = args.path.parent().unwrap_or(Path::new(""));
    let scripts: Vec<(PathBuf, &str)> =
        args.kind.scripts().iter().map(|(name, text)| (folder.join(name), *text)).collect();
    // What cannot be written is found before anything is.
    if let Some((path, _)) = scripts.iter().find(|(path, text)| is_other(path, text)) {
        return Err(exists(path, "the template needs a script of this name: choose another folder"));
    }
    write_new(&args.path, args.kind.template())?;
    for (path, text) in scripts.iter().filter(|(path, _)| !path.exists()) {
        write_new(path, text)?;
    }
    if shared.quiet {
        return Ok(());
    }
    let shown = shown_path(&args.path);
    let beside: Vec<String> = scripts.iter().map(|(path, _)| shown_path(path).to_string()).collect();
    let files = [&[shown.to_string()], &beside[..]].concat().join(", ");
    print(&format!("wrote {files}; try: {}", args.kind.next(&shown.to_string(), folder)))
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
