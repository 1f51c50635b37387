//! Distances between the impactor's shape and points and triangles of film: the one file that names parry.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::details::closest_points_segment_segment_with_locations;
use parry3d_f64::query::{self, PointProjection, PointQuery};
use parry3d_f64::shape::{
    Ball, Capsule, Compound, Cylinder, Segment, Shape, SharedShape, TriMesh, TriMeshFlags, Triangle, TypedShape,
};
use thiserror::Error;

use crate::lane::{LANES, Lane, Lane3, dot, larger, smaller, splat};

/// The impactor's surface about its centre of mass, body axes.
#[derive(Clone, Debug)]
pub struct Surface {
    shape: Kind,
    size: f64,
    bounding_radius: f64,
    lowest: f64,
    inertia_per_mass: Matrix3<f64>,
    /// One over `size`: the largest curvature of what is round, 1/m.
    curvature: f64,
}

/// Vertices (m) and triangles of a surface.
pub type Triangles = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// The round ones apart: their queries are resolved at compile time and exact, where other shapes are searched.
#[derive(Clone, Debug)]
enum Kind {
    Ball(Ball),
    /// About its centre, upright in body axes.
    Capsule(Capsule),
    Other(SharedShape),
}

/// Where a point of film stands towards the impactor.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Distance from the surface, negative inside, m.
    pub gap: f64,
    /// Outward unit normal of the impactor.
    pub normal: Vector3<f64>,
}

/// Deepest point of an element of film.
#[derive(Clone, Copy, Debug)]
pub struct FaceTouch {
    /// The point's own touch.
    pub touch: Touch,
    /// Weights of the element's corners in it.
    pub weights: [f64; 4],
}

/// Why a triangle surface is not an impactor.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SurfaceError {
    #[error("the impactor's surface is not a closed, orientable mesh of triangles")]
    NotASurface,
    #[error("the impactor's surface encloses no volume")]
    NoVolume,
}

impl Surface {
    /// A sphere of `radius` (m).
    ///
    /// # Errors
    /// [`SurfaceError::NoVolume`], as with all shapes.
    pub fn sphere(radius: f64) -> Result<Surface, SurfaceError> {
        Surface::about_centre(Kind::Ball(Ball::new(radius)))
    }

    /// A shaft along z of `radius` and `length` (m) with a hemisphere at each end: the lower one is the tip.
    pub fn hemisphere(radius: f64, length: f64) -> Result<Surface, SurfaceError> {
        let (low, high) = (Vector::new(0.0, 0.0, -0.5 * length), Vector::new(0.0, 0.0, 0.5 * length));
        Surface::about_centre(Kind::Capsule(Capsule::new(low, high, radius)))
    }

    /// A flat-ended cylinder along z of `radius` and `length` (m).
    pub fn cylinder(radius: f64, length: f64) -> Result<Surface, SurfaceError> {
        let upright = Pose::from_parts(Vector::ZERO, rotation_y_to_z());
        let cylinder = SharedShape::new(Cylinder::new(0.5 * length, radius));
        Surface::about_centre(Kind::Other(SharedShape::compound(vec![(upright, cylinder)])))
    }

    /// A closed, orientable surface of `triangles`.
    ///
    /// # Errors
    /// [`SurfaceError::NotASurface`] where it is open or not orientable.
    pub fn closed_mesh(triangles: Triangles) -> Result<Surface, SurfaceError> {
        let (vertices, indices) = triangles;
        Surface::about_centre(Kind::Other(SharedShape::new(closed_mesh(&vertices, indices)?)))
    }

    fn about_centre(shape: Kind) -> Result<Surface, SurfaceError> {
        let properties = shape.as_shape().mass_properties(1.0);
        let mass = properties.mass();
        if !(mass.is_finite() && mass > 0.0) {
            return Err(SurfaceError::NoVolume);
        }
        let centre = properties.local_com;
        let shape = shape.moved(-centre);
        let bounds = shape.as_shape().compute_local_aabb();
        let half = bounds.half_extents();
        let sphere = shape.as_shape().compute_local_bounding_sphere();
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

    /// Vertices about the centre of mass and triangles, for pictures; what is round has so many `sides`.
    pub fn triangles(&self, sides: u32) -> Triangles {
        triangulated(self.shape.as_shape(), sides)
    }

    /// Half the smallest extent, m: the radius of a sphere.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Distance from the centre of mass within which the whole body lies, m.
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

    /// Whether it is nowhere more curved than a sphere of its size, so that a fine mesh touches it at nodes alone.
    pub fn is_round(&self) -> bool {
        matches!(self.shape, Kind::Ball(_) | Kind::Capsule(_))
    }

    /// Where `point` stands towards the body at `pose`.
    #[inline(always)]
    pub fn touch(&self, pose: &Isometry3<f64>, point: &Point3<f64>) -> Touch {
        let arm = point.coords - pose.translation.vector;
        match &self.shape {
            // A ball looks the same however it is turned, and a point's projection on it is the normal itself.
            Kind::Ball(ball) => {
                let point = ball.project_local_point(vector(&arm), false).point * self.curvature;
                let is_centre = arm.norm_squared() == 0.0;
                let normal = if is_centre { ANYWHERE.into() } else { Vector3::new(point.x, point.y, point.z) };
                Touch { gap: arm.dot(&normal) - ball.radius, normal }
            }
            Kind::Capsule(capsule) => {
                let axis = pose.rotation * Vector3::z();
                let off = arm - axis * along(capsule, arm.dot(&axis));
                let length = off.norm();
                let normal = if length > 0.0 { off / length } else { pose.rotation * Vector3::x() };
                Touch { gap: length - capsule.radius, normal }
            }
            Kind::Other(shape) => turned_touch(&**shape, pose, &arm),
        }
    }

    /// Distances and outward normals of points at `arm` (m) from the centre of mass of the body at `pose`, as [`Surface::touch`] has
    /// them; only those where `close` is one count. On what is round, parry's projection is written out for all lanes at once.
    #[inline(always)]
    pub(in crate::engine) fn touch_lanes(&self, pose: &Isometry3<f64>, arm: &Lane3, close: &Lane) -> (Lane, Lane3) {
        let (mut gap, mut normal): (Lane, Lane3) = (splat(0.0), [splat(0.0); 3]);
        match &self.shape {
            Kind::Ball(ball) => {
                let squared = dot(arm, arm);
                let mut scale: Lane = splat(0.0);
                for l in 0..LANES {
                    let length = squared[l].sqrt();
                    gap[l] = length - ball.radius;
                    scale[l] = 1.0 / length;
                }
                for axis in 0..3 {
                    for l in 0..LANES {
                        normal[axis][l] = if squared[l] > 0.0 { arm[axis][l] * scale[l] } else { ANYWHERE[axis] };
                    }
                }
            }
            Kind::Capsule(capsule) => {
                let axis = pose.rotation * Vector3::z();
                let (axis, aside) = ([axis.x, axis.y, axis.z], pose.rotation * Vector3::x());
                for l in 0..LANES {
                    let place = along(capsule, arm[0][l] * axis[0] + arm[1][l] * axis[1] + arm[2][l] * axis[2]);
                    let off = [0, 1, 2].map(|k| arm[k][l] - axis[k] * place);
                    let length = (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]).sqrt();
                    gap[l] = length - capsule.radius;
                    (0..3).for_each(|k| normal[k][l] = if length > 0.0 { off[k] / length } else { aside[k] });
                }
            }
            Kind::Other(shape) => {
                for l in (0..LANES).filter(|l| close[*l] > 0.0) {
                    let touch = turned_touch(&**shape, pose, &Vector3::new(arm[0][l], arm[1][l], arm[2][l]));
                    gap[l] = touch.gap;
                    (0..3).for_each(|axis| normal[axis][l] = touch.normal[axis]);
                }
            }
        }
        (gap, normal)
    }

    /// Bound on the depth (m, negative outside) of any point of an element: on what is round, a point of a triangle is not nearer
    /// to its axis (of a ball, its centre) than √(d² − l²/3), d from the nearest corner and l the longest line. No bound on other
    /// shapes.
    pub(in crate::engine) fn deepest_at_most(&self, pose: &Isometry3<f64>, corners: &[Point3<f64>; 4]) -> f64 {
        if !self.is_round() {
            return f64::INFINITY;
        }
        let mean = Point3::from(corners.iter().map(|c| c.coords).sum::<Vector3<f64>>() * 0.25);
        let nearest = corners.iter().chain([&mean]).map(|c| self.axis_distance_squared(pose, c));
        let lines = (0..4).flat_map(|a| [(corners[a], corners[(a + 1) % 4]), (corners[a], mean)]);
        let longest = lines.map(|(a, b)| nalgebra::distance_squared(&a, &b)).fold(0.0, f64::max);
        self.size - larger(nearest.fold(f64::INFINITY, f64::min) - longest / 3.0, 0.0).sqrt()
    }

    /// Squared distance of `point` from the axis of a capsule, from the centre of all else, m².
    fn axis_distance_squared(&self, pose: &Isometry3<f64>, point: &Point3<f64>) -> f64 {
        let arm = point.coords - pose.translation.vector;
        match &self.shape {
            Kind::Capsule(capsule) => {
                let axis = pose.rotation * Vector3::z();
                (arm - axis * along(capsule, arm.dot(&axis))).norm_squared()
            }
            Kind::Ball(_) | Kind::Other(_) => arm.norm_squared(),
        }
    }

    /// The point of an element of film that is nearest to, or deepest in, the body at `pose`; `None` where it is farther than
    /// `within` (m). The element is the four triangles between its edges and the mean of its corners.
    ///
    /// On what is round the point is exact. On other shapes it is the deepest of nine points spread over the element and, where
    /// the element is coarse against the shape, of parry's contact with each triangle.
    pub fn deepest(&self, pose: &Isometry3<f64>, corners: &[Point3<f64>; 4], within: f64) -> Option<FaceTouch> {
        let mean = Point3::from(corners.iter().map(|c| c.coords).sum::<Vector3<f64>>() * 0.25);
        let triangles = (0..4).map(|a| [a, (a + 1) % 4]);
        let mut best: Option<FaceTouch> = None;
        let mut offer = |weights: [f64; 4]| {
            let place = (0..4).map(|a| corners[a].coords * weights[a]).sum::<Vector3<f64>>();
            let touch = self.touch(pose, &place.into());
            if touch.gap < best.map_or(within, |b| b.touch.gap) {
                best = Some(FaceTouch { touch, weights });
            }
        };
        let shape = match &self.shape {
            Kind::Ball(_) => {
                for [a, b] in triangles {
                    let triangle = self.local(pose, [&corners[a], &corners[b], &mean]);
                    let nearest = triangle.project_local_point(Vector::ZERO, false).point;
                    offer(spread(a, b, barycentric(&triangle, nearest)));
                }
                return best;
            }
            Kind::Capsule(capsule) => {
                for [a, b] in triangles {
                    let triangle = self.local(pose, [&corners[a], &corners[b], &mean]);
                    let nearest = nearest_to_axis(&triangle, &capsule.segment);
                    offer(spread(a, b, barycentric(&triangle, nearest)));
                }
                return best;
            }
            Kind::Other(shape) => shape,
        };
        SAMPLES.iter().for_each(|weights| offer(*weights));
        let coarse = nalgebra::distance(&corners[0], &corners[2]).max(nalgebra::distance(&corners[1], &corners[3]));
        if coarse > COARSE * self.size {
            for [a, b] in triangles {
                let triangle = self.local(pose, [&corners[a], &corners[b], &mean]);
                let found = query::contact(&Pose::IDENTITY, &triangle, &Pose::IDENTITY, &**shape, within.max(0.0));
                if let Ok(Some(contact)) = found {
                    offer(spread(a, b, barycentric(&triangle, contact.point1)));
                }
            }
        }
        best
    }

    fn local(&self, pose: &Isometry3<f64>, corners: [&Point3<f64>; 3]) -> Triangle {
        let arms = corners.map(|c| c.coords - pose.translation.vector);
        let [a, b, c] = match &self.shape {
            Kind::Ball(_) => arms.map(|arm| vector(&arm)),
            Kind::Capsule(_) | Kind::Other(_) => arms.map(|arm| vector(&pose.rotation.inverse_transform_vector(&arm))),
        };
        Triangle::new(a, b, c)
    }
}

/// Normal of a ball at its centre, from where its surface is as near everywhere.
const ANYWHERE: [f64; 3] = [0.0, 1.0, 0.0];

/// Longest line of an element over the shape's size from which its triangles are looked at as a whole.
const COARSE: f64 = 0.25;

/// Weights of the corners at the natural coordinates −⅔, 0, ⅔ of a bilinear element.
const SAMPLES: [[f64; 4]; 9] = {
    let mut samples = [[0.0; 4]; 9];
    let mut k = 0;
    while k < 9 {
        let (x, y) = ((k % 3) as f64 * (2.0 / 3.0) - 2.0 / 3.0, (k / 3) as f64 * (2.0 / 3.0) - 2.0 / 3.0);
        samples[k] = [
            0.25 * (1.0 - x) * (1.0 - y),
            0.25 * (1.0 + x) * (1.0 - y),
            0.25 * (1.0 + x) * (1.0 + y),
            0.25 * (1.0 - x) * (1.0 + y),
        ];
        k += 1;
    }
    samples
};

/// Weights of an element's corners at a point of its triangle over the corners `a`, `b` and their mean.
fn spread(a: usize, b: usize, [wa, wb, wm]: [f64; 3]) -> [f64; 4] {
    let mut weights = [0.25 * wm; 4];
    weights[a] += wa;
    weights[b] += wb;
    weights
}

/// Signed distance and outward normal at a point whose projection on the surface is known, both in the same axes.
#[inline(always)]
fn outward(point: &Vector3<f64>, projection: PointProjection) -> Touch {
    let arm = vector(point) - projection.point;
    let distance = arm.length();
    let side = if projection.is_inside { -1.0 } else { 1.0 };
    let normal = if distance > 0.0 { arm * (side / distance) } else { vector(point).normalize_or(Vector::NEG_Z) };
    Touch { gap: side * distance, normal: Vector3::new(normal.x, normal.y, normal.z) }
}

/// The place on an upright capsule's axis that is nearest to a point `z` (m) along it from the centre.
#[inline(always)]
fn along(capsule: &Capsule, z: f64) -> f64 {
    smaller(larger(z, capsule.segment.a.z), capsule.segment.b.z)
}

/// The point of a triangle that is nearest to an upright axis which does not pierce it.
fn nearest_to_axis(triangle: &Triangle, axis: &Segment) -> Vector {
    let corners = [triangle.a, triangle.b, triangle.c];
    let under = |end: Vector| triangle.project_local_point(end, false).point;
    if corners.iter().all(|corner| corner.z <= axis.a.z) {
        return under(axis.a);
    }
    let at_edges = triangle.edges().map(|edge| {
        let (on_edge, _) = closest_points_segment_segment_with_locations(&Pose::IDENTITY, &edge, axis);
        edge.point_at(&on_edge)
    });
    let candidates = at_edges.into_iter().chain([under(axis.a), under(axis.b)]);
    let squared = |point: &Vector| (*point - axis.project_local_point(*point, false).point).length_squared();
    candidates.min_by(|a, b| squared(a).total_cmp(&squared(b))).unwrap_or(triangle.a)
}

fn turned_touch(shape: &dyn Shape, pose: &Isometry3<f64>, arm: &Vector3<f64>) -> Touch {
    let local = pose.rotation.inverse_transform_vector(arm);
    let touch = outward(&local, shape.project_local_point(vector(&local), false));
    Touch { normal: pose.rotation * touch.normal, ..touch }
}

#[inline(always)]
fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

impl Kind {
    fn as_shape(&self) -> &dyn Shape {
        match self {
            Kind::Ball(ball) => ball,
            Kind::Capsule(capsule) => capsule,
            Kind::Other(shape) => &**shape,
        }
    }

    fn moved(self, by: Vector) -> Kind {
        match self {
            Kind::Ball(_) | Kind::Capsule(_) => self,
            Kind::Other(_) if by.length() == 0.0 => self,
            Kind::Other(shape) => match shape.as_trimesh() {
                Some(mesh) => {
                    let mut mesh = mesh.clone();
                    mesh.transform_vertices(&Pose::from_translation(by));
                    Kind::Other(SharedShape::new(mesh))
                }
                None => Kind::Other(SharedShape::compound(vec![(Pose::from_translation(by), shape)])),
            },
        }
    }
}

/// Triangles of one of the shapes that a [`Surface`] can have; none of others.
fn triangulated(shape: &dyn Shape, sides: u32) -> Triangles {
    let (vertices, triangles) = match shape.as_typed_shape() {
        TypedShape::Ball(ball) => ball.to_trimesh(sides, sides / 2),
        TypedShape::Capsule(capsule) => capsule.to_trimesh(sides, sides / 2),
        TypedShape::Cylinder(cylinder) => cylinder.to_trimesh(sides),
        TypedShape::TriMesh(mesh) => (mesh.vertices().to_vec(), mesh.indices().to_vec()),
        TypedShape::Compound(compound) => return joined(compound, sides),
        _ => (vec![], vec![]),
    };
    (vertices.iter().map(|v| Point3::new(v.x, v.y, v.z)).collect(), triangles)
}

fn joined(compound: &Compound, sides: u32) -> Triangles {
    let (mut vertices, mut triangles) = (vec![], vec![]);
    for (pose, part) in compound.shapes() {
        let (own, corners) = triangulated(&**part, sides);
        let first = vertices.len() as u32;
        let placed = own.iter().map(|p| pose * Vector::new(p.x, p.y, p.z));
        vertices.extend(placed.map(|v| Point3::new(v.x, v.y, v.z)));
        triangles.extend(corners.iter().map(|corners| corners.map(|n| first + n)));
    }
    (vertices, triangles)
}

fn rotation_y_to_z() -> parry3d_f64::math::Rotation {
    parry3d_f64::math::Rotation::from_rotation_arc(Vector::Y, Vector::Z)
}

fn closed_mesh(vertices: &[Point3<f64>], indices: Vec<[u32; 3]>) -> Result<TriMesh, SurfaceError> {
    let vertices = vertices.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
    let flags = TriMeshFlags::ORIENTED | TriMeshFlags::MERGE_DUPLICATE_VERTICES | TriMeshFlags::HALF_EDGE_TOPOLOGY;
    TriMesh::with_flags(vertices, indices, flags).map_err(|_| SurfaceError::NotASurface)
}

fn barycentric(triangle: &Triangle, point: Vector) -> [f64; 3] {
    let (u, v, w) = (triangle.b - triangle.a, triangle.c - triangle.a, point - triangle.a);
    let (uu, uv, vv, wu, wv) = (u.dot(u), u.dot(v), v.dot(v), w.dot(u), w.dot(v));
    let determinant = uu * vv - uv * uv;
    if determinant <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let b = smaller(larger((vv * wu - uv * wv) / determinant, 0.0), 1.0);
    let c = smaller(larger((uu * wv - uv * wu) / determinant, 0.0), 1.0 - b);
    [1.0 - b - c, b, c]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> Vec<Surface> {
        [Surface::sphere(0.15), Surface::hemisphere(0.02, 0.1), Surface::cylinder(0.03, 0.2)].map(Result::unwrap).into()
    }

    /// Volumes by the divergence theorem are those of the shapes, but for what flat pieces cut off; all faces look outwards.
    #[test]
    fn pictures_of_shapes_have_their_volume() {
        use std::f64::consts::PI;
        let [radius, length]: [f64; 2] = [0.02, 0.1];
        let (ball, shaft) = (4.0 / 3.0 * PI * radius.powi(3), PI * radius * radius * length);
        for (surface, volume, lowest) in [
            (Surface::sphere(radius), ball, -radius),
            (Surface::hemisphere(radius, length), ball + shaft, -radius - 0.5 * length),
            (Surface::cylinder(radius, length), shaft, -0.5 * length),
        ] {
            let (vertices, triangles) = surface.unwrap().triangles(48);
            let six = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|n| vertices[n as usize].coords);
                a.dot(&b.cross(&c))
            };
            let found = triangles.iter().map(six).sum::<f64>() / 6.0;
            assert!((0.98 * volume..volume).contains(&found), "{found} for {volume}");
            let bottom = vertices.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
            assert!((bottom - lowest).abs() < 1e-12, "{bottom} for {lowest}");
        }
    }

    #[test]
    fn gaps_and_normals_below_the_tip() {
        for surface in shapes() {
            let pose = Isometry3::translation(0.1, -0.2, 0.5);
            for depth in [-0.004, 0.003, 0.02] {
                let point = Point3::new(0.1, -0.2, 0.5 + surface.lowest() - depth);
                let touch = surface.touch(&pose, &point);
                assert!((touch.gap - depth).abs() < 1e-12, "{} for {depth}", touch.gap);
                assert!((touch.normal + Vector3::z()).norm() < 1e-9);
            }
        }
    }

    /// A node in the middle of the body has to leave it somewhere.
    #[test]
    fn points_at_the_centre_and_on_the_axis_have_a_normal() {
        for surface in shapes() {
            let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::zeros());
            for height in [0.0, 0.5, -1.0].map(|share| share * (surface.size() + surface.lowest())) {
                let arm = Vector3::new(0.0, 0.0, height);
                let (gap, normal) = surface.touch_lanes(&pose, &[0, 1, 2].map(|axis| splat(arm[axis])), &splat(1.0));
                let lanes = Touch { gap: gap[0], normal: Vector3::from_fn(|axis, _| normal[axis][0]) };
                for touch in [lanes, surface.touch(&pose, &(pose.translation.vector + arm).into())] {
                    assert!((touch.gap + surface.size()).abs() < 1e-12, "{touch:?}");
                    assert!((touch.normal.norm() - 1.0).abs() < 1e-12, "{touch:?}");
                }
            }
        }
    }

    #[test]
    fn lanes_find_what_parry_finds() {
        for surface in shapes() {
            let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::new(0.3, 0.2, -0.1));
            let arm: Lane3 = [0, 1, 2].map(|axis| {
                std::array::from_fn(|l| surface.size() * (0.3 + 0.11 * l as f64) * [0.6, -0.5, -0.9][axis])
            });
            let (gap, normal) = surface.touch_lanes(&pose, &arm, &splat(1.0));
            for l in 0..LANES {
                let arm = Vector3::new(arm[0][l], arm[1][l], arm[2][l]);
                let parrys = turned_touch(surface.shape.as_shape(), &pose, &arm);
                let lanes = Touch { gap: gap[l], normal: Vector3::from_fn(|axis, _| normal[axis][l]) };
                for touch in [lanes, surface.touch(&pose, &(pose.translation.vector + arm).into())] {
                    let off = touch.normal - parrys.normal;
                    assert!((touch.gap - parrys.gap).abs() < 1e-15 && off.norm() < 1e-13, "lane {l}: {touch:?}");
                }
            }
        }
    }

    /// A square of film and a triangle (which repeats its last corner), both reaching 1 mm into the tip.
    #[test]
    fn the_deepest_point_of_an_element_lies_under_the_tip() {
        for surface in shapes() {
            let z = surface.lowest() + 1e-3;
            let [a, b, c, d] = [[-0.5, -0.4], [0.5, -0.4], [0.6, 0.5], [-0.4, 0.6]].map(|[x, y]| Point3::new(x, y, z));
            for corners in [[a, b, c, d], [a, b, c, c]] {
                let found = surface.deepest(&Isometry3::identity(), &corners, 0.0).unwrap();
                assert!((found.touch.gap + 1e-3).abs() < 1e-6, "{found:?}");
                assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
    }

    /// Triangles of film beside, below and above a dart, against parry's own distance between triangle and axis.
    #[test]
    fn the_deepest_point_on_a_capsule_is_the_nearest_to_its_axis() {
        let surface = &shapes()[1];
        let axis = Segment::new(Vector::new(0.0, 0.0, -0.05), Vector::new(0.0, 0.0, 0.05));
        let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::new(0.3, 0.2, -0.1));
        for k in 0..60 {
            let turn = f64::from(k);
            let (sin, cos) = (0.7 * turn).sin_cos();
            let middle = Vector3::new(0.025 * cos, 0.025 * sin, 0.09 * (1.3 * turn).sin());
            let side = Vector3::new(-sin, cos, 0.4 * (2.1 * turn).cos()) * 0.02;
            let up = Vector3::new(0.3 * cos, 0.3 * sin, 1.0) * 0.015;
            let corners = [middle - side, middle + side, middle + up, middle + up].map(|c| pose * Point3::from(c));
            let Some(found) = surface.deepest(&pose, &corners, f64::INFINITY) else { panic!("nothing at {k}") };
            let local = |a: usize| vector(&(pose.inverse() * corners[a]).coords);
            let triangle = Triangle::new(local(0), local(1), local(2));
            let distance = query::distance(&Pose::IDENTITY, &triangle, &Pose::IDENTITY, &axis).unwrap().distance;
            assert!((found.touch.gap + surface.size() - distance).abs() < 1e-7, "{k}: {found:?} {distance}");
            assert!(surface.deepest_at_most(&pose, &corners) >= -found.touch.gap - 1e-12, "{k}");
        }
    }

    #[test]
    fn a_sphere_has_the_inertia_of_the_book() {
        let inertia = shapes()[0].inertia_per_mass();
        assert!((inertia - Matrix3::from_diagonal_element(0.4 * 0.15 * 0.15)).norm() < 1e-12);
    }
}
