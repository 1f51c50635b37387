//! Element sizes that grow with the distance from a place.

use std::f64::consts::PI;

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use super::{MeshError, grid};

/// Sizes of the elements of a graded mesh: `fine` within the zones, growing beyond them up to the size of the meshing
/// (theory.md, equation 200). Lengths in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grading {
    /// Edge length within the zones.
    pub fine: f64,
    /// Growth of the edge length per distance from the nearest zone.
    pub growth: f64,
    /// Where elements are fine.
    pub zones: Vec<Zone>,
}

/// A circle in which elements are fine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Zone {
    /// Its centre, x and y.
    pub at: [f64; 2],
    /// Its radius.
    pub within: f64,
}

impl Grading {
    /// Edge length at a distance from the edge of the nearest zone, of elements of at most `size`.
    pub(crate) fn size_at(&self, distance: f64, size: f64) -> f64 {
        size.min(self.fine + self.growth * distance.max(0.0))
    }

    /// Distance of a point from the edge of the nearest zone, m; negative within it.
    pub(crate) fn distance(&self, point: Point2<f64>) -> f64 {
        let from = |zone: &Zone| (point - Point2::from(zone.at)).norm() - zone.within;
        self.zones.iter().map(from).fold(f64::INFINITY, f64::min)
    }

    /// Refuses sizes that are not positive, and meshes of an outline of these `lengths` and this `area` (m, m²) whose
    /// nodes cannot be numbered.
    pub(crate) fn check(&self, lengths: [f64; 2], area: f64, size: f64) -> Result<(), MeshError> {
        if !(self.growth.is_finite() && self.growth > 0.0) {
            return Err(MeshError::Growth { growth: self.growth });
        }
        grid::check(lengths, size, 0)?;
        grid::check(lengths, self.fine, self.cells(area, size) as usize)
    }

    /// Squares of these sizes that fill a plane figure of `area` (m²), at most: a zone may lie beside it.
    pub fn cells(&self, area: f64, size: f64) -> f64 {
        let Grading { fine, growth, .. } = *self;
        // Integral of 2πr (1/h² - 1/size²) from the edge of the zone to where h is the size.
        let (reach, ratio) = ((size - fine) / growth, size / fine);
        let of_zone = |zone: &Zone| {
            let r = zone.within;
            let inside = PI * r * r / (fine * fine);
            let ring = 2.0 * PI / growth * ((r - fine / growth) * (1.0 / fine - 1.0 / size) + ratio.ln() / growth);
            let replaced = PI * (r + reach).powi(2) / (size * size);
            inside + ring - replaced
        };
        (area / (size * size) + self.zones.iter().map(of_zone).sum::<f64>()).min(area / (fine * fine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_cells_is_the_integral_of_their_density() {
        let grading = Grading { fine: 0.5, growth: 0.2, zones: vec![Zone { at: [0.0; 2], within: 10.0 }] };
        let (rim, size, rings) = (60.0, 4.0, 60_000);
        let width = rim / f64::from(rings);
        let summed: f64 = (0..rings)
            .map(|ring| (f64::from(ring) + 0.5) * width)
            .map(|r| 2.0 * PI * r * width / grading.size_at(r - 10.0, size).powi(2))
            .sum();
        let closed = grading.cells(PI * rim * rim, size);
        assert!((closed / summed - 1.0).abs() < 1e-4, "{closed} against {summed}");
    }
}
