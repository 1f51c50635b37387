//! The stress of film at its pre-strain.

use crate::model::Face;
use membrane::lane::splat;
use membrane::material::{Gradient, Viscosity};

/// First Piola–Kirchhoff stress (Pa) along MD and TD of a face that is stretched in all directions by `stretch` beyond
/// its pre-strain; components along MD, TD and its normal. Viscous film has rested.
pub(super) fn of_face(face: &Face, stretch: f64) -> Gradient<1> {
    let [md, td] = face.prestrain.map(|prestrain| (1.0 + prestrain) * stretch);
    let stress = face.material.law.virgin_stress([[md, 0.0, 0.0], [0.0, td, 0.0]].map(|v| v.map(splat)));
    let share = face.material.viscosity.as_ref().map_or(1.0, Viscosity::mounted);
    stress.map(|vector| vector.map(|[component]| [share * component]))
}
