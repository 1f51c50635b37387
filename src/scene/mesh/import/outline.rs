//! Outlines from DXF and SVG.

use std::path::Path;

use nalgebra::Point2;

use super::drawing::{Drawing, DrawingFault};
use super::{dxf, svg};
use crate::mesh::Polygon;
use base::file;

/// Reads the bytes of a drawing.
type Reader = fn(&[u8]) -> Result<Drawing, DrawingFault>;

/// Longest file that is read, bytes.
const MOST_BYTES: u64 = 64 << 20;
/// Coordinates are whole numbers over this, 1/m: a power of two, 0.001 nm apart.
const ROUNDED: f64 = (1_u64 << 40) as f64;

/// The outline drawn in a DXF or SVG file, with the drawing's own unit, or `unit` (m) where it gives none. The largest
/// loop is the outline, the others are its holes.
///
/// # Errors
/// [`DrawingFault`].
pub fn polygon(path: &Path, unit: Option<f64>) -> Result<Polygon, DrawingFault> {
    let (read, by): (Reader, _) = match super::extension(path).as_str() {
        "dxf" => (dxf::read, "$INSUNITS"),
        "svg" => (svg::read, "width and height"),
        _ => return Err(DrawingFault::Format),
    };
    let drawing = read(&file::read(path, MOST_BYTES)?)?;
    let unit = match (drawing.unit, unit) {
        (Some(own), Some(given)) if (own / given - 1.0).abs() > 1e-9 => {
            return Err(DrawingFault::OtherUnit { drawing: own, by });
        }
        (own, given) => own.or(given).ok_or(DrawingFault::NoUnit { by })?,
    };
    let mut loops = drawing.loops()?;
    let area = |corners: &[Point2<f64>]| {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| a.coords.perp(&b.coords)).sum::<f64>().abs()
    };
    loops.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let mut loops =
        loops.into_iter().map(|corners| corners.iter().map(|p| [p.x, p.y].map(|c| rounded(c * unit))).collect());
    let outer = loops.next().ok_or(DrawingFault::Empty)?;
    Ok(Polygon { outer, holes: loops.collect() })
}

/// A coordinate without its last digits, in which the sines of machines differ: meshes of one drawing are the same.
fn rounded(coordinate: f64) -> f64 {
    (coordinate * ROUNDED).round() / ROUNDED
}
