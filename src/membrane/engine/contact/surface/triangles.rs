//! The surface as triangles, for pictures and recordings.

use nalgebra::Point3;
use parry3d_f64::math::Vector;
use parry3d_f64::shape::{Compound, Shape, TypedShape};

use super::Surface;

/// Vertices (m) and triangles of a surface.
pub(crate) type Triangles = (Vec<Point3<f64>>, Vec<[u32; 3]>);

impl Surface {
    /// Vertices about the centre of mass and triangles; circles have `sides` sides.
    pub fn triangles(&self, sides: u32) -> Triangles {
        triangulated(self.shape.as_parry(), sides)
    }
}

/// Triangles of one of the shapes that a [`Surface`] can have.
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

/// The triangles of all parts of a compound.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The volume by the divergence theorem is that of the shape less what flat faces cut off, so that all normals
    /// point outwards.
    #[test]
    fn triangulations_have_the_volume_of_their_shapes() {
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
}
