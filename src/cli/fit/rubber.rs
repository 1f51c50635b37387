//! `droptower fit rubber`: a law of rubber-like film fitted to tests.

use std::path::Path;

use clap::Args;
use serde::Serialize;

use super::{FittedArgs, Places, columns};
use crate::argument::number;
use crate::reduce::coupon::{all, paths};
use crate::{Failure, Shared, faults, findings, print_figures, table};
use base::diagnostic::Diagnostic;
use base::finding::Finding;
use base::number::{figure, significant};
use lab::experiment::Warning;
use lab::experiment::law_fit::hyperelastic::Energy;
use lab::experiment::law_fit::{
    Coefficient, DataSet, FitOptions, LawFit, Measured, StressReader, TestFit, TestKind, Weighting, fit_law,
};
use lab::experiment::material_file::fitted::law_text;
use lab::signal::file::ChannelSelection;
use plot::{Correlation, Curve, Look, Plot};
use report::{FitPage, FitTable, fit_page};

#[derive(Debug, Args)]
pub(crate) struct RubberArgs {
    /// Measured data, files or globs, with the columns `stretch` (or `strain`) and nominal `stress`; of a biaxial test
    /// `stretch_1`, `stretch_2`, `stress_1`, `stress_2`
    #[arg(required = true, value_name = "DATA")]
    data: Vec<String>,
    /// The law: neo-hookean, compressible-neo-hookean, mooney-rivlin, yeoh, gent or ogden:N
    #[arg(long, value_name = "LAW")]
    law: Energy,
    /// Kinds of the tests in the order of the files, or one for all, in place of what the files state: uniaxial (ut),
    /// equibiaxial (et), plane (ps) or biaxial
    #[arg(long, value_name = "KINDS", value_delimiter = ',')]
    test: Vec<TestKind>,
    /// Weights of the files in their order, or one for all
    #[arg(long, value_name = "WEIGHTS", value_delimiter = ',', value_parser = number)]
    weight: Vec<f64>,
    /// Whether differences of stress count as they are or over the measured stress: absolute or relative
    #[arg(long, value_name = "HOW", default_value_t)]
    residual: Weighting,
    /// A test to predict with the fitted law, several times; its kind as that of the data
    #[arg(long, value_name = "FILE")]
    predict: Vec<String>,
    /// Stretch up to which the law must be stable in uniaxial, equibiaxial and plane tension [default: the largest of
    /// the data]
    #[arg(long, value_name = "STRETCH", value_parser = number)]
    stable_to: Option<f64>,
    #[command(flatten)]
    fitted: FittedArgs,
}

pub(super) fn run(args: &RubberArgs, shared: &Shared) -> Result<(), Failure> {
    let places = Places::from_args(&args.fitted)?;
    let data = paths(&args.data)?;
    let kinds = one_each(&args.test, data.len(), "kinds of tests", "--test")?;
    let weights = one_each(&args.weight, data.len(), "weights", "--weight")?;
    let sets = all(data.iter().enumerate().map(|(place, path)| set(args, path, kinds(place), weights(place))))?;
    let predicted = all(paths(&args.predict)?.iter().map(|path| set(args, path, None, None)))?;
    let options = FitOptions { weighting: args.residual, stable_to: args.stable_to };
    let fit = fit_law(args.law, &sets, &predicted, &options).map_err(|error| faults::recording(&error))?;
    let missing = places.material.as_ref().and(args.fitted.film().missing());
    let incomplete = missing.map(|keys| Finding::new(&Warning::MaterialIncomplete { keys: keys.into() }));
    let findings: Vec<Finding> = fit.findings().into_iter().chain(incomplete).collect();
    let material = law_text(&fit, &args.fitted.film());
    let written =
        places.write(&material, &page(&fit, &findings, places.material.as_ref().map(|_| material.as_str())))?;
    let figures = LawFigures::new(&fit, findings, written);
    print_figures(shared, &figures, || figures.text())
}

/// The value of each file: one for all, or as many as there are.
fn one_each<'v, T: Copy>(
    values: &'v [T],
    files: usize,
    what: &str,
    option: &str,
) -> Result<impl Fn(usize) -> Option<T> + 'v, Diagnostic> {
    if values.len() > 1 && values.len() != files {
        let message = format!("{option} has {} {what} for {files} files", values.len());
        return Err(Diagnostic::new(message).hint("give one for all, or one for each in the order of the files"));
    }
    Ok(move |place: usize| if values.len() == 1 { values.first().copied() } else { values.get(place).copied() })
}

fn set(args: &RubberArgs, path: &Path, kind: Option<TestKind>, weight: Option<f64>) -> Result<DataSet, Diagnostic> {
    let reader = StressReader { kind, table: args.fitted.file.options(ChannelSelection::All)? };
    let set = reader.read(path).map_err(|error| faults::recording(&error))?;
    set.with_weight(weight.unwrap_or(1.0)).map_err(|error| located(path, &error))
}

fn located(path: &Path, error: &impl std::fmt::Display) -> Diagnostic {
    Diagnostic::new(format!("{}: {error}", path.display()))
}

/// The page with measured and fitted curves, residuals and figures.
fn page(fit: &LawFit, findings: &[Finding], material: Option<&str>) -> String {
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

/// All figures; SI.
#[derive(Serialize)]
struct LawFigures {
    law: String,
    residual: String,
    coefficients: Vec<CoefficientFigures>,
    /// Rows of the correlation matrix of the coefficients.
    correlation: Option<Vec<Vec<f64>>>,
    tests: Vec<TestFigures>,
    predictions: Vec<TestFigures>,
    stable_to_stretch: f64,
    /// Kind of tension and stretch below 10 from which on the law is unstable.
    unstable_from: Option<(String, f64)>,
    findings: Vec<Finding>,
    written: Vec<String>,
}

#[derive(Serialize)]
struct CoefficientFigures {
    name: String,
    value: f64,
    unit: &'static str,
    standard_error: Option<f64>,
    interval: Option<[f64; 2]>,
}

#[derive(Serialize)]
struct TestFigures {
    name: String,
    kind: String,
    weight: f64,
    stresses: usize,
    is_virtual: bool,
    r_squared: f64,
    #[serde(rename = "rms_Pa")]
    rms_pa: f64,
    relative_rms: f64,
    #[serde(rename = "largest_error_Pa")]
    largest_error_pa: f64,
    largest_error_at_stretch: f64,
}

impl LawFigures {
    fn new(fit: &LawFit, findings: Vec<Finding>, written: Vec<String>) -> LawFigures {
        let matrix = fit.confidence.as_ref().map(|confidence| &confidence.correlation);
        LawFigures {
            law: fit.choice.to_string(),
            residual: fit.weighting.to_string(),
            coefficients: fit.coefficients.iter().map(coefficient).collect(),
            correlation: matrix.map(|matrix| matrix.row_iter().map(|row| row.iter().copied().collect()).collect()),
            tests: fit.tests.iter().map(test).collect(),
            predictions: fit.predictions.iter().map(test).collect(),
            stable_to_stretch: fit.stable_to,
            unstable_from: fit.unstable_from.map(|(tension, stretch)| (tension.to_string(), stretch)),
            findings,
            written,
        }
    }

    fn text(&self) -> String {
        let coefficients = self.coefficients.iter().map(CoefficientFigures::cells);
        let coefficients: Vec<Vec<String>> =
            std::iter::once(COEFFICIENTS.map(String::from).to_vec()).chain(coefficients).collect();
        let test = |fitted: bool| move |test: &TestFigures| test.cells(fitted);
        let tests = self.tests.iter().map(test(true)).chain(self.predictions.iter().map(test(false)));
        let lines: Vec<Vec<String>> = std::iter::once(HEADER.map(String::from).to_vec()).chain(tests).collect();
        let stability = match &self.unstable_from {
            None => "stable up to the stretch 10".to_owned(),
            Some((tension, stretch)) => {
                format!("unstable in {tension} from the stretch {} on", significant(*stretch, 4))
            }
        };
        format!(
            "{}, {} residuals\n{}{}  {stability} (Hill's criterion)\n{}{}",
            self.law,
            self.residual,
            table::aligned(&coefficients, 2),
            table::aligned(&lines, 2),
            findings::lines("", &self.findings),
            self.written.iter().map(|file| format!("wrote {file}\n")).collect::<String>()
        )
    }
}

const COEFFICIENTS: [&str; 5] = ["", "", "value", "95 % from", "to"];

const HEADER: [&str; 7] = ["", "", "stresses", "R2", "rms (MPa)", "rms (%)", "largest (MPa)"];

impl CoefficientFigures {
    fn cells(&self) -> Vec<String> {
        let (factor, unit) = if self.unit == "Pa" { (1e-6, "MPa") } else { (1.0, "") };
        let shown = |value: f64| figure(value * factor, 5);
        let ends = match self.interval {
            Some(ends) if ends.iter().all(|end| end.is_finite()) => ends.map(shown),
            Some(_) => ["not determined".into(), String::new()],
            None => [String::new(), String::new()],
        };
        let [low, high] = ends;
        vec![self.name.clone(), unit.into(), shown(self.value), low, high]
    }
}

impl TestFigures {
    fn cells(&self, fitted: bool) -> Vec<String> {
        let mark = if fitted { "" } else { ", predicted" };
        vec![
            self.name.clone(),
            format!("{}{mark}", self.kind),
            self.stresses.to_string(),
            format!("{:.5}", self.r_squared),
            figure(self.rms_pa * 1e-6, 3),
            format!("{:.2}", self.relative_rms * 100.0),
            figure(self.largest_error_pa * 1e-6, 3),
        ]
    }
}

fn coefficient(one: &Coefficient) -> CoefficientFigures {
    CoefficientFigures {
        name: one.name.clone(),
        value: one.value,
        unit: if one.is_modulus { "Pa" } else { "" },
        standard_error: one.standard_error,
        interval: one.interval,
    }
}

fn test(test: &TestFit) -> TestFigures {
    TestFigures {
        name: test.set.name.clone(),
        kind: test.set.kind().to_string(),
        weight: test.set.weight,
        stresses: test.quality.samples,
        is_virtual: test.set.is_virtual,
        r_squared: test.quality.r_squared,
        rms_pa: test.quality.rms,
        relative_rms: test.quality.relative_rms,
        largest_error_pa: test.quality.largest_error,
        largest_error_at_stretch: test.quality.at_stretch,
    }
}
