//! `[[specimen.material.prony]]`: a Prony series on a law that can have one, at the film's temperature.

use super::ModelDiagnostics;
use crate::scenario::{self, PronyOf, Shift};
use base::number::significant;
use membrane::material::{Arrhenius, Law, PronyTerm, ShiftFactor, Viscosity, ViscosityError, Wlf, Written};

/// The series written in the material at `path` on its law; none where there is none or it is invalid.
pub(super) fn check(
    written: &scenario::Material,
    law: &Law,
    path: &str,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Viscosity> {
    let of = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    if written.prony.is_empty() {
        let keys = [
            ("prony_of", written.prony_of.is_some()),
            ("temperature", written.temperature.is_some()),
            ("shift", written.shift.is_some()),
        ];
        for (key, _) in keys.iter().filter(|(_, is_written)| *is_written) {
            mistakes.out_of_place(&of(key), "the material has no `prony`");
        }
        return None;
    }
    let place = of("prony");
    if matches!(law, Law::RateFabric(_)) {
        let message = "a fabric with `rates` cannot also have `prony`: the rate would count twice";
        mistakes.report_with(&place, message, "leave `prony` out, or give each fibre set one curve");
        return None;
    }
    let is_quasi_static = |fabric: &scenario::Fabric| fabric.mounting == scenario::MountingCurve::QuasiStatic;
    if written.fabric.as_ref().is_some_and(is_quasi_static) {
        let message =
            "a fabric mounted at its quasi-static curve cannot also have `prony`: relaxation would count twice";
        mistakes.report_with(&place, message, "leave `mounting` out: film with `prony` relaxes on the frame");
        mistakes.label(&of("fabric.mounting"), "the mounting");
        return None;
    }
    if matches!(law, Law::Plastic(_)) {
        let message = "a plastic film cannot also have `prony`";
        let hint = "its yield stress grows with the strain rate by `plastic.hardening.rates`; elastic, hyperelastic and fabric film relax";
        mistakes.report_with(&place, message, hint);
        return None;
    }
    if law.viscous().is_none() {
        let message = "`prony` is not supported on this law";
        mistakes.report_with(
            &place,
            message,
            "it needs curves that rise from the origin, or an elastic or hyperelastic law",
        );
        return None;
    }
    let terms = written.prony.iter().map(|term| PronyTerm { share: term.share, time: term.time.0 }).collect();
    let viscosity = match Viscosity::new(terms) {
        Ok(viscosity) => viscosity,
        Err(ViscosityError::NothingLeft { sum }) => {
            let message =
                format!("the shares sum to {}, and film that has relaxed would carry nothing", significant(sum, 4));
            mistakes.report_with(
                &place,
                message,
                "a share is that of the instantaneous stiffness; all sum to less than 1",
            );
            return None;
        }
        // The ranges were checked before.
        Err(ViscosityError::Empty | ViscosityError::InvalidTerm { .. }) => return None,
    };
    let viscosity = viscosity.with_written(match written.prony_of.unwrap_or_default() {
        PronyOf::Instantaneous => Written::Instantaneous,
        PronyOf::LongTerm => Written::LongTerm,
    });
    shifted(viscosity, written, &of, mistakes)
}

/// The series at the temperature of the film.
fn shifted(
    viscosity: Viscosity,
    written: &scenario::Material,
    of: &dyn Fn(&str) -> String,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Viscosity> {
    let (temperature, shift) = match (written.temperature, written.shift) {
        (None, None) => return Some(viscosity),
        (Some(temperature), Some(shift)) => (temperature.0, shift),
        (Some(_), None) => {
            mistakes.out_of_place(&of("temperature"), "it needs `shift`, by which times change with temperature");
            return None;
        }
        (None, Some(_)) => {
            mistakes.missing(&of("temperature"), "that of the film, to which `shift` moves the relaxation times");
            return None;
        }
    };
    let factor = match shift {
        Shift::Wlf(wlf) => Wlf { c1: wlf.c1, c2: wlf.c2.0, reference: wlf.reference.0 }.factor_at(temperature),
        Shift::Arrhenius(arrhenius) => {
            Arrhenius { energy: arrhenius.energy.0, reference: arrhenius.reference.0 }.factor_at(temperature)
        }
    };
    let is_usable = |factor: &f64| {
        let time = |term: &PronyTerm| (term.time * factor).is_normal();
        viscosity.terms().iter().all(time)
    };
    let Some(factor) = factor.filter(is_usable) else {
        let message = "`shift` gives no relaxation times at this temperature";
        let hint = match shift {
            Shift::Wlf(wlf) => {
                let lowest = significant(wlf.reference.0 - wlf.c2.0, 4);
                format!("`wlf` has a pole at {lowest} K, `arrhenius` has none")
            }
            Shift::Arrhenius(_) => "it is too far from the reference".to_owned(),
        };
        mistakes.report_with(&of("temperature"), message, hint);
        return None;
    };
    Some(viscosity.shifted(factor))
}
