//! Films of any outline with holes: triangles by Delaunay refinement, or quadrilaterals joined from them.

mod boundary;
mod check;
mod delaunay;
mod recombine;

use nalgebra::{Point2, Point3};
use serde::{Deserialize, Serialize};

use super::smoothing::smooth;
use super::{Element, Mesh, MeshError, Meshing, grid, topology};
use boundary::Boundary;
pub use check::PolygonFault;

/// Nodes over the wanted elements beyond which refinement stops: more are needed only where parts of an outline almost
/// meet.
const POINTS_PER_TRIANGLE: f64 = 8.0;

/// Most distance of a curved outline from the middle of an edge along it, over the length of the edge.
const BEND: f64 = 0.15;

/// A plane outline with holes, coordinates x and y in m. A loop is closed: its last corner precedes its first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    /// Corners of the outline.
    pub outer: Vec<[f64; 2]>,
    /// Corners of the holes.
    pub holes: Vec<Vec<[f64; 2]>>,
}

impl Polygon {
    /// The outline and the holes.
    pub(crate) fn loops(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        std::iter::once(self.outer.as_slice()).chain(self.holes.iter().map(Vec::as_slice))
    }

    /// Area of the outline without the holes, m².
    pub fn area(&self) -> f64 {
        let of = |corners: &[[f64; 2]]| check::signed_area(corners).abs();
        2.0 * of(&self.outer) - self.loops().map(of).sum::<f64>()
    }

    /// Length of the outline without the holes, m.
    pub fn perimeter(&self) -> f64 {
        check::edges(&self.outer).map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum()
    }

    /// Largest extent along x or y, m.
    pub fn extent(&self) -> f64 {
        let along = |axis: usize| {
            let range = self.outer.iter().map(|corner| corner[axis]);
            range.clone().fold(f64::MIN, f64::max) - range.fold(f64::MAX, f64::min)
        };
        along(0).max(along(1))
    }

    /// The middle of an edge along the outline, on the outline where that is curved.
    fn middle(&self, [a, b]: [Point2<f64>; 2]) -> Point2<f64> {
        let middle = nalgebra::center(&a, &b);
        let near = self.loops().map(|corners| check::nearest(corners, middle));
        let distance = |point: &Point2<f64>| (point - middle).norm();
        let near = near.fold(None, |best: Option<Point2<f64>>, point| match best {
            Some(best) if distance(&best) <= distance(&point) => Some(best),
            _ => Some(point),
        });
        let bend = |point: &Point2<f64>| (1e-9 * (b - a).norm()..BEND * (b - a).norm()).contains(&distance(point));
        near.filter(bend).unwrap_or(middle)
    }

    /// Distance of a point from the film, m; zero on it.
    pub fn distance(&self, point: [f64; 2]) -> f64 {
        if self.covers(point) {
            return 0.0;
        }
        let from = |corners: &[[f64; 2]]| check::distance(corners, Point2::from(point));
        self.loops().map(from).fold(f64::INFINITY, f64::min)
    }

    /// Whether the film covers a point.
    pub fn covers(&self, point: [f64; 2]) -> bool {
        self.loops().fold(false, |inside, corners| inside != check::is_inside(corners, point))
    }
}

/// The film of a polygon that is its computed part: no corner lies beyond a mirror plane.
pub(crate) fn mesh(polygon: &Polygon, mirrored: [bool; 2], meshing: &Meshing) -> Result<Mesh, MeshError> {
    polygon.check(mirrored)?;
    let (size, area) = (meshing.size, polygon.area());
    let count = match &meshing.grading {
        Some(grading) => {
            grading.check([polygon.extent(); 2], area, size)?;
            grading.cells(area, size)
        }
        None => area / (size * size),
    };
    grid::check([polygon.extent(); 2], size, (2.0 * count) as usize)?;
    let wanted = |place: Point2<f64>| match &meshing.grading {
        None => size,
        Some(grading) => grading.size_at(grading.distance(place), size),
    };
    let most = POINTS_PER_TRIANGLE * count + 1e4;
    let mut mesh = Mesh::default();
    match meshing.element {
        Element::Tri3 => {
            (mesh.nodes, mesh.tris) = triangles(polygon, &wanted, most)?;
        }
        Element::Quad4 | Element::Quad4Full => {
            // Every element is divided once more.
            let (nodes, tris) = triangles(polygon, &|place| 2.0 * wanted(place), most)?;
            (mesh.nodes, mesh.quads) = recombine::quadrilaterals(nodes, &tris, polygon);
            smooth(&mut mesh.nodes, &mesh.quads);
        }
    }
    topology::label(&mut mesh, mirrored);
    free_holes(&mut mesh, polygon);
    Ok(mesh)
}

fn triangles(
    polygon: &Polygon,
    wanted: &dyn Fn(Point2<f64>) -> f64,
    most: f64,
) -> Result<delaunay::Triangles<Point3<f64>>, PolygonFault> {
    let boundary = Boundary::from_polygon(polygon, wanted);
    let refined = delaunay::refined(boundary, polygon, wanted, most as usize);
    let (mut nodes, tris) = refined.map_err(PolygonFault::NotTriangulated)?;
    smooth(&mut nodes, &tris);
    Ok((nodes, tris))
}

/// Leaves the edges of holes, which no frame holds, out of the rim and the sides.
fn free_holes(mesh: &mut Mesh, polygon: &Polygon) {
    let near = 1e-9 * polygon.extent();
    let distance = |corners: &[[f64; 2]], node: u32| check::distance(corners, mesh.nodes[node as usize].xy());
    let of_hole =
        |node: &u32| polygon.holes.iter().any(|hole| distance(hole, *node) < distance(&polygon.outer, *node).max(near));
    let free: Vec<u32> = mesh.rim.iter().copied().filter(of_hole).collect();
    let is_held = |node: &u32| free.binary_search(node).is_err();
    mesh.rim.retain(is_held);
    mesh.sides.iter_mut().for_each(|side| side.retain(is_held));
}
