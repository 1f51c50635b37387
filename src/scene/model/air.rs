//! The air around the film.

use super::loading::Inertia;
use super::{Air, Cushion, Face, Frame, Hold, Loading, ModelDiagnostics};
use crate::scenario::{Compression, Scenario};

/// Exponent of air that exchanges no heat.
const ADIABATIC: f64 = 1.4;

/// The air; none where there is no table.
pub fn check(
    scenario: &Scenario,
    loading: &Loading,
    faces: Option<&[Face]>,
    frame: &Frame,
    mistakes: &mut ModelDiagnostics<'_>,
) -> Option<Air> {
    let written = scenario.air.as_ref()?;
    if loading.inertia() != Inertia::Dynamic {
        mistakes.out_of_place("air", "air matters to fast tests, under `loading.impact`");
        return None;
    }
    let cushion = written.cushion.map(|compression| Cushion {
        exponent: if compression == Compression::Adiabatic { ADIABATIC } else { 1.0 },
        vent: written.vent.0 * written.discharge,
    });
    if cushion.is_none() {
        for key in ["air.vent", "air.discharge"].into_iter().filter(|key| mistakes.is_written(key)).collect::<Vec<_>>()
        {
            mistakes.out_of_place(key, "no air is enclosed without `cushion`");
        }
    } else {
        if faces.is_some_and(|faces| faces.len() != 2) {
            let hint = "a cushion has two faces; air between more of them is not supported yet";
            mistakes.report_with("air.cushion", "there is no air between exactly two faces of film", hint);
        }
        if frame.hold != Hold::All {
            mistakes.report_with("air.cushion", "air escapes past an edge that is not held", "hold \"all\"");
        }
    }
    Some(Air { cushion, added_mass: written.added_mass.0, density: written.density.0, pressure: written.pressure.0 })
}
