//! Whether a polygon is the outline of a film.

use nalgebra::Point2;
use spade::InsertionError;

use super::Polygon;
use crate::mesh::{MeshError, MeshErrorKind, directed, fault};

/// Least angle of a corner, rad: 5 degrees. No element at a narrower one is sound.
const NARROWEST: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Distance over the extent below which two corners are one.
const SAME: f64 = 1e-9;
/// Most corners of all loops.
const MOST_CORNERS: usize = 20_000;

/// A fault of the loop `of`: 0 is the outline, the others are the holes.
fn of_loop(of: usize, message: String) -> MeshError {
    MeshError::new(of.checked_sub(1).map_or(MeshErrorKind::Outline, MeshErrorKind::Hole), message)
}

/// Two edges of loops that cross or touch each other, near a place.
fn crossing([a, b]: [usize; 2], at: [f64; 2]) -> MeshError {
    let cross =
        if a == b { format!("{} crosses itself", named(a)) } else { format!("{} and {} cross", named(a), named(b)) };
    of_loop(b, format!("{cross} near {}", millimetres(at)))
}

/// A coordinate beyond those that can be triangulated.
pub(super) fn not_triangulated(error: InsertionError) -> MeshError {
    let coordinate = match error {
        InsertionError::TooSmall => "too close to zero",
        InsertionError::TooLarge => "too large",
        InsertionError::NAN => "not a number",
    };
    fault!("the film cannot be triangulated: a coordinate is {coordinate}")
}

fn named(of: usize) -> String {
    if of == 0 { "the outline".into() } else { format!("hole {of}") }
}

fn millimetres([x, y]: [f64; 2]) -> String {
    format!("({:.4} mm, {:.4} mm)", 1e3 * x, 1e3 * y)
}

impl Polygon {
    /// Checks corners, edges, holes, and the place of the mirror planes.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, mirrored: [bool; 2]) -> Result<(), MeshError> {
        let corners: usize = self.loops().map(<[_]>::len).sum();
        if corners > MOST_CORNERS {
            return Err(fault!("the outline has {corners} corners; at most {MOST_CORNERS} are read"));
        }
        let same = SAME * self.extent();
        for (of, corners) in self.loops().enumerate() {
            self::corners(of, corners, same)?;
        }
        self.crossings()?;
        for (of, hole) in self.loops().enumerate().skip(1) {
            let others = self.loops().enumerate().filter(|(other, _)| *other != of);
            // In the outline and in no other hole.
            if others.filter(|(_, corners)| is_inside(corners, hole[0])).map(|(other, _)| other).ne([0]) {
                return Err(of_loop(of, format!("{} lies outside the film", named(of))));
            }
        }
        (0..2).filter(|axis| mirrored[*axis]).try_for_each(|axis| self.mirror(axis, same))
    }

    fn mirror(&self, axis: usize, same: f64) -> Result<(), MeshError> {
        let name = ['x', 'y'][axis];
        if let Some(at) = self.loops().flatten().find(|corner| corner[axis] < -same) {
            return Err(fault!(
                "the corner {} lies beyond the mirror plane {name} = 0; with symmetry the polygon is the part at {name} >= 0",
                millimetres(*at)
            ));
        }
        let on_plane = |[a, b]: [[f64; 2]; 2]| a[axis].abs() <= same && b[axis].abs() <= same;
        match directed(&self.outer).any(on_plane) {
            true => Ok(()),
            false => Err(fault!("no edge lies on the mirror plane {name} = 0")),
        }
    }

    /// No two edges have a point in common but the corner between neighbours.
    fn crossings(&self) -> Result<(), MeshError> {
        let mut all: Vec<Edge> = vec![];
        for (of, corners) in self.loops().enumerate() {
            let count = corners.len();
            all.extend(directed(corners).enumerate().map(|(place, ends)| Edge { of, place, count, ends }));
        }
        // By their least x: those that begin beyond the end of an edge do not meet it.
        all.sort_by(|a, b| a.low().total_cmp(&b.low()));
        for (first, edge) in all.iter().enumerate() {
            let near = all[first + 1..].iter().take_while(|other| other.low() <= edge.high());
            for other in near.filter(|other| !edge.is_beside(other)) {
                if cross(edge.ends, other.ends) {
                    return Err(crossing([edge.of.min(other.of), edge.of.max(other.of)], other.ends[0]));
                }
            }
        }
        Ok(())
    }
}

struct Edge {
    of: usize,
    place: usize,
    count: usize,
    ends: [[f64; 2]; 2],
}

impl Edge {
    fn low(&self) -> f64 {
        self.ends[0][0].min(self.ends[1][0])
    }

    fn high(&self) -> f64 {
        self.ends[0][0].max(self.ends[1][0])
    }

    /// Whether both have a corner in common.
    fn is_beside(&self, other: &Edge) -> bool {
        let next = |edge: &Edge| (edge.place + 1) % edge.count;
        self.of == other.of && (next(self) == other.place || next(other) == self.place)
    }
}

/// Corners of one loop: at least three, none twice, none too narrow.
fn corners(of: usize, corners: &[[f64; 2]], same: f64) -> Result<(), MeshError> {
    if !corners.iter().flatten().all(|coordinate| coordinate.is_finite()) {
        return Err(of_loop(of, format!("a coordinate of {} is not finite", named(of))));
    }
    let perimeter = perimeter(corners);
    if corners.len() < 3 || signed_area(corners).abs() <= 1e-9 * perimeter * perimeter {
        // The two halves of a bow tie have areas of opposite sign.
        let all: Vec<_> = directed(corners).collect();
        let pairs =
            all.iter().enumerate().flat_map(|(first, edge)| all[first + 1..].iter().map(move |other| (edge, other)));
        let point = pairs.into_iter().find_map(|(edge, other)| crossing_point(*edge, *other));
        let no_area = || of_loop(of, format!("{} has no area", named(of)));
        return Err(point.map_or_else(no_area, |at| crossing([of, of], at)));
    }
    let count = corners.len();
    for place in 0..count {
        let point = |index: usize| Point2::from(corners[index % count]);
        let [before, here, next] = [point(place + count - 1), point(place), point(place + 1)];
        if (next - here).norm() <= same {
            let at = millimetres(corners[place]);
            return Err(of_loop(of, format!("{} has the corner {at} twice", named(of))));
        }
        let angle = (before - here).angle(&(next - here));
        if angle < NARROWEST {
            let (at, degrees) = (millimetres(corners[place]), angle.to_degrees());
            let message = format!("the corner {at} of {} has {degrees:.1} degrees; at least 5 are meshed", named(of));
            return Err(of_loop(of, message));
        }
    }
    Ok(())
}

/// Length of a loop, m.
pub(super) fn perimeter(corners: &[[f64; 2]]) -> f64 {
    directed(corners).map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum()
}

/// Area within a loop, positive where it runs counter-clockwise, m².
pub(super) fn signed_area(corners: &[[f64; 2]]) -> f64 {
    directed(corners).map(|[a, b]| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum()
}

/// Whether a point is inside a loop.
pub(super) fn is_inside(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let crosses =
        |[a, b]: &[[f64; 2]; 2]| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    directed(corners).filter(crosses).count() % 2 == 1
}

/// The point of a loop that is nearest to `point`.
pub(super) fn nearest(corners: &[[f64; 2]], point: Point2<f64>) -> Point2<f64> {
    let on_edge = |[from, to]: [[f64; 2]; 2]| {
        let (from, along) = (Point2::from(from), Point2::from(to) - Point2::from(from));
        let share = ((point - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        from + along * share
    };
    let distance = |other: &Point2<f64>| (other - point).norm_squared();
    let mut places = directed(corners).map(on_edge);
    let first = places.next().unwrap_or(point);
    places.fold(first, |best, place| if distance(&place) < distance(&best) { place } else { best })
}

/// Distance of a point from the nearest edge of a loop, m.
pub(super) fn distance(corners: &[[f64; 2]], point: Point2<f64>) -> f64 {
    (nearest(corners, point) - point).norm()
}

/// Where two edges cross within both of them.
fn crossing_point([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let [of_c, of_d] = [c, d].map(|end| side(a, b, end));
    let share = of_c / (of_c - of_d);
    let crosses = of_c * of_d < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
    crosses.then(|| [0, 1].map(|axis| c[axis] + share * (d[axis] - c[axis])))
}

/// Whether two edges have a point in common.
fn cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        if area > 0.0 { 1 } else { -i32::from(area < 0.0) }
    };
    let apart =
        |axis: usize| a[axis].max(b[axis]) < c[axis].min(d[axis]) || c[axis].max(d[axis]) < a[axis].min(b[axis]);
    let across = side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0;
    across && !apart(0) && !apart(1)
}
