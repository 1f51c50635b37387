//! Signed distances from cylinders, cones and boxes in closed form.

use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::shape::{Cone, Cuboid, Cylinder, Shape as ParryShape, SharedShape, TriMesh};

use super::features::Features;
use super::projection::Projection;
use super::vector;

/// A convex shape about its own centre, its axis along z.
#[derive(Clone, Copy, Debug)]
pub(super) enum Convex {
    /// Of a radius and half a length, m.
    Cylinder { radius: f64, half: f64 },
    /// Tip down, of the radius of its flat upper end and half a length, m.
    Cone { radius: f64, half: f64 },
    /// Of half lengths, m.
    Cuboid { half: [f64; 3] },
}

impl Convex {
    /// Signed distance of a point (m) and the outward unit normal there.
    #[inline(always)]
    pub(super) fn project(&self, point: [f64; 3]) -> (f64, [f64; 3]) {
        let [x, y, z] = point;
        match *self {
            Convex::Cylinder { radius, half } => {
                let rho = (x * x + y * y).sqrt();
                let (distance, [radial, axial]) = rectangle([rho - radius, z.abs() - half]);
                (distance, turned([x, y], rho, [radial, axial.copysign(z)]))
            }
            Convex::Cone { radius, half } => {
                let rho = (x * x + y * y).sqrt();
                let (distance, normal) = half_triangle([rho, z + half], radius, 2.0 * half);
                (distance, turned([x, y], rho, normal))
            }
            Convex::Cuboid { half } => {
                let beyond = [x.abs() - half[0], y.abs() - half[1], z.abs() - half[2]];
                let (distance, normal) = corner(beyond);
                (distance, [0, 1, 2].map(|k| if point[k] < 0.0 { -normal[k] } else { normal[k] }))
            }
        }
    }

    /// The farthest point along the unit vector `direction`, times it, m.
    pub(super) fn reach(&self, direction: [f64; 3]) -> f64 {
        let [x, y, z] = direction;
        let radial = (x * x + y * y).sqrt();
        match *self {
            Convex::Cylinder { radius, half } => radial * radius + z.abs() * half,
            Convex::Cone { radius, half } => (radial * radius + z * half).max(-z * half),
            Convex::Cuboid { half } => x.abs() * half[0] + y.abs() * half[1] + z.abs() * half[2],
        }
    }

    /// The farthest point along `direction`, of which there may be several, m.
    #[inline(always)]
    pub(super) fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = direction;
        let on_circle = |radius: f64| {
            let rho = (x * x + y * y).sqrt();
            if rho > 0.0 { [radius * (x / rho), radius * (y / rho)] } else { [0.0; 2] }
        };
        match *self {
            Convex::Cylinder { radius, half } => {
                let [u, v] = on_circle(radius);
                [u, v, half.copysign(z)]
            }
            Convex::Cone { radius, half } => {
                let [u, v] = on_circle(radius);
                if x * u + y * v + z * half > -z * half { [u, v, half] } else { [0.0, 0.0, -half] }
            }
            Convex::Cuboid { half } => [half[0].copysign(x), half[1].copysign(y), half[2].copysign(z)],
        }
    }

    /// How far all faces can move inwards, m.
    pub(super) fn inradius(&self) -> f64 {
        match *self {
            Convex::Cylinder { radius, half } => radius.min(half),
            Convex::Cone { radius, half } => {
                let length = 2.0 * half;
                radius * length / (radius + (radius * radius + length * length).sqrt())
            }
            Convex::Cuboid { half } => half[0].min(half[1]).min(half[2]),
        }
    }

    /// The shape whose faces lie `by` (m) inside these, less than [`Convex::inradius`], and how far its centre lies
    /// above.
    pub(super) fn shrunk(&self, by: f64) -> (Convex, f64) {
        match *self {
            Convex::Cylinder { radius, half } => (Convex::Cylinder { radius: radius - by, half: half - by }, 0.0),
            Convex::Cone { radius, half } => {
                // The tip moves up by the depth over the sine of half its angle, the flat end down by the depth.
                let share = 1.0 - by / self.inradius();
                (Convex::Cone { radius: radius * share, half: half * share }, half * (1.0 - share) - by)
            }
            Convex::Cuboid { half } => (Convex::Cuboid { half: half.map(|half| half - by) }, 0.0),
        }
    }
}

/// Turns a normal of a profile, radial and axial, about the axis to the point at `[x, y]`, `rho` from it.
#[inline(always)]
fn turned([x, y]: [f64; 2], rho: f64, [radial, axial]: [f64; 2]) -> [f64; 3] {
    if rho > 0.0 { [radial * (x / rho), radial * (y / rho), axial] } else { [radial, 0.0, axial] }
}

/// Distance and normal of a point `beyond` the two sides of a right angle.
#[inline(always)]
fn rectangle(beyond: [f64; 2]) -> (f64, [f64; 2]) {
    let [a, b] = beyond;
    if a > 0.0 && b > 0.0 {
        let length = (a * a + b * b).sqrt();
        return (length, [a / length, b / length]);
    }
    if a > b { (a, [1.0, 0.0]) } else { (b, [0.0, 1.0]) }
}

/// Distance and normal of a point `beyond` the three faces of a corner.
#[inline(always)]
fn corner(beyond: [f64; 3]) -> (f64, [f64; 3]) {
    let outside = beyond.map(|b| b.max(0.0));
    let squared = outside[0] * outside[0] + outside[1] * outside[1] + outside[2] * outside[2];
    if squared > 0.0 {
        let length = squared.sqrt();
        return (length, outside.map(|b| b / length));
    }
    let [a, b, c] = beyond;
    if a > b && a > c {
        (a, [1.0, 0.0, 0.0])
    } else if b > c {
        (b, [0.0, 1.0, 0.0])
    } else {
        (c, [0.0, 0.0, 1.0])
    }
}

/// Distance and normal of a point from the half profile of a cone: its tip at the origin, its flat end of `radius` at
/// `length` along the second axis.
#[inline(always)]
fn half_triangle([r, z]: [f64; 2], radius: f64, length: f64) -> (f64, [f64; 2]) {
    let slant = (radius * radius + length * length).sqrt();
    let (cos, sin) = (length / slant, radius / slant);
    let (across, along) = (r * cos - z * sin, r * sin + z * cos);
    let above = z - length;
    if across <= 0.0 && above <= 0.0 {
        return if across > above { (across, [cos, -sin]) } else { (above, [0.0, 1.0]) };
    }
    let from = |a: f64, b: f64| {
        let distance = (a * a + b * b).sqrt();
        (distance, [a / distance, b / distance])
    };
    if along < 0.0 {
        from(r, z)
    } else if r > radius && along > slant {
        from(r - radius, above)
    } else if above > 0.0 && r <= radius {
        (above, [0.0, 1.0])
    } else {
        (across, [cos, -sin])
    }
}

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
