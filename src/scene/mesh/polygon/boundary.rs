//! Edges of elements along an outline.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use nalgebra::Point2;

use super::Polygon;

/// Change of direction from which a corner is a node, rad; below it is a point of a smooth curve.
const CORNER: f64 = PI / 9.0;
/// Most change of direction along one edge of an element of a curve, rad.
const TURN: f64 = PI / 6.0;
/// Angle between two lines below which the triangles between them stay as narrow as it is, rad.
const NARROW: f64 = PI / 3.0;

/// Edges along the outline and the holes.
#[derive(Default)]
pub(super) struct Boundary {
    /// m.
    pub(super) points: Vec<Point2<f64>>,
    /// Lines between corners on which each point is; twice the same but for corners.
    lines: Vec<[usize; 2]>,
    pub(super) segments: Vec<Segment>,
    /// Lines that meet at an angle at which triangles are narrow.
    narrow: BTreeSet<[usize; 2]>,
}

/// An edge along a loop.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    pub(super) ends: [usize; 2],
    line: usize,
    /// How often it was halved.
    pub(super) depth: u32,
}

impl Boundary {
    /// The loops of `polygon` in edges of about the `wanted` lengths (m).
    pub(super) fn from_polygon(polygon: &Polygon, wanted: &dyn Fn(Point2<f64>) -> f64) -> Boundary {
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
            if turn(from) > PI - NARROW {
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
    pub(super) fn is_across_narrow(&self, nodes: [usize; 2]) -> bool {
        let [Some(a), Some(b)] = nodes.map(|node| self.lines.get(node)) else { return false };
        let pairs = a.iter().flat_map(|x| b.iter().map(move |y| [*x.min(y), *x.max(y)]));
        pairs.into_iter().any(|pair| self.narrow.contains(&pair))
    }

    pub(super) fn ends(&self, segment: &Segment) -> [Point2<f64>; 2] {
        segment.ends.map(|end| self.points[end])
    }

    /// Halves a segment along a loop of `polygon`.
    pub(super) fn split(&mut self, segment: usize, polygon: &Polygon) {
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
