//! The page of a fitted relaxation.

use super::fitted::Fitted;
use base::finding::Finding;
use base::number::{figure, plain, rounded, significant};
use lab::experiment::relaxation::{ShiftLawFit, ZERO_CELSIUS};
use plot::{Axis, Curve, Look, Plot, Scale};
use report::{FitPage, FitTable, fit_page};

/// The page with measured and fitted modulus, errors, terms and shift factors.
pub(super) fn page(fitted: &Fitted, findings: &[Finding], material: Option<&str>) -> String {
    let title = format!("Relaxation of {}", fitted.source);
    let (tables, plots) = (tables(fitted), plots(fitted));
    fit_page(&FitPage { title: &title, tables, plots, correlation: None, findings, material })
}

fn columns<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).into()
}

fn tables(fitted: &Fitted) -> Vec<FitTable> {
    let fit = &fitted.fit;
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
    let mut tables = vec![
        FitTable { title: "Figures", columns: columns(["figure", "value"]), rows: figures },
        FitTable { title: "Terms", columns: columns(["share", "time (s)"]), rows: terms.collect() },
    ];
    if let Some((master, _)) = &fitted.master {
        let row = |temperature: f64, log: f64| vec![significant(temperature - ZERO_CELSIUS, 4), figure(log, 5)];
        let rows = master.factors.iter().map(|factor| row(factor.temperature, factor.log_shift)).collect();
        tables
            .push(FitTable { title: "Shift factors", columns: columns(["temperature (°C)", "log₁₀ a_T"]), rows });
    }
    tables
}

fn plots(fitted: &Fitted) -> Vec<Plot> {
    let fit = &fitted.fit;
    let measured = points("measured", fit.measured.iter().map(|[time, modulus]| [*time, modulus * 1e-6]));
    let series = Curve::line("series", fit.measured.iter().map(|[time, _]| [*time, fit.prony.modulus(*time) * 1e-6]));
    let error = |[time, modulus]: &[f64; 2]| [*time, 100.0 * (fit.prony.modulus(*time) / modulus - 1.0)];
    let time = || Axis { label: "time (s)".into(), scale: Scale::Logarithmic };
    let mut plots = vec![
        Plot { x: time(), ..Plot::new("Relaxation modulus", ["", "modulus (MPa)"], vec![measured, series]) },
        Plot {
            x: time(),
            ..Plot::new("Error of the series", ["", "error (%)"], vec![points("error", fit.measured.iter().map(error))])
        },
    ];
    if let Some((master, fits)) = &fitted.master {
        let factors = master.factors.iter().map(|factor| [factor.temperature - ZERO_CELSIUS, factor.log_shift]);
        let law = |name: &str, law: &ShiftLawFit| {
            let at = |temperature: f64| [temperature - ZERO_CELSIUS, law.law.log_shift(temperature)];
            Curve::line(name, master.factors.iter().map(|factor| at(factor.temperature)))
        };
        let laws = [("WLF", &fits.wlf), ("Arrhenius", &fits.arrhenius)];
        let laws = laws.into_iter().filter_map(|(name, fit)| Some(law(name, fit.as_ref()?)));
        let curves = std::iter::once(points("factors", factors)).chain(laws).collect();
        plots.push(Plot::new("Shift factors", ["temperature (°C)", "log₁₀ a_T"], curves));
    }
    plots
}

fn points(name: &str, points: impl Iterator<Item = [f64; 2]>) -> Curve {
    Curve { look: Look::Points, ..Curve::line(name, points) }
}
