//! The impactor's surface: its shape, and the projection of points and elements of film onto it. This folder is the
//! only place that names parry.

mod deepest_point;
mod projection;
mod triangles;

pub(crate) use triangles::Triangles;

use nalgebra::{Matrix3, Point3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::shape::{Ball, Capsule, Cylinder, SharedShape, TriMesh, TriMeshFlags};
use thiserror::Error;

/// The impactor's surface about its centre of mass, body axes.
#[derive(Clone, Debug)]
pub struct Surface {
    shape: Shape,
    /// Half the smallest extent, m.
    size: f64,
    /// m.
    bounding_radius: f64,
    /// z of the lowest point, m.
    lowest: f64,
    /// m², body axes.
    inertia_per_mass: Matrix3<f64>,
    /// One over `size`: the curvature of a ball, 1/m.
    curvature: f64,
}

/// A parry shape. Balls and capsules are separate: their projections are exact and statically dispatched.
#[derive(Clone, Debug)]
enum Shape {
    Ball(Ball),
    /// Centred, along z in body axes.
    Capsule(Capsule),
    Other(SharedShape),
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
}

impl Surface {
    /// A sphere of `radius` (m).
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`].
    pub fn sphere(radius: f64) -> Result<Surface, SurfaceError> {
        Surface::about_centre(Shape::Ball(Ball::new(radius)))
    }

    /// A shaft along z of `radius` and `length` (m) with a hemisphere at each end: the lower one is the tip.
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`].
    pub fn hemisphere(radius: f64, length: f64) -> Result<Surface, SurfaceError> {
        let (low, high) = (Vector::new(0.0, 0.0, -0.5 * length), Vector::new(0.0, 0.0, 0.5 * length));
        Surface::about_centre(Shape::Capsule(Capsule::new(low, high, radius)))
    }

    /// A flat-ended cylinder along z of `radius` and `length` (m).
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`].
    pub fn cylinder(radius: f64, length: f64) -> Result<Surface, SurfaceError> {
        let upright = Pose::from_parts(Vector::ZERO, rotation_y_to_z());
        let cylinder = SharedShape::new(Cylinder::new(0.5 * length, radius));
        Surface::about_centre(Shape::Other(SharedShape::compound(vec![(upright, cylinder)])))
    }

    /// A closed, orientable surface of `triangles`.
    ///
    /// # Errors
    /// [`SurfaceError::NotASurface`] where it is open or not orientable, [`SurfaceError::NoVolume`].
    pub fn closed_mesh(triangles: Triangles) -> Result<Surface, SurfaceError> {
        let (vertices, indices) = triangles;
        Surface::about_centre(Shape::Other(SharedShape::new(closed_mesh(&vertices, indices)?)))
    }

    /// `shape` moved to its centre of mass, with its mass properties.
    fn about_centre(shape: Shape) -> Result<Surface, SurfaceError> {
        let properties = shape.as_parry().mass_properties(1.0);
        let mass = properties.mass();
        if !(mass.is_finite() && mass > 0.0) {
            return Err(SurfaceError::NoVolume);
        }
        let centre = properties.local_com;
        let shape = shape.moved(-centre);
        let bounds = shape.as_parry().compute_local_aabb();
        let half = bounds.half_extents();
        let sphere = shape.as_parry().compute_local_bounding_sphere();
        let principal = properties.principal_inertia() / mass;
        let axes = properties.principal_inertia_local_frame;
        let inertia = Matrix3::from_fn(|i, j| {
            let unit = |k: usize| axes * Vector::new(f64::from(k == 0), f64::from(k == 1), f64::from(k == 2));
            (0..3).map(|k| principal[k] * unit(k)[i] * unit(k)[j]).sum()
        });
        Ok(Surface {
            size: half.x.min(half.y).min(half.z),
            curvature: 1.0 / half.x.min(half.y).min(half.z),
            bounding_radius: sphere.center().length() + sphere.radius(),
            lowest: bounds.mins.z,
            inertia_per_mass: inertia,
            shape,
        })
    }

    /// Half the smallest extent, m: the radius of a sphere.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Radius of the sphere about the centre of mass that holds the whole body, m.
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// z of the lowest point below the centre of mass, m.
    pub fn lowest(&self) -> f64 {
        self.lowest
    }

    /// Inertia of a homogeneous body over its mass, m², body axes.
    pub fn inertia_per_mass(&self) -> Matrix3<f64> {
        self.inertia_per_mass
    }

    /// Whether its curvature is nowhere larger than that of a sphere of its size, so that node contact suffices for a
    /// fine mesh.
    pub fn is_round(&self) -> bool {
        matches!(self.shape, Shape::Ball(_) | Shape::Capsule(_))
    }
}

/// The same vector of parry.
#[inline(always)]
fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

impl Shape {
    fn as_parry(&self) -> &dyn parry3d_f64::shape::Shape {
        match self {
            Shape::Ball(ball) => ball,
            Shape::Capsule(capsule) => capsule,
            Shape::Other(shape) => &**shape,
        }
    }

    /// The shape moved `by` a vector (m); balls and capsules are centred already.
    fn moved(self, by: Vector) -> Shape {
        match self {
            Shape::Ball(_) | Shape::Capsule(_) => self,
            Shape::Other(_) if by.length() == 0.0 => self,
            Shape::Other(shape) => match shape.as_trimesh() {
                Some(mesh) => {
                    let mut mesh = mesh.clone();
                    mesh.transform_vertices(&Pose::from_translation(by));
                    Shape::Other(SharedShape::new(mesh))
                }
                None => Shape::Other(SharedShape::compound(vec![(Pose::from_translation(by), shape)])),
            },
        }
    }
}

fn rotation_y_to_z() -> Rotation {
    Rotation::from_rotation_arc(Vector::Y, Vector::Z)
}

fn closed_mesh(vertices: &[Point3<f64>], indices: Vec<[u32; 3]>) -> Result<TriMesh, SurfaceError> {
    let vertices = vertices.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
    let flags = TriMeshFlags::ORIENTED | TriMeshFlags::MERGE_DUPLICATE_VERTICES | TriMeshFlags::HALF_EDGE_TOPOLOGY;
    TriMesh::with_flags(vertices, indices, flags).map_err(|_| SurfaceError::NotASurface)
}

/// A sphere, a hemisphere-ended shaft and a cylinder.
#[cfg(test)]
fn test_shapes() -> Vec<Surface> {
    [Surface::sphere(0.15), Surface::hemisphere(0.02, 0.1), Surface::cylinder(0.03, 0.2)].map(Result::unwrap).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_has_its_inertia() {
        let inertia = test_shapes()[0].inertia_per_mass();
        assert!((inertia - Matrix3::from_diagonal_element(0.4 * 0.15 * 0.15)).norm() < 1e-12);
    }
}
