//! The surface as triangles, for pictures and recordings.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::query::{PointQuery, PointQueryWithLocation};
use parry3d_f64::shape::{Ball, Shape as ParryShape, TypedShape};
use parry3d_f64::transformation::try_convex_hull;

use super::bars::Bars;
use super::convex::{Solid, signed};
use super::projection::Projection;
use super::{Part, Shape, Surface, vector};

/// Vertices (m) and triangles of a surface.
pub(crate) type Triangles = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// Sides of a circle of a rounded edge over those of a large circle.
const EDGE_SIDES: u32 = 3;

impl Surface {
    /// Vertices about the centre of mass and triangles; circles have `sides` sides.
    pub fn triangles(&self, sides: u32) -> Triangles {
        triangulated(&self.shape, sides)
    }
}

fn triangulated(shape: &Shape, sides: u32) -> Triangles {
    match shape {
        Shape::Ball(ball) => points(ball.to_trimesh(sides, sides / 2)),
        Shape::Capsule(capsule) => points(capsule.to_trimesh(sides, sides / 2)),
        Shape::Solid(solid) => of_solid(solid, sides),
        Shape::Compound(parts) => joined(parts, sides),
        Shape::Bars(bars) => tubes(bars, sides),
    }
}

fn points((vertices, triangles): (Vec<Vector>, Vec<[u32; 3]>)) -> Triangles {
    (vertices.iter().map(|v| Point3::new(v.x, v.y, v.z)).collect(), triangles)
}

/// The core, or the convex hull of balls on its corners.
fn of_solid(solid: &Solid, sides: u32) -> Triangles {
    let (corners, triangles) = of_core(solid.core(), sides);
    let corners: Vec<Vector> = corners.into_iter().map(|corner| solid.place() * corner).collect();
    if solid.edge() == 0.0 {
        return points((corners, triangles));
    }
    let sides = (sides / EDGE_SIDES).max(6);
    let (ball, _) = Ball::new(solid.edge()).to_trimesh(sides, sides / 2);
    let all: Vec<Vector> = corners.iter().flat_map(|corner| ball.iter().map(move |point| *corner + *point)).collect();
    points(try_convex_hull(&all).unwrap_or((corners, triangles)))
}

/// Triangles of one of the shapes that the core of a [`Solid`] can have.
fn of_core(core: &dyn ParryShape, sides: u32) -> (Vec<Vector>, Vec<[u32; 3]>) {
    match core.as_typed_shape() {
        TypedShape::Cylinder(cylinder) => cylinder.to_trimesh(sides),
        TypedShape::Cone(cone) => cone.to_trimesh(sides),
        TypedShape::Cuboid(cuboid) => cuboid.to_trimesh(),
        TypedShape::TriMesh(mesh) => (mesh.vertices().to_vec(), mesh.indices().to_vec()),
        _ => (vec![], vec![]),
    }
}

/// The bars as tubes with about half as many sides and flat ends.
fn tubes(bars: &Bars, sides: u32) -> Triangles {
    // Of so many sides, corners lie at the crest and at the lowest line, and none where walls begin.
    let sides = 4 * (sides / 8).max(1) + 2;
    let (mut vertices, mut triangles) = (vec![], vec![]);
    for sections in bars.sections(sides) {
        let first = vertices.len() as u32;
        vertices.extend(sections.into_iter().flatten().map(Point3::from));
        let at = |section: u32, side: u32| first + section * sides + side % sides;
        for side in 0..sides {
            let [a, b] = [at(0, side), at(0, side + 1)];
            let [c, d] = [at(1, side + 1), at(1, side)];
            triangles.extend([[a, c, b], [a, d, c]]);
        }
        for side in 1..sides - 1 {
            triangles.push([at(0, 0), at(0, side), at(0, side + 1)]);
            triangles.push([at(1, 0), at(1, side + 1), at(1, side)]);
        }
    }
    (vertices, triangles)
}

/// The triangles of all parts.
fn joined(parts: &[Part], sides: u32) -> Triangles {
    let (mut vertices, mut triangles) = (vec![], vec![]);
    for Part { place, shape, .. } in parts {
        let (own, corners) = triangulated(shape, sides);
        let first = vertices.len() as u32;
        vertices.extend(own.iter().map(|point| place * point));
        triangles.extend(corners.iter().map(|corners| corners.map(|n| first + n)));
    }
    (vertices, triangles)
}

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

#[cfg(test)]
mod tests {
    use super::*;

    impl Nearest {
        /// Whether `other` is what was known before.
        pub(in crate::engine::contact::surface) fn is_kept(&self, other: &Nearest) -> bool {
            self.from == other.from && self.others == other.others
        }

        /// Whether it was found without a search over the whole mesh, since the point lies over a face.
        pub(in crate::engine::contact::surface) fn is_under(&self) -> bool {
            self.others == self.distance
        }
    }

    /// The volume by the divergence theorem is that of the shape less what flat faces cut off, so that all normals
    /// point outwards.
    #[test]
    fn triangulations_have_the_volume_of_their_shapes() {
        use std::f64::consts::PI;
        let [radius, length]: [f64; 2] = [0.02, 0.1];
        let (ball, shaft) = (4.0 / 3.0 * PI * radius.powi(3), PI * radius * radius * length);
        let rounded_box =
            |m: f64, e: f64| 8.0 * m.powi(3) + 24.0 * m * m * e + 6.0 * PI * m * e * e + 4.0 / 3.0 * PI * e.powi(3);
        for (surface, volume, lowest) in [
            (Surface::sphere(radius), ball, -radius),
            (Surface::capsule(radius, length), ball + shaft, -radius - 0.5 * length),
            (Surface::cylinder(radius, length, 0.0), shaft, -0.5 * length),
            // A box of the side 2r with edges of r/4: 8 m³ + 24 m² e + 6π m e² + 4π/3 e³ with the half side m of its
            // core.
            (Surface::cuboid([2.0 * radius; 3], 0.25 * radius), rounded_box(0.75 * radius, 0.25 * radius), -radius),
            // Its centre of mass is a quarter of its length above the flat end.
            (Surface::cone(radius, length, 0.0), shaft / 3.0, -0.75 * length),
            (Surface::bars(&[[[0.0, 0.0], [0.0, length]]], radius, 0.0), shaft, -radius),
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
}
