//! The rigid body: its shape once, its pose at every time.

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::archetypes::{Mesh3D, Transform3D};
use re_sdk_types::datatypes::{Quaternion, Rgba32};

use crate::normals;
use crate::scene::{BodyShape, BodyTrack, Pose};
use crate::series::Moment;

/// Steel that lets the film behind it show through.
const STEEL: [u8; 4] = [170, 178, 190, 100];

/// Sides of a revolved surface.
const SIDES: u32 = 64;

/// Pieces of the half circle that a sphere is turned from.
const ARC: u32 = 32;

/// Logs the shape.
pub(crate) fn log_shape(stream: &RecordingStream, body: &BodyTrack) -> RecordingStreamResult<()> {
    match &body.shape {
        BodyShape::Sphere { radius } => log_turned(stream, body, &half_circle(*radius)),
        BodyShape::Revolved { profile } => log_turned(stream, body, profile),
        BodyShape::Surface { points, triangles } => stream.log_static(entity(body), &surface(points, triangles)),
    }
}

/// Logs where the body is.
pub(crate) fn log_pose(stream: &RecordingStream, body: &BodyTrack, pose: &Pose) -> RecordingStreamResult<()> {
    Moment::Time(pose.time).set(stream);
    let moved = Transform3D::update_fields()
        .with_translation(pose.position)
        .with_quaternion(Quaternion::from_xyzw(pose.rotation));
    stream.log(entity(body), &moved)
}

fn entity(body: &BodyTrack) -> String {
    format!("scene/{}", body.name)
}

fn log_turned(stream: &RecordingStream, body: &BodyTrack, profile: &[[f32; 2]]) -> RecordingStreamResult<()> {
    let (points, triangles) = revolved(profile);
    stream.log_static(entity(body), &surface(&points, &triangles))
}

/// The profile of a sphere.
fn half_circle(radius: f32) -> Vec<[f32; 2]> {
    let angle = |piece: u32| std::f32::consts::PI * piece as f32 / ARC as f32;
    (0..=ARC).map(|piece| [radius * angle(piece).sin(), radius * angle(piece).cos()]).collect()
}

fn surface(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh3D {
    Mesh3D::new(points.iter().copied())
        .with_triangle_indices(triangles.iter().copied())
        .with_vertex_normals(normals::of_surface(points, triangles))
        .with_albedo_factor(Rgba32::from_unmultiplied_rgba(STEEL[0], STEEL[1], STEEL[2], STEEL[3]))
}

/// Rings of points and the triangles between them, facing outwards for a profile from top to bottom.
fn revolved(profile: &[[f32; 2]]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let angle = |side: u32| std::f32::consts::TAU * side as f32 / SIDES as f32;
    let ring = |&[radius, z]: &[f32; 2]| {
        let point = move |side| {
            let (sin, cos) = angle(side).sin_cos();
            [radius * cos, radius * sin, z]
        };
        (0..SIDES).map(point).collect::<Vec<_>>()
    };
    let points = profile.iter().flat_map(ring).collect();
    let between = |upper: u32| {
        let node = |ring: u32, side: u32| ring * SIDES + side % SIDES;
        let pair = move |side| {
            let [a, b] = [node(upper, side), node(upper, side + 1)];
            let [c, d] = [node(upper + 1, side), node(upper + 1, side + 1)];
            [[a, c, d], [a, d, b]]
        };
        (0..SIDES).flat_map(pair).collect::<Vec<_>>()
    };
    let rings = profile.len().saturating_sub(1) as u32;
    (points, (0..rings).flat_map(between).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_revolved_cylinder_has_its_volume_and_faces_outwards() {
        let (points, triangles) = revolved(&[[0.0, 1.0], [0.5, 1.0], [0.5, -1.0], [0.0, -1.0]]);
        let six = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|node| points[node as usize]);
            a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        let volume = triangles.iter().map(six).sum::<f32>() / 6.0;
        let sides = SIDES as f32;
        let polygon = sides / 2.0 * 0.25 * (std::f32::consts::TAU / sides).sin();
        assert!((volume - 2.0 * polygon).abs() < 1e-4, "{volume}");
    }
}
