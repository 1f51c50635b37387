//! The nearest triangle of a mesh to a point that moves little from step to step.

use nalgebra::{Isometry3, Vector3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::query::{PointQuery, PointQueryWithLocation};

use super::projection::Projection;
use super::solid::signed;
use super::{Shape, Surface, vector};

/// Distance around a point within which other triangles are looked at, over the size of the body.
const AROUND: f64 = 0.01;

/// The nearest triangle to a point when it was last searched. That a projection uses it changes no bit of the result,
/// so it need not be saved.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine::contact) struct Nearest {
    triangle: u32,
    /// The point, in body axes, m.
    from: Vector3<f64>,
    /// Its distance from the triangle, m.
    distance: f64,
    /// No other triangle is nearer to the point than this, m; negative where nothing is known.
    others: f64,
}

impl Default for Nearest {
    fn default() -> Nearest {
        Nearest { triangle: 0, from: Vector3::zeros(), distance: 0.0, others: -1.0 }
    }
}

#[cfg(test)]
impl Nearest {
    /// Whether `other` is what was known before.
    pub(super) fn is_kept(&self, other: &Nearest) -> bool {
        self.from == other.from && self.others == other.others
    }
}

impl Surface {
    /// Whether it is a mesh.
    pub(in crate::engine::contact) fn is_mesh(&self) -> bool {
        matches!(&self.shape, Shape::Solid(solid) if solid.features().is_some())
    }

    /// Projection of the point at `arm` (m) from the centre of the body at `pose`, as of [`Surface::project`], with
    /// what is known of the triangle of a mesh that is nearest. Where the point is farther than `beyond` (m), a lower
    /// bound of the distance will do, without a normal.
    pub(in crate::engine::contact) fn project_on_mesh(
        &self,
        pose: &Isometry3<f64>,
        arm: &Vector3<f64>,
        beyond: Option<f64>,
        nearest: &mut Nearest,
    ) -> Projection {
        let mesh = match &self.shape {
            Shape::Solid(solid) => solid.core().as_trimesh(),
            _ => None,
        };
        let Some(mesh) = mesh else { return self.shape.project(pose, arm) };
        let local = pose.rotation.inverse_transform_vector(arm);
        let moved = (local - nearest.from).norm();
        // By the triangle inequality: after a motion of `moved` any distance has changed by at most that.
        if nearest.others >= 0.0 {
            if beyond.is_some_and(|beyond| nearest.distance > 0.0 && nearest.distance - moved > beyond) {
                return Projection { distance: nearest.distance - moved, normal: Vector3::zeros() };
            }
            let triangle = mesh.triangle(nearest.triangle);
            let found = triangle.project_local_point(vector(&local), false);
            let arm = vector(&local) - found.point;
            // Only where no other triangle can be as near: the result is then the one that the search would give, to
            // the bit.
            if arm.length() < nearest.others - moved
                && let Some(normal) = triangle.normal()
            {
                return signed(&local, found.point, normal.dot(arm) <= 0.0).turned(pose);
            }
        }
        let (found, (triangle, _)) = mesh.project_local_point_and_get_location(vector(&local), false);
        let projection = signed(&local, found.point, found.is_inside);
        // What lies beyond is not looked at, so `around` is the bound where the box holds no other triangle.
        let around = projection.distance.abs() + AROUND * self.size();
        if projection.distance > AROUND * self.size() {
            // It is not in contact, and many triangles are about as near.
            *nearest = Nearest { triangle, from: local, distance: projection.distance, others: 0.0 };
            return projection.turned(pose);
        }
        let margin = Vector3::repeat(around);
        let bounds = Aabb::new(vector(&(local - margin)), vector(&(local + margin)));
        let distance =
            |t: u32| (mesh.triangle(t).project_local_point(vector(&local), false).point - vector(&local)).length();
        let others = mesh.bvh().intersect_aabb(&bounds).filter(|t| *t != triangle).map(distance).fold(around, f64::min);
        *nearest = Nearest { triangle, from: local, distance: projection.distance, others };
        projection.turned(pose)
    }
}
