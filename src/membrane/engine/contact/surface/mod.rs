//! The impactor's surface: its shape, and the projection of points and elements of film onto it. This folder is the
//! only place that names parry.

mod bars;
mod convex;
#[cfg(test)]
mod convex_tests;
mod deepest_point;
mod element_points;
mod features;
mod meeting;
mod projection;
mod triangle_minimum;
mod triangles;

pub(in crate::engine::contact) use element_points::{Clearance, DeepestPoint, Followed, UNKNOWN, point_of};
pub(in crate::engine) use meeting::Meeting;
pub(in crate::engine::contact) use projection::Projection;
pub(in crate::engine::contact) use triangles::Nearest;
pub(crate) use triangles::Triangles;

use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};
use parry3d_f64::mass_properties::MassProperties;
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::shape::{Ball, Capsule, Cone, Cuboid, Cylinder, Shape as _, TriMesh, TriMeshFlags};
use thiserror::Error;

use bars::Bars;
use convex::{Convex, Solid};
use features::Features;

/// The impactor's surface about its centre of mass, body axes.
#[derive(Clone, Debug)]
pub struct Surface {
    shape: Shape,
    /// Half the smallest extent, m.
    size: f64,
    /// m.
    bounding_radius: f64,
    /// Centre of mass in the coordinates in which the shape was given, m.
    centre: Vector3<f64>,
    /// m³.
    volume: f64,
    /// m², body axes.
    inertia_per_mass: Matrix3<f64>,
}

/// A shape about the centre of mass. Balls and capsules are separate: their projections are exact and statically
/// dispatched.
#[derive(Clone, Debug)]
enum Shape {
    Ball(Ball),
    /// Centred, along z in body axes.
    Capsule(Capsule),
    Solid(Solid),
    /// Parts at their poses.
    Compound(Vec<Part>),
    /// Bars of a frame.
    Bars(Bars),
}

/// A part of a compound body.
#[derive(Clone, Debug)]
struct Part {
    place: Isometry3<f64>,
    shape: Shape,
}

/// Why a shape cannot be an impactor.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SurfaceError {
    /// The triangles are not the boundary of a body.
    #[error("the impactor's surface is not a closed, orientable mesh of triangles")]
    NotASurface,
    /// The volume is zero or not finite.
    #[error("the impactor's surface encloses no volume")]
    NoVolume,
    /// The rounding is too large for the shape.
    #[error("the radius of the impactor's edges is too large for its flat faces")]
    NoFaces,
}

impl Surface {
    /// A sphere of `radius` (m).
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`].
    pub fn sphere(radius: f64) -> Result<Surface, SurfaceError> {
        let ball = Ball::new(radius);
        let properties = ball.mass_properties(1.0);
        Surface::about_centre(Shape::Ball(ball), properties)
    }

    /// A shaft along z of `radius` and `length` (m) with a hemisphere at each end: the lower one is the tip.
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`].
    pub fn capsule(radius: f64, length: f64) -> Result<Surface, SurfaceError> {
        let (low, high) = (Vector::new(0.0, 0.0, -0.5 * length), Vector::new(0.0, 0.0, 0.5 * length));
        let capsule = Capsule::new(low, high, radius);
        let properties = capsule.mass_properties(1.0);
        Surface::about_centre(Shape::Capsule(capsule), properties)
    }

    /// A flat-ended cylinder along z of `radius` and `length` (m) whose edges are rounded with the radius `edge` (m).
    /// Its inertia is that without rounding.
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`], [`SurfaceError::NoFaces`].
    pub fn cylinder(radius: f64, length: f64, edge: f64) -> Result<Surface, SurfaceError> {
        let outer = Cylinder::new(0.5 * length, radius).mass_properties(1.0);
        let core = Convex::Cylinder { radius: positive(radius - edge)?, half: positive(0.5 * length - edge)? };
        let upright = Pose::from_parts(Vector::ZERO, convex::y_to_z());
        Surface::solid(core, Vector::ZERO, outer.transform_by(&upright), edge)
    }

    /// A cone along z of `length` (m) with its tip down and a flat upper end of `radius` (m), between which z is zero;
    /// tip and edge are rounded with the radius `edge` (m) inside its faces. Its inertia is that without rounding.
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`], [`SurfaceError::NoFaces`].
    pub fn cone(radius: f64, length: f64, edge: f64) -> Result<Surface, SurfaceError> {
        let outer = Cone::new(0.5 * length, radius).mass_properties(1.0);
        let sharp = Convex::Cone { radius, half: 0.5 * length };
        positive(sharp.inradius() - edge)?;
        let (core, up) = sharp.shrunk(edge);
        let tip_down = Pose::from_parts(Vector::ZERO, convex::y_to_minus_z());
        Surface::solid(core, Vector::new(0.0, 0.0, up), outer.transform_by(&tip_down), edge)
    }

    /// A box of the lengths `size` (m) along x, y and z whose edges are rounded with the radius `edge` (m). Its inertia
    /// is that without rounding.
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`], [`SurfaceError::NoFaces`].
    pub fn cuboid(size: [f64; 3], edge: f64) -> Result<Surface, SurfaceError> {
        let outer = Cuboid::new(Vector::new(0.5 * size[0], 0.5 * size[1], 0.5 * size[2])).mass_properties(1.0);
        let [x, y, z] = size.map(|size| positive(0.5 * size - edge));
        Surface::solid(Convex::Cuboid { half: [x?, y?, z?] }, Vector::ZERO, outer, edge)
    }

    /// A closed, orientable surface of `triangles`.
    ///
    /// # Errors
    /// [`SurfaceError::NotASurface`] where it is open or not orientable, [`SurfaceError::NoVolume`].
    pub fn closed_mesh(triangles: Triangles) -> Result<Surface, SurfaceError> {
        let (vertices, indices) = triangles;
        let mesh = closed_mesh(&vertices, indices)?;
        let properties = mesh.mass_properties(1.0);
        let shape = Shape::Solid(Solid::mesh(mesh, -properties.local_com));
        Surface::about_centre(shape, properties)
    }

    /// All `parts` at the poses of their own coordinates, of one density: a body of several. Where parts overlap, the
    /// mass there counts for each of them.
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`] where there is no part.
    pub fn compound(parts: Vec<(Isometry3<f64>, Surface)>) -> Result<Surface, SurfaceError> {
        let centre_of = |pose: &Isometry3<f64>, part: &Surface| (pose * Point3::from(part.centre)).coords;
        let volume: f64 = parts.iter().map(|(_, part)| part.volume).sum();
        if parts.is_empty() || volume <= 0.0 {
            return Err(SurfaceError::NoVolume);
        }
        let moment: Vector3<f64> = parts.iter().map(|(pose, part)| centre_of(pose, part) * part.volume).sum();
        let centre = moment / volume;
        let mut inertia = Matrix3::zeros();
        let mut shapes = Vec::with_capacity(parts.len());
        for (pose, part) in &parts {
            let arm = centre_of(pose, part) - centre;
            let rotation = pose.rotation.to_rotation_matrix();
            let own = rotation * part.inertia_per_mass * rotation.transpose();
            let steiner = Matrix3::identity() * arm.norm_squared() - arm * arm.transpose();
            inertia += (own + steiner) * (part.volume / volume);
            let place = Isometry3::from_parts(arm.into(), pose.rotation);
            shapes.push(Part { place, shape: part.shape.clone() });
        }
        Ok(Surface::with(Shape::Compound(shapes), centre, volume, inertia))
    }

    /// Bars of `radius` (m) in the plane z = 0 along `lines` from point to point, with walls of `half_height` (m) above
    /// and below that plane: all points within the radius of upright rectangles. They have a volume, but no inertia.
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`].
    pub fn bars(lines: &[[[f64; 2]; 2]], radius: f64, half_height: f64) -> Result<Surface, SurfaceError> {
        let bars = Bars::new(lines, radius, half_height);
        let (volume, size) = (bars.volume(), bars.radius());
        if !(volume.is_finite() && volume > 0.0) {
            return Err(SurfaceError::NoVolume);
        }
        let surface = Surface::with(Shape::Bars(bars), Vector3::zeros(), volume, Matrix3::zeros());
        Ok(Surface { size, ..surface })
    }

    /// A convex body: everything within `edge` (m) of `core` with its centre at `centre`, with the mass properties
    /// `outer`.
    fn solid(core: Convex, centre: Vector, outer: MassProperties, edge: f64) -> Result<Surface, SurfaceError> {
        Surface::about_centre(Shape::Solid(Solid::rounded(core, centre - outer.local_com, edge)), outer)
    }

    /// This body, of which convex parts have edges of at least the radius `edge` (m) inside the same faces.
    pub(super) fn with_edges(&self, edge: f64) -> Surface {
        Surface { shape: self.shape.with_edges(edge), ..self.clone() }
    }

    /// `shape` about its centre of mass, with its mass properties of density one.
    fn about_centre(shape: Shape, properties: MassProperties) -> Result<Surface, SurfaceError> {
        let volume = properties.mass();
        if !(volume.is_finite() && volume > 0.0) {
            return Err(SurfaceError::NoVolume);
        }
        let principal = properties.principal_inertia() / volume;
        let axes = properties.principal_inertia_local_frame;
        let inertia = Matrix3::from_fn(|i, j| {
            let unit = |k: usize| axes * Vector::new(f64::from(k == 0), f64::from(k == 1), f64::from(k == 2));
            (0..3).map(|k| principal[k] * unit(k)[i] * unit(k)[j]).sum()
        });
        let centre = properties.local_com;
        Ok(Surface::with(shape, Vector3::new(centre.x, centre.y, centre.z), volume, inertia))
    }

    fn with(shape: Shape, centre: Vector3<f64>, volume: f64, inertia_per_mass: Matrix3<f64>) -> Surface {
        let along = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| shape.reach(&axis) + shape.reach(&-axis));
        Surface {
            size: 0.5 * along.into_iter().fold(f64::INFINITY, f64::min),
            bounding_radius: shape.bounding_radius(),
            shape,
            centre,
            volume,
            inertia_per_mass,
        }
    }

    /// Half the smallest extent, m: the radius of a sphere.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Radius of the sphere about the centre of mass that holds the whole body, m.
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// z of the lowest point of the body with `rotation` below its centre of mass, m.
    pub fn lowest(&self, rotation: &UnitQuaternion<f64>) -> f64 {
        -self.shape.reach(&rotation.inverse_transform_vector(&-Vector3::z()))
    }

    /// Centre of mass in the coordinates in which the shape was given, m.
    pub fn centre(&self) -> Vector3<f64> {
        self.centre
    }

    /// Inertia of a homogeneous body over its mass, m², body axes.
    pub fn inertia_per_mass(&self) -> Matrix3<f64> {
        self.inertia_per_mass
    }

    /// Radius of the sharpest edge, m: zero where one is sharp, that of the sphere or capsule where there is none. That
    /// of a mesh is of the curved surface that its triangles stand for.
    pub(super) fn edge_radius(&self) -> f64 {
        self.shape.edge_radius()
    }

    /// Whether it consists of several parts, which may be smaller than its size.
    pub(super) fn has_parts(&self) -> bool {
        matches!(self.shape, Shape::Compound(_))
    }

    /// Whether it is much longer than its size.
    pub(super) fn is_long(&self) -> bool {
        matches!(self.shape, Shape::Bars(_))
    }

    /// Whether its nodes suffice for a fine mesh: a sphere, a capsule, or a mesh without sharp edges.
    pub(super) fn is_smooth(&self) -> bool {
        self.is_round() || (self.is_mesh() && self.edge_radius() > 0.0)
    }

    /// Whether it is a cylinder, a cone or a box, whose tangents bound its distance.
    pub(super) fn is_convex_solid(&self) -> bool {
        matches!(&self.shape, Shape::Solid(solid) if solid.features().is_none())
    }

    /// Whether it is a convex body other than a sphere or a capsule, whose tangents bound its distance: a cylinder, a
    /// cone, a box, or such a mesh.
    pub(super) fn is_convex(&self) -> bool {
        matches!(&self.shape, Shape::Solid(solid) if solid.features().is_none_or(Features::is_convex))
    }

    /// Whether its curvature is nowhere larger than that of a sphere of its size, so that node contact suffices for a
    /// fine mesh.
    pub fn is_round(&self) -> bool {
        matches!(self.shape, Shape::Ball(_) | Shape::Capsule(_) | Shape::Bars(_))
    }
}

/// A length that must be left of a shape whose edges are rounded.
fn positive(length: f64) -> Result<f64, SurfaceError> {
    if length > 0.0 { Ok(length) } else { Err(SurfaceError::NoFaces) }
}

/// A vector as one of parry.
#[inline(always)]
fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

impl Shape {
    /// This shape, of which convex parts have edges of at least the radius `edge` (m).
    fn with_edges(&self, edge: f64) -> Shape {
        match self {
            Shape::Ball(_) | Shape::Capsule(_) | Shape::Bars(_) => self.clone(),
            Shape::Solid(solid) => Shape::Solid(solid.with_edges(edge)),
            Shape::Compound(parts) => {
                let rounded = |part: &Part| Part { shape: part.shape.with_edges(edge), ..part.clone() };
                Shape::Compound(parts.iter().map(rounded).collect())
            }
        }
    }

    /// Radius of the sharpest edge, m.
    fn edge_radius(&self) -> f64 {
        match self {
            Shape::Ball(ball) => ball.radius,
            Shape::Capsule(capsule) => capsule.radius,
            Shape::Solid(solid) => solid.edge_radius(),
            Shape::Bars(bars) => bars.radius(),
            Shape::Compound(parts) => parts.iter().map(|part| part.shape.edge_radius()).fold(f64::INFINITY, f64::min),
        }
    }

    /// How far the shape reaches along the unit vector `direction`, m.
    fn reach(&self, direction: &Vector3<f64>) -> f64 {
        match self {
            Shape::Ball(ball) => ball.radius,
            Shape::Capsule(capsule) => capsule.radius + direction.z.abs() * capsule.segment.b.z,
            Shape::Solid(solid) => solid.reach(direction),
            Shape::Compound(parts) => {
                let of_part = |Part { place, shape, .. }: &Part| {
                    let own = place.rotation.inverse_transform_vector(direction);
                    place.translation.vector.dot(direction) + shape.reach(&own)
                };
                parts.iter().map(of_part).fold(f64::NEG_INFINITY, f64::max)
            }
            Shape::Bars(bars) => bars.reach(direction),
        }
    }

    /// Radius of the sphere about the origin that holds the shape, m.
    fn bounding_radius(&self) -> f64 {
        match self {
            Shape::Ball(ball) => ball.radius,
            Shape::Capsule(capsule) => capsule.segment.b.z + capsule.radius,
            Shape::Solid(solid) => solid.bounding_radius(),
            Shape::Compound(parts) => {
                let of_part =
                    |Part { place, shape, .. }: &Part| place.translation.vector.norm() + shape.bounding_radius();
                parts.iter().map(of_part).fold(0.0, f64::max)
            }
            Shape::Bars(bars) => bars.bounding_radius(),
        }
    }
}

fn closed_mesh(vertices: &[Point3<f64>], indices: Vec<[u32; 3]>) -> Result<TriMesh, SurfaceError> {
    let vertices = vertices.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
    let flags = TriMeshFlags::ORIENTED | TriMeshFlags::MERGE_DUPLICATE_VERTICES | TriMeshFlags::HALF_EDGE_TOPOLOGY;
    TriMesh::with_flags(vertices, indices, flags).map_err(|_| SurfaceError::NotASurface)
}

#[cfg(test)]
mod tests {
    use super::convex_tests::test_shapes;
    use super::*;

    #[test]
    fn a_sphere_has_its_inertia() {
        let inertia = test_shapes()[0].inertia_per_mass();
        assert!((inertia - Matrix3::from_diagonal_element(0.4 * 0.15 * 0.15)).norm() < 1e-12);
    }

    /// Two halves are the whole: centre of mass, inertia, extent and projection.
    #[test]
    fn a_compound_of_two_halves_is_the_whole() {
        let whole = Surface::cuboid([0.2, 0.1, 0.3], 0.0).unwrap();
        let half = || Surface::cuboid([0.2, 0.1, 0.15], 0.0).unwrap();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
        let upper = Isometry3::from_parts(Vector3::new(0.0, 0.0, 0.25).into(), turn);
        let both = Surface::compound(vec![(Isometry3::translation(0.0, 0.0, 0.1), half()), (upper, half())]).unwrap();
        assert!((both.centre - Vector3::new(0.0, 0.0, 0.175)).norm() < 1e-15);
        assert!((both.inertia_per_mass - whole.inertia_per_mass).norm() < 1e-15);
        let tilted = UnitQuaternion::from_euler_angles(0.3, -0.5, 0.2);
        assert!((both.lowest(&tilted) - whole.lowest(&tilted)).abs() < 1e-15);
        let pose = Isometry3::from_parts(Vector3::new(0.4, -0.1, 0.2).into(), tilted);
        for outside in [[0.6, -0.1, 0.2], [0.4, -0.1, -0.1], [0.3, -0.4, 0.6]] {
            let [found, expected] = [&both, &whole].map(|surface| surface.project(&pose, &outside.into()));
            assert!((found.distance - expected.distance).abs() < 1e-14, "{found:?} {expected:?}");
            assert!((found.normal - expected.normal).norm() < 1e-13, "{found:?} {expected:?}");
        }
    }

    /// The flat parts of shapes stay where they are when edges are rounded.
    #[test]
    fn rounding_keeps_flat_faces() {
        let upright = UnitQuaternion::identity();
        let lying = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
        for edge in [0.0, 0.004] {
            let cylinder = Surface::cylinder(0.03, 0.2, edge).unwrap();
            assert!((cylinder.lowest(&upright) + 0.1).abs() < 1e-15 && (cylinder.lowest(&lying) + 0.03).abs() < 1e-15);
            let cone = Surface::cone(0.03, 0.04, edge).unwrap();
            // The sine of half the angle of the tip is 0.6; its centre of mass lies 0.03 above the tip.
            let tip = -0.03 + edge / 0.6 - edge;
            assert!((cone.lowest(&upright) - tip).abs() < 1e-15, "{} for {tip}", cone.lowest(&upright));
            let turned = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
            assert!((cone.lowest(&turned) + 0.01).abs() < 1e-15);
        }
        assert_eq!(Surface::cylinder(0.03, 0.2, 0.03).unwrap_err(), SurfaceError::NoFaces);
        assert_eq!(Surface::cone(0.03, 0.04, 0.02).unwrap_err(), SurfaceError::NoFaces);
    }
}
