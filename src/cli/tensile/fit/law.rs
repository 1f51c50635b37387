//! `droptower tensile fit --law`: a law fitted to tests.

use std::path::Path;

use super::FitArgs;
use super::law_figures::LawFigures;
use super::law_page::page;
use super::written::Places;
use crate::faults;
use crate::tensile::reduce::{all, paths};
use crate::{Failure, Shared, print_figures};
use base::diagnostic::Diagnostic;
use base::finding::Finding;
use lab::experiment::Warning;
use lab::experiment::law_fit::hyperelastic::Energy;
use lab::experiment::law_fit::{DataSet, FitError, FitOptions, StressReader, StressReadingError, TestKind, fit_law};
use lab::experiment::material_file::fitted::law_text;
use lab::signal::file::ChannelSelection;

pub(super) fn run(law: Energy, args: &FitArgs, shared: &Shared) -> Result<(), Failure> {
    let places = Places::from_args(args)?;
    let data = paths(&args.data)?;
    let kinds = one_each(&args.test, data.len(), "kinds of tests", "--test")?;
    let weights = one_each(&args.weight, data.len(), "weights", "--weight")?;
    let sets = all(data.iter().enumerate().map(|(place, path)| set(args, path, kinds(place), weights(place))))?;
    let predicted = all(paths(&args.predict)?.iter().map(|path| set(args, path, None, None)))?;
    let options = FitOptions { weighting: args.residual, stable_to: args.stable_to };
    let fit = fit_law(law, &sets, &predicted, &options).map_err(|error| fault(&error))?;
    let missing = places.material.as_ref().and(args.film().missing());
    let incomplete = missing.map(|keys| Finding::new(&Warning::MaterialIncomplete { keys: keys.into() }));
    let findings: Vec<Finding> = fit.findings().into_iter().chain(incomplete).collect();
    let material = law_text(&fit, &args.film());
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

fn set(args: &FitArgs, path: &Path, kind: Option<TestKind>, weight: Option<f64>) -> Result<DataSet, Diagnostic> {
    let reader = StressReader { kind, table: args.file.options(ChannelSelection::All)? };
    let set = reader.read(path).map_err(|error| reading(&error))?;
    set.with_weight(weight.unwrap_or(1.0)).map_err(|error| located(path, &error))
}

fn located(path: &Path, error: &impl std::fmt::Display) -> Diagnostic {
    Diagnostic::new(format!("{}: {error}", path.display()))
}

fn reading(error: &StressReadingError) -> Diagnostic {
    match error {
        StressReadingError::Read(error) => faults::recording(error),
        other => Diagnostic { hint: other.hint(), ..Diagnostic::new(other.to_string()) },
    }
}

fn fault(error: &FitError) -> Diagnostic {
    Diagnostic { hint: error.hint().map(str::to_owned), ..Diagnostic::new(error.to_string()) }
}
