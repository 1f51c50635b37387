//! The film's outline and its mirror planes.

use std::f64::consts::FRAC_PI_2;

use super::{ModelDiagnostics, Specimen, Symmetry};
use crate::mesh::import::{self, DrawingFault};
use crate::mesh::{Outline, Polygon};
use crate::scenario;
use base::diagnostic::shown_path;
use base::units::Length;

/// The specimen in SI values; none where the file of its mesh is missing.
pub fn check(specimen: &scenario::Specimen, mistakes: &mut ModelDiagnostics<'_>) -> Option<Specimen> {
    let shape = match &specimen.shape {
        scenario::Shape::Rectangle([x, y]) => Outline::Rectangle { x: x.0, y: y.0 },
        scenario::Shape::Circle(circle) => Outline::Circle { radius: circle.radius() },
        scenario::Shape::Polygon(written) => Outline::Polygon(polygon(written, symmetry(specimen), mistakes)?),
        scenario::Shape::Mesh(file) => {
            let (path, scale) = mistakes.mesh("specimen.shape.mesh", file)?;
            Outline::Mesh { path, scale }
        }
    };
    let cuts = specimen.cuts.iter().map(|cut| cut.iter().map(|point| point.map(|length| length.0)).collect()).collect();
    let (symmetry, damping) = (symmetry(specimen), specimen.damping.0);
    Some(Specimen { shape, symmetry, damping, cuts })
}

/// The outline with its holes, from corners or a drawing.
fn polygon(written: &scenario::Polygon, symmetry: Symmetry, mistakes: &mut ModelDiagnostics<'_>) -> Option<Polygon> {
    const KEY: &str = "specimen.shape.polygon";
    let key = |name: &str| format!("{KEY}.{name}");
    let (path, polygon) = match (&written.file, &written.points) {
        // Neither or both are a mistake that was reported when they were read.
        (None, None) | (Some(_), Some(_)) => return None,
        (None, Some(points)) => {
            if written.unit.is_some() && !mistakes.is_inherited(&key("unit")) {
                mistakes.out_of_place(&key("unit"), "corners have their own units");
            }
            let holes = written.holes.iter().map(|hole| corners(hole)).collect();
            (key("points"), Polygon { outer: corners(points), holes })
        }
        (Some(_), None) => {
            // Those of inherited corners go with them.
            if !written.holes.is_empty() && !mistakes.is_inherited(&key("holes")) {
                mistakes.out_of_place(&key("holes"), "`file` gives the holes");
            }
            let path = key("file");
            let file = mistakes.file(&path)?;
            match import::polygon(&file, written.unit.map(scenario::MeshUnit::metres)) {
                Ok(polygon) => (path, polygon),
                Err(fault) => {
                    let message = format!("{}: {fault}", shown_path(&file));
                    match fault {
                        DrawingFault::NoUnit { .. } => mistakes.report_with(&path, message, "give it: `unit = \"mm\"`"),
                        DrawingFault::OtherUnit { .. } => {
                            mistakes.report_with(&key("unit"), message, "leave `unit` out, or correct the drawing");
                        }
                        _ => mistakes.report(&path, message),
                    }
                    return None;
                }
            }
        }
    };
    match polygon.check(symmetry.mirrors()) {
        Ok(()) => Some(polygon),
        Err(fault) => {
            let of_hole = fault.hole().filter(|_| written.file.is_none());
            mistakes.report(&of_hole.map_or(path, |hole| key(&format!("holes.{hole}"))), fault.to_string());
            None
        }
    }
}

/// The corners of a loop, m; without a last one that repeats the first.
fn corners(points: &[[Length; 2]]) -> Vec<[f64; 2]> {
    let mut corners: Vec<[f64; 2]> = points.iter().map(|point| point.map(|length| length.0)).collect();
    if corners.len() > 3 && corners.first() == corners.last() {
        corners.pop();
    }
    corners
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
