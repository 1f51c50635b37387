//! `droptower card write`: one film, one card.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::request::RequestArgs;
use super::source::{self, Source};
use crate::{Failure, Shared, findings, output, print_figures};
use ::card::{Film, Request};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;

/// The options of `card write`.
#[derive(Debug, Args)]
pub(crate) struct WriteArgs {
    /// A material, a scenario, or the folder of a run
    pub film: PathBuf,
    /// The card to write
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    #[command(flatten)]
    pub request: RequestArgs,
    /// Layers that one element stands for [default: those of the scenario's face, else 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub layers: Option<u32>,
    /// The face of a scenario with several, counted from 1
    #[arg(long, value_name = "N")]
    pub face: Option<usize>,
    /// Number of the material; those of its curves follow from it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=99_999))]
    pub id: u32,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
}

/// What was written, for `--json`.
#[derive(Serialize)]
struct Summary {
    out: String,
    target: &'static str,
    units: &'static str,
    film: String,
    layers: u32,
    findings: Vec<Finding>,
}

pub(super) fn run(args: &WriteArgs, shared: &Shared) -> Result<(), Failure> {
    let target = args.request.target;
    output::check(&args.out, target.ending(), Some(&args.film), Some(args.force))?;
    let Source { name, material, layers, origin } = source::read(&args.film, args.face)?;
    let request = Request { layers: args.layers.unwrap_or(layers), id: args.id, ..args.request.request() };
    let film = Film { name: &name, material: &material, origin: &origin };
    let written = ::card::write(&film, &request).map_err(|refusal| {
        let mistake = Diagnostic::new(format!("{}: {refusal}", shown_path(&args.film)));
        args.request.with_hint(mistake, &refusal)
    })?;
    output::write(&args.out, |file| file.write_all(written.text.as_bytes()))?;
    let summary = Summary {
        out: shown_path(&args.out),
        target: target.name(),
        units: args.request.units.name(),
        film: name,
        layers: request.layers,
        findings: written.losses.iter().map(Finding::new).collect(),
    };
    print_figures(shared, &summary, || {
        let Summary { out, target, units, film, findings, .. } = &summary;
        format!("{film} for {target}, {units}\n{}  {out}", findings::lines("  ", findings))
    })
}
