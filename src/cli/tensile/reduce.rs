//! `droptower tensile reduce`: from force over displacement to a material file.

use std::path::PathBuf;

use super::args::{CouponArgs, ReduceArgs, Reduced};
use super::figures::Figures;
use super::{material, output};
use crate::faults;
use crate::scenarios::expanded;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::Diagnostic;
use lab::experiment::coupon::{
    Coupon, CouponError, CouponReader, CouponTest, Dimensions, Label, RecordingError, Reduction, Rules,
};
use lab::signal::file::ChannelSelection;

pub(super) fn run(args: &ReduceArgs, shared: &Shared) -> Result<(), Failure> {
    let reduced = reduced(&args.coupons, args.velocity)?;
    let texts = material::texts(args, &reduced)?;
    output::write(&texts)?;
    let written: Vec<PathBuf> = texts.into_iter().map(|(path, _)| path).collect();
    let figures = Figures::new(&reduced, args.density.is_none(), &written);
    print_figures(shared, &figures, || figures.text())
}

/// The recordings that arguments name, reduced, with this speed in place of what they state.
pub(super) fn reduced(args: &CouponArgs, velocity: Option<f64>) -> Result<Reduced, Vec<Diagnostic>> {
    let one = |error: String| vec![Diagnostic::new(error)];
    check(args).map_err(one)?;
    let reader = reader(args, velocity).map_err(|mistake| vec![mistake])?;
    let paths = paths(&args.recordings)?;
    let tests = all(paths.iter().map(|path| reader.read_all(path).map_err(|error| fault(&error))))?.concat();
    let coupon = mean(&tests).map_err(|error| one(error.to_string()))?;
    let samples: Vec<_> = tests.iter().map(|test| test.sample.clone()).collect();
    let reduction = Reduction::from_samples(&samples, &reader.rules).map_err(|error| one(error.to_string()))?;
    Ok(Reduced { coupon, tests, reduction })
}

/// Refuses dimensions that no coupon has, before any file is read.
fn check(args: &CouponArgs) -> Result<(), String> {
    // In place of those that a file states, any will do.
    let [gauge, width, thickness] = [args.gauge, args.width, args.thickness].map(|given| given.unwrap_or(1.0));
    Coupon::new(gauge, width, thickness).map(drop).map_err(|error| error.to_string())
}

/// The coupon of the mean dimensions.
fn mean(tests: &[CouponTest]) -> Result<Coupon, CouponError> {
    let mean = |dimension: fn(&Coupon) -> f64| {
        let first = tests.first().map_or(f64::NAN, |test| dimension(&test.coupon));
        // Equal dimensions are their own mean, to the last digit.
        let apart: f64 = tests.iter().map(|test| dimension(&test.coupon) - first).sum();
        first + apart / tests.len().max(1) as f64
    };
    Coupon::new(mean(Coupon::gauge), mean(Coupon::width), mean(Coupon::thickness))
}

fn reader(args: &CouponArgs, velocity: Option<f64>) -> Result<CouponReader, Diagnostic> {
    let window = [args.window[0], args.window[1]];
    let rules = Rules { window, break_share: args.break_share, toe_compensation: args.toe };
    Ok(CouponReader {
        given: Label { direction: args.direction, velocity },
        force: args.force.clone(),
        displacement: args.displacement.clone(),
        table: args.file.options(ChannelSelection::All)?,
        ..CouponReader::new(Dimensions { gauge: args.gauge, width: args.width, thickness: args.thickness }, rules)
    })
}

/// The files that paths and globs name, each once, in the order of the arguments.
pub(super) fn paths(patterns: &[String]) -> Result<Vec<PathBuf>, Vec<Diagnostic>> {
    let mut paths = all(patterns.iter().map(|pattern| expanded(pattern)))?.concat();
    let mut seen = std::collections::HashSet::new();
    paths.retain(|path| seen.insert(path.clone()));
    Ok(paths)
}

/// All values, or all mistakes.
pub(super) fn all<T>(results: impl Iterator<Item = Result<T, Diagnostic>>) -> Result<Vec<T>, Vec<Diagnostic>> {
    let (values, mistakes): (Vec<_>, Vec<_>) = results.partition(Result::is_ok);
    let mistakes: Vec<Diagnostic> = mistakes.into_iter().filter_map(Result::err).collect();
    if mistakes.is_empty() { Ok(values.into_iter().filter_map(Result::ok).collect()) } else { Err(mistakes) }
}

fn fault(error: &RecordingError) -> Diagnostic {
    match error {
        RecordingError::Read(error) => faults::recording(error),
        other => Diagnostic { hint: other.hint(), ..Diagnostic::new(other.to_string()) },
    }
}
