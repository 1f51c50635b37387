//! The page of a fitted relaxation.

use base::finding::Finding;
use base::number::{figure, plain, rounded, significant};
use lab::experiment::relaxation::PronyFit;
use plot::{Axis, Curve, Look, Plot, Scale};
use report::{FitPage, FitTable, fit_page};

/// The page with measured and fitted modulus, errors and terms.
pub(super) fn page(source: &str, fit: &PronyFit, findings: &[Finding], material: Option<&str>) -> String {
    let title = format!("Relaxation of {source}");
    let (tables, plots) = (tables(fit), plots(fit));
    fit_page(&FitPage { title: &title, tables, plots, correlation: None, findings, material })
}

fn columns<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).into()
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
