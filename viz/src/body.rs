//! The rigid body: its shape logged once, its pose at every time.

use std::collections::HashMap;

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::archetypes::{Mesh3D, Transform3D};
use re_sdk_types::datatypes::{Quaternion, Rgba32};

use crate::normals;
use crate::scene::{BodyTrack, Pose};
use crate::series::TIME;

/// Translucent steel, so that the film behind it is visible.
const STEEL: [u8; 4] = [170, 178, 190, 100];

/// Logs the shape.
pub(crate) fn log_shape(stream: &RecordingStream, body: &BodyTrack) -> RecordingStreamResult<()> {
    let Corners { points, normals, triangles } = Corners::from_body(body);
    let surface = Mesh3D::new(points)
        .with_triangle_indices(triangles)
        .with_vertex_normals(normals)
        .with_albedo_factor(Rgba32::from_unmultiplied_rgba(STEEL[0], STEEL[1], STEEL[2], STEEL[3]));
    stream.log_static(entity(body), &surface)
}

/// Logs the pose of the body.
pub(crate) fn log_pose(stream: &RecordingStream, body: &BodyTrack, pose: &Pose) -> RecordingStreamResult<()> {
    stream.set_duration_secs(TIME, pose.time);
    let moved = Transform3D::update_fields()
        .with_translation(pose.position)
        .with_quaternion(Quaternion::from_xyzw(pose.rotation));
    stream.log(entity(body), &moved)
}

fn entity(body: &BodyTrack) -> String {
    format!("scene/{}", body.name)
}

/// A surface with a vertex for each normal of a point: several at edges.
struct Corners {
    points: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Corners {
    fn from_body(body: &BodyTrack) -> Corners {
        let mut corners = Corners { points: vec![], normals: vec![], triangles: vec![] };
        let mut known = HashMap::new();
        for (triangle, normals) in body.triangles.iter().zip(normals::corner_normals(&body.points, &body.triangles)) {
            corners.triangles.push([0, 1, 2].map(|corner| {
                let (point, normal): (u32, [f32; 3]) = (triangle[corner], normals[corner]);
                // By the bits of the rounded normal, which faces around a smooth point share; a float is no key.
                *known.entry((point, normal.map(f32::to_bits))).or_insert_with(|| {
                    corners.points.push(body.points[point as usize]);
                    corners.normals.push(normal);
                    corners.points.len() as u32 - 1
                })
            }));
        }
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight corners with three normals each; a slanted one of a flat pyramid, one for all around.
    #[test]
    fn edges_are_sharp_and_what_is_round_is_smooth() {
        let body = |points: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>| BodyTrack {
            name: "body".to_owned(),
            points,
            triangles,
            poses: vec![],
        };
        let cube = (0..8).map(|corner| [corner & 1, corner >> 1 & 1, corner >> 2].map(|c| c as f32)).collect();
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let corners = Corners::from_body(&body(cube, halves.collect()));
        assert_eq!((corners.points.len(), corners.triangles.len()), (24, 12));
        for triangle in &corners.triangles {
            let normals = triangle.map(|corner| corners.normals[corner as usize]);
            assert!(normals.iter().all(|normal| *normal == normals[0]), "{normals:?}");
        }

        let pyramid = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.1]];
        let corners = Corners::from_body(&body(pyramid, vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]));
        let tip: Vec<_> = corners.points.iter().zip(&corners.normals).filter(|(point, _)| point[2] > 0.0).collect();
        assert_eq!(tip.iter().map(|(_, normal)| **normal).collect::<Vec<_>>(), [[0.0, 0.0, 1.0]]);
    }
}
