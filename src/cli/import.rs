//! `droptower import`: a card of another solver as a material.

use crate::argument::quantity;
use crate::export::card::system;
use crate::{Failure, Shared, findings, output, print_figures};
use ::card::System;
use ::card::read::{self, Mistake, Reading};
use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::file;
use base::finding::Finding;
use base::units::Length;
use clap::{Args, Subcommand};
use scene::model;
use scene::scenario::Document;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Longest card, bytes.
const MOST_BYTES: u64 = 64 << 20;

#[derive(Debug, Subcommand)]
pub(super) enum ImportCommand {
    /// Read the film of a card as a material
    Card(CardArgs),
}

pub(super) fn run(command: &ImportCommand, shared: &Shared) -> Result<(), Failure> {
    let ImportCommand::Card(args) = command;
    card(args, shared)
}

/// The options of `import card`.
#[derive(Debug, Args)]
pub(crate) struct CardArgs {
    /// A card of LS-DYNA or OpenRadioss
    pub card: PathBuf,
    /// The material to write
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// The units of the card: kg-m-s, t-mm-s, g-mm-ms, kg-mm-ms or lbf-in-s [default: those that a card of droptower names]
    #[arg(long, value_name = "SYSTEM", value_parser = system)]
    pub units: Option<System>,
    /// Thickness of one layer, which is not in a card [default: that which a card of droptower names]
    #[arg(long, value_name = "LENGTH", value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub thickness: Option<f64>,
    /// Number or title of the material, where the card has several [default: the first]
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
}

/// What was written, for `--json`.
#[derive(Serialize)]
struct Summary {
    out: String,
    card: String,
    film: String,
    units: &'static str,
    thickness_m: f64,
    findings: Vec<Finding>,
}

fn card(args: &CardArgs, shared: &Shared) -> Result<(), Failure> {
    output::check(&args.out, "toml", Some(&args.card), Some(args.force))?;
    let shown = shown_path(&args.card);
    let text = file::read_text(&args.card, MOST_BYTES)
        .map_err(|error| Diagnostic::new(format!("cannot read {shown}: {error}")))?;
    let system = args.units.or_else(|| ::card::units_of(&text)).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("the units of {shown} are not known: cards have none of their own"));
        mistake.hint("name them, such as --units t-mm-s")
    })?;
    let thickness = args.thickness.or_else(|| ::card::thickness_of(&text, system)).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("the thickness of the film is not in {shown}"));
        mistake.hint("name that of one layer, such as --thickness \"12 um\"")
    })?;
    let Reading { film, warnings } =
        read::read(&text, system, args.material.as_deref()).map_err(|mistake| misread(&args.card, &text, &mistake))?;
    let findings: Vec<Finding> = warnings.iter().map(Finding::new).collect();
    let comments = [format!("Read from {shown} ({}) by droptower {}.", system.name(), env!("CARGO_PKG_VERSION"))];
    let comments: Vec<String> =
        comments.into_iter().chain(findings.iter().map(|finding| finding.message.clone())).collect();
    let material = read::material(&film, thickness, &comments);
    check(&material)?;
    output::write(&args.out, |file| file.write_all(material.as_bytes()))?;
    let summary = Summary {
        out: shown_path(&args.out),
        card: shown,
        film: film.name,
        units: system.name(),
        thickness_m: thickness,
        findings,
    };
    print_figures(shared, &summary, || {
        let Summary { out, card, film, units, findings, .. } = &summary;
        format!("{film} of {card}, {units}\n{}  {out}", findings::lines("  ", findings))
    })
}

/// Refuses a material that `droptower check` would refuse.
fn check(material: &str) -> Result<(), Vec<Diagnostic>> {
    let unwritten = |error: std::io::Error| vec![Diagnostic::new(format!("no material: {error}"))];
    let scratch = tempfile::tempdir().map_err(unwritten)?;
    let draft = scratch.path().join("material.toml");
    fs::write(&draft, material).map_err(unwritten)?;
    model::check_material(&Document::read_material(&draft)?).map(|_| ())
}

/// A mistake in the `text` of a card, with its line.
fn misread(path: &Path, text: &str, mistake: &Mistake) -> Diagnostic {
    let line = text.lines().nth(mistake.place.line - 1).unwrap_or_default().to_owned();
    let source = Source::excerpt(path, mistake.place.line, line);
    Diagnostic::new(mistake.fault.to_string()).at(&Span::position(&source, 1, mistake.place.column))
}
