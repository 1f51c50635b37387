//! `[specimen.material.plastic]`: a flow curve that does not fall and a yield surface that is closed.

use super::ModelDiagnostics;
use crate::scenario::{self, HillRatios, Point};
use base::number::significant;
use base::units::Rate;
use membrane::material::{
    CurveError, Elastic, FlowCurve, FlowCurveError, FlowRate, Hardening, Hill, Law, Plastic, RateTable, RateTableError,
    Voce,
};

/// The law written at `path`; none where it is invalid.
pub(super) fn check(written: &scenario::Plastic, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<Law> {
    let hill = match &written.hill {
        Some(ratios) => hill(ratios, &format!("{path}.hill"), mistakes),
        None => Some(Hill::default()),
    };
    let flow = flow(written, path, mistakes);
    let elastic = Elastic { young: written.young.0, poisson: written.poisson };
    let (hardening, rate) = flow?;
    Some(Law::Plastic(Plastic::new(elastic, hill?, hardening, rate)))
}

/// Hill's function. Which ratios are written was checked before.
fn hill(written: &HillRatios, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<Hill> {
    let HillRatios { r0, r45, r90, r11, r22, r33, r12 } = *written;
    let hill = match (r0, r11) {
        (Some(r0), _) => Hill::from_strain_ratios([r0, r45?, r90?]),
        (None, Some(r11)) => Hill::from_stress_ratios([r11, r22?, r33?], r12?),
        (None, None) => return None,
    };
    if !hill.is_closed() {
        let message = "the yield surface of these ratios is open: some stresses in the plane never make the film yield";
        mistakes.report_with(path, message, "1/r11, 1/r22 and 1/r33 are to be sides of a triangle");
        return None;
    }
    Some(hill)
}

/// Hardening and dependence on the rate.
fn flow(written: &scenario::Plastic, path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<(Hardening, FlowRate)> {
    let place = format!("{path}.hardening");
    let hardening = &written.hardening;
    if let Some(points) = &hardening.curve {
        return Some((Hardening::Table(curve(points, &format!("{place}.curve"), mistakes)?), FlowRate::Independent));
    }
    if let Some(scenario::Voce { initial, saturation, rate: approach }) = hardening.voce {
        if saturation.0 < initial.0 {
            let message = "the saturation is below the yield stress, so the flow stress would fall";
            mistakes.report_with(&format!("{place}.voce.saturation"), message, "film that softens has no law");
            mistakes.label(&format!("{place}.voce.yield"), "the yield stress");
            return None;
        }
        let voce = Voce { initial: initial.0, saturation: saturation.0, rate: approach };
        return Some((Hardening::Voce(voce), FlowRate::Independent));
    }
    by_rate(hardening.rates.as_ref()?, &format!("{place}.rates"), mistakes)
}

fn by_rate(
    written: &[scenario::FlowCurve],
    path: &str,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<(Hardening, FlowRate)> {
    let mut curves = Vec::with_capacity(written.len());
    for (index, scenario::FlowCurve { rate, curve }) in written.iter().enumerate() {
        curves.push(self::curve(curve, &format!("{path}.{index}.curve"), mistakes).map(|curve| (rate.0, curve)));
    }
    match RateTable::new(curves.into_iter().collect::<Option<_>>()?) {
        Ok((slowest, table)) => return Some((Hardening::Table(slowest), FlowRate::Table(table))),
        Err(RateTableError::RateNotIncreasing { index, rate, previous }) => mistakes.report_with(
            &format!("{path}.{index}.rate"),
            "the rates do not increase",
            format!("{} follows {}; list the slowest first", Rate(rate), Rate(previous)),
        ),
        Err(RateTableError::StressFalls { index, strain }) => {
            let strain = significant(strain, 4);
            let message = format!("the flow stress falls with the rate at the plastic strain {strain}");
            mistakes.report_with(&format!("{path}.{index}"), message, "a curve lies nowhere below the slower ones");
        }
        // The number of curves was checked before.
        Err(RateTableError::TooShort) => {}
    }
    None
}

/// The flow curve through `points`.
fn curve(points: &[Point], path: &str, mistakes: &mut ModelDiagnostics<'_>) -> Option<FlowCurve> {
    let pairs: Vec<[f64; 2]> = points.iter().map(|Point(strain, stress)| [*strain, stress.0]).collect();
    let place = |index: usize| format!("{path}.{index}");
    let error = match FlowCurve::new(&pairs) {
        Ok(curve) => return Some(curve),
        Err(error) => error,
    };
    match error {
        FlowCurveError::StartsLate { strain } => {
            let message = format!("the flow curve starts at the plastic strain {}", significant(strain, 4));
            mistakes.report_with(&place(0), message, "its first point is the yield stress: [0, \"8 MPa\"]");
        }
        FlowCurveError::NoStress => {
            mistakes.report_with(&place(0), "film without yield stress", "its first point is the yield stress");
        }
        FlowCurveError::Curve(CurveError::StrainNotIncreasing { index, strain, previous }) => {
            let hint = format!("{strain} follows {previous}");
            mistakes.report_with(&place(index), "the flow curve is not increasing in plastic strain", hint);
        }
        FlowCurveError::Curve(CurveError::StressFalls { index, .. }) => {
            mistakes.report_with(&place(index), "the flow stress falls", "film that softens has no law");
        }
        FlowCurveError::Curve(CurveError::NotFinite { index }) => {
            mistakes.report(&place(index), "this point of the flow curve is not finite");
        }
        // The number of points was checked before.
        FlowCurveError::Empty | FlowCurveError::Curve(CurveError::TooShort) => {}
    }
    None
}
