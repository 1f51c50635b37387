//! Vertex normals: meshes without them are drawn unlit.

use crate::scene::{FilmSnapshot, FilmTrack};

/// Normals are rounded to 1/32: enough for light, and they compress.
const STEPS: f32 = 32.0;

/// Cosine of the angle between two triangles from which there is an edge between them: 30°.
const EDGE: f32 = 0.866;

/// One normal a node, weighted by the area of the triangles that are left around it; on a mirror
/// plane, which nodes nearer than `near` stand on, it lies in that plane, so that no crease shows.
pub fn node_normals(film: &FilmTrack, snapshot: &FilmSnapshot, near: f32) -> Vec<[f32; 3]> {
    let left = film.triangles.iter().zip(&snapshot.visible);
    let left = left.filter(|(_, visible)| **visible).map(|(t, _)| *t);
    let mut normals = sums(&snapshot.positions, left);
    for (normal, position) in normals.iter_mut().zip(&snapshot.positions) {
        for axis in (0..2).filter(|axis| film.images.iter().any(|image| image[*axis] < 0.0)) {
            if position[axis].abs() < near {
                normal[axis] = 0.0;
            }
        }
    }
    normals.into_iter().map(rounded_unit).collect()
}

/// The normals at the corners of each triangle of a closed surface, weighted by the area of those around the corner
/// that do not turn away from it by more than an edge does.
pub fn corner_normals(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[[f32; 3]; 3]> {
    let areas: Vec<[f32; 3]> = triangles.iter().map(|triangle| area(points, triangle)).collect();
    let mut around: Vec<Vec<usize>> = vec![vec![]; points.len()];
    for (index, triangle) in triangles.iter().enumerate() {
        triangle.iter().for_each(|node| around[*node as usize].push(index));
    }
    let is_smooth = |one: &[f32; 3], other: &[f32; 3]| dot(one, other) > EDGE * length(one) * length(other);
    // A normal a corner, not a node: at an edge of a body the faces keep their own.
    let normal = |index: usize, node: u32| {
        let smooth = around[node as usize].iter().map(|other| areas[*other]).filter(|o| is_smooth(&areas[index], o));
        rounded_unit(smooth.fold([0.0; 3], plus))
    };
    triangles.iter().enumerate().map(|(index, triangle)| triangle.map(|node| normal(index, node))).collect()
}

fn sums(points: &[[f32; 3]], triangles: impl Iterator<Item = [u32; 3]>) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; points.len()];
    for triangle in triangles {
        // Not made a unit: a longer cross product gives a larger triangle its larger weight.
        let area = area(points, &triangle);
        for node in triangle {
            let normal = &mut normals[node as usize];
            *normal = plus(*normal, area);
        }
    }
    normals
}

/// Along its normal, twice as long as its area.
fn area(points: &[[f32; 3]], triangle: &[u32; 3]) -> [f32; 3] {
    let [a, b, c] = triangle.map(|node| points[node as usize]);
    cross(minus(b, a), minus(c, a))
}

fn rounded_unit(normal: [f32; 3]) -> [f32; 3] {
    let length = length(&normal);
    // Upward where no triangle is left: the viewer needs some direction.
    if length > 0.0 { normal.map(|c| (c / length * STEPS).round() / STEPS) } else { [0.0, 0.0, 1.0] }
}

fn length(a: &[f32; 3]) -> f32 {
    dot(a, a).sqrt()
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn plus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| a[i] * b[j] - a[j] * b[i])
}
