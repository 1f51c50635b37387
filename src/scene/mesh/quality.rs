//! Quality of a mesh: sizes and shapes of its elements.

use std::f64::consts::FRAC_PI_2;
use std::f64::consts::FRAC_PI_3;
use std::fmt;

use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::Mesh;
use super::topology::outlines;

/// Extremes over the elements of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Number of elements.
    pub elements: usize,
    /// Shortest and longest edge, m.
    pub edges: [f64; 2],
    /// Smallest and largest area of an element, m².
    pub areas: [f64; 2],
    /// Area of all elements, m².
    pub area: f64,
    /// Largest ratio of the longest to the shortest edge of an element.
    pub aspect: f64,
    /// Smallest scaled Jacobian: 1 for squares and equilateral triangles, 0 or less where inverted.
    pub jacobian: f64,
    /// Largest equiangle skew: 0 for squares and equilateral triangles, 1 where degenerate.
    pub skew: f64,
}

impl Quality {
    /// Measures every element of `mesh`.
    pub fn from_mesh(mesh: &Mesh) -> Quality {
        let none = Quality {
            elements: 0,
            edges: [f64::INFINITY, 0.0],
            areas: [f64::INFINITY, 0.0],
            area: 0.0,
            aspect: 1.0,
            jacobian: 1.0,
            skew: 0.0,
        };
        let corner = |node: &u32| mesh.nodes[*node as usize];
        outlines(mesh)
            .map(|corners| corners.iter().map(corner).collect::<Vec<_>>())
            .fold(none, |quality, points| quality.with(&points))
    }

    fn with(self, points: &[Point3<f64>]) -> Quality {
        let edges = edge_range(points);
        let area = area_vector(points).norm();
        let wider = |[low, high]: [f64; 2], [a, b]: [f64; 2]| [low.min(a), high.max(b)];
        Quality {
            elements: self.elements + 1,
            edges: wider(self.edges, edges),
            areas: wider(self.areas, [area, area]),
            area: self.area + area,
            aspect: self.aspect.max(edges[1] / edges[0]),
            jacobian: self.jacobian.min(scaled_jacobian(points)),
            skew: self.skew.max(skew(points)),
        }
    }
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [shortest, longest] = self.edges.map(|edge| edge * 1e3);
        write!(
            f,
            "{} elements, edges {shortest:.3} to {longest:.3} mm, aspect ratio up to {:.2}, \
             scaled Jacobian from {:.2}, skew up to {:.2}, area {:.6} m2",
            self.elements, self.aspect, self.jacobian, self.skew, self.area
        )
    }
}

/// Normal of an element, as long as its area (m²); for a twisted one that of its mean plane.
pub fn area_vector(points: &[Point3<f64>]) -> Vector3<f64> {
    // The sum does not depend on the corner that the fan starts from, as the fan of a twisted element itself does.
    let origin = points[0];
    let fan = points.windows(2).map(|w| (w[0] - origin).cross(&(w[1] - origin)));
    fan.sum::<Vector3<f64>>() / 2.0
}

/// Shortest and longest edge, m.
pub fn edge_range(points: &[Point3<f64>]) -> [f64; 2] {
    corners(points)
        .map(|[_, here, next]| (next - here).norm())
        .fold([f64::INFINITY, 0.0], |[low, high], edge| [low.min(edge), high.max(edge)])
}

/// Smallest sine of a corner's angle, signed by the element's normal and scaled so that the regular
/// element has 1.
pub fn scaled_jacobian(points: &[Point3<f64>]) -> f64 {
    let normal = area_vector(points).normalize();
    let sine = |[before, here, next]: [Point3<f64>; 3]| {
        // Of unit vectors, so that only the angle counts; by the sign a re-entrant corner is worse than any other.
        let (out, back) = ((next - here).normalize(), (before - here).normalize());
        out.cross(&back).dot(&normal)
    };
    let smallest = corners(points).map(sine).fold(f64::INFINITY, f64::min);
    smallest / regular_angle(points).sin()
}

/// How far the angles are from those of the regular element, 0 to 1.
fn skew(points: &[Point3<f64>]) -> f64 {
    let regular = regular_angle(points);
    let angle = |[before, here, next]: [Point3<f64>; 3]| (next - here).angle(&(before - here));
    corners(points)
        .map(angle)
        .map(|angle| {
            let wide = (angle - regular) / (std::f64::consts::PI - regular);
            wide.max((regular - angle) / regular)
        })
        .fold(0.0, f64::max)
}

fn regular_angle(points: &[Point3<f64>]) -> f64 {
    if points.len() == 3 { FRAC_PI_3 } else { FRAC_PI_2 }
}

/// Each corner between the one before and the one after it.
fn corners(points: &[Point3<f64>]) -> impl Iterator<Item = [Point3<f64>; 3]> + '_ {
    let n = points.len();
    (0..n).map(move |i| [points[(i + n - 1) % n], points[i], points[(i + 1) % n]])
}
