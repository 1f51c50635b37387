//! `droptower tensile reduce`: from force over displacement to a material file.

use std::path::PathBuf;

use super::args::{ReduceArgs, Reduced};
use super::figures::Figures;
use super::{material, output};
use crate::faults;
use crate::scenarios::expanded;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::Diagnostic;
use lab::experiment::coupon::{Coupon, CouponReader, Label, RecordingError, Reduction, Rules};
use lab::signal::file::ChannelSelection;

pub(super) fn run(args: &ReduceArgs, shared: &Shared) -> Result<(), Failure> {
    let reduced = reduced(args)?;
    let texts = material::texts(args, &reduced)?;
    output::write(&texts)?;
    let written: Vec<PathBuf> = texts.into_iter().map(|(path, _)| path).collect();
    let figures = Figures::new(&reduced, args.density.is_none(), &written);
    print_figures(shared, &figures, || figures.text())
}

fn reduced(args: &ReduceArgs) -> Result<Reduced, Vec<Diagnostic>> {
    let one = |error: String| vec![Diagnostic::new(error)];
    let coupon = Coupon::new(args.gauge, args.width, args.thickness).map_err(|error| one(error.to_string()))?;
    let reader = reader(args, coupon).map_err(|mistake| vec![mistake])?;
    let tests = all(paths(&args.recordings)?.iter().map(|path| reader.read(path).map_err(|error| fault(&error))))?;
    let samples: Vec<_> = tests.iter().map(|test| test.sample.clone()).collect();
    let reduction = Reduction::from_samples(&samples, &reader.rules).map_err(|error| one(error.to_string()))?;
    Ok(Reduced { coupon, tests, reduction })
}

fn reader(args: &ReduceArgs, coupon: Coupon) -> Result<CouponReader, Diagnostic> {
    let window = [args.window[0], args.window[1]];
    let rules = Rules { window, break_share: args.break_share, toe_compensation: args.toe };
    Ok(CouponReader {
        given: Label { direction: args.direction, velocity: args.velocity },
        force: args.force.clone(),
        displacement: args.displacement.clone(),
        table: args.file.options(ChannelSelection::All)?,
        ..CouponReader::new(coupon, rules)
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
