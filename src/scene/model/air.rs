//! The air around the film.

use super::layers::height_path;
use super::loading::Inertia;
use super::{Air, Cushion, Face, Frame, Hold, Loading, ModelDiagnostics};
use crate::scenario::{Compression, Scenario};
use base::number::significant;

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
        if let Some([upper, lower]) = faces {
            let thickness = |face: &Face| face.material.thickness * f64::from(face.layers);
            let needed = 0.5 * (thickness(upper) + thickness(lower));
            // Faces in the wrong order are refused elsewhere.
            let apart = upper.height - lower.height;
            if apart > 0.0 && apart <= needed {
                let [apart, needed] = [apart, needed].map(|length| significant(1e6 * length, 3));
                let message = format!("faces {apart} um apart are as thick as that: there is no air between them");
                let hint = format!("mount their middle surfaces more than {needed} um apart");
                mistakes.report_with(&height_path(scenario, 1), message, hint);
                mistakes.label("air.cushion", "the air");
            }
        }
        if frame.hold != Hold::All {
            mistakes.report_with("air.cushion", "air escapes past an edge that is not held", "hold \"all\"");
        }
    }
    Some(Air { cushion, added_mass: written.added_mass.0, density: written.density.0, pressure: written.pressure.0 })
}
