//! `droptower fit prony`: a Prony series fitted to a relaxation modulus.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{FittedArgs, Places, columns, name};
use crate::argument::number;
use crate::{Failure, Shared, faults, findings, print_figures, table};
use base::diagnostic::Diagnostic;
use base::finding::Finding;
use base::number::{figure, plain, rounded, significant};
use lab::experiment::Warning;
use lab::experiment::material_file::fitted::{ASSUMED_POISSON, RelaxationMaterial, relaxation_text};
use lab::experiment::relaxation::{PronyFit, fit_prony, read_relaxation};
use lab::signal::file::ChannelSelection;
use plot::{Axis, Curve, Look, Plot, Scale};
use report::{FitPage, FitTable, fit_page};

/// Number of terms of a Prony series where none is given.
const TERMS: usize = 12;

#[derive(Debug, Args)]
pub(crate) struct PronyArgs {
    /// The measured relaxation modulus, a file with `time` and `modulus`
    #[arg(value_name = "DATA")]
    data: PathBuf,
    /// Most terms of the Prony series
    #[arg(long, value_name = "N", default_value_t = TERMS)]
    terms: usize,
    /// Poisson's ratio, for the material file
    #[arg(long, value_name = "RATIO", value_parser = number)]
    poisson: Option<f64>,
    #[command(flatten)]
    fitted: FittedArgs,
}

pub(super) fn run(args: &PronyArgs, shared: &Shared) -> Result<(), Failure> {
    let places = Places::from_args(&args.fitted)?;
    if let Some(poisson) = args.poisson.filter(|ratio| !(-1.0 < *ratio && *ratio < 0.5)) {
        return Err(Diagnostic::new(format!("expected a Poisson's ratio from -1 to 0.5, found {poisson}")).into());
    }
    let path = &args.data;
    let points = read_relaxation(path, &args.fitted.file.options(ChannelSelection::All)?)
        .map_err(|error| faults::recording(&error))?;
    let fit =
        fit_prony(&points, args.terms).map_err(|error| Diagnostic::new(format!("{}: {error}", path.display())))?;
    let incomplete = args.fitted.film().missing().map(|keys| Warning::MaterialIncomplete { keys: keys.into() });
    let assumed = args.poisson.is_none().then_some(Warning::PoissonAssumed { poisson: ASSUMED_POISSON });
    let of_material = [incomplete, assumed].into_iter().flatten().filter(|_| places.material.is_some());
    let findings: Vec<Finding> =
        fit.warnings.iter().map(Finding::new).chain(of_material.map(|one| Finding::new(&one))).collect();
    let source = name(path);
    let (poisson, film) = (args.poisson, args.fitted.film());
    let material = relaxation_text(&RelaxationMaterial { fit: &fit, source: &source, poisson, film });
    let shown = places.material.as_ref().map(|_| material.as_str());
    let written = places.write(&material, &page(&source, &fit, &findings, shown))?;
    let figures = RelaxationFigures::new(&source, &fit, findings, written);
    print_figures(shared, &figures, || figures.text())
}

/// The page with measured and fitted modulus, errors and terms.
fn page(source: &str, fit: &PronyFit, findings: &[Finding], material: Option<&str>) -> String {
    let title = format!("Relaxation of {source}");
    let (tables, plots) = (tables(fit), plots(fit));
    fit_page(&FitPage { title: &title, tables, plots, correlation: None, findings, material })
}

fn tables(fit: &PronyFit) -> Vec<FitTable> {
    let figures = [
        ("instantaneous modulus (MPa)", figure(fit.prony.instantaneous * 1e-6, 5)),
        ("modulus in the end (MPa)", figure(fit.prony.equilibrium() * 1e-6, 5)),
        ("R²", format!("{:.6}", fit.r_squared)),
        ("error rms (%)", significant(fit.relative_rms * 100.0, 3)),
        ("largest error (%)", significant(fit.largest_error * 100.0, 3)),
        ("at time (s)", plain(rounded(fit.at_time, 3))),
    ];
    let figures = figures.map(|(name, value)| vec![name.to_owned(), value]).into();
    let terms = fit.prony.terms.iter().map(|term| vec![figure(term.share, 5), plain(rounded(term.time, 5))]);
    vec![
        FitTable { title: "Figures", texts: 1, columns: columns(["figure", "value"]), rows: figures },
        FitTable { title: "Terms", texts: 0, columns: columns(["share", "time (s)"]), rows: terms.collect() },
    ]
}

fn plots(fit: &PronyFit) -> Vec<Plot> {
    let measured = points("measured", fit.measured.iter().map(|[time, modulus]| [*time, modulus * 1e-6]));
    let series = Curve::line("series", fit.measured.iter().map(|[time, _]| [*time, fit.prony.modulus(*time) * 1e-6]));
    let error = |[time, modulus]: &[f64; 2]| [*time, 100.0 * (fit.prony.modulus(*time) / modulus - 1.0)];
    let time = || Axis { label: "time (s)".into(), scale: Scale::Logarithmic };
    vec![
        Plot { x: time(), ..Plot::new("Relaxation modulus", ["", "modulus (MPa)"], vec![measured, series]) },
        Plot {
            x: time(),
            ..Plot::new("Error of the series", ["", "error (%)"], vec![points("error", fit.measured.iter().map(error))])
        },
    ]
}

fn points(name: &str, points: impl Iterator<Item = [f64; 2]>) -> Curve {
    Curve { look: Look::Points, ..Curve::line(name, points) }
}

/// All figures; SI.
#[derive(Serialize)]
struct RelaxationFigures {
    source: String,
    moduli: usize,
    #[serde(rename = "instantaneous_modulus_Pa")]
    instantaneous_modulus_pa: f64,
    #[serde(rename = "equilibrium_modulus_Pa")]
    equilibrium_modulus_pa: f64,
    terms: Vec<TermFigures>,
    r_squared: f64,
    relative_rms: f64,
    largest_relative_error: f64,
    largest_error_at_time_s: f64,
    findings: Vec<Finding>,
    written: Vec<String>,
}

#[derive(Serialize)]
struct TermFigures {
    share: f64,
    time_s: f64,
}

impl RelaxationFigures {
    fn new(source: &str, fit: &PronyFit, findings: Vec<Finding>, written: Vec<String>) -> RelaxationFigures {
        RelaxationFigures {
            source: source.into(),
            moduli: fit.measured.len(),
            instantaneous_modulus_pa: fit.prony.instantaneous,
            equilibrium_modulus_pa: fit.prony.equilibrium(),
            terms: fit.prony.terms.iter().map(|term| TermFigures { share: term.share, time_s: term.time }).collect(),
            r_squared: fit.r_squared,
            relative_rms: fit.relative_rms,
            largest_relative_error: fit.largest_error,
            largest_error_at_time_s: fit.at_time,
            findings,
            written,
        }
    }

    fn text(&self) -> String {
        let cells = |share: String, time: String| vec![share, time];
        let header = cells("share".into(), "time (s)".into());
        let rows = self.terms.iter().map(|term| cells(figure(term.share, 5), plain(rounded(term.time_s, 5))));
        let lines: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
        format!(
            "{}: {} moduli, {} terms\n{}  instantaneous {} MPa, in the end {} MPa\n  R2 {:.6}, error {} % rms, {} % at most, at {} s\n{}{}",
            self.source,
            self.moduli,
            self.terms.len(),
            table::aligned(&lines, 0),
            figure(self.instantaneous_modulus_pa * 1e-6, 5),
            figure(self.equilibrium_modulus_pa * 1e-6, 5),
            self.r_squared,
            significant(self.relative_rms * 100.0, 3),
            significant(self.largest_relative_error * 100.0, 3),
            plain(rounded(self.largest_error_at_time_s, 3)),
            findings::lines("", &self.findings),
            self.written.iter().map(|file| format!("wrote {file}\n")).collect::<String>()
        )
    }
}
