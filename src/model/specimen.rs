//! The film's outline and its mirror planes.

use std::f64::consts::FRAC_PI_2;

use super::{Mistakes, Specimen, Symmetry};
use crate::mesh::Outline;
use crate::scenario;

/// The specimen in SI values; none where the file of its mesh is missing.
pub fn check(written: &scenario::Specimen, mistakes: &mut Mistakes<'_>) -> Option<Specimen> {
    let shape = match &written.shape {
        scenario::Shape::Rectangle([x, y]) => Outline::Rectangle { x: x.0, y: y.0 },
        scenario::Shape::Circle(circle) => Outline::Circle { radius: circle.radius.0 },
        scenario::Shape::Mesh(_) => Outline::Mesh(mistakes.file("specimen.shape.mesh")?),
    };
    Some(Specimen { shape, symmetry: symmetry(written), damping: written.damping.0 })
}

/// The mirror planes.
pub fn symmetry(written: &scenario::Specimen) -> Symmetry {
    match written.symmetry {
        scenario::Symmetry::None => Symmetry::None,
        scenario::Symmetry::HalfX => Symmetry::HalfX,
        scenario::Symmetry::HalfY => Symmetry::HalfY,
        scenario::Symmetry::Quarter => Symmetry::Quarter,
    }
}

impl Symmetry {
    /// Whether x = 0 and y = 0 are mirror planes.
    pub fn mirrors(self) -> [bool; 2] {
        [matches!(self, Symmetry::HalfX | Symmetry::Quarter), matches!(self, Symmetry::HalfY | Symmetry::Quarter)]
    }

    /// How many copies of the computed part the whole is made of.
    pub fn copies(self) -> f64 {
        self.mirrors().iter().map(|mirror| if *mirror { 2.0 } else { 1.0 }).product()
    }
}

/// Whether fibres at this angle lie along the axes, so that a mirror plane leaves them as they are.
pub fn is_along_axes(angle: f64) -> bool {
    let quarters = angle / FRAC_PI_2;
    (quarters - quarters.round()).abs() < 1e-9
}
