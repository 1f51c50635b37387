//! Bars along a frame: all points within a radius of upright walls over straight lines.

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};
use parry3d_f64::math::Vector;

use super::convex::{Convex, Solid};
use super::projection::Projection;
use super::vector;
use crate::lane::{larger, smaller};

/// Thickness of the box in a bar over its radius, where the bar meets a body that is no ball: its crest is flat over
/// twice as much.
const FLAT: f64 = 1e-3;

/// Bars in the plane z = 0.
#[derive(Clone, Debug)]
pub(super) struct Bars {
    lines: Vec<Line>,
    /// m.
    radius: f64,
    /// Half the height of the walls, m; zero where bars are round.
    half_height: f64,
    /// Their convex pieces, one a line.
    pieces: Vec<Piece>,
}

/// The axis of a bar.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Its beginning, m.
    from: Vector2<f64>,
    /// Its direction.
    along: Vector2<f64>,
    /// m.
    length: f64,
}

/// A bar as a convex body.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// About its centre.
    pub(super) solid: Solid,
    pub(super) place: Isometry3<f64>,
    /// Radius of the sphere about its centre that holds it, m.
    pub(super) reach: f64,
}

impl Line {
    /// The vector from the point of the line nearest to `place` to it, m.
    #[inline(always)]
    fn offset(&self, place: &Vector2<f64>) -> Vector2<f64> {
        let arm = place - self.from;
        arm - self.along * larger(smaller(arm.dot(&self.along), self.length), 0.0)
    }

    /// Its end, m.
    fn to(&self) -> Vector2<f64> {
        self.from + self.along * self.length
    }
}

impl Bars {
    /// Bars of `radius` and walls of `half_height` (m) over straight `lines` from point to point.
    pub(super) fn new(lines: &[[[f64; 2]; 2]], radius: f64, half_height: f64) -> Bars {
        let line = |[from, to]: &[[f64; 2]; 2]| {
            let [from, to] = [Vector2::from(*from), Vector2::from(*to)];
            let length = (to - from).norm();
            Line { from, along: (to - from) / length, length }
        };
        let lines: Vec<Line> = lines.iter().map(line).collect();
        let flat = FLAT * radius;
        let piece = |line: &Line| {
            let half = 0.5 * line.length;
            let middle = line.from + line.along * half;
            let core = Convex::Cuboid { half: [half, flat, half_height.max(flat)] };
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), line.along.y.atan2(line.along.x));
            Piece {
                solid: Solid::rounded(core, Vector::ZERO, radius - flat),
                place: Isometry3::from_parts(Vector3::new(middle.x, middle.y, 0.0).into(), turn),
                reach: half + half_height + radius,
            }
        };
        let pieces = lines.iter().map(piece).collect();
        Bars { lines, radius, half_height, pieces }
    }

    /// m.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }

    /// All bars as convex bodies.
    pub(super) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Volume of all bars, without what is round at their ends, m³.
    pub(super) fn volume(&self) -> f64 {
        let section = PI * self.radius * self.radius + 4.0 * self.radius * self.half_height;
        section * self.lines.iter().map(|line| line.length).sum::<f64>()
    }

    /// The vectors to `place` (m, body axes) from the nearest point of the wall of each bar.
    fn offsets(&self, place: &Vector3<f64>) -> impl Iterator<Item = Vector3<f64>> + use<'_> {
        let (flat, up) = (place.xy(), place.z - place.z.clamp(-self.half_height, self.half_height));
        self.lines.iter().map(move |line| {
            let offset = line.offset(&flat);
            Vector3::new(offset.x, offset.y, up)
        })
    }

    /// The vector to `place` (m, body axes) from the nearest point of all walls, the first of several.
    #[inline]
    pub(super) fn offset(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let flat = place.xy();
        let (mut least, mut nearest) = (f64::INFINITY, Vector2::from_element(f64::INFINITY));
        for line in &self.lines {
            let offset = line.offset(&flat);
            // Compared in the plane, since all bars have the same height: one root for the nearest instead of one a
            // bar.
            let squared = offset.x * offset.x + offset.y * offset.y;
            if squared < least {
                (least, nearest) = (squared, offset);
            }
        }
        Vector3::new(nearest.x, nearest.y, place.z - larger(smaller(place.z, self.half_height), -self.half_height))
    }

    /// Signed distances and outward normals of the point at `arm` (m) from the origin of the bars at `pose`, from each.
    pub(super) fn project_on_each(
        &self,
        pose: &Isometry3<f64>,
        arm: &Vector3<f64>,
    ) -> impl Iterator<Item = Projection> {
        let offsets = self.offsets(&pose.rotation.inverse_transform_vector(arm));
        offsets.map(|offset| self.projection(pose, &offset))
    }

    /// Signed distance and outward normal from the nearest of the bars.
    pub(super) fn project(&self, pose: &Isometry3<f64>, arm: &Vector3<f64>) -> Projection {
        self.projection(pose, &self.offset(&pose.rotation.inverse_transform_vector(arm)))
    }

    #[inline]
    fn projection(&self, pose: &Isometry3<f64>, offset: &Vector3<f64>) -> Projection {
        let length = offset.norm();
        let normal = if length > 0.0 { pose.rotation * (offset / length) } else { pose.rotation * Vector3::z() };
        Projection { distance: length - self.radius, normal }
    }

    /// The point nearest to the walls of the bars of the points of a convex set, from `start` in it, by projections
    /// onto the walls and onto the set in turn (all in body axes). Across a bar one turn is exact where the set is
    /// flat.
    pub(super) fn nearest(&self, start: Vector, onto_set: impl Fn(Vector) -> Vector) -> Vector {
        const TURNS: usize = 8;
        const STILL: f64 = 1e-4;
        let mut point = start;
        for _ in 0..TURNS {
            let place = Vector3::new(point.x, point.y, point.z);
            let next = onto_set(point - vector(&self.offset(&place)));
            let moved = (next - point).length_squared();
            point = next;
            // An error in the place along a bar changes the distance in second order only.
            if moved <= STILL * STILL * self.radius * self.radius {
                break;
            }
        }
        point
    }

    /// How far it reaches along the unit vector `direction`, m.
    pub(super) fn reach(&self, direction: &Vector3<f64>) -> f64 {
        let along = direction.xy();
        let of_line = |line: &Line| line.from.dot(&along).max(line.to().dot(&along));
        let flat = self.lines.iter().map(of_line).fold(f64::NEG_INFINITY, f64::max);
        flat + self.half_height * direction.z.abs() + self.radius
    }

    /// Radius of a sphere about the origin that holds all bars, m.
    pub(super) fn bounding_radius(&self) -> f64 {
        let extent = |line: &Line| line.from.norm().max(line.to().norm());
        self.lines.iter().map(extent).fold(0.0, f64::max) + self.half_height + self.radius
    }

    /// Points of the surface of each bar around the section at both of its ends, for pictures: `sides` points each.
    pub(super) fn sections(&self, sides: u32) -> Vec<[Vec<Vector3<f64>>; 2]> {
        let around = |centre: Vector2<f64>, across: Vector2<f64>| -> Vec<Vector3<f64>> {
            let point = |k: u32| {
                let (sin, cos) = (TAU * (f64::from(k) + 0.5) / f64::from(sides)).sin_cos();
                let flat = centre + across * (self.radius * cos);
                Vector3::new(flat.x, flat.y, self.radius * sin + self.half_height * sin.signum())
            };
            (0..sides).map(point).collect()
        };
        let of_line = |line: &Line| {
            let across = Vector2::new(line.along.y, -line.along.x);
            [around(line.from, across), around(line.to(), across)]
        };
        self.lines.iter().map(of_line).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::contact::surface::Surface;

    /// Four bars around a rectangle: round in section and at the corners, with a flat wall where they are high.
    #[test]
    fn straight_bars_are_round_about_their_lines() {
        let corners = [[0.2, 0.1], [-0.2, 0.1], [-0.2, -0.1], [0.2, -0.1]];
        let lines: Vec<[[f64; 2]; 2]> = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
        for (half_height, point, expected) in [
            (0.0, [0.0, 0.08, 0.0], 0.01),
            (0.0, [0.0, 0.094, 0.008], 0.0),
            (0.0, [0.203, 0.104, 0.0], -0.005),
            (0.0, [0.0, 0.0, 0.0], 0.09),
            (0.005, [0.197, 0.01, 0.009], -0.005),
            (0.005, [0.19, 0.01, 0.003], 0.0),
            (0.005, [0.19, 0.0, -0.005], 0.0),
        ] {
            let surface = Surface::bars(&lines, 0.01, half_height).unwrap();
            let found = surface.project(&Isometry3::identity(), &point.into());
            assert!((found.distance - expected).abs() < 1e-15, "{found:?} {expected}");
            assert_eq!(surface.size(), 0.01);
        }
    }

    /// A triangle that spans the corner of a rectangle, one along a bar and one across it, against a fine search.
    #[test]
    fn the_deepest_point_on_bars_is_the_nearest_to_their_lines() {
        let corners = [[0.2, 0.1], [-0.2, 0.1], [-0.2, -0.1], [0.2, -0.1]];
        let lines: Vec<[[f64; 2]; 2]> = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
        let frames = [0.0, 0.004].map(|half_height| Surface::bars(&lines, 0.01, half_height).unwrap());
        let pose = Isometry3::translation(0.0, 0.0, -0.01);
        for surface in &frames {
            for [a, b, c, d] in [
                [[0.2, 0.01, 0.0], [0.2, 0.02, 0.0], [0.188, 0.02, -0.012], [0.188, 0.01, -0.012]],
                [[0.192, 0.05, -0.002], [0.192, 0.06, -0.003], [0.16, 0.06, -0.012], [0.16, 0.05, -0.011]],
                [[-0.05, 0.193, 0.0], [0.05, 0.197, 0.0], [0.04, 0.189, -0.004], [-0.04, 0.189, -0.004]],
            ] {
                let corners = [a, b, c, d].map(nalgebra::Point3::from);
                let found = surface.deepest_point(&pose, &corners, f64::INFINITY, f64::INFINITY);
                let Some(found) = found else { panic!("none") };
                let mean = (corners[0].coords + corners[1].coords + corners[2].coords + corners[3].coords) * 0.25;
                let mut least = f64::INFINITY;
                let parts = 200;
                for a in 0..4 {
                    let (p, q) = (corners[a].coords, corners[(a + 1) % 4].coords);
                    for i in 0..=parts {
                        for j in 0..=parts - i {
                            let (u, v) = (f64::from(i) / f64::from(parts), f64::from(j) / f64::from(parts));
                            let point = mean + (p - mean) * u + (q - mean) * v;
                            least = least.min(surface.project(&pose, &point.into()).distance);
                        }
                    }
                }
                let distance = found.projection.distance;
                assert!(distance - least < 2e-5 && least - distance < 1e-4, "{distance} {least}");
                assert!(surface.penetration_bound(&pose, &corners) >= -distance - 1e-12);
            }
        }
    }
}
