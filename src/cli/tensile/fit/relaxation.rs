//! `droptower tensile fit --relaxation`: a Prony series fitted to a relaxation modulus.

use std::path::Path;

use super::FitArgs;
use super::fitted::Fitted;
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
use lab::experiment::relaxation::{
    Master, RelaxationData, RelaxationReadingError, fit_prony, fit_shift, read_relaxation, read_shift_factors,
};
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
        return Err(Diagnostic::new(message)
            .hint("write several temperatures into one, with `temperature_degC`")
            .into());
    };
    let fitted = fitted(args, path)?;
    let shift = fitted.shift(args.shift);
    if let (Some(_), Some(_), None) = (&fitted.master, args.shift, shift) {
        return Err(Diagnostic::new("the shift factors do not determine the law that is asked for").into());
    }
    let incomplete = args.film().missing().map(|keys| Warning::MaterialIncomplete { keys: keys.into() });
    let assumed = args.poisson.is_none().then_some(Warning::PoissonAssumed { poisson: ASSUMED_POISSON });
    let of_material = [incomplete, assumed].into_iter().flatten().filter(|_| places.material.is_some());
    let findings: Vec<Finding> =
        fitted.fit.warnings.iter().map(Finding::new).chain(of_material.map(|one| Finding::new(&one))).collect();
    let (fit, source, poisson, film) = (&fitted.fit, fitted.source.as_str(), args.poisson, args.film());
    let material = relaxation_text(&RelaxationMaterial { fit, source, poisson, shift, film });
    let shown = places.material.as_ref().map(|_| material.as_str());
    let written = places.write(&material, &page(&fitted, &findings, shown))?;
    let figures = RelaxationFigures::new(&fitted, findings, written);
    print_figures(shared, &figures, || figures.text())
}

fn fitted(args: &FitArgs, path: &Path) -> Result<Fitted, Diagnostic> {
    let fault = |error: &dyn std::fmt::Display| Diagnostic::new(format!("{}: {error}", path.display()));
    let options = args.file.options(ChannelSelection::All)?;
    let (points, master) = match read_relaxation(path, &options).map_err(|error| reading(&error))? {
        RelaxationData::Curve(_)
            if args.shift_factors.is_some() || args.shift.is_some() || args.reference.is_some() =>
        {
            let mistake = fault(&"the file has no temperatures, to which shift factors belong");
            return Err(mistake.hint("add the column `temperature_degC`, or leave out the options of shift factors"));
        }
        RelaxationData::Curve(points) => (points, None),
        RelaxationData::Raw(relaxations) => {
            let master = match &args.shift_factors {
                Some(file) => {
                    let factors = read_shift_factors(file).map_err(|error| reading(&error))?;
                    Master::shifted(&relaxations, &factors)
                }
                None => Master::overlapped(&relaxations, args.reference),
            };
            let master = master.map_err(|error| fault(&error))?;
            let fits = fit_shift(&master.factors, master.reference);
            (master.points.clone(), Some((master, fits)))
        }
    };
    let fit = fit_prony(&points, args.terms).map_err(|error| fault(&error))?;
    Ok(Fitted { source: name(path), fit, master })
}

fn reading(error: &RelaxationReadingError) -> Diagnostic {
    match error {
        RelaxationReadingError::Read(error) => faults::recording(error),
        other => Diagnostic { hint: other.hint(), ..Diagnostic::new(other.to_string()) },
    }
}
