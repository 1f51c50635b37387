//! `droptower new`: a commented scenario to start from.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{Failure, Shared, print};
use crate::diagnostic::{Diagnostic, shown_path};

#[derive(Debug, Args)]
pub(super) struct NewArgs {
    /// What to simulate
    pub kind: Kind,
    /// The file to write; an existing file is not replaced
    pub path: PathBuf,
}

/// The tests for which there is a template.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Kind {
    /// A sphere on a wound film, as in the LLDPE study
    Drop,
    /// A falling dart on a clamped disc (after ASTM D1709, method A)
    Dart,
    /// A tensile coupon between two jaws
    Coupon,
    /// A slow probe into a clamped disc
    Indent,
    /// A clamped disc inflated by pressure
    Pressure,
}

impl Kind {
    fn template(self) -> &'static str {
        match self {
            Kind::Drop => include_str!("templates/drop.toml"),
            Kind::Dart => include_str!("templates/dart.toml"),
            Kind::Coupon => include_str!("templates/coupon.toml"),
            Kind::Indent => include_str!("templates/indent.toml"),
            Kind::Pressure => include_str!("templates/pressure.toml"),
        }
    }
}

pub(super) fn run(args: &NewArgs, shared: &Shared) -> Result<(), Failure> {
    let shown = shown_path(&args.path);
    let written = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&args.path)
        .and_then(|mut file| file.write_all(args.kind.template().as_bytes()));
    match written {
        Ok(()) if shared.quiet => Ok(()),
        Ok(()) => print(&format!("wrote {shown}; try: droptower check {shown}")),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            let mistake = Diagnostic::new(format!("{shown} already exists"));
            Err(mistake.hint("give another name, or remove it first").into())
        }
        Err(error) => Err(Failure::output(Diagnostic::new(format!("cannot write {shown}: {error}")))),
    }
}
