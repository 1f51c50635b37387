//! Inflation: a pressure on the lower side of the film.

use super::{LoadCase, slow};
use crate::model::{Face, Model, loading};
use crate::simulate::fault::RunError;
use crate::simulate::mount::Mounting;
use crate::simulate::tracks::Tracks;
use lab::signal::{Recording, column};
use membrane::engine::{self, Film, Inflation, Loads, Nodes};

/// Decay times of a free oscillation in the rise of the pressure, which is held afterwards. The film must not overshoot
/// its equilibrium, since its law may depend on its largest strain.
const DECAYS: f64 = 40.0;

/// A `pressure` (Pa) that rises over `ramp` (s) and is held.
pub(super) struct Pressure<'a> {
    model: &'a Model,
    pressure: f64,
    ramp: f64,
}

impl Pressure<'_> {
    fn inflation(&self) -> Inflation {
        Inflation { pressure: self.pressure, ramp: self.ramp }
    }
}

impl<'a> Pressure<'a> {
    /// The loading of `model`.
    pub(super) fn new(model: &'a Model, loading: &loading::Pressure) -> Pressure<'a> {
        Pressure { model, pressure: loading.pressure, ramp: loading.ramp }
    }
}

impl LoadCase for Pressure<'_> {
    fn excess(&self, _: f64) -> f64 {
        let stretch = |face: &Face, radius: f64| cap(face, radius, self.pressure);
        slow::periods(self.model, self.ramp, stretch) / slow::PERIODS
    }

    fn damping(&self) -> f64 {
        2.0 * DECAYS / self.ramp
    }

    fn apply(&self, _: &[Film], _: &Nodes, loads: &mut Loads) -> Result<Vec<engine::Impact>, RunError> {
        loads.inflation = Some(self.inflation());
        Ok(vec![])
    }

    fn has_rise(&self) -> bool {
        true
    }

    /// Pressure, the largest rise of a node, and the volume under the film.
    fn signals(&self, tracks: &Tracks, _: &Mounting) -> Recording {
        let inflation = self.inflation();
        let samples = tracks.sampled(&column::DEFLECTION).iter().zip(tracks.sampled(&column::VOLUME)).enumerate();
        let row = |(k, (rise, volume)): (usize, (&f64, &f64))| {
            [inflation.pressure_at(k as f64 * tracks.sampling.interval), *rise, *volume]
        };
        let rows: Vec<_> = samples.map(row).collect();
        tracks.table(&[column::PRESSURE.name, column::DEFLECTION.name, column::VOLUME.name], &rows)
    }
}

/// Arc over chord of a cap with this height over the radius of its rim.
pub(super) fn stretch(height: f64) -> f64 {
    let angle = 2.0 * height.atan();
    angle / angle.sin()
}

/// Stretch of a spherical cap over a disc of `radius` (m) that carries `pressure` (Pa), by bisection of its height.
fn cap(face: &Face, radius: f64, pressure: f64) -> f64 {
    let thickness = face.material.thickness * f64::from(face.layers);
    let carried = |height: f64| {
        let curvature = 2.0 * height / (1.0 + height * height) / radius;
        2.0 * thickness * slow::tension(face, stretch(height)) * curvature / stretch(height)
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
    use crate::mesh::{Element, Meshing};
    use membrane::material::{Elastic, Law, Material};

    /// Compared with the strain ⅔ (w/a)² of Hencky's solution.
    #[test]
    fn a_cap_estimates_the_stretch_of_an_inflated_disc() {
        let (young, thickness, radius, pressure) = (1e9, 50e-6, 0.1, 500.0);
        let law = Law::Elastic(Elastic { young, poisson: 0.3 });
        let material = Material::new(law, 1e3, thickness);
        let meshing = Meshing { element: Element::Quad4, size: 0.01, grading: None };
        let face = Face {
            height: 0.0,
            layers: 1,
            film: None,
            material,
            break_is_moved: false,
            unsourced_coupling: None,
            md_angle: 0.0,
            prestrain: [0.0; 2],
            meshing,
            settle: true,
        };
        let hencky = 0.65344 * (pressure * radius / (young * thickness)).cbrt();
        let strain = 2.0 / 3.0 * hencky * hencky;
        assert!((cap(&face, radius, pressure) - 1.0 - strain).abs() < 0.15 * strain);
    }
}
