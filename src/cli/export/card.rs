//! `droptower export card`: one film, one card; and what a solver is written, for `droptower explain`.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::argument::{number, quantity};
use crate::film::{self, Source};
use crate::{Failure, Shared, findings, output, print, print_figures, print_json};
use ::card::{About, Film, Refusal, Request, System, Target};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::units::Rate;

/// The options of films that are written, for cards and decks.
#[derive(Debug, Args)]
pub(crate) struct RequestArgs {
    /// The solver: ls-dyna, openradioss, abaqus, calculix, febio, kratos, or curves for a table; `droptower explain SOLVER`
    /// has what it is written
    #[arg(long = "for", value_name = "SOLVER", value_parser = target)]
    pub target: Target,
    /// The units: kg-m-s, t-mm-s, g-mm-ms, kg-mm-ms or lbf-in-s
    #[arg(long, value_name = "SYSTEM", default_value = "t-mm-s", value_parser = system)]
    pub units: System,
    /// Strain rate of the curves where the target takes those of one [default: all rates]
    #[arg(long, value_name = "RATE", value_parser = |text: &str| quantity(Rate::DIMENSION, text))]
    pub rate: Option<f64>,
    /// Most points of a curve
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u16).range(2..=10_000))]
    pub points: u16,
    /// Poisson's ratio of incompressible film in elements that need one [default: 0.4995 or more, by the stress of the film]
    #[arg(long, value_name = "NUMBER", value_parser = poisson)]
    pub poisson: Option<f64>,
    /// Strain from which unloading curves are exact [default: the end of each curve]
    #[arg(long, value_name = "STRAIN", value_parser = strain)]
    pub unloading_from: Option<f64>,
}

impl RequestArgs {
    /// A request of one layer.
    pub(crate) fn request(&self) -> Request {
        Request {
            rate: self.rate,
            points: self.points.into(),
            poisson: self.poisson,
            unloading_from: self.unloading_from,
            ..Request::new(self.target, self.units)
        }
    }

    /// The mistake of a film that is refused, with what helps.
    pub(crate) fn with_hint(&self, mistake: Diagnostic, refusal: &Refusal) -> Diagnostic {
        match refusal {
            Refusal::NoLaw { .. } => mistake.hint("write it for another solver, or fit a law that this one has"),
            Refusal::ManyRates { range, .. } => mistake.hint(format!("name one: --rate \"{} 1/s\"", range[1])),
            Refusal::OtherRate { .. } => mistake.hint("name a rate within"),
            Refusal::TooManyTerms { .. } => mistake.hint("fit fewer terms: `droptower fit prony`"),
        }
    }
}

fn target(text: &str) -> Result<Target, String> {
    let names = || Target::ALL.map(Target::key).join(", ");
    Target::ALL.into_iter().find(|target| target.key() == text).ok_or_else(|| format!("expected one of {}", names()))
}

/// The system of units of this name.
pub(crate) fn system(text: &str) -> Result<System, String> {
    System::from_name(text).ok_or_else(|| format!("expected one of {}", System::ALL.map(System::name).join(", ")))
}

fn poisson(text: &str) -> Result<f64, String> {
    let found = number(text)?;
    let is_possible = (0.4..0.5).contains(&found);
    is_possible.then_some(found).ok_or_else(|| format!("expected 0.4 to less than 0.5, found {text}"))
}

fn strain(text: &str) -> Result<f64, String> {
    let found = number(text)?;
    let is_possible = found > 0.0 && found <= 100.0;
    is_possible.then_some(found).ok_or_else(|| format!("expected a strain above 0 and up to 100, found {text}"))
}

/// The options of `export card`.
#[derive(Debug, Args)]
pub(crate) struct CardArgs {
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

pub(super) fn run(args: &CardArgs, shared: &Shared) -> Result<(), Failure> {
    let target = args.request.target;
    output::check(&args.out, target.ending(), Some(&args.film), Some(args.force))?;
    let Source { name, material, layers, origin } = film::read(&args.film, args.face)?;
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

/// The word in place of a key that lists all solvers.
pub(crate) const WORD: &str = "solvers";

/// The solver of this name on the command line.
pub(crate) fn find(name: &str) -> Option<Target> {
    Target::ALL.into_iter().find(|target| target.key() == name)
}

/// A solver as it is explained.
#[derive(Serialize)]
struct Explanation {
    solver: &'static str,
    write: String,
    #[serde(flatten)]
    about: About,
}

impl Explanation {
    fn new(target: Target) -> Explanation {
        let key = target.key();
        Explanation {
            solver: target.name(),
            write: format!("droptower export card FILM --for {key} -o film.{}", target.ending()),
            about: target.about(),
        }
    }

    fn text(&self) -> String {
        let laws = self.about.laws.iter().map(|(film, keyword)| format!("{film}: {keyword}"));
        let advice = self.about.advice.iter().map(|sentence| format!("note: {sentence}"));
        let lines: Vec<String> =
            std::iter::once(self.write.clone()).chain(laws).chain(advice).map(|line| format!("\n    {line}")).collect();
        format!("{}{}", self.solver, lines.concat())
    }
}

/// Prints what `target` is written, or what all are.
pub(crate) fn explain(target: Option<Target>, shared: &Shared) -> Result<(), Failure> {
    let targets = target.map_or_else(|| Target::ALL.to_vec(), |target| vec![target]);
    let explanations: Vec<Explanation> = targets.into_iter().map(Explanation::new).collect();
    if shared.json {
        return print_json(&explanations);
    }
    print(&explanations.iter().map(Explanation::text).collect::<Vec<_>>().join("\n\n"))
}
