//! Meshes of elements of many shapes, in many directions.

use nalgebra::Point3;

use super::cells;
use crate::engine::Mesh;

/// Shape of the elements of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// Edges along and across the tear, m.
    pub edges: [f64; 2],
    /// Angle by which the mesh is turned, degrees.
    pub turned: f64,
    /// By how much rows are moved along themselves from one to the next, over the edge.
    pub skew: f64,
    /// By how much nodes are moved at random, over the edges.
    pub uneven: f64,
    /// Whether each quadrilateral is parted into two triangles, all by the diagonal from the same corner.
    pub triangles: bool,
}

impl Shape {
    pub(super) const fn even(edges: [f64; 2], turned: f64) -> Shape {
        Shape { edges, turned, skew: 0.0, uneven: 0.0, triangles: false }
    }

    /// Elements of this shape that cover a rectangle from 0 along x and about 0 along y, and so much (m) above and below.
    pub(super) fn mesh(&self, [length, height]: [f64; 2], beyond: f64) -> Mesh {
        let Shape { edges: [along, across], turned, skew, uneven, triangles } = *self;
        let reach = length + height;
        let [columns, rows] = [along, across].map(|edge| (2 * (reach / edge).ceil() as u32) | 1);
        let mut random = thorough::random(1);
        let (sin, cos) = turned.to_radians().sin_cos();
        let places: Vec<Point3<f64>> = (0..=rows)
            .flat_map(|j| (0..=columns).map(move |i| (f64::from(i), f64::from(j))))
            .map(|(i, j)| {
                let row = j - 0.5 * f64::from(rows);
                let [a, b] = [random(), random()].map(|r| 2.0 * uneven * (r - 0.5));
                let x = (i - 0.5 * f64::from(columns) + skew * row % 1.0 + a) * along;
                // Jaws hold straight lines of an even mesh.
                let is_held = turned == 0.0 && row.abs() * across > 0.5 * height - 1e-9;
                let y = if is_held { row * across } else { (row + b) * across };
                Point3::new(0.5 * length + cos * x - sin * y, sin * x + cos * y, 0.0)
            })
            .collect();
        let all = cells(columns, rows, |i, j| places[(j * (columns + 1) + i) as usize]);
        let within = |quad: &[u32; 4]| {
            let centre = quad.iter().map(|n| places[*n as usize].coords).sum::<nalgebra::Vector3<f64>>() / 4.0;
            (0.0..length).contains(&centre.x) && centre.y.abs() < 0.5 * height + beyond
        };
        let quads: Vec<[u32; 4]> = all.quads.into_iter().filter(within).collect();
        let mut numbers = vec![u32::MAX; places.len()];
        let mut mesh = Mesh::default();
        let mut number = |n: u32| {
            if numbers[n as usize] == u32::MAX {
                numbers[n as usize] = mesh.nodes.len() as u32;
                mesh.nodes.push(places[n as usize]);
            }
            numbers[n as usize]
        };
        let quads: Vec<[u32; 4]> = quads.iter().map(|quad| quad.map(&mut number)).collect();
        if triangles {
            mesh.tris = halves(&quads);
        } else {
            mesh.quads = quads;
        }
        mesh
    }
}

/// Quadrilaterals, each parted into two triangles.
pub(super) fn halves(quads: &[[u32; 4]]) -> Vec<[u32; 3]> {
    quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect()
}
