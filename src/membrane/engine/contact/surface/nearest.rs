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

    /// Whether it was found without a search over the whole mesh, since the point lies over a face.
    pub(super) fn is_under(&self) -> bool {
        self.others == self.distance
    }
}

impl Nearest {
    /// Whether a point that has `moved` since (m) is nearer to the surface than `margin` (m), where that is known: by
    /// the triangle inequality its signed distance has changed by at most that.
    fn is_within(&self, margin: f64, moved: f64) -> Option<bool> {
        if self.others < 0.0 {
            return None;
        }
        if self.distance - moved > margin {
            return Some(false);
        }
        (self.distance + moved < margin).then_some(true)
    }
}

impl Surface {
    /// Whether it is a mesh.
    pub(in crate::engine::contact) fn is_mesh(&self) -> bool {
        matches!(&self.shape, Shape::Solid(solid) if solid.features().is_some())
    }

    /// Whether the point at `arm` (m) from the centre of the body at `pose` is nearer to its mesh than `margin` (m).
    pub(in crate::engine::contact) fn is_mesh_within(
        &self,
        pose: &Isometry3<f64>,
        arm: &Vector3<f64>,
        margin: f64,
        nearest: &mut Nearest,
    ) -> bool {
        let moved = (pose.rotation.inverse_transform_vector(arm) - nearest.from).norm();
        nearest
            .is_within(margin, moved)
            .unwrap_or_else(|| self.project_on_mesh(pose, arm, Some(margin), nearest).distance < margin)
    }

    /// Height over the plane of the face that was the `nearest` to it, and its normal, of the point at `arm` (m) from the
    /// centre of the body at `pose`: a convex mesh lies below all of these planes.
    pub(in crate::engine::contact) fn face_of_mesh(
        &self,
        pose: &Isometry3<f64>,
        arm: &Vector3<f64>,
        nearest: &Nearest,
    ) -> Option<Projection> {
        let Shape::Solid(solid) = &self.shape else { return None };
        let face = solid.core().as_trimesh().filter(|_| nearest.others >= 0.0)?.triangle(nearest.triangle);
        let (normal, corner) = (face.normal()?, face.a);
        let distance = (vector(&pose.rotation.inverse_transform_vector(arm)) - corner).dot(normal);
        Some(Projection { distance, normal: Vector3::new(normal.x, normal.y, normal.z) }.turned(pose))
    }

    /// How far a convex body at `pose` reaches along the unit vector `direction` from its centre, m; of a mesh searched
    /// from the `nearest` triangle to a point on that side.
    pub(in crate::engine::contact) fn convex_reach(
        &self,
        pose: &Isometry3<f64>,
        direction: &Vector3<f64>,
        nearest: Option<&Nearest>,
    ) -> f64 {
        let local = pose.rotation.inverse_transform_vector(direction);
        match &self.shape {
            Shape::Solid(solid) => match (solid.features(), nearest) {
                (Some(features), Some(nearest)) => features.reach(&local, nearest.triangle),
                _ => solid.reach(&local),
            },
            shape => shape.reach(&local),
        }
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
            Shape::Solid(solid) => solid.core().as_trimesh().zip(solid.features()),
            _ => None,
        };
        let Some((mesh, features)) = mesh else { return self.shape.project(pose, arm) };
        let local = pose.rotation.inverse_transform_vector(arm);
        let moved = (local - nearest.from).norm();
        // By the triangle inequality: after a motion of `moved` any distance has changed by at most that.
        let mut farthest = f64::MAX;
        if nearest.others >= 0.0 {
            if beyond.is_some_and(|beyond| nearest.distance > 0.0 && nearest.distance - moved > beyond) {
                return Projection { distance: nearest.distance - moved, normal: Vector3::zeros() };
            }
            if features.is_convex()
                && let Some((triangle, foot)) = features.face_under(mesh, vector(&local), nearest.triangle)
            {
                let projection = signed(&local, foot, false);
                let distance = projection.distance;
                *nearest = Nearest { triangle, from: local, distance, others: distance };
                return projection.turned(pose);
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
            // None is farther than the triangle that was the nearest; round-off must not rule out that one itself.
            farthest = arm.length() * (1.0 + 1e-9) + 1e-9 * self.size();
        }
        let search = mesh.project_local_point_and_get_location_with_max_dist(vector(&local), false, farthest);
        let (found, (triangle, _)) =
            search.unwrap_or_else(|| mesh.project_local_point_and_get_location(vector(&local), false));
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
