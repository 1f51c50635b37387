//! The shape of the impactor as pictures show it, about its centre of mass, its axis along z.

use nalgebra::{Point3, Vector3};

use crate::mesh::{self, MeshError};
use crate::model::ImpactorShape;

/// Points on a quarter circle of a drawn hemisphere.
const ARC: u32 = 12;

/// A shape to be drawn, lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    Sphere {
        radius: f32,
    },
    /// Radius and height along the axis, from top to bottom.
    Revolved {
        profile: Vec<[f32; 2]>,
    },
    /// A closed surface.
    Surface {
        points: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
    },
}

impl Body {
    /// The shape about its centre of mass, as the run moves it.
    ///
    /// # Errors
    /// The file of a mesh cannot be read.
    pub fn of(shape: &ImpactorShape) -> Result<Body, MeshError> {
        Ok(match shape {
            ImpactorShape::Sphere { radius } => Body::Sphere { radius: *radius as f32 },
            ImpactorShape::Hemisphere { radius, length } => {
                Body::Revolved { profile: capsule(*radius as f32, *length as f32) }
            }
            ImpactorShape::Cylinder { radius, length } => {
                let [r, half] = [*radius as f32, *length as f32 / 2.0];
                Body::Revolved { profile: vec![[0.0, half], [r, half], [r, -half], [0.0, -half]] }
            }
            ImpactorShape::Mesh(path) => {
                let (points, triangles) = mesh::import::surface(path)?;
                let centre = centroid(&points, &triangles);
                let place = |p: &Point3<f64>| <[f64; 3]>::from(p - centre).map(|c| c as f32);
                Body::Surface { points: points.iter().map(place).collect(), triangles }
            }
        })
    }

    /// The outline of a body of revolution, radius and height along the axis from top to bottom.
    pub fn profile(&self) -> Option<Vec<[f32; 2]>> {
        match self {
            Body::Sphere { radius } => Some(capsule(*radius, 0.0)),
            Body::Revolved { profile } => Some(profile.clone()),
            Body::Surface { .. } => None,
        }
    }
}

/// A shaft of this length between two hemispheres, from top to bottom.
fn capsule(radius: f32, length: f32) -> Vec<[f32; 2]> {
    let arc = |index: u32, end: f32| {
        let angle = std::f32::consts::FRAC_PI_2 * index as f32 / ARC as f32;
        let (sin, cos) = angle.sin_cos();
        [radius * sin, end * (length / 2.0 + radius * cos)]
    };
    let top = (0..=ARC).map(|index| arc(index, 1.0));
    let bottom = (0..=ARC).rev().map(|index| arc(index, -1.0));
    let mut profile: Vec<[f32; 2]> = top.chain(bottom).collect();
    // Without a shaft the equator is one ring.
    profile.dedup();
    profile
}

/// Centre of mass of the homogeneous body inside a closed surface.
fn centroid(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Vector3<f64> {
    let corners = |t: &[u32; 3]| t.map(|node| points[node as usize].coords);
    let (volume, moment) =
        triangles.iter().map(corners).fold((0.0, Vector3::zeros()), |(volume, moment), [a, b, c]| {
            let six = a.dot(&b.cross(&c));
            (volume + six, moment + six * (a + b + c) / 4.0)
        });
    moment / volume
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_reaches_one_radius_beyond_its_shaft() {
        let profile = capsule(0.02, 0.1);
        let [top, bottom] = [profile[0], profile[profile.len() - 1]];
        assert!((top[1] - 0.07).abs() < 1e-7 && (bottom[1] + 0.07).abs() < 1e-7);
        assert!(profile.windows(2).all(|pair| pair[0][1] >= pair[1][1]));
    }

    #[test]
    fn the_centroid_of_a_tetrahedron_is_the_mean_of_its_corners() {
        let corners = [[1.0, 1.0, 1.0], [5.0, 1.0, 1.0], [1.0, 5.0, 1.0], [1.0, 1.0, 5.0]];
        let points = corners.map(Point3::from);
        let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let centre = centroid(&points, &triangles);
        assert!((centre - Vector3::new(2.0, 2.0, 2.0)).norm() < 1e-14);
    }
}
