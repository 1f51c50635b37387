//! Vertex normals: meshes without them are drawn unlit.

use crate::scene::{FilmFrame, FilmTrack};

/// Normals are rounded to 1/32: enough for light, and they compress.
const STEPS: f32 = 32.0;

/// One normal a node, weighted by the area of the triangles that are left around it; on a mirror
/// plane, which nodes nearer than `near` stand on, it lies in that plane, so that no crease shows.
pub fn of(film: &FilmTrack, frame: &FilmFrame, near: f32) -> Vec<[f32; 3]> {
    let left = film.triangles.iter().zip(&frame.visible);
    let left = left.filter(|(_, visible)| **visible).map(|(t, _)| *t);
    let mut normals = sums(&frame.positions, left);
    for (normal, position) in normals.iter_mut().zip(&frame.positions) {
        for axis in (0..2).filter(|axis| film.mirrored[*axis]) {
            if position[axis].abs() < near {
                normal[axis] = 0.0;
            }
        }
    }
    normals.into_iter().map(rounded_unit).collect()
}

/// One normal a point of a closed surface.
pub fn of_surface(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let sums = sums(points, triangles.iter().copied());
    sums.into_iter().map(rounded_unit).collect()
}

fn sums(points: &[[f32; 3]], triangles: impl Iterator<Item = [u32; 3]>) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|node| points[node as usize]);
        let area = cross(minus(b, a), minus(c, a));
        for node in triangle {
            let normal = &mut normals[node as usize];
            *normal = [0, 1, 2].map(|i| normal[i] + area[i]);
        }
    }
    normals
}

fn rounded_unit(normal: [f32; 3]) -> [f32; 3] {
    let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
    if length > 0.0 { normal.map(|c| (c / length * STEPS).round() / STEPS) } else { [0.0, 0.0, 1.0] }
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| a[i] * b[j] - a[j] * b[i])
}
