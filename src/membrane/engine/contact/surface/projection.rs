//! Projection of points onto the surface.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Capsule;

use super::{Part, Shape, Surface, vector};
use crate::lane::{Lane, Lane3, Mask, dot, larger, smaller, splat};

/// Projection of a point onto the surface.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine::contact) struct Projection {
    /// Signed distance of the point, negative inside, m.
    pub(in crate::engine::contact) distance: f64,
    /// Outward unit normal.
    pub(in crate::engine::contact) normal: Vector3<f64>,
}

impl Projection {
    /// Of a point of which nothing is known.
    pub(in crate::engine::contact) const UNKNOWN: Projection =
        Projection { distance: f64::NEG_INFINITY, normal: Vector3::new(0.0, 0.0, 0.0) };

    /// This projection with its normal turned as `pose` is.
    pub(super) fn turned(self, pose: &Isometry3<f64>) -> Projection {
        Projection { normal: pose.rotation * self.normal, ..self }
    }
}

impl Surface {
    /// Projection of `point` onto the body at `pose`.
    #[inline(always)]
    pub(in crate::engine::contact) fn project(&self, pose: &Isometry3<f64>, point: &Point3<f64>) -> Projection {
        self.shape.project(pose, &(point.coords - pose.translation.vector))
    }

    /// Signed distances and outward normals of points at `arm` (m) from the centre of mass of the body at `pose`, as of
    /// [`Surface::project`]; undefined where they are not `close`. For balls and capsules parry's projection is written out
    /// for all lanes at once.
    #[inline(always)]
    pub(in crate::engine::contact) fn project_lanes(
        &self,
        pose: &Isometry3<f64>,
        arm: &Lane3,
        close: Mask,
    ) -> (Lane, Lane3) {
        let (mut distance, mut normal): (Lane, Lane3) = (splat(0.0), Lane3::ZERO);
        match &self.shape {
            Shape::Ball(ball) => {
                let squared = dot(arm, arm);
                let length = squared.sqrt();
                distance = length - ball.radius;
                // One division a lane instead of three; at the centre, where it is infinite, the normal is set instead.
                normal = (1.0 / length) * *arm;
                for axis in 0..3 {
                    normal[axis] = squared.above(0.0).select(normal[axis], NORMAL_AT_CENTRE[axis]);
                }
            }
            Shape::Capsule(capsule) => {
                let (axis, lateral) = (Lane3::splat(pose.rotation * Vector3::z()), pose.rotation * Vector3::x());
                let place = dot(arm, &axis).max(capsule.segment.a.z).min(capsule.segment.b.z);
                let radial = *arm - place * axis;
                let length = dot(&radial, &radial).sqrt();
                distance = length - capsule.radius;
                for k in 0..3 {
                    normal[k] = length.above(0.0).select(radial[k] / length, lateral[k]);
                }
            }
            Shape::Solid(_) | Shape::Compound(_) | Shape::Bars(_) => {
                for l in close.lanes() {
                    let projection = self.shape.project(pose, &arm.vector(l));
                    distance[l] = projection.distance;
                    normal.set(l, &projection.normal);
                }
            }
        }
        (distance, normal)
    }
}

impl Shape {
    /// Signed distance and outward normal of the point at `arm` (m) from the centre of the shape at `pose`.
    #[inline(always)]
    pub(super) fn project(&self, pose: &Isometry3<f64>, arm: &Vector3<f64>) -> Projection {
        match self {
            // The projection onto a ball needs no rotation, and the projected point over the radius is the normal.
            Shape::Ball(ball) => {
                let point = ball.project_local_point(vector(arm), false).point * (1.0 / ball.radius);
                let is_centre = arm.norm_squared() == 0.0;
                let normal = if is_centre { NORMAL_AT_CENTRE.into() } else { Vector3::new(point.x, point.y, point.z) };
                Projection { distance: arm.dot(&normal) - ball.radius, normal }
            }
            Shape::Capsule(capsule) => {
                let axis = pose.rotation * Vector3::z();
                let radial = arm - axis * nearest_on_axis(capsule, arm.dot(&axis));
                let length = radial.norm();
                let normal = if length > 0.0 { radial / length } else { pose.rotation * Vector3::x() };
                Projection { distance: length - capsule.radius, normal }
            }
            Shape::Solid(solid) => solid.project(pose, arm),
            Shape::Compound(parts) => project_on_parts(parts, pose, arm),
            Shape::Bars(bars) => bars.project(pose, arm),
        }
    }
}

/// Projection onto the nearest of several parts.
fn project_on_parts(parts: &[Part], pose: &Isometry3<f64>, arm: &Vector3<f64>) -> Projection {
    let onto = |Part { place, shape, .. }: &Part| {
        let offset = pose.rotation * place.translation.vector;
        shape.project(&Isometry3::from_parts(offset.into(), pose.rotation * place.rotation), &(arm - offset))
    };
    let nearest = parts.iter().map(onto).min_by(|a, b| a.distance.total_cmp(&b.distance));
    nearest.unwrap_or(Projection { distance: f64::INFINITY, normal: Vector3::z() })
}

/// Normal of a ball at its centre, where it is not unique.
const NORMAL_AT_CENTRE: [f64; 3] = [0.0, 1.0, 0.0];

/// Coordinate of the point of a capsule's axis nearest to a point whose coordinate along it is `z`, m.
#[inline(always)]
pub(super) fn nearest_on_axis(capsule: &Capsule, z: f64) -> f64 {
    smaller(larger(z, capsule.segment.a.z), capsule.segment.b.z)
}

#[cfg(test)]
mod tests {
    use parry3d_f64::math::Vector;
    use parry3d_f64::query::PointProjection;

    use super::*;
    use crate::engine::contact::surface::convex_tests::test_shapes;
    use crate::lane::{LANES, lanes};

    /// A box with edges of the radius e: the distance from a box that is smaller by e on every side, less e.
    #[test]
    fn rounded_edges_have_their_radius() {
        let (half, edge) = (Vector3::new(0.05, 0.04, 0.06), 0.01);
        let surface = Surface::cuboid([0.1, 0.08, 0.12], edge).unwrap();
        for point in [[0.07, 0.01, 0.0], [0.06, 0.055, 0.0], [0.048, 0.038, 0.058], [-0.06, 0.05, -0.07]] {
            let point = Point3::from(point);
            let beyond = (point.coords.abs() - half.map(|x| x - edge)).map(|x| x.max(0.0));
            let found = surface.project(&Isometry3::identity(), &point).distance;
            assert!((found - (beyond.norm() - edge)).abs() < 1e-14, "{found} at {point}");
        }
    }

    #[test]
    fn distance_and_normal_below_the_tip() {
        for surface in test_shapes() {
            let pose = Isometry3::translation(0.1, -0.2, 0.5);
            for depth in [-0.003, 0.003, 0.02] {
                let point = Point3::new(0.1, -0.2, 0.5 + surface.lowest(&pose.rotation) - depth);
                let projection = surface.project(&pose, &point);
                assert!((projection.distance - depth).abs() < 1e-12, "{} for {depth}", projection.distance);
                assert!((projection.normal + Vector3::z()).norm() < 1e-9);
            }
        }
    }

    /// Where the nearest point of the surface is not unique.
    #[test]
    fn a_point_on_the_axis_has_a_normal() {
        for surface in &test_shapes()[..3] {
            let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::zeros());
            for height in [0.0, 0.5, -1.0].map(|share| share * (surface.size() + surface.lowest(&pose.rotation))) {
                let arm = Vector3::new(0.0, 0.0, height);
                let (distance, normal) = surface.project_lanes(&pose, &Lane3::splat(arm), Mask::first(LANES));
                let lanes = Projection { distance: distance[0], normal: normal.vector(0) };
                for projection in [lanes, surface.project(&pose, &(pose.translation.vector + arm).into())] {
                    assert!((projection.distance + surface.size()).abs() < 1e-12, "{projection:?}");
                    assert!((projection.normal.norm() - 1.0).abs() < 1e-12, "{projection:?}");
                }
            }
        }
    }

    /// Signed distance and outward normal from a projection of parry.
    fn signed(point: Vector, projection: PointProjection, pose: &Isometry3<f64>) -> Projection {
        let arm = point - projection.point;
        let side = if projection.is_inside { -1.0 } else { 1.0 };
        let normal = arm * (side / arm.length());
        let normal = pose.rotation * Vector3::new(normal.x, normal.y, normal.z);
        Projection { distance: side * arm.length(), normal }
    }

    #[test]
    fn lanes_agree_with_the_projection_of_parry() {
        for surface in test_shapes() {
            let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::new(0.3, 0.2, -0.1));
            let arm: Lane3 =
                Lane3([0.6, -0.5, -0.9].map(|part| lanes(|l| surface.size() * (0.3 + 0.11 * l as f64) * part)));
            let (distance, normal) = surface.project_lanes(&pose, &arm, Mask::first(LANES));
            for l in 0..LANES {
                let arm = arm.vector(l);
                let local = vector(&pose.rotation.inverse_transform_vector(&arm));
                let reference = match &surface.shape {
                    Shape::Ball(ball) => signed(local, ball.project_local_point(local, false), &pose),
                    Shape::Capsule(capsule) => signed(local, capsule.project_local_point(local, false), &pose),
                    other => other.project(&pose, &arm),
                };
                let lanes = Projection { distance: distance[l], normal: normal.vector(l) };
                for projection in [lanes, surface.project(&pose, &(pose.translation.vector + arm).into())] {
                    let difference = projection.normal - reference.normal;
                    assert!(
                        (projection.distance - reference.distance).abs() < 1e-15 && difference.norm() < 1e-13,
                        "lane {l}: {projection:?}"
                    );
                }
            }
        }
    }
}
