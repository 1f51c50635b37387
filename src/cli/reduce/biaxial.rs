//! `droptower reduce bulge` and `wide`: tests that stretch film in both directions, and the coupling of MD and TD that they show.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value as Json, json};

use crate::args::quantity;
use crate::failure::all;
use crate::reduce::coupon::{CouponArgs, Reduced, reduced};
use crate::scenarios::paths;
use crate::signal::FileArgs;
use crate::{Failure, Shared, export, failure, output, print_results, terminal};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::number::{figure, significant};
use base::units::{Dimension, Length, Pressure};
use lab::error::{Error, Kind};
use lab::experiment::Warning;
use lab::experiment::biaxial::{Bulge, Coupling, Uncoupled, edge_share};
use lab::experiment::coupon::average::SampleStatistics;
use lab::experiment::coupon::{CouponTest, Curve, Direction};
use lab::signal::file::{self, ChannelSelection};
use lab::signal::{Measurement, Series};
use membrane::material::{Fabric, Law};

/// What a test that stretches film in both directions is compared with, and where its curve goes.
#[derive(Debug, Args)]
pub(crate) struct CouplingArgs {
    /// The film whose coupling of MD and TD the tests show: a fabric, as a material, a scenario or the folder of a run
    #[arg(long, value_name = "FILE")]
    pub film: Option<PathBuf>,
    /// The face of a scenario with several, counted from 1
    #[arg(long, value_name = "N", requires = "film")]
    pub face: Option<usize>,
    /// The curve to write, FILE.csv, as `droptower fit rubber` reads it; of one recording
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct WideArgs {
    #[command(flatten)]
    pub coupons: CouponArgs,
    #[command(flatten)]
    pub coupling: CouplingArgs,
}

#[derive(Debug, Args)]
pub(crate) struct BulgeArgs {
    /// Recordings of bulges, files or globs: pressure, and height of the top
    #[arg(required = true, value_name = "RECORDING")]
    pub recordings: Vec<String>,
    /// Radius within the clamp, "50 mm"
    #[arg(long, allow_hyphen_values = true, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub radius: f64,
    /// Thickness of the film before the test, "12 um"
    #[arg(long, allow_hyphen_values = true, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub thickness: f64,
    /// Name of the channel of pressure
    #[arg(long, value_name = "NAME", default_value = "pressure")]
    pub pressure: String,
    /// Name of the channel of the height of the top [default: `height`, `apex` or `deflection`]
    #[arg(long, value_name = "NAME")]
    pub height: Option<String>,
    #[command(flatten)]
    pub coupling: CouplingArgs,
    #[command(flatten)]
    pub file: FileArgs,
}

/// Change of the coupling over the strains of a test beyond which one number does not follow it.
const MOST_CHANGE: f64 = 0.15;

/// Largest coupling that a film may have: that of isotropic elastic film with ν = 0.5 is 1.
const MOST_COUPLING: f64 = 1.2;

/// Share of the stress that a coupling may leave unexplained.
const MOST_LEFT: f64 = 0.1;

/// Rows of a curve that are printed and given as figures.
const ROWS: usize = 6;

/// A reduced test.
struct Test {
    name: String,
    is_virtual: bool,
    curve: Curve,
    /// Of a coupon: its direction and how many times it is as wide as long.
    coupon: Option<(String, f64)>,
    coupling: Option<Coupling>,
    /// The largest coupling with what free edges lack.
    high: Option<f64>,
}

/// The fabric of the film that arguments name.
fn fabric(args: &CouplingArgs) -> Result<Option<Fabric>, Failure> {
    let Some(path) = &args.film else { return Ok(None) };
    match export::read(path, args.face)?.material.law {
        Law::Fabric(fabric) => Ok(Some(fabric)),
        Law::RateFabric(_) => Err(no_fabric(path, "a fabric with curves by strain rate")
            .hint("give a fabric with the curves of the rate at which the test was made")
            .into()),
        _ => Err(no_fabric(path, "another law than a fabric")
            .hint("a coupling of MD and TD is a fabric's; `fit rubber` fits other laws to the curve that --out writes")
            .into()),
    }
}

fn no_fabric(path: &Path, found: &str) -> Diagnostic {
    Diagnostic::new(format!("{} has {found}, whose coupling no such test shows", shown_path(path)))
}

/// The coupling by `find` of the curves of a fabric.
fn of<T>(fabric: &Fabric, find: impl FnOnce(&Uncoupled<'_>) -> T) -> T {
    let (md, td) = (|strain| fabric.md().stress(strain), |strain| fabric.td().stress(strain));
    find(&Uncoupled { stresses: [&md, &td], ends: [fabric.md().end(), fabric.td().end()] })
}

/// Refuses a curve that cannot be written before anything is read.
fn check_out(args: &CouplingArgs, recordings: usize) -> Result<(), Failure> {
    let Some(out) = &args.out else { return Ok(()) };
    if recordings > 1 {
        let message = format!("--out writes the curve of one recording, and {recordings} are given");
        return Err(Diagnostic::new(message).hint("reduce them one by one").into());
    }
    output::check(out, "csv", None, None)
}

/// Writes the curve of the only test as `droptower fit rubber` reads it.
fn write(args: &CouplingArgs, kind: &str, tests: &[Test]) -> Result<Vec<String>, Failure> {
    let (Some(out), [test]) = (&args.out, tests) else { return Ok(Vec::new()) };
    let mark = if test.is_virtual { "# VIRTUAL, as its recording\n" } else { "" };
    let mut text = format!("{mark}# test: {kind}\n# from {}\nstrain,stress_Pa\n", test.name);
    for [strain, stress] in test.curve.samples() {
        let _ = writeln!(text, "{strain},{stress}");
    }
    output::write_sealed(&[(out.clone(), text)])?;
    Ok(vec![shown_path(out)])
}

/// Warnings about the coupling of a test.
fn warnings(test: &Test) -> Vec<Warning> {
    let Some(coupling) = &test.coupling else { return Vec::new() };
    let name = || test.name.clone();
    let mut all: Vec<Warning> = coupling.cut.map(|end| Warning::CurvesEnd { test: name(), end }).into_iter().collect();
    if !is_plausible(coupling) {
        all.push(Warning::CouplingDoubtful { test: name(), coupling: coupling.value, left: coupling.relative_rms });
        return all;
    }
    // The first part of a curve is noise, slack and the zero of its height.
    let later = coupling.by_strain.get(1..).unwrap_or_default();
    let by_coupling = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
    let ends = later.iter().min_by(by_coupling).zip(later.iter().max_by(by_coupling));
    let varies = ends.filter(|(least, largest)| largest[1] - least[1] > MOST_CHANGE);
    all.extend(varies.map(|(least, largest)| Warning::CouplingVaries { test: name(), at: [*least, *largest] }));
    all
}

/// Whether film may couple like that.
fn is_plausible(coupling: &Coupling) -> bool {
    (0.0..=MOST_COUPLING).contains(&coupling.value) && coupling.relative_rms <= MOST_LEFT
}

/// The coupling of all tests that one explains; none without a film.
fn mean_coupling(tests: &[Test]) -> Option<SampleStatistics> {
    let found = tests.iter().filter_map(|test| test.coupling.as_ref());
    let values: Vec<f64> = found.filter(|own| is_plausible(own)).map(|own| own.value).collect();
    SampleStatistics::from_figures(&values).ok()
}

/// Prints the figures in SI, or as tables in MPa and per cent.
fn print(shared: &Shared, tests: &[Test], warnings: &[Warning], written: &[String]) -> Result<(), Failure> {
    let findings: Vec<Finding> = warnings.iter().map(Finding::new).collect();
    let coupling = mean_coupling(tests);
    let figures = json!({ "tests": tests.iter().map(Test::figures).collect::<Vec<_>>(), "coupling": coupling });
    print_results(shared, figures, &findings, written, || {
        let mut text: String = tests.iter().map(Test::text).collect();
        if let Some(SampleStatistics { mean, deviation, count }) = coupling {
            let of_all = match count {
                1 => String::new(),
                count => format!(" +- {} ({count} tests)", figure(deviation, 2)),
            };
            let mean = figure(mean, 3);
            text +=
                &format!("coupling of MD and TD {mean}{of_all}: fabric.biaxial, and this test as its biaxial_source\n");
        }
        text
    })
}

impl Test {
    /// Strain, and nominal stress (Pa) there: where the coupling is given, so that both are in one row, else at equal distances.
    fn shown_curve(&self) -> Vec<[f64; 2]> {
        let [_, last] = self.curve.range();
        let at = |strain: f64| self.curve.stress_at(strain).map(|stress| [strain, stress]);
        match &self.coupling {
            Some(coupling) => coupling.by_strain.iter().filter_map(|[strain, _]| at(*strain)).collect(),
            None => (1..=ROWS).filter_map(|place| at(last * place as f64 / ROWS as f64)).collect(),
        }
    }

    fn figures(&self) -> Json {
        let mut figures = json!({ "file": self.name, "virtual": self.is_virtual });
        if let Some((direction, ratio)) = &self.coupon {
            figures["direction"] = json!(direction);
            figures["width_over_length"] = json!(ratio);
        }
        figures["curve"] = json!(self.shown_curve());
        figures["coupling"] = json!(self.coupling);
        if let Some(high) = self.high {
            figures["coupling"]["high"] = json!(high);
        }
        figures
    }

    fn text(&self) -> String {
        let mark = if self.is_virtual { ", VIRTUAL" } else { "" };
        let coupon = self.coupon.as_ref().map_or_else(String::new, |(along, ratio)| {
            format!(", {along}, {} times as wide as long", significant(*ratio, 3))
        });
        let header = ["strain (%)", "stress (MPa)"].into_iter().chain(self.coupling.as_ref().map(|_| "coupling"));
        let rows = self.shown_curve().into_iter().map(|[strain, stress]| {
            let mut cells = vec![figure(100.0 * strain, 3), figure(1e-6 * stress, 4)];
            if let Some(coupling) = &self.coupling {
                let same = coupling.by_strain.iter().find(|[at, _]| *at == strain);
                cells.push(same.map_or_else(String::new, |[_, own]| format!("{own:.3}")));
            }
            cells
        });
        let left = self.coupling.as_ref().map_or_else(String::new, |own| {
            let value = figure(own.value, 3);
            format!("  coupling {value}, {} % of the stress left\n", figure(100.0 * own.relative_rms, 2))
        });
        format!("{}{coupon}{mark}\n{}{left}", self.name, terminal::table(0, header, rows))
    }
}

/// Names of the height of the top, in the order in which they are looked for.
const HEIGHTS: [&str; 3] = ["height", "apex", "deflection"];

pub(super) fn bulge(args: &BulgeArgs, shared: &Shared) -> Result<(), Failure> {
    let bulge = Bulge::new(args.radius, args.thickness).map_err(|error| failure::recording(&error))?;
    let paths = paths(&args.recordings)?;
    check_out(&args.coupling, paths.len())?;
    let fabric = fabric(&args.coupling)?;
    let tests = all(paths.iter().map(|path| bulged(args, &bulge, path, fabric.as_ref())))?;
    let written = write(&args.coupling, "equibiaxial", &tests)?;
    let warnings: Vec<Warning> = std::iter::once(Warning::CapAssumed).chain(tests.iter().flat_map(warnings)).collect();
    print(shared, &tests, &warnings, &written)
}

fn bulged(args: &BulgeArgs, bulge: &Bulge, path: &Path, fabric: Option<&Fabric>) -> Result<Test, Diagnostic> {
    let fault = |error: Error| failure::content(path, &error);
    let options = args.file.options(ChannelSelection::All)?;
    let table = file::columns(path, &options).map_err(|error| failure::recording(&error))?;
    let pressure = channel(&table, path, &args.pressure, Pressure::DIMENSION)?;
    let named = args.height.as_deref().or_else(|| HEIGHTS.into_iter().find(|name| table.channel(name).is_ok()));
    let height = channel(&table, path, named.unwrap_or(HEIGHTS[0]), Length::DIMENSION)?;
    let curve = bulge.curve(pressure.values(), height.values()).map_err(fault)?;
    let coupling = fabric.map(|fabric| of(fabric, |film| Coupling::of_equal_strains(&curve, film))).transpose();
    let coupling = coupling.map_err(|error| fault(error).hint("check the units of height and --radius, and --film"))?;
    let is_virtual = table.annotations.is_virtual();
    Ok(Test { name: shown_path(path), is_virtual, curve, coupon: None, coupling, high: None })
}

/// The channel of a name, in SI.
fn channel<'t>(
    table: &'t Measurement,
    path: &Path,
    name: &str,
    dimension: Dimension,
) -> Result<&'t Series, Diagnostic> {
    let missing = |error: Error| {
        failure::content(path, &error)
            .hint("a bulge has the channels `pressure` and `height`; --pressure and --height name others")
    };
    table.channel(name).map_err(missing)?.quantity(dimension).map_err(|error| match error.kind() {
        // Of several channels, each has its own.
        Kind::NoUnit { name, unit } => failure::content(path, &error).hint(format!("give it: --unit {name}={unit}")),
        _ => failure::content(path, &error),
    })
}

/// Speed of the jaws, m/s: nothing here depends on it.
const ANY_SPEED: f64 = 1.0;

/// Width over length of a coupon from which it counts as held.
const LEAST_WIDTH: f64 = 3.0;

pub(super) fn wide(args: &WideArgs, shared: &Shared) -> Result<(), Failure> {
    check_out(&args.coupling, paths(&args.coupons.recordings)?.len())?;
    let fabric = fabric(&args.coupling)?;
    let Reduced { tests, .. } = reduced(&args.coupons, Some(ANY_SPEED))?;
    let tests = all(tests.iter().map(|own| held(own, fabric.as_ref())))?;
    let written = write(&args.coupling, "plane", &tests)?;
    let warnings: Vec<Warning> = tests.iter().flat_map(held_warnings).collect();
    print(shared, &tests, &warnings, &written)
}

fn held(own: &CouponTest, fabric: Option<&Fabric>) -> Result<Test, Diagnostic> {
    let name = shown_path(&own.place());
    let ratio = own.coupon.width() / own.coupon.gauge();
    if ratio < LEAST_WIDTH {
        let message = format!("{name}: its width, {ratio:.2} times its length, is not held by the jaws");
        return Err(Diagnostic::new(message)
            .hint("a wide coupon is at least three times as wide as long, better ten; `reduce coupon` takes others"));
    }
    let direction = own.sample.direction;
    let along = match direction {
        Direction::Md => Some(0),
        Direction::Td => Some(1),
        _ => None,
    };
    let curve = own.sample.curve.clone();
    let coupling = match (fabric, along) {
        (Some(fabric), Some(along)) => {
            let found = of(fabric, |film| Coupling::of_held_width(&curve, film, along));
            Some(found.map_err(|error| Diagnostic::new(format!("{name}: {error}")))?)
        }
        (Some(_), None) => {
            let message = format!("{name}: the coupling of MD and TD shows in coupons along MD or TD, not {direction}");
            return Err(Diagnostic::new(message));
        }
        (None, _) => None,
    };
    let high = coupling.as_ref().map(|own| own.value / (1.0 - edge_share(1.0, ratio)));
    let coupon = Some((direction.to_string(), ratio));
    Ok(Test { name, is_virtual: own.sample.is_virtual, curve, coupon, coupling, high })
}

/// Warnings about a coupon whose width is held.
fn held_warnings(test: &Test) -> Vec<Warning> {
    let (Some(own), Some((_, ratio)), Some(high)) = (&test.coupling, &test.coupon, test.high) else {
        return Vec::new();
    };
    let name = || test.name.clone();
    let mut all = warnings(test);
    if !all.iter().any(|warning| matches!(warning, Warning::CouplingDoubtful { .. })) {
        all.push(Warning::CouponEdges { test: name(), ratio: *ratio, ends: [own.value, high] });
        all.push(Warning::WidthHeld { test: name() });
    }
    all
}
