//! `droptower card write`: one film, one card.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::source::{self, Source};
use crate::argument::{number, quantity};
use crate::{Failure, Shared, findings, output, print_figures};
use ::card::{Film, Refusal, Request, System, Target};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::units::Rate;

/// The options of `card write`.
#[derive(Debug, Args)]
pub(crate) struct WriteArgs {
    /// A material, a scenario, or the folder of a run
    pub film: PathBuf,
    /// The solver: ls-dyna, openradioss, abaqus, calculix, febio, kratos, or curves for a table; `droptower explain SOLVER`
    /// has what it is written
    #[arg(long = "for", value_name = "SOLVER", value_parser = target)]
    pub target: Target,
    /// The units of the card: kg-m-s, t-mm-s, g-mm-ms, kg-mm-ms or lbf-in-s
    #[arg(long, value_name = "SYSTEM", default_value = "t-mm-s", value_parser = system)]
    pub units: System,
    /// The card to write
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Layers that one element stands for [default: those of the scenario's face, else 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub layers: Option<u32>,
    /// The face of a scenario with several, counted from 1
    #[arg(long, value_name = "N")]
    pub face: Option<usize>,
    /// Number of the material; those of its curves follow from it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=99_999))]
    pub id: u32,
    /// Strain rate of the curves where the target takes those of one [default: all rates]
    #[arg(long, value_name = "RATE", value_parser = |text: &str| quantity(Rate::DIMENSION, text))]
    pub rate: Option<f64>,
    /// Most points of a curve
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u16).range(2..=10_000))]
    pub points: u16,
    /// Poisson's ratio of incompressible film in elements that need one
    #[arg(long, value_name = "NUMBER", default_value = "0.4995", value_parser = poisson)]
    pub poisson: f64,
    /// Strain from which unloading curves are exact [default: the end of each curve]
    #[arg(long, value_name = "STRAIN", value_parser = strain)]
    pub unloading_from: Option<f64>,
    /// Write the nearest law of the target for one that it has not, and how far it is off up to this strain
    #[arg(long, value_name = "STRAIN", value_parser = strain, num_args = 0..=1, default_missing_value = "1")]
    pub approximate: Option<f64>,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
}

fn target(text: &str) -> Result<Target, String> {
    let names = || Target::ALL.map(Target::key).join(", ");
    Target::ALL.into_iter().find(|target| target.key() == text).ok_or_else(|| format!("expected one of {}", names()))
}

pub(super) fn system(text: &str) -> Result<System, String> {
    System::from_name(text).ok_or_else(|| format!("expected one of {}", System::ALL.map(System::name).join(", ")))
}

pub(super) fn poisson(text: &str) -> Result<f64, String> {
    let found = number(text)?;
    let is_possible = (0.4..0.5).contains(&found);
    is_possible.then_some(found).ok_or_else(|| format!("expected 0.4 to less than 0.5, found {text}"))
}

fn strain(text: &str) -> Result<f64, String> {
    let found = number(text)?;
    let is_possible = found > 0.0 && found <= 100.0;
    is_possible.then_some(found).ok_or_else(|| format!("expected a strain above 0 and up to 100, found {text}"))
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
    output::check(&args.out, args.target.ending(), Some(&args.film), Some(args.force))?;
    let Source { name, material, layers, origin, .. } = source::read(&args.film, args.face)?;
    let request = Request {
        layers: args.layers.unwrap_or(layers),
        id: args.id,
        rate: args.rate,
        points: args.points.into(),
        poisson: args.poisson,
        unloading_from: args.unloading_from,
        approximate: args.approximate,
        ..Request::new(args.target, args.units)
    };
    let film = Film { name: &name, material: &material, origin: &origin };
    let written = ::card::write(&film, &request).map_err(|refusal| refused(&refusal, args))?;
    output::write(&args.out, |file| file.write_all(written.text.as_bytes()))?;
    let summary = Summary {
        out: shown_path(&args.out),
        target: args.target.name(),
        units: args.units.name(),
        film: name,
        layers: request.layers,
        findings: written.losses.iter().map(Finding::new).collect(),
    };
    print_figures(shared, &summary, || {
        let Summary { out, target, units, film, findings, .. } = &summary;
        format!("{film} for {target}, {units}\n{}  {out}", findings::lines("  ", findings))
    })
}

fn refused(refusal: &Refusal, args: &WriteArgs) -> Diagnostic {
    let mistake = Diagnostic::new(format!("{}: {refusal}", shown_path(&args.film)));
    match refusal {
        Refusal::NoLaw { .. } if args.approximate.is_some() => {
            mistake.hint("it has none that is near: write it for another solver, or fit a law that this one has")
        }
        Refusal::NoLaw { .. } => {
            mistake.hint("--approximate 1.0 writes the nearest, and how far it is off up to the strain 1")
        }
        Refusal::ManyRates { range, .. } => mistake.hint(format!("name one: --rate \"{} 1/s\"", range[1])),
        Refusal::OtherRate { .. } => mistake.hint("name a rate within"),
        Refusal::TooManyTerms { .. } => mistake.hint("fit fewer terms: `droptower tensile fit`"),
    }
}
