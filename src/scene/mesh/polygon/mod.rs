//! Films of any outline with holes: triangles by Delaunay refinement, or quadrilaterals joined from them.

mod check;
mod delaunay;

use std::collections::BTreeSet;
use std::f64::consts::PI;

use nalgebra::{Point2, Point3};
use serde::{Deserialize, Serialize};

use super::structured::smooth;
use super::{Element, Mesh, MeshError, Meshing, quadtree};
use crate::mesh;

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
        check::perimeter(&self.outer)
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
    quadtree::check([polygon.extent(); 2], size, (2.0 * count) as usize)?;
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
            (mesh.nodes, mesh.quads) = delaunay::quadrilaterals(nodes, &tris, polygon);
            smooth(&mut mesh.nodes, &mesh.quads);
        }
    }
    mesh::label(&mut mesh, mirrored);
    free_holes(&mut mesh, polygon);
    Ok(mesh)
}

fn triangles(
    polygon: &Polygon,
    wanted: &dyn Fn(Point2<f64>) -> f64,
    most: f64,
) -> Result<delaunay::Triangles<Point3<f64>>, MeshError> {
    let boundary = Boundary::from_polygon(polygon, wanted);
    let refined = delaunay::refined(boundary, polygon, wanted, most as usize);
    let (mut nodes, tris) = refined.map_err(check::not_triangulated)?;
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

/// Change of direction from which a corner is a node, rad; below it is a point of a smooth curve.
const CORNER: f64 = PI / 9.0;
/// Most change of direction along one edge of an element of a curve, rad.
const TURN: f64 = PI / 6.0;
/// Angle between two lines below which the triangles between them stay as narrow as it is, rad.
const NARROW_CORNER: f64 = PI / 3.0;

/// Edges along the outline and the holes.
#[derive(Default)]
struct Boundary {
    /// m.
    points: Vec<Point2<f64>>,
    /// Lines between corners on which each point is; twice the same but for corners.
    lines: Vec<[usize; 2]>,
    segments: Vec<Segment>,
    /// Lines that meet at an angle at which triangles are narrow.
    narrow: BTreeSet<[usize; 2]>,
}

/// An edge along a loop.
#[derive(Clone, Copy)]
struct Segment {
    ends: [usize; 2],
    line: usize,
    /// How often it was halved.
    depth: u32,
}

impl Boundary {
    /// The loops of `polygon` in edges of about the `wanted` lengths (m).
    fn from_polygon(polygon: &Polygon, wanted: &dyn Fn(Point2<f64>) -> f64) -> Boundary {
        let mut boundary = Boundary::default();
        polygon.loops().for_each(|corners| boundary.add(corners, wanted));
        boundary
    }

    /// Adds a loop: its corners, and between them points at equal shares of the number of wanted edges.
    fn add(&mut self, corners: &[[f64; 2]], wanted: &dyn Fn(Point2<f64>) -> f64) {
        let count = corners.len();
        let point = |index: usize| Point2::from(corners[index % count]);
        let turn = |index: usize| {
            let (before, after) = (point(index) - point(index + count - 1), point(index + 1) - point(index));
            before.angle(&after)
        };
        let mut sharp: Vec<usize> = (0..count).filter(|index| turn(*index) > CORNER).collect();
        if sharp.is_empty() {
            sharp.push(0);
        }
        let (first, first_line) = (self.points.len(), self.lines.iter().flatten().max().map_or(0, |line| line + 1));
        for (place, &from) in sharp.iter().enumerate() {
            let to = if place + 1 < sharp.len() { sharp[place + 1] } else { sharp[0] + count };
            let path: Vec<Point2<f64>> = (from..=to).map(point).collect();
            let turns: f64 = (from + 1..to).map(turn).sum();
            let fewest = (turns / TURN).ceil().max(if sharp.len() == 1 { 3.0 } else { 1.0 });
            let line = first_line + place;
            let before = first_line + (place + sharp.len() - 1) % sharp.len();
            if turn(from) > PI - NARROW_CORNER {
                self.narrow.insert([line.min(before), line.max(before)]);
            }
            for (index, point) in along(&path, fewest, wanted).into_iter().enumerate() {
                let (here, before) = (self.points.len(), if index == 0 { before } else { line });
                self.segments.push(Segment { ends: [here, here + 1], line, depth: 0 });
                self.points.push(point);
                self.lines.push([before, line]);
            }
        }
        if let Some(last) = self.segments.last_mut() {
            last.ends[1] = first;
        }
    }

    /// Whether two nodes are on two lines with a narrow angle between them; those of the boundary come first.
    fn is_across_narrow(&self, nodes: [usize; 2]) -> bool {
        let [Some(a), Some(b)] = nodes.map(|node| self.lines.get(node)) else { return false };
        let pairs = a.iter().flat_map(|x| b.iter().map(move |y| [*x.min(y), *x.max(y)]));
        pairs.into_iter().any(|pair| self.narrow.contains(&pair))
    }

    fn ends(&self, segment: &Segment) -> [Point2<f64>; 2] {
        segment.ends.map(|end| self.points[end])
    }

    /// Halves a segment along a loop of `polygon`.
    fn split(&mut self, segment: usize, polygon: &Polygon) {
        let Segment { ends: [from, to], line, depth } = self.segments[segment];
        let middle = self.points.len();
        self.points.push(polygon.middle([from, to].map(|end| self.points[end])));
        self.lines.push([line; 2]);
        self.segments[segment] = Segment { ends: [from, middle], line, depth: depth + 1 };
        self.segments.push(Segment { ends: [middle, to], line, depth: depth + 1 });
    }
}

/// The first point of a line and those that divide it, so that each part has its wanted length or less.
fn along(line: &[Point2<f64>], fewest: f64, wanted: &dyn Fn(Point2<f64>) -> f64) -> Vec<Point2<f64>> {
    let mut marks = vec![(0.0, line[0])];
    let mut edges = 0.0;
    for ends in line.windows(2) {
        let (from, way) = (ends[0], ends[1] - ends[0]);
        let mut done = 0.0;
        while done < 1.0 {
            // The wanted lengths grow by less than the way, so that a quarter of one changes them little.
            let here = wanted(from + way * done);
            let share = (0.25 * here / way.norm()).min(1.0 - done);
            let share = if 1.0 - done - share < 1e-9 { 1.0 - done } else { share };
            edges += share * way.norm() / wanted(from + way * (done + 0.5 * share));
            done += share;
            marks.push((edges, from + way * done));
        }
    }
    // Equal shares of the number of wanted edges, not of the length: neighbours differ as the wanted lengths do.
    let parts = (edges - 1e-6).ceil().max(fewest).max(1.0);
    let mut next = marks.windows(2).peekable();
    let place = |part: u32| {
        let at = edges * f64::from(part) / parts;
        while next.peek().is_some_and(|pair| pair[1].0 < at) {
            next.next();
        }
        let pair = next.peek().map_or(&marks[..2], |pair| *pair);
        let share = ((at - pair[0].0) / (pair[1].0 - pair[0].0)).clamp(0.0, 1.0);
        pair[0].1 + (pair[1].1 - pair[0].1) * share
    };
    (0..parts as u32).map(place).collect()
}
