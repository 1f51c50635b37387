//! `droptower fit`: laws fitted to measured data, and written as a material.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::{Value as Json, json};

use crate::args::{number, quantity};
use crate::failure::all;
use crate::scenarios::paths;
use crate::signal::FileArgs;
use crate::{Failure, Shared, failure, output, print_results, terminal};
use base::diagnostic::{Diagnostic, file_name, shown_path};
use base::finding::Finding;
use base::number::{figure, plain, rounded, significant};
use base::units::{Density, Length};
use lab::experiment::Warning;
use lab::experiment::law_fit::hyperelastic::Energy;
use lab::experiment::law_fit::{
    Coefficient, DataSet, FitOptions, LawFit, Measured, StressReader, TestFit, TestKind, Weighting, fit_law,
};
use lab::experiment::material_file::fitted::{
    ASSUMED_POISSON, FilmKeys, RelaxationMaterial, law_text, relaxation_text,
};
use lab::experiment::relaxation::{PronyFit, fit_prony, read_relaxation};
use lab::signal::file::ChannelSelection;
use plot::{Axis, Correlation, Curve, Look, Plot, Scale};
use report::{FitPage, FitTable, fit_page};

#[derive(Debug, Subcommand)]
pub(crate) enum FitCommand {
    /// Fit the law of a rubber-like film to measured stresses
    Rubber(RubberArgs),
    /// Fit a Prony series to a measured relaxation modulus
    Prony(PronyArgs),
}

pub(crate) fn run(command: &FitCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        FitCommand::Rubber(args) => fit_rubber(args, shared),
        FitCommand::Prony(args) => fit_prony_series(args, shared),
    }
}

/// What a fit writes, and how its data are read.
#[derive(Debug, Args)]
struct FittedArgs {
    /// The material file to write, FILE.toml; a page with the curves goes beside it, as FILE.html
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The page to write, FILE.html, in place of one beside the material file
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Density of the film, for the material file: "915 kg/m3"
    #[arg(long, value_parser = |text: &str| quantity(Density::DIMENSION, text))]
    density: Option<f64>,
    /// Thickness of one layer, for the material file: "12 um"
    #[arg(long, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    thickness: Option<f64>,
    #[command(flatten)]
    file: FileArgs,
}

impl FittedArgs {
    /// The film's keys.
    fn film(&self) -> FilmKeys {
        FilmKeys { density: self.density, thickness: self.thickness }
    }
}

/// Where the files of a fit go, checked before anything is computed.
struct Places {
    material: Option<PathBuf>,
    page: Option<PathBuf>,
}

impl Places {
    /// The places that the arguments name.
    fn from_args(args: &FittedArgs) -> Result<Places, Failure> {
        let material = args.out.clone();
        if let Some(path) = material.as_deref().filter(|path| !output::ends_in(path, "toml")) {
            let message = format!("a material file ends in .toml, and {} does not", shown_path(path));
            return Err(Diagnostic::new(message).into());
        }
        let page = args.page.clone().or_else(|| material.as_ref().map(|path| path.with_extension("html")));
        let checked = [
            material.as_deref().map_or(Ok(()), |path| output::check(path, "toml", None, None)),
            page.as_deref().map_or(Ok(()), |path| output::check_page(path, None)),
        ];
        all(checked)?;
        Ok(Places { material, page })
    }

    /// Writes the page and then the material, and gives their paths.
    fn write(&self, material: &str, page: &str) -> Result<Vec<String>, Failure> {
        if let Some(path) = &self.page {
            output::write(path, |file| file.write_all(page.as_bytes()))?;
        }
        if let Some(path) = &self.material {
            output::write_sealed(&[(path.clone(), material.to_owned())])?;
        }
        Ok([&self.page, &self.material].into_iter().flatten().map(|path| shown_path(path)).collect())
    }
}

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

fn fit_rubber(args: &RubberArgs, shared: &Shared) -> Result<(), Failure> {
    let places = Places::from_args(&args.fitted)?;
    let data = paths(&args.data)?;
    let kinds = one_each(&args.test, data.len(), "kinds of tests", "--test")?;
    let weights = one_each(&args.weight, data.len(), "weights", "--weight")?;
    let sets = all(data.iter().enumerate().map(|(place, path)| set(args, path, kinds(place), weights(place))))?;
    let predicted = all(paths(&args.predict)?.iter().map(|path| set(args, path, None, None)))?;
    let options = FitOptions { weighting: args.residual, stable_to: args.stable_to };
    let fit = fit_law(args.law, &sets, &predicted, &options).map_err(|error| failure::recording(&error))?;
    let missing = places.material.as_ref().and(args.fitted.film().missing());
    let incomplete = missing.map(|keys| Finding::new(&Warning::MaterialIncomplete { keys: keys.into() }));
    let findings: Vec<Finding> = fit.findings().into_iter().chain(incomplete).collect();
    let material = law_text(&fit, &args.fitted.film());
    let written =
        places.write(&material, &rubber_page(&fit, &findings, places.material.as_ref().map(|_| material.as_str())))?;
    print_results(shared, rubber_figures(&fit), &findings, &written, || rubber_text(&fit))
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
    let set = reader.read(path).map_err(|error| failure::recording(&error))?;
    set.with_weight(weight.unwrap_or(1.0)).map_err(|error| failure::content(path, &error))
}

/// The page with measured and fitted curves, residuals and figures.
fn rubber_page(fit: &LawFit, findings: &[Finding], material: Option<&str>) -> String {
    let all: Vec<&TestFit> = fit.tests.iter().chain(&fit.predictions).collect();
    let title =
        format!("{} fitted to {} test{}", fit.choice, fit.tests.len(), if fit.tests.len() == 1 { "" } else { "s" });
    let error = |test: &TestFit| test.quality.relative_rms;
    let worst = all.iter().max_by(|one, other| error(one).total_cmp(&error(other)));
    let answer = worst.map(|test| {
        format!("Its stress is off by {} % (rms) at most, in {}.", figure(100.0 * error(test), 3), test.set.name)
    });
    fit_page(&FitPage {
        title: &title,
        answer: answer.unwrap_or_default(),
        tables: vec![coefficients(fit), tests(fit)],
        plots: rubber_plots(&all),
        correlation: correlation(fit).filter(|correlation| correlation.names.len() > 1),
        findings,
        material,
    })
}

fn correlation(fit: &LawFit) -> Option<Correlation> {
    fit.confidence.as_ref().map(|confidence| Correlation {
        title: "Correlation of the coefficients".into(),
        names: confidence.names.clone(),
        rows: confidence.correlation.row_iter().map(|row| row.iter().copied().collect()).collect(),
    })
}

/// Name, unit, value, standard error and interval of a coefficient.
fn coefficient_cells(one: &Coefficient) -> [String; 6] {
    let (factor, unit) = if one.is_modulus { (1e-6, "MPa") } else { (1.0, "") };
    let shown = |value: f64| figure(value * factor, 5);
    let [low, high] = match one.interval {
        Some(ends) if ends.iter().all(|end| end.is_finite()) => ends.map(shown),
        Some(_) => ["not determined".into(), String::new()],
        None => [String::new(), String::new()],
    };
    let error = one.standard_error.map_or_else(String::new, shown);
    [one.name.clone(), unit.into(), shown(one.value), error, low, high]
}

fn coefficients(fit: &LawFit) -> FitTable {
    let rows = fit.coefficients.iter().map(|one| coefficient_cells(one).into());
    let columns = &["coefficient", "unit", "value", "standard error", "95 %: from", "to"];
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
    let columns =
        &["test", "kind", "", "weight", "stresses", "R²", "rms (MPa)", "rms (%)", "largest error (MPa)", "at stretch"];
    FitTable { title: "Tests", texts: 3, columns, rows }
}

/// Stress over stretch of tests in tension, fitted over measured stress of biaxial ones, and the residuals of all.
fn rubber_plots(tests: &[&TestFit]) -> Vec<Plot> {
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

fn points(name: impl Into<String>, points: impl Iterator<Item = [f64; 2]>) -> Curve {
    Curve { look: Look::Points, ..Curve::line(name, points) }
}

/// All figures; SI.
fn rubber_figures(fit: &LawFit) -> Json {
    let coefficient = |one: &Coefficient| {
        json!({
            "name": one.name,
            "value": one.value,
            "unit": if one.is_modulus { "Pa" } else { "" },
            "standard_error": one.standard_error,
            "interval": one.interval,
        })
    };
    let test = |test: &TestFit| {
        json!({
            "name": test.set.name,
            "kind": test.set.kind().to_string(),
            "weight": test.set.weight,
            "stresses": test.quality.samples,
            "is_virtual": test.set.is_virtual,
            "r_squared": test.quality.r_squared,
            "rms_Pa": test.quality.rms,
            "relative_rms": test.quality.relative_rms,
            "largest_error_Pa": test.quality.largest_error,
            "largest_error_at_stretch": test.quality.at_stretch,
        })
    };
    json!({
        "law": fit.choice.to_string(),
        "residual": fit.weighting.to_string(),
        "coefficients": fit.coefficients.iter().map(coefficient).collect::<Vec<_>>(),
        "correlation": correlation(fit).map(|correlation| correlation.rows),
        "tests": fit.tests.iter().map(test).collect::<Vec<_>>(),
        "predictions": fit.predictions.iter().map(test).collect::<Vec<_>>(),
        "stable_to_stretch": fit.stable_to,
        "unstable_from": fit.unstable_from.map(|(tension, stretch)| (tension.to_string(), stretch)),
    })
}

/// The figures on the terminal.
fn rubber_text(fit: &LawFit) -> String {
    let coefficient = |one: &Coefficient| {
        let [name, unit, value, _, low, high] = coefficient_cells(one);
        vec![name, unit, value, low, high]
    };
    let test = |mark: &'static str| {
        move |TestFit { set, quality, .. }: &TestFit| {
            vec![
                set.name.clone(),
                format!("{}{mark}", set.kind()),
                quality.samples.to_string(),
                format!("{:.5}", quality.r_squared),
                figure(quality.rms * 1e-6, 3),
                format!("{:.2}", quality.relative_rms * 100.0),
                figure(quality.largest_error * 1e-6, 3),
            ]
        }
    };
    let tests = fit.tests.iter().map(test("")).chain(fit.predictions.iter().map(test(", predicted")));
    let stability = match &fit.unstable_from {
        None => "stable up to the stretch 10".to_owned(),
        Some((tension, stretch)) => format!("unstable in {tension} from the stretch {} on", significant(*stretch, 4)),
    };
    format!(
        "{}, {} residuals\n{}{}  {stability} (Hill's criterion)\n",
        fit.choice,
        fit.weighting,
        terminal::table(2, ["", "", "value", "95 % from", "to"], fit.coefficients.iter().map(coefficient)),
        terminal::table(2, ["", "", "stresses", "R2", "rms (MPa)", "rms (%)", "largest (MPa)"], tests),
    )
}

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

fn fit_prony_series(args: &PronyArgs, shared: &Shared) -> Result<(), Failure> {
    let places = Places::from_args(&args.fitted)?;
    if let Some(poisson) = args.poisson.filter(|ratio| !(-1.0 < *ratio && *ratio < 0.5)) {
        return Err(Diagnostic::new(format!("expected a Poisson's ratio from -1 to 0.5, found {poisson}")).into());
    }
    let path = &args.data;
    let points = read_relaxation(path, &args.fitted.file.options(ChannelSelection::All)?)
        .map_err(|error| failure::recording(&error))?;
    let fit = fit_prony(&points, args.terms).map_err(|error| failure::content(path, &error))?;
    let incomplete = args.fitted.film().missing().map(|keys| Warning::MaterialIncomplete { keys: keys.into() });
    let assumed = args.poisson.is_none().then_some(Warning::PoissonAssumed { poisson: ASSUMED_POISSON });
    let of_material = [incomplete, assumed].into_iter().flatten().filter(|_| places.material.is_some());
    let findings: Vec<Finding> =
        fit.warnings.iter().map(Finding::new).chain(of_material.map(|one| Finding::new(&one))).collect();
    let source = file_name(path);
    let (poisson, film) = (args.poisson, args.fitted.film());
    let material = relaxation_text(&RelaxationMaterial { fit: &fit, source: &source, poisson, film });
    let shown = places.material.as_ref().map(|_| material.as_str());
    let written = places.write(&material, &prony_page(&source, &fit, &findings, shown))?;
    print_results(shared, prony_figures(&source, &fit), &findings, &written, || prony_text(&source, &fit))
}

/// The page with measured and fitted modulus, errors and terms.
fn prony_page(source: &str, fit: &PronyFit, findings: &[Finding], material: Option<&str>) -> String {
    let title = format!("Relaxation of {source}");
    let (tables, plots) = (tables(fit), prony_plots(fit));
    let error = figure(100.0 * fit.relative_rms, 3);
    let answer = format!("Its modulus is off by {error} % (rms).");
    fit_page(&FitPage { title: &title, answer, tables, plots, correlation: None, findings, material })
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
    vec![
        FitTable { title: "Figures", texts: 1, columns: &["figure", "value"], rows: figures },
        FitTable { title: "Terms", texts: 0, columns: &TERM_COLUMNS, rows: term_cells(fit).collect() },
    ]
}

/// The columns of a table of terms.
const TERM_COLUMNS: [&str; 2] = ["share", "time (s)"];

fn term_cells(fit: &PronyFit) -> impl Iterator<Item = Vec<String>> {
    fit.prony.terms.iter().map(|term| vec![figure(term.share, 5), plain(rounded(term.time, 5))])
}

fn prony_plots(fit: &PronyFit) -> Vec<Plot> {
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

/// All figures; SI.
fn prony_figures(source: &str, fit: &PronyFit) -> Json {
    let terms = fit.prony.terms.iter().map(|term| json!({ "share": term.share, "time_s": term.time }));
    json!({
        "source": source,
        "moduli": fit.measured.len(),
        "instantaneous_modulus_Pa": fit.prony.instantaneous,
        "equilibrium_modulus_Pa": fit.prony.equilibrium(),
        "terms": terms.collect::<Vec<_>>(),
        "r_squared": fit.r_squared,
        "relative_rms": fit.relative_rms,
        "largest_relative_error": fit.largest_error,
        "largest_error_at_time_s": fit.at_time,
    })
}

/// The figures on the terminal.
fn prony_text(source: &str, fit: &PronyFit) -> String {
    format!(
        "{source}: {} moduli, {} terms\n{}  instantaneous {} MPa, in the end {} MPa\n  R2 {:.6}, error {} % rms, {} % at most, at {} s\n",
        fit.measured.len(),
        fit.prony.terms.len(),
        terminal::table(0, TERM_COLUMNS, term_cells(fit)),
        figure(fit.prony.instantaneous * 1e-6, 5),
        figure(fit.prony.equilibrium() * 1e-6, 5),
        fit.r_squared,
        significant(fit.relative_rms * 100.0, 3),
        significant(fit.largest_error * 100.0, 3),
        plain(rounded(fit.at_time, 3)),
    )
}
