//! The impactor as the recording shows it.

use droptower_viz::{BodyShape, BodyTrack, Pose};
use nalgebra::{Point3, Vector3};

use crate::mesh::{self, MeshError};
use crate::model::{Impactor, ImpactorShape};
use crate::simulate::Frame;

/// Points on a quarter circle of a drawn hemisphere.
const ARC: u32 = 12;

/// The impactor in the states `frames`.
pub fn track(impactor: &Impactor, frames: &[Frame]) -> Result<BodyTrack, MeshError> {
    let poses = frames.iter().filter_map(pose).collect();
    Ok(BodyTrack { name: "impactor".to_owned(), shape: body_shape(&impactor.shape)?, poses })
}

/// Where the impactor is in a state.
pub fn pose(frame: &Frame) -> Option<Pose> {
    let (position, rotation) = frame.impactor?;
    Some(Pose { time: frame.time, position: position.map(|c| c as f32), rotation: rotation.map(|c| c as f32) })
}

/// The shape about its centre of mass, as the run moves it.
fn body_shape(shape: &ImpactorShape) -> Result<BodyShape, MeshError> {
    Ok(match shape {
        ImpactorShape::Sphere { radius } => BodyShape::Sphere { radius: *radius as f32 },
        ImpactorShape::Hemisphere { radius, length } => {
            BodyShape::Revolved { profile: capsule(*radius as f32, *length as f32) }
        }
        ImpactorShape::Cylinder { radius, length } => {
            let [r, half] = [*radius as f32, *length as f32 / 2.0];
            BodyShape::Revolved { profile: vec![[0.0, half], [r, half], [r, -half], [0.0, -half]] }
        }
        ImpactorShape::Mesh(path) => {
            let (points, triangles) = mesh::import::surface(path)?;
            let centre = centroid(&points, &triangles);
            let place = |p: &Point3<f64>| <[f64; 3]>::from(p - centre).map(|c| c as f32);
            BodyShape::Surface { points: points.iter().map(place).collect(), triangles }
        }
    })
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
    top.chain(bottom).collect()
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
