//! The page of a fitted law.

use base::finding::Finding;
use base::number::{figure, significant};
use lab::experiment::law_fit::{LawFit, Measured, TestFit};
use plot::{Correlation, Curve, Look, Plot};
use report::{FitPage, FitTable, fit_page};

/// The page with measured and fitted curves, residuals and figures.
pub(super) fn page(fit: &LawFit, findings: &[Finding], material: Option<&str>) -> String {
    let all: Vec<&TestFit> = fit.tests.iter().chain(&fit.predictions).collect();
    let title =
        format!("{} fitted to {} test{}", fit.choice, fit.tests.len(), if fit.tests.len() == 1 { "" } else { "s" });
    let correlation = fit.confidence.as_ref().map(|confidence| Correlation {
        title: "Correlation of the coefficients".into(),
        names: confidence.names.clone(),
        rows: confidence.correlation.row_iter().map(|row| row.iter().copied().collect()).collect(),
    });
    fit_page(&FitPage {
        title: &title,
        tables: vec![coefficients(fit), tests(fit)],
        plots: plots(&all),
        correlation: correlation.filter(|correlation| correlation.names.len() > 1),
        findings,
        material,
    })
}

fn columns<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).into()
}

fn coefficients(fit: &LawFit) -> FitTable {
    let rows = fit.coefficients.iter().map(|one| {
        let (factor, unit) = if one.is_modulus { (1e-6, "MPa") } else { (1.0, "") };
        let shown = |value: Option<f64>| value.map_or_else(String::new, |value| figure(value * factor, 5));
        let [low, high] = one.interval.map_or([None; 2], |ends| ends.map(Some));
        vec![one.name.clone(), unit.into(), shown(Some(one.value)), shown(one.standard_error), shown(low), shown(high)]
    });
    let columns = columns(["coefficient", "unit", "value", "standard error", "95 %: from", "to"]);
    FitTable { title: "Coefficients", texts: 2, columns, rows: rows.collect() }
}

fn tests(fit: &LawFit) -> FitTable {
    let row = |test: &TestFit, use_of: &str| {
        vec![
            test.set.name.clone(),
            test.set.kind().to_string(),
            use_of.into(),
            significant(test.set.weight, 4),
            test.quality.samples.to_string(),
            format!("{:.5}", test.quality.r_squared),
            figure(test.quality.rms * 1e-6, 4),
            figure(test.quality.relative_rms * 100.0, 3),
            figure(test.quality.largest_error * 1e-6, 4),
            significant(test.quality.at_stretch, 4),
        ]
    };
    let fitted = fit.tests.iter().map(|test| row(test, "fitted"));
    let rows = fitted.chain(fit.predictions.iter().map(|test| row(test, "predicted"))).collect();
    let columns = columns([
        "test",
        "kind",
        "",
        "weight",
        "stresses",
        "R²",
        "rms (MPa)",
        "rms (%)",
        "largest error (MPa)",
        "at stretch",
    ]);
    FitTable { title: "Tests", texts: 3, columns, rows }
}

/// Stress over stretch of tests in tension, fitted over measured stress of biaxial ones, and the residuals of all.
fn plots(tests: &[&TestFit]) -> Vec<Plot> {
    let is_tension = |test: &&&TestFit| matches!(test.set.measured, Measured::Tension(..));
    let mpa = |stress: f64| stress * 1e-6;
    let tension = tests.iter().filter(is_tension).flat_map(|test| {
        let measured = test.set.measured.stretches().into_iter().zip(test.set.measured.stresses());
        let measured = points(format!("{} measured", test.set.name), measured.map(|(s, p)| [s, mpa(p)]));
        [measured, Curve::line(test.set.name.clone(), test.curve.iter().map(|[s, p]| [*s, mpa(*p)]))]
    });
    let biaxial = tests.iter().filter(|test| !is_tension(test)).flat_map(|test| {
        let stresses = test.set.measured.stresses();
        let largest = stresses.iter().copied().fold(0.0, f64::max);
        let pairs = stresses.into_iter().zip(&test.predicted).map(|(p, found)| [mpa(p), mpa(*found)]);
        [points(test.set.name.clone(), pairs), Curve::line("equal", [[0.0; 2], [mpa(largest); 2]]).dashed()]
    });
    let residuals = tests.iter().map(|test| {
        let errors = test.predicted.iter().zip(test.set.measured.stresses()).map(|(found, p)| mpa(found - p));
        points(test.set.name.clone(), test.set.measured.stretches().into_iter().zip(errors).map(|(s, e)| [s, e]))
    });
    let stress = "nominal stress (MPa)";
    let plots = [
        Plot::new("Stress over stretch", ["stretch", stress], tension.collect()),
        Plot::new("Biaxial tension", ["measured stress (MPa)", "stress of the law (MPa)"], biaxial.collect()),
        Plot::new("Residuals", ["stretch", "law less measured stress (MPa)"], residuals.collect()),
    ];
    plots.into_iter().filter(|plot| !plot.curves.is_empty()).collect()
}

fn points(name: String, points: impl Iterator<Item = [f64; 2]>) -> Curve {
    Curve { look: Look::Points, ..Curve::line(name, points) }
}
