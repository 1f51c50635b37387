//! Duration of a test in which the film stays in equilibrium (theory.md, section 10).

use std::f64::consts::TAU;

use crate::mesh::{Outline, Side};
use crate::model::{Face, Hold, Model};
use crate::simulate::prestress;

/// Duration of the loading in periods of the film, where the factor on its mass is chosen.
pub(super) const PERIODS: f64 = 50.0;

/// First zero of the Bessel function J₀: angular frequency of a round membrane over its wave speed and radius.
const ROUND: f64 = 2.404_826;

/// Periods of the softest face in `time` (s), where `stretch` is what a face of a radius (m) is stretched by at the end
/// of the test: an estimate within a factor of two.
pub(super) fn periods(model: &Model, time: f64, stretch: impl Fn(&Face, f64) -> f64) -> f64 {
    let Some(radius) = radius(&model.specimen.shape, &model.frame.hold) else { return 0.0 };
    let frequency =
        |face: &Face| ROUND * (tension_at_most(face, stretch(face, radius)) / face.material.density).sqrt() / radius;
    let softest = model.faces.iter().map(frequency).fold(f64::INFINITY, f64::min);
    time * softest / TAU
}

/// Radius of the largest disc between held edges, m; none for imported outlines.
fn radius(shape: &Outline, hold: &Hold) -> Option<f64> {
    let held = |side| match hold {
        Hold::All => true,
        Hold::Sides(sides) => sides.contains(&side),
        Hold::None => false,
    };
    match shape {
        Outline::Rectangle { x, .. } if !held(Side::YMinus) || !held(Side::YPlus) => Some(0.5 * x),
        Outline::Rectangle { y, .. } if !held(Side::XMinus) || !held(Side::XPlus) => Some(0.5 * y),
        Outline::Rectangle { x, y } => Some(0.5 * x.min(*y)),
        Outline::Circle { radius } => Some(*radius),
        // Exact for discs and squares.
        Outline::Polygon(polygon) => Some(2.0 * polygon.area() / polygon.perimeter()),
        Outline::Mesh { .. } => None,
    }
}

/// [`tension`] at `stretch`, or at the first of ever halved strains that the law admits.
fn tension_at_most(face: &Face, stretch: f64) -> f64 {
    let strains = std::iter::successors(Some(stretch - 1.0), |strain| Some(0.5 * strain)).take(50);
    strains.map(|strain| tension(face, 1.0 + strain)).find(|tension| !tension.is_nan()).unwrap_or(f64::NAN)
}

/// Mean stress of a face, Pa, that is stretched in all directions by `stretch` beyond its pre-strain.
pub(super) fn tension(face: &Face, stretch: f64) -> f64 {
    let p = prestress::of_face(face, stretch);
    0.5 * (p[0][0][0] + p[1][1][0])
}
