//! Convex bodies with rounded edges, and closed meshes.

use nalgebra::{Isometry3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::shape::{Shape as ParryShape, SharedShape, SupportMap, TriMesh};

use super::projection::Projection;
use super::vector;

/// Everything within `edge` of `core`.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    core: SharedShape,
    /// Of the core, in body axes.
    place: Pose,
    /// Radius of the edges, m.
    edge: f64,
}

impl Solid {
    /// Everything within `edge` (m) of a convex `core` at `place`.
    pub(super) fn rounded(core: SharedShape, place: Pose, edge: f64) -> Solid {
        Solid { core, place, edge }
    }

    /// A closed mesh, moved `by` a vector (m).
    pub(super) fn mesh(mut mesh: TriMesh, by: Vector) -> Solid {
        mesh.transform_vertices(&Pose::from_translation(by));
        Solid { core: SharedShape::new(mesh), place: Pose::IDENTITY, edge: 0.0 }
    }

    pub(super) fn core(&self) -> &dyn ParryShape {
        &*self.core
    }

    pub(super) fn place(&self) -> &Pose {
        &self.place
    }

    pub(super) fn edge(&self) -> f64 {
        self.edge
    }

    /// Signed distance and outward normal of the point at `arm` (m) from the body's centre, at `pose`.
    pub(super) fn project(&self, pose: &Isometry3<f64>, arm: &Vector3<f64>) -> Projection {
        let local = vector(&pose.rotation.inverse_transform_vector(arm));
        let projection = self.core.project_point(&self.place, local, false);
        let arm = local - projection.point;
        let distance = arm.length();
        let side = if projection.is_inside { -1.0 } else { 1.0 };
        let normal = if distance > 0.0 { arm * (side / distance) } else { local.normalize_or(Vector::NEG_Z) };
        let normal = pose.rotation * Vector3::new(normal.x, normal.y, normal.z);
        Projection { distance: side * distance - self.edge, normal }
    }

    /// How far it reaches along the unit vector `direction`, m.
    pub(super) fn reach(&self, direction: &Vector3<f64>) -> f64 {
        let direction = vector(direction);
        let of_mesh =
            |mesh: &TriMesh| mesh.vertices().iter().map(|v| v.dot(direction)).fold(f64::NEG_INFINITY, f64::max);
        let of_convex = |core: &dyn SupportMap| core.support_point(&self.place, direction).dot(direction);
        let farthest = self.core.as_trimesh().map(of_mesh).or_else(|| self.core.as_support_map().map(of_convex));
        farthest.unwrap_or(f64::NAN) + self.edge
    }

    /// Radius of the sphere about the body's centre that holds it, m.
    pub(super) fn bounding_radius(&self) -> f64 {
        let sphere = self.core.compute_bounding_sphere(&self.place);
        sphere.center().length() + sphere.radius() + self.edge
    }
}

/// The rotation that turns the axis of parry's cylinders up.
pub(super) fn y_to_z() -> Pose {
    Pose::from_parts(Vector::ZERO, Rotation::from_rotation_arc(Vector::Y, Vector::Z))
}

/// The rotation that turns the tip of parry's cones down.
pub(super) fn y_to_minus_z() -> Pose {
    Pose::from_parts(Vector::ZERO, Rotation::from_rotation_arc(Vector::Y, Vector::NEG_Z))
}
