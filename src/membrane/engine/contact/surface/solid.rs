//! Convex bodies with rounded edges, and closed meshes.

use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::shape::{Cone, Cuboid, Cylinder, Shape as ParryShape, SharedShape, TriMesh};

use super::convex::Convex;
use super::features::Features;
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
    /// The core in closed form about its place, but for a mesh.
    convex: Option<Convex>,
    /// Of a mesh.
    features: Option<Arc<Features>>,
    /// The body with the edges that it was given, where these have a larger radius.
    sharp: Option<Arc<Solid>>,
}

impl Solid {
    /// Everything within `edge` (m) of a convex core with its centre at `centre` (m).
    pub(super) fn rounded(convex: Convex, centre: Vector, edge: f64) -> Solid {
        let (core, rotation) = match convex {
            Convex::Cylinder { radius, half } => (SharedShape::new(Cylinder::new(half, radius)), y_to_z()),
            Convex::Cone { radius, half } => (SharedShape::new(Cone::new(half, radius)), y_to_minus_z()),
            Convex::Cuboid { half: [x, y, z] } => {
                (SharedShape::new(Cuboid::new(Vector::new(x, y, z))), Rotation::IDENTITY)
            }
        };
        Solid {
            core,
            place: Pose::from_parts(centre, rotation),
            edge,
            convex: Some(convex),
            features: None,
            sharp: None,
        }
    }

    /// A closed mesh, moved `by` a vector (m).
    pub(super) fn mesh(mut mesh: TriMesh, by: Vector) -> Solid {
        mesh.transform_vertices(&Pose::from_translation(by));
        let features = Some(Arc::new(Features::from_mesh(&mesh)));
        Solid { core: SharedShape::new(mesh), place: Pose::IDENTITY, edge: 0.0, convex: None, features, sharp: None }
    }

    /// This solid, of which convex shapes have edges of at least the radius `edge` (m), or of half of what leaves
    /// nothing of it, inside the same faces.
    pub(super) fn with_edges(&self, edge: f64) -> Solid {
        let Some(convex) = self.convex.filter(|_| edge > self.edge) else { return self.clone() };
        let by = (edge - self.edge).min(0.5 * convex.inradius());
        let (convex, up) = convex.shrunk(by);
        let centre = self.place.translation + Vector::new(0.0, 0.0, up);
        Solid { sharp: Some(Arc::new(self.clone())), ..Solid::rounded(convex, centre, self.edge + by) }
    }

    /// Corners and edges of a mesh.
    pub(super) fn features(&self) -> Option<&Features> {
        self.features.as_deref()
    }

    /// Radius of the sharpest edge, m.
    pub(super) fn edge_radius(&self) -> f64 {
        self.features().map_or(self.edge, Features::edge_radius)
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
        self.project_local(&pose.rotation.inverse_transform_vector(arm)).turned(pose)
    }

    /// Signed distance and outward normal, in body axes, of a point in body axes.
    #[inline(always)]
    pub(super) fn project_local(&self, local: &Vector3<f64>) -> Projection {
        if let Some(convex) = &self.convex {
            let centre = self.place.translation;
            let (distance, normal) = convex.project([local.x - centre.x, local.y - centre.y, local.z - centre.z]);
            return Projection { distance: distance - self.edge, normal: normal.into() };
        }
        let projection = self.core.project_point(&self.place, vector(local), false);
        signed(local, projection.point, projection.is_inside)
    }

    /// The farthest point of a convex core along `direction`, body axes, m; none of a mesh.
    #[inline(always)]
    pub(super) fn support_of_core(&self, direction: &Vector3<f64>) -> Option<Vector3<f64>> {
        let centre = self.place.translation;
        let support = self.convex.as_ref()?.support((*direction).into());
        Some(Vector3::new(support[0] + centre.x, support[1] + centre.y, support[2] + centre.z))
    }

    /// How far it reaches along the unit vector `direction`, m.
    pub(super) fn reach(&self, direction: &Vector3<f64>) -> f64 {
        let farthest = match &self.convex {
            Some(convex) => vector(direction).dot(self.place.translation) + convex.reach((*direction).into()),
            None => {
                let along = |mesh: &TriMesh| {
                    mesh.vertices().iter().map(|v| v.dot(vector(direction))).fold(f64::NEG_INFINITY, f64::max)
                };
                self.core.as_trimesh().map_or(f64::NAN, along)
            }
        };
        farthest + self.edge
    }

    /// How far the body with the edges that it was given reaches along the unit vector `direction`, m.
    pub(super) fn sharp_reach(&self, direction: &Vector3<f64>) -> f64 {
        self.sharp.as_deref().unwrap_or(self).reach(direction)
    }

    /// Radius of the sphere about the body's centre that holds it, m.
    pub(super) fn bounding_radius(&self) -> f64 {
        let sphere = self.core.compute_bounding_sphere(&self.place);
        sphere.center().length() + sphere.radius() + self.edge
    }
}

/// Signed distance and outward normal of a point of which `on_surface` is the nearest.
pub(super) fn signed(point: &Vector3<f64>, on_surface: Vector, is_inside: bool) -> Projection {
    let arm = vector(point) - on_surface;
    let distance = arm.length();
    let side = if is_inside { -1.0 } else { 1.0 };
    let normal = if distance > 0.0 { arm * (side / distance) } else { vector(point).normalize_or(Vector::NEG_Z) };
    Projection { distance: side * distance, normal: Vector3::new(normal.x, normal.y, normal.z) }
}

/// The rotation that turns the axis of parry's cylinders up.
pub(super) fn y_to_z() -> Rotation {
    Rotation::from_rotation_arc(Vector::Y, Vector::Z)
}

/// The rotation that turns the tip of parry's cones down.
pub(super) fn y_to_minus_z() -> Rotation {
    Rotation::from_rotation_arc(Vector::Y, Vector::NEG_Z)
}
