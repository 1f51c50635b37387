//! What tests that stretch film in both directions show: stress over strain, and the coupling of MD and TD.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use super::args::CouplingArgs;
use super::figures::Statistics;
use crate::card::source;
use crate::{Failure, findings, output, table};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::number::{figure, significant};
use lab::experiment::Warning;
use lab::experiment::biaxial::{Coupling, Uncoupled};
use lab::experiment::coupon::Curve;
use lab::experiment::coupon::average::SampleStatistics;
use membrane::material::{Fabric, Law};

/// Change of the coupling over the strains of a test beyond which one number does not follow it.
const MOST_CHANGE: f64 = 0.15;

/// Largest coupling that a film may have: that of isotropic elastic film with ν = 0.5 is 1.
const MOST_COUPLING: f64 = 1.2;

/// Share of the stress that a coupling may leave unexplained.
const MOST_LEFT: f64 = 0.1;

/// Rows of a curve that are printed and given as figures.
const ROWS: usize = 6;

/// A reduced test.
pub(super) struct Test {
    pub(super) name: String,
    pub(super) is_virtual: bool,
    pub(super) curve: Curve,
    /// Of a coupon: its direction and how many times it is as wide as long.
    pub(super) coupon: Option<(String, f64)>,
    pub(super) coupling: Option<Coupling>,
    /// The largest coupling with what free edges lack.
    pub(super) high: Option<f64>,
}

/// All figures; SI.
#[derive(Serialize)]
pub(super) struct Figures {
    tests: Vec<TestFigures>,
    /// The coupling of all tests that one explains; none without a film.
    coupling: Option<Statistics>,
    findings: Vec<Finding>,
    written: Vec<String>,
}

#[derive(Serialize)]
struct TestFigures {
    file: String,
    #[serde(rename = "virtual")]
    is_virtual: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    width_over_length: Option<f64>,
    /// Strain, and nominal stress (Pa) there.
    curve: Vec<[f64; 2]>,
    coupling: Option<CouplingFigures>,
}

#[derive(Serialize)]
struct CouplingFigures {
    value: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    high: Option<f64>,
    relative_rms: f64,
    /// Strain, and the coupling there.
    by_strain: Vec<[f64; 2]>,
}

/// The fabric of the film that arguments name.
pub(super) fn fabric(args: &CouplingArgs) -> Result<Option<Fabric>, Failure> {
    let Some(path) = &args.film else { return Ok(None) };
    match source::read(path, args.face)?.material.law {
        Law::Fabric(fabric) => Ok(Some(fabric)),
        Law::RateFabric(_) => Err(no_fabric(path, "a fabric with curves by strain rate")
            .hint("give a fabric with the curves of the rate at which the test was made")
            .into()),
        _ => Err(no_fabric(path, "another law than a fabric")
            .hint("a coupling of MD and TD is a fabric's; `tensile fit --law` fits other laws to the curve that --out writes")
            .into()),
    }
}

fn no_fabric(path: &Path, found: &str) -> Diagnostic {
    Diagnostic::new(format!("{} has {found}, whose coupling no such test shows", shown_path(path)))
}

/// The coupling by `find` of the curves of a fabric.
pub(super) fn of<T>(fabric: &Fabric, find: impl FnOnce(&Uncoupled<'_>) -> T) -> T {
    let (md, td) = (|strain| fabric.md().stress(strain), |strain| fabric.td().stress(strain));
    find(&Uncoupled { stresses: [&md, &td], ends: [fabric.md().end(), fabric.td().end()] })
}

/// Refuses a curve that cannot be written before anything is read.
pub(super) fn check_out(args: &CouplingArgs, recordings: usize) -> Result<(), Failure> {
    let Some(out) = &args.out else { return Ok(()) };
    if recordings > 1 {
        let message = format!("--out writes the curve of one recording, and {recordings} are given");
        return Err(Diagnostic::new(message).hint("reduce them one by one").into());
    }
    output::check(out, "csv", None, None)
}

/// Writes the curve of the only test as `tensile fit` reads it.
pub(super) fn write(args: &CouplingArgs, kind: &str, tests: &[Test]) -> Result<Vec<String>, Failure> {
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
pub(super) fn warnings(test: &Test) -> Vec<Warning> {
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

impl Figures {
    pub(super) fn new(tests: &[Test], warnings: &[Warning], written: Vec<String>) -> Figures {
        let found = tests.iter().filter_map(|test| test.coupling.as_ref());
        let values: Vec<f64> = found.filter(|own| is_plausible(own)).map(|own| own.value).collect();
        let coupling = SampleStatistics::from_figures(&values).ok().map(Statistics::from);
        let findings = warnings.iter().map(Finding::new).collect();
        Figures { tests: tests.iter().map(figures).collect(), coupling, findings, written }
    }

    /// The figures as tables, in MPa and per cent.
    pub(super) fn text(&self) -> String {
        let mut text: String = self.tests.iter().map(TestFigures::text).collect();
        if let Some(Statistics { mean, deviation, count }) = &self.coupling {
            let of_all = match count {
                1 => String::new(),
                count => format!(" +- {} ({count} tests)", figure(*deviation, 2)),
            };
            let _ = writeln!(
                text,
                "coupling of MD and TD {}{of_all}: fabric.biaxial, and this test as its biaxial_source",
                figure(*mean, 3)
            );
        }
        text += &findings::lines("", &self.findings);
        text.extend(self.written.iter().map(|file| format!("wrote {file}\n")));
        text
    }
}

impl TestFigures {
    fn text(&self) -> String {
        let mark = if self.is_virtual { ", VIRTUAL" } else { "" };
        let along = self.direction.as_deref().map(|along| format!(", {along}")).unwrap_or_default();
        let wide = self.width_over_length.map(|ratio| format!(", {} times as wide as long", significant(ratio, 3)));
        let mut header = vec!["strain (%)".to_owned(), "stress (MPa)".to_owned()];
        header.extend(self.coupling.as_ref().map(|_| "coupling".to_owned()));
        let rows = self.curve.iter().map(|[strain, stress]| {
            let mut cells = vec![figure(100.0 * strain, 3), figure(1e-6 * stress, 4)];
            if let Some(coupling) = &self.coupling {
                let same = coupling.by_strain.iter().find(|[at, _]| at == strain);
                cells.push(same.map_or_else(String::new, |[_, own]| format!("{own:.3}")));
            }
            cells
        });
        let lines: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
        let left = self.coupling.as_ref().map_or_else(String::new, |own| {
            let value = figure(own.value, 3);
            format!("  coupling {value}, {} % of the stress left\n", figure(100.0 * own.relative_rms, 2))
        });
        format!("{}{along}{}{mark}\n{}{left}", self.file, wide.unwrap_or_default(), table::aligned(&lines, 0))
    }
}

fn figures(test: &Test) -> TestFigures {
    let [_, last] = test.curve.range();
    let at = |strain: f64| test.curve.stress_at(strain).map(|stress| [strain, stress]);
    let curve = match &test.coupling {
        // Where the coupling is given, so that both are in one row.
        Some(coupling) => coupling.by_strain.iter().filter_map(|[strain, _]| at(*strain)).collect(),
        None => (1..=ROWS).filter_map(|place| at(last * place as f64 / ROWS as f64)).collect(),
    };
    TestFigures {
        file: test.name.clone(),
        is_virtual: test.is_virtual,
        direction: test.coupon.as_ref().map(|(direction, _)| direction.clone()),
        width_over_length: test.coupon.as_ref().map(|(_, ratio)| *ratio),
        curve,
        coupling: test.coupling.as_ref().map(|own| CouplingFigures {
            value: own.value,
            high: test.high,
            relative_rms: own.relative_rms,
            by_strain: own.by_strain.clone(),
        }),
    }
}
