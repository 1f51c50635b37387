//! The surface of a body as triangles.

use std::f64::consts::PI;

use super::Shape;

/// Triangles around a body.
const SIDES: usize = 96;

/// Share of the radius by which the mesh of a body is smaller where a penalty needs room.
const INSET: f64 = 0.01;

/// Points (m) and triangles, oriented outwards.
pub(super) struct Triangles {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) corners: Vec<[usize; 3]>,
}

impl Shape {
    /// Radius of its round parts, m.
    pub(super) fn radius(self) -> f64 {
        match self {
            Shape::Sphere { radius } | Shape::Capsule { radius, .. } => radius,
        }
    }

    /// How far a mesh lies below it where a penalty needs room, m.
    pub(super) fn inset(self) -> f64 {
        INSET * self.radius()
    }

    /// Largest distance of facets below it, m.
    pub(super) fn facet_depth(self) -> f64 {
        // Along the diagonal of a facet at the equator.
        self.radius() * (1.0 - (PI / SIDES as f64).cos().powi(2))
    }

    /// Its triangles, smaller by `inset` (m) along its normals, about its centre.
    pub(super) fn triangles(self, inset: f64) -> Triangles {
        let radius = self.radius() - inset;
        let half = match self {
            Shape::Sphere { .. } => 0.0,
            Shape::Capsule { length, .. } => 0.5 * length,
        };
        // Rings from the lower pole to the upper one; the shaft of a capsule lies between two of them.
        let quarter = SIDES / 4;
        let angle = |ring: usize| 0.5 * PI * (ring as f64 / quarter as f64 - 1.0);
        let lower = (1..=quarter).map(|ring| (angle(ring), -half));
        let upper = (quarter..2 * quarter).map(|ring| (angle(ring), half));
        let rings: Vec<(f64, f64)> = lower.chain(upper.skip(usize::from(half == 0.0))).collect();
        let mut points = vec![[0.0, 0.0, -half - radius]];
        for (latitude, middle) in &rings {
            points.extend((0..SIDES).map(|side| {
                let longitude = 2.0 * PI * side as f64 / SIDES as f64;
                let out = latitude.cos();
                let [x, y, z] = [out * longitude.cos(), out * longitude.sin(), latitude.sin()].map(without_round_off);
                [radius * x, radius * y, middle + radius * z]
            }));
        }
        let top = points.len();
        points.push([0.0, 0.0, half + radius]);
        let at = |ring: usize, side: usize| 1 + ring * SIDES + side % SIDES;
        let mut corners = vec![];
        for side in 0..SIDES {
            corners.push([0, at(0, side + 1), at(0, side)]);
            for ring in 1..rings.len() {
                let [a, b, c, d] = [at(ring - 1, side), at(ring - 1, side + 1), at(ring, side + 1), at(ring, side)];
                corners.extend([[a, b, c], [a, c, d]]);
            }
            corners.push([at(rings.len() - 1, side), at(rings.len() - 1, side + 1), top]);
        }
        Triangles { points, corners }
    }
}

impl Triangles {
    /// m².
    pub(super) fn area(&self) -> f64 {
        self.corners.iter().map(|corners| 0.5 * length(self.normal(corners))).sum()
    }

    /// Twice the area of a triangle, along its normal.
    fn normal(&self, corners: &[usize; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| self.points[corner]);
        let ([u, v, w], [x, y, z]) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        [v * z - w * y, w * x - u * z, u * y - v * x]
    }
}

/// A component of a unit vector, exactly zero where it is round-off.
fn without_round_off(component: f64) -> f64 {
    if component.abs() < 1e-15 { 0.0 } else { component }
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|v| v * v).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Area and volume of sphere and capsule, and a closed surface: each edge belongs to two triangles that pass it in
    /// opposite directions.
    #[test]
    fn bodies_are_closed_and_face_outwards() {
        for (shape, area, volume) in [
            (Shape::Sphere { radius: 0.12 }, 4.0 * PI * 0.0144, 4.0 / 3.0 * PI * 0.12_f64.powi(3)),
            (
                Shape::Capsule { radius: 0.02, length: 0.1 },
                4.0 * PI * 0.0004 + 2.0 * PI * 0.002,
                4.0 / 3.0 * PI * 8e-6 + PI * 4e-5,
            ),
        ] {
            let found = shape.triangles(0.0);
            let of_corners = |corners: &[usize; 3]| {
                let (normal, point) = (found.normal(corners), found.points[corners[0]]);
                (0..3).map(|axis| normal[axis] * point[axis]).sum::<f64>() / 6.0
            };
            let inside: f64 = found.corners.iter().map(of_corners).sum();
            assert!((found.area() / area - 1.0).abs() < 2e-3, "{} and {area}", found.area());
            assert!((inside / volume - 1.0).abs() < 3e-3, "{} and {volume}", inside);
            let edges: std::collections::HashSet<[usize; 2]> =
                found.corners.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            assert_eq!(edges.len(), 3 * found.corners.len());
            assert!(edges.iter().all(|[a, b]| edges.contains(&[*b, *a])));
        }
    }
}
