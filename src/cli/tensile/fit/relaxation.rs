//! `droptower tensile fit --relaxation`: a Prony series fitted to a relaxation modulus.

use super::FitArgs;
use super::relaxation_figures::RelaxationFigures;
use super::relaxation_page::page;
use super::written::{Places, name};
use crate::faults;
use crate::tensile::reduce::paths;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, listed};
use base::finding::Finding;
use lab::experiment::Warning;
use lab::experiment::material_file::fitted::{ASSUMED_POISSON, RelaxationMaterial, relaxation_text};
use lab::experiment::relaxation::{RelaxationReadingError, fit_prony, read_relaxation};
use lab::signal::file::ChannelSelection;

pub(super) fn run(args: &FitArgs, shared: &Shared) -> Result<(), Failure> {
    let places = Places::from_args(args)?;
    if let Some(poisson) = args.poisson.filter(|ratio| !(-1.0 < *ratio && *ratio < 0.5)) {
        return Err(Diagnostic::new(format!("expected a Poisson's ratio from -1 to 0.5, found {poisson}")).into());
    }
    let data = paths(&args.data)?;
    let [path] = &data[..] else {
        let names: Vec<String> = data.iter().map(|path| path.display().to_string()).collect();
        let message = format!("a relaxation is one file, and {} are given: {}", data.len(), listed(&names));
        return Err(Diagnostic::new(message).into());
    };
    let points = read_relaxation(path, &args.file.options(ChannelSelection::All)?).map_err(|error| reading(&error))?;
    let fit =
        fit_prony(&points, args.terms).map_err(|error| Diagnostic::new(format!("{}: {error}", path.display())))?;
    let incomplete = args.film().missing().map(|keys| Warning::MaterialIncomplete { keys: keys.into() });
    let assumed = args.poisson.is_none().then_some(Warning::PoissonAssumed { poisson: ASSUMED_POISSON });
    let of_material = [incomplete, assumed].into_iter().flatten().filter(|_| places.material.is_some());
    let findings: Vec<Finding> =
        fit.warnings.iter().map(Finding::new).chain(of_material.map(|one| Finding::new(&one))).collect();
    let source = name(path);
    let (poisson, film) = (args.poisson, args.film());
    let material = relaxation_text(&RelaxationMaterial { fit: &fit, source: &source, poisson, film });
    let shown = places.material.as_ref().map(|_| material.as_str());
    let written = places.write(&material, &page(&source, &fit, &findings, shown))?;
    let figures = RelaxationFigures::new(&source, &fit, findings, written);
    print_figures(shared, &figures, || figures.text())
}

fn reading(error: &RelaxationReadingError) -> Diagnostic {
    match error {
        RelaxationReadingError::Read(error) => faults::recording(error),
        other => Diagnostic { hint: other.hint(), ..Diagnostic::new(other.to_string()) },
    }
}
