//! Inflation by gas that is let in under the film.

use std::f64::consts::PI;

use super::pressure::stretch;
use super::{LoadCase, slow};
use crate::mesh::Outline;
use crate::model::{Face, Model, loading};
use crate::simulate::fault::RunError;
use crate::simulate::mount::Mounting;
use crate::simulate::tracks::Tracks;
use lab::signal::{Recording, column};
use membrane::engine::{self, Filling, Film, Loads, Nodes};

/// Decay times of a free oscillation in the rise of the volume. The pressure is recorded throughout, so damping must
/// not add to it.
const DECAYS: f64 = 10.0;

/// Factor on [`slow::PERIODS`]: the pressure is recorded from the flat film on, which is softer than stretched film.
const LONGER: f64 = 2.0;

/// A `volume` (m³) under the whole film that is let in over `ramp` (s) and then constant.
pub(super) struct Volume<'a> {
    model: &'a Model,
    volume: f64,
    ramp: f64,
}

impl<'a> Volume<'a> {
    /// The loading of `model`.
    pub(super) fn new(model: &'a Model, loading: &loading::Volume) -> Volume<'a> {
        Volume { model, volume: loading.volume, ramp: loading.ramp }
    }
}

impl LoadCase for Volume<'_> {
    fn excess(&self, _: f64) -> f64 {
        let mean = self.volume / area(self.model);
        let stretch = |_: &Face, radius: f64| stretch(height(PI * mean / radius));
        slow::periods(self.model, self.ramp, stretch) / (LONGER * slow::PERIODS)
    }

    fn damping(&self) -> f64 {
        2.0 * DECAYS / self.ramp
    }

    fn apply(&self, _: &[Film], _: &Nodes, loads: &mut Loads) -> Result<Vec<engine::Impact>, RunError> {
        loads.filling = Some(Filling { volume: self.volume / loads.multiplicity, ramp: self.ramp });
        Ok(vec![])
    }

    fn has_rise(&self) -> bool {
        true
    }

    /// Pressure, the largest rise of a node, and the volume under the film.
    fn signals(&self, tracks: &Tracks, _: &Mounting) -> Recording {
        let [pressure, rise, volume] =
            [column::PRESSURE, column::DEFLECTION, column::VOLUME].map(|column| tracks.sampled(&column));
        let rows: Vec<_> = (0..rise.len()).map(|k| [pressure[k], rise[k], volume[k]]).collect();
        tracks.table(&[column::PRESSURE.name, column::DEFLECTION.name, column::VOLUME.name], &rows)
    }
}

/// Area of the whole film, m²; NaN for an imported outline.
fn area(model: &Model) -> f64 {
    match &model.specimen.shape {
        Outline::Rectangle { x, y } => x * y,
        Outline::Circle { radius } => PI * radius * radius,
        Outline::Polygon(polygon) => polygon.area() * model.specimen.symmetry.copies(),
        Outline::Mesh { .. } => f64::NAN,
    }
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

    #[test]
    fn the_height_is_that_of_the_cap() {
        for h in [1e-3, 0.3, 1.0, 4.0] {
            let volume = PI * h * (3.0 + h * h) / 6.0;
            assert!((height(volume) / h - 1.0).abs() < 1e-10, "{h}");
        }
    }
}
