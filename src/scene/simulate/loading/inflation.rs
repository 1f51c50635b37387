//! Inflation: gas below the film, of a pressure or of a volume.

use std::f64::consts::PI;

use super::{LoadCase, PERIODS, periods, tension};
use crate::mesh::Outline;
use crate::model::loading::{self, Gas};
use crate::model::{Face, Model};
use crate::simulate::fault::RunError;
use crate::simulate::mount::Mounting;
use crate::simulate::tracks::Tracks;
use lab::signal::{Recording, column};
use membrane::engine::{self, Filling, Film, Loads, Nodes};

/// Decay times of a free oscillation in the rise of a pressure, which is held afterwards. The film must not overshoot
/// its equilibrium, since its law may depend on its largest strain.
const DECAYS_OF_PRESSURE: f64 = 40.0;

/// Decay times of a free oscillation in the rise of a volume. The pressure is recorded throughout, so damping must not add
/// to it.
const DECAYS_OF_VOLUME: f64 = 10.0;

/// Factor on [`PERIODS`] of a volume: the pressure is recorded from the flat film on, which is softer than stretched film.
const LONGER: f64 = 2.0;

/// A pressure or a volume that rises and is held.
pub(super) struct Inflation<'a> {
    pub(super) model: &'a Model,
    pub(super) loading: &'a loading::Inflation,
}

impl LoadCase for Inflation<'_> {
    fn excess(&self, _: f64) -> f64 {
        match self.loading.gas {
            Gas::Pressure(pressure) => {
                periods(self.model, self.loading.ramp, |face, radius| cap(face, radius, pressure)) / PERIODS
            }
            Gas::Volume(volume) => {
                let mean = volume / area(self.model);
                periods(self.model, self.loading.ramp, |_, radius| stretch(height(PI * mean / radius)))
                    / (LONGER * PERIODS)
            }
        }
    }

    fn damping(&self) -> f64 {
        let decays = match self.loading.gas {
            Gas::Pressure(_) => DECAYS_OF_PRESSURE,
            Gas::Volume(_) => DECAYS_OF_VOLUME,
        };
        2.0 * decays / self.loading.ramp
    }

    fn apply(&self, _: &[Film], _: &Nodes, loads: &mut Loads) -> Result<Vec<engine::Impact>, RunError> {
        let ramp = self.loading.ramp;
        match self.loading.gas {
            Gas::Pressure(pressure) => loads.inflation = Some(engine::Inflation { pressure, ramp }),
            Gas::Volume(volume) => loads.filling = Some(Filling { volume: volume / loads.multiplicity, ramp }),
        }
        Ok(vec![])
    }

    /// Pressure, the largest rise of a node, and the volume under the film.
    fn signals(&self, tracks: &Tracks, _: &Mounting) -> Recording {
        let [rise, volume] = [column::DEFLECTION, column::VOLUME].map(|column| tracks.sampled(&column));
        let pressure = |k: usize| match self.loading.gas {
            Gas::Pressure(pressure) => {
                engine::Inflation { pressure, ramp: self.loading.ramp }.pressure_at(k as f64 * tracks.sampling.interval)
            }
            Gas::Volume(_) => tracks.sampled(&column::PRESSURE)[k],
        };
        let rows: Vec<_> = (0..rise.len().min(volume.len())).map(|k| [pressure(k), rise[k], volume[k]]).collect();
        tracks.table(&[column::PRESSURE.name, column::DEFLECTION.name, column::VOLUME.name], &rows)
    }
}

/// Arc over chord of a cap with this height over the radius of its rim.
fn stretch(height: f64) -> f64 {
    let angle = 2.0 * height.atan();
    angle / angle.sin()
}

/// Stretch of a spherical cap over a disc of `radius` (m) that carries `pressure` (Pa), by bisection of its height.
fn cap(face: &Face, radius: f64, pressure: f64) -> f64 {
    let carried = |height: f64| {
        let curvature = 2.0 * height / (1.0 + height * height) / radius;
        2.0 * face.thickness() * tension(face, stretch(height)) * curvature / stretch(height)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if carried(middle) < pressure { low = middle } else { high = middle }
    }
    stretch(high)
}

/// Area of the whole film, m²; NaN for an imported outline.
fn area(model: &Model) -> f64 {
    let shape = &model.specimen.shape;
    // A polygon is the computed part.
    let copies = if matches!(shape, Outline::Polygon(_)) { model.specimen.symmetry.copies() } else { 1.0 };
    shape.area().map_or(f64::NAN, |area| area * copies)
}

/// Height of a spherical cap over the radius of its rim, of a `volume` over the cube of that radius: the root of
/// π h (3 + h²)/6 = V.
fn height(volume: f64) -> f64 {
    let half = 3.0 * volume / PI;
    let root = (half * half + 1.0).sqrt();
    (half + root).cbrt() - (root - half).cbrt()
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

    #[test]
    fn the_height_is_that_of_the_cap() {
        for h in [1e-3, 0.3, 1.0, 4.0] {
            let volume = PI * h * (3.0 + h * h) / 6.0;
            assert!((height(volume) / h - 1.0).abs() < 1e-10, "{h}");
        }
    }
}
