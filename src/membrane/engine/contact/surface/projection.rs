//! Projection of points onto the surface.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::Vector;
use parry3d_f64::query::{PointProjection, PointQuery};
use parry3d_f64::shape::{self, Capsule};

use super::{Shape, Surface, vector};
use crate::lane::{LANES, Lane, Lane3, dot, larger, smaller, splat};

/// Projection of a point onto the surface.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine::contact) struct Projection {
    /// Signed distance of the point, negative inside, m.
    pub(in crate::engine::contact) distance: f64,
    /// Outward unit normal.
    pub(in crate::engine::contact) normal: Vector3<f64>,
}

impl Surface {
    /// Projection of `point` onto the body at `pose`.
    #[inline(always)]
    pub(in crate::engine::contact) fn project(&self, pose: &Isometry3<f64>, point: &Point3<f64>) -> Projection {
        let arm = point.coords - pose.translation.vector;
        match &self.shape {
            // The projection onto a ball needs no rotation, and the projected point over the radius is the normal.
            Shape::Ball(ball) => {
                let point = ball.project_local_point(vector(&arm), false).point * self.curvature;
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
            Shape::Other(shape) => project_on_shape(&**shape, pose, &arm),
        }
    }

    /// Signed distances and outward normals of points at `arm` (m) from the centre of mass of the body at `pose`, as of
    /// [`Surface::project`]; undefined where `close` is zero. For balls and capsules parry's projection is written out
    /// for all lanes at once.
    #[inline(always)]
    pub(in crate::engine::contact) fn project_lanes(
        &self,
        pose: &Isometry3<f64>,
        arm: &Lane3,
        close: &Lane,
    ) -> (Lane, Lane3) {
        let (mut distance, mut normal): (Lane, Lane3) = (splat(0.0), [splat(0.0); 3]);
        match &self.shape {
            Shape::Ball(ball) => {
                let squared = dot(arm, arm);
                let mut scale: Lane = splat(0.0);
                for l in 0..LANES {
                    let length = squared[l].sqrt();
                    distance[l] = length - ball.radius;
                    scale[l] = 1.0 / length;
                }
                for axis in 0..3 {
                    for l in 0..LANES {
                        normal[axis][l] =
                            if squared[l] > 0.0 { arm[axis][l] * scale[l] } else { NORMAL_AT_CENTRE[axis] };
                    }
                }
            }
            Shape::Capsule(capsule) => {
                let axis = pose.rotation * Vector3::z();
                let (axis, lateral) = ([axis.x, axis.y, axis.z], pose.rotation * Vector3::x());
                for l in 0..LANES {
                    let place =
                        nearest_on_axis(capsule, arm[0][l] * axis[0] + arm[1][l] * axis[1] + arm[2][l] * axis[2]);
                    let radial = [0, 1, 2].map(|k| arm[k][l] - axis[k] * place);
                    let length = (radial[0] * radial[0] + radial[1] * radial[1] + radial[2] * radial[2]).sqrt();
                    distance[l] = length - capsule.radius;
                    (0..3).for_each(|k| normal[k][l] = if length > 0.0 { radial[k] / length } else { lateral[k] });
                }
            }
            Shape::Other(shape) => {
                for l in (0..LANES).filter(|l| close[*l] > 0.0) {
                    let projection = project_on_shape(&**shape, pose, &Vector3::new(arm[0][l], arm[1][l], arm[2][l]));
                    distance[l] = projection.distance;
                    (0..3).for_each(|axis| normal[axis][l] = projection.normal[axis]);
                }
            }
        }
        (distance, normal)
    }
}

/// Normal of a ball at its centre, where it is not unique.
const NORMAL_AT_CENTRE: [f64; 3] = [0.0, 1.0, 0.0];

/// Signed distance and outward normal of a point from the projection of parry, in the same axes.
#[inline(always)]
fn signed(point: &Vector3<f64>, projection: PointProjection) -> Projection {
    let arm = vector(point) - projection.point;
    let distance = arm.length();
    let side = if projection.is_inside { -1.0 } else { 1.0 };
    let normal = if distance > 0.0 { arm * (side / distance) } else { vector(point).normalize_or(Vector::NEG_Z) };
    Projection { distance: side * distance, normal: Vector3::new(normal.x, normal.y, normal.z) }
}

/// Coordinate of the point of a capsule's axis nearest to a point whose coordinate along it is `z`, m.
#[inline(always)]
pub(super) fn nearest_on_axis(capsule: &Capsule, z: f64) -> f64 {
    smaller(larger(z, capsule.segment.a.z), capsule.segment.b.z)
}

/// Projection of the point at `arm` (m) from the centre of mass of the body at `pose` onto any shape.
fn project_on_shape(shape: &dyn shape::Shape, pose: &Isometry3<f64>, arm: &Vector3<f64>) -> Projection {
    let local = pose.rotation.inverse_transform_vector(arm);
    let projection = signed(&local, shape.project_local_point(vector(&local), false));
    Projection { normal: pose.rotation * projection.normal, ..projection }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::contact::surface::test_shapes;

    #[test]
    fn distance_and_normal_below_the_tip() {
        for surface in test_shapes() {
            let pose = Isometry3::translation(0.1, -0.2, 0.5);
            for depth in [-0.004, 0.003, 0.02] {
                let point = Point3::new(0.1, -0.2, 0.5 + surface.lowest() - depth);
                let projection = surface.project(&pose, &point);
                assert!((projection.distance - depth).abs() < 1e-12, "{} for {depth}", projection.distance);
                assert!((projection.normal + Vector3::z()).norm() < 1e-9);
            }
        }
    }

    /// Where the nearest point of the surface is not unique.
    #[test]
    fn a_point_on_the_axis_has_a_normal() {
        for surface in test_shapes() {
            let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::zeros());
            for height in [0.0, 0.5, -1.0].map(|share| share * (surface.size() + surface.lowest())) {
                let arm = Vector3::new(0.0, 0.0, height);
                let (distance, normal) =
                    surface.project_lanes(&pose, &[0, 1, 2].map(|axis| splat(arm[axis])), &splat(1.0));
                let lanes = Projection { distance: distance[0], normal: Vector3::from_fn(|axis, _| normal[axis][0]) };
                for projection in [lanes, surface.project(&pose, &(pose.translation.vector + arm).into())] {
                    assert!((projection.distance + surface.size()).abs() < 1e-12, "{projection:?}");
                    assert!((projection.normal.norm() - 1.0).abs() < 1e-12, "{projection:?}");
                }
            }
        }
    }

    #[test]
    fn lanes_agree_with_the_projection_of_parry() {
        for surface in test_shapes() {
            let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::new(0.3, 0.2, -0.1));
            let arm: Lane3 = [0, 1, 2].map(|axis| {
                std::array::from_fn(|l| surface.size() * (0.3 + 0.11 * l as f64) * [0.6, -0.5, -0.9][axis])
            });
            let (distance, normal) = surface.project_lanes(&pose, &arm, &splat(1.0));
            for l in 0..LANES {
                let arm = Vector3::new(arm[0][l], arm[1][l], arm[2][l]);
                let reference = project_on_shape(surface.shape.as_parry(), &pose, &arm);
                let lanes = Projection { distance: distance[l], normal: Vector3::from_fn(|axis, _| normal[axis][l]) };
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
