//! The stress of film at its pre-strain.

use nalgebra::Vector2;

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

/// Force of the pre-strain of `face` over the length of an edge as mounted with the outward `normal` in the plane of the
/// frame, N/m.
pub(super) fn line_force(face: &Face, normal: &Vector2<f64>) -> Vector2<f64> {
    let [md, td] = face.prestrain.map(|prestrain| 1.0 + prestrain);
    let stress = of_face(face, 1.0);
    let (sin, cos) = face.md_angle.sin_cos();
    let [n1, n2] = [normal.x * cos + normal.y * sin, normal.y * cos - normal.x * sin];
    let [f1, f2] = [0, 1].map(|axis| stress[0][axis][0] * n1 / td + stress[1][axis][0] * n2 / md);
    Vector2::new(f1 * cos - f2 * sin, f1 * sin + f2 * cos) * (face.material.thickness * f64::from(face.layers))
}
