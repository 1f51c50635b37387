//! How films are written, for cards and decks.

use clap::Args;

use crate::argument::{number, quantity};
use ::card::{Refusal, Request, System, Target};
use base::diagnostic::Diagnostic;
use base::units::Rate;

/// The options of films that are written.
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
            Refusal::TooManyTerms { .. } => mistake.hint("fit fewer terms: `droptower tensile fit`"),
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
