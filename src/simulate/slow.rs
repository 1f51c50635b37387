//! What keeps a slow test quasi-static: enough time, heavy film, damping (theory.md, section 10).

use std::f64::consts::TAU;

use crate::lane::splat;
use crate::mesh::{Outline, Side};
use crate::model::{Face, Hold, Loading, Model};

/// Steps above which the film of a stretch is made heavier.
const STEPS_OF_A_STRETCH: f64 = 200_000.0;

/// Periods of the film for which an indentation or inflation loads it, if its mass may be chosen.
const PERIODS: f64 = 50.0;

/// Times in which damping takes a free oscillation to 1/e, over the time of an indentation: its force is read all along, so
/// damping must not be felt in it.
const DECAYS_INDENTED: f64 = 10.0;

/// The same over the rise of a pressure, which is held afterwards: there, film must not swing beyond its place, since it may
/// remember how far it was stretched.
const DECAYS_INFLATED: f64 = 40.0;

/// First zero of the Bessel function J₀: angular frequency of a round membrane over its wave speed and radius.
const ROUND: f64 = 2.404_826;

/// Factor on the film's mass of a test that would take `steps` steps with its own: as heavy as it may be, never lighter.
pub(super) fn mass_scaling(model: &Model, steps: f64) -> f64 {
    let excess = match model.loading {
        Loading::Impact { .. } => 1.0,
        Loading::Stretch { .. } => steps / STEPS_OF_A_STRETCH,
        Loading::Indent { .. } | Loading::Pressure { .. } => periods(model) / PERIODS,
    };
    // Not comparable where there is nothing to estimate it from: then the mass stays what it is.
    if excess > 1.0 { excess * excess } else { 1.0 }
}

/// Mass-proportional damping of the film, 1/s (theory.md, equation 28). In a test that is in equilibrium all the time it is tied to the time of
/// loading alone: what swings dies away in a small part of it, and film that follows the load hardly feels it.
pub(super) fn damping(model: &Model) -> f64 {
    match model.loading {
        Loading::Impact { .. } | Loading::Stretch { .. } => model.specimen.damping,
        Loading::Indent { .. } => 2.0 * DECAYS_INDENTED / time_of_loading(model),
        Loading::Pressure { .. } => 2.0 * DECAYS_INFLATED / time_of_loading(model),
    }
}

/// Time in which the load rises, s.
fn time_of_loading(model: &Model) -> f64 {
    match model.loading {
        Loading::Pressure { ramp, .. } => ramp,
        _ => model.run_time(),
    }
}

/// Periods of the softest face, as it is stretched at the end, in the time of loading; a guess within a factor of two.
fn periods(model: &Model) -> f64 {
    let Some(radius) = radius(&model.specimen.shape, &model.frame.hold) else { return 0.0 };
    let frequency = |face: &Face| {
        let stretch = match model.loading {
            Loading::Indent { depth, .. } => (depth / radius).hypot(1.0),
            Loading::Pressure { pressure, .. } => cap(face, radius, pressure),
            Loading::Impact { .. } | Loading::Stretch { .. } => 1.0,
        };
        ROUND * (tension(face, stretch) / face.material.density).sqrt() / radius
    };
    let softest = model.faces.iter().map(frequency).fold(f64::INFINITY, f64::min);
    time_of_loading(model) * softest / TAU
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
        Outline::Mesh(_) => None,
    }
}

/// Mean stress of a face, Pa, that is stretched in all directions by `stretch` beyond its pre-strain.
fn tension(face: &Face, stretch: f64) -> f64 {
    let [md, td] = face.prestrain.map(|prestrain| (1.0 + prestrain) * stretch);
    let f = [[md, 0.0, 0.0], [0.0, td, 0.0]].map(|v| v.map(splat));
    let p = face.material.law.virgin_stress(f);
    0.5 * (p[0][0][0] + p[1][1][0])
}

/// Stretch of a spherical cap over a disc of `radius` (m) that carries `pressure` (Pa), by halving its height.
fn cap(face: &Face, radius: f64, pressure: f64) -> f64 {
    let thickness = face.material.thickness * f64::from(face.layers);
    // Arc over chord of a cap with this height over the disc's radius.
    let stretch = |height: f64| {
        let angle = 2.0 * height.atan();
        angle / angle.sin()
    };
    let carried = |height: f64| {
        let curvature = 2.0 * height / (1.0 + height * height) / radius;
        2.0 * thickness * tension(face, stretch(height)) * curvature / stretch(height)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if carried(middle) < pressure { low = middle } else { high = middle }
    }
    stretch(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Elastic, Law, Material};
    use crate::mesh::{Element, Meshing};

    /// Against Hencky's centre: the cap is within a tenth of its strain ⅔ (w/a)².
    #[test]
    fn a_cap_is_a_fair_guess_of_an_inflated_disc() {
        let (young, thickness, radius, pressure) = (1e9, 50e-6, 0.1, 500.0);
        let law = Law::Elastic(Elastic { young, poisson: 0.3 });
        let material = Material { density: 1e3, thickness, law, measured_rates: None };
        let meshing = Meshing { element: Element::Quad4, size: 0.01 };
        let face = Face { height: 0.0, layers: 1, film: None, material, md_angle: 0.0, prestrain: [0.0; 2], meshing };
        let hencky = 0.65344 * (pressure * radius / (young * thickness)).cbrt();
        let strain = 2.0 / 3.0 * hencky * hencky;
        assert!((cap(&face, radius, pressure) - 1.0 - strain).abs() < 0.15 * strain);
    }
}
