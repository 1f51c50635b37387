//! The surface as triangles, for pictures and recordings.

use nalgebra::Point3;
use parry3d_f64::math::Vector;
use parry3d_f64::shape::{Ball, Shape as ParryShape, TypedShape};
use parry3d_f64::transformation::try_convex_hull;

use super::bars::Bars;
use super::solid::Solid;
use super::{Part, Shape, Surface};

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
