//! `droptower deck`: whole tests for other solvers.

mod folder;
mod scene;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde::Serialize;

use crate::card::request::RequestArgs;
use crate::card::source;
use crate::{Failure, Shared, findings, print_figures};
use ::card::deck::{self, DeckRefusal};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use scene::Test;

#[derive(Debug, Subcommand)]
pub(super) enum DeckCommand {
    /// Write a drop test as a deck of LS-DYNA or OpenRadioss
    Write(WriteArgs),
}

pub(super) fn run(command: &DeckCommand, shared: &Shared) -> Result<(), Failure> {
    let DeckCommand::Write(args) = command;
    write(args, shared)
}

/// The options of `deck write`.
#[derive(Debug, Args)]
pub(crate) struct WriteArgs {
    /// A scenario, or the folder of a run
    pub scenario: PathBuf,
    /// The folder to write
    #[arg(long, short, value_name = "FOLDER")]
    pub out: PathBuf,
    #[command(flatten)]
    pub request: RequestArgs,
    /// Replace the deck in the folder
    #[arg(long)]
    pub force: bool,
}

/// What was written, for `--json`.
#[derive(Serialize)]
struct Summary {
    out: String,
    files: Vec<&'static str>,
    target: &'static str,
    units: &'static str,
    title: String,
    nodes: usize,
    elements: usize,
    findings: Vec<Finding>,
}

fn write(args: &WriteArgs, shared: &Shared) -> Result<(), Failure> {
    folder::check(&args.out, args.force)?;
    let file = if args.scenario.is_dir() { source::in_folder(&args.scenario)? } else { args.scenario.clone() };
    let test = Test::read(&file)?;
    let origin = source::origin(&file)?;
    let deck = test.deck(&origin)?;
    let written = deck::write(&deck, &args.request.request()).map_err(|refusal| {
        let mistake = Diagnostic::new(format!("{}: {refusal}", shown_path(&file)));
        match &refusal {
            DeckRefusal::Film { refusal, .. } => args.request.with_hint(mistake, refusal),
            DeckRefusal::Target(_) => mistake.hint("its materials can be written: `droptower card write`"),
            DeckRefusal::Units(_) => mistake.hint("name other ones, such as --units t-mm-s"),
        }
    })?;
    folder::write(&args.out, &written.files)?;
    let of_deck = written.losses.iter().map(Finding::new);
    let summary = Summary {
        out: shown_path(&args.out),
        files: written.files.iter().map(|file| file.name).collect(),
        target: args.request.target.name(),
        units: args.request.units.name(),
        title: deck.title.to_owned(),
        nodes: deck.faces.iter().map(|face| face.mounted.len()).sum(),
        elements: deck.faces.iter().map(|face| face.quads.len() + face.tris.len()).sum(),
        findings: of_deck.chain(written.card_losses.iter().map(Finding::new)).collect(),
    };
    print_figures(shared, &summary, || {
        let Summary { out, files, target, units, title, nodes, elements, findings } = &summary;
        format!(
            "{title} for {target}, {units}: {nodes} nodes and {elements} elements of film\n{}  {out}: {}",
            findings::lines("  ", findings),
            files.join("  ")
        )
    })
}
