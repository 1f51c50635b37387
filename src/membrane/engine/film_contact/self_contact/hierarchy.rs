//! Triangles of a face in bounding volumes with cones of their normals, built once and refitted.
//!
//! Film whose normals are all within a right angle of one direction is the graph of a function over the plane across it
//! and cannot meet itself (Volino and Magnenat-Thalmann 1994), if it is convex as mounted: between two lips of a slit, or
//! around a notch, film lies beside film that it may meet.

use std::ops::Range;

use nalgebra::Vector3;

use crate::engine::film_contact::surface::{NONE, Surface};
use crate::engine::film_contact::tracking::place;
use crate::engine::footprint::bytes;
use crate::engine::nodes::Vectors;

/// Triangles of a leaf at most.
const LEAF: usize = 4;

/// Largest angle of normals from the axis of their cone for which film does not meet itself, rad: 85°.
const WIDEST: f64 = 1.483_529_864_195_180_2;

/// Share of the size of a face by which it may lie beside a line or plane and still counts as on it.
const FLAT: f64 = 1e-6;

/// A face in bounding volumes.
pub(super) struct Hierarchy {
    /// Triangles, those of each volume next to each other.
    triangles: Vec<u32>,
    /// From the root, each followed by all that are inside its first half.
    volumes: Vec<Volume>,
    /// Edges of the outline as mounted that all of the face lies on one side of, in order.
    hull: Vec<u32>,
}

/// A bounding volume.
#[derive(Clone, Debug)]
struct Volume {
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Sum of the areas times the normals of its triangles, m².
    area: Vector3<f64>,
    /// Largest angle of a normal from that sum until the next search, rad; infinite where film in it may meet itself
    /// whatever the angle.
    angle: f64,
    /// Of [`Hierarchy::triangles`].
    range: Range<u32>,
    /// Volume of the second half; zero for a leaf.
    second: u32,
}

impl Hierarchy {
    /// Of the `triangles` of a face, mounted at `position`.
    pub(super) fn new(surface: &Surface, position: &Vectors, triangles: Range<u32>) -> Hierarchy {
        let middle = |triangle: u32| {
            let corners = surface.corners[triangle as usize].map(|n| place(position, n as usize));
            corners[0] + corners[1] + corners[2]
        };
        let mut sorted: Vec<(u32, Vector3<f64>)> = triangles.map(|triangle| (triangle, middle(triangle))).collect();
        let mut volumes = vec![];
        let count = sorted.len() as u32;
        divide(&mut sorted, 0..count, &mut volumes);
        let triangles: Vec<u32> = sorted.into_iter().map(|(triangle, _)| triangle).collect();
        let hull = hull(surface, position, &triangles);
        Hierarchy { triangles, volumes, hull }
    }

    /// Whether an edge of the triangle is one beside which film may meet film without a fold: of a cut, a tear, a hole or
    /// a notch.
    fn is_open(&self, surface: &Surface, triangle: u32) -> bool {
        let k = triangle as usize;
        (0..3).any(|side| surface.across[k][side] == NONE && self.hull.binary_search(&surface.edges_of[k][side]).is_err())
    }

    /// Whether the face has any such edge.
    pub(super) fn has_open_edges(&self, surface: &Surface) -> bool {
        let mut intact = self.triangles.iter().filter(|triangle| surface.is_intact[**triangle as usize]);
        intact.any(|triangle| self.is_open(surface, *triangle))
    }

    /// Distance by which two points of a face without open edges may come nearer to each other until it may meet itself,
    /// m; not positive where it may do so already, as its normals spread too far.
    pub(super) fn spared(&self, surface: &Surface, position: &Vectors) -> f64 {
        let area = |triangle: u32| {
            let [a, b, c] = surface.corners[triangle as usize].map(|n| place(position, n as usize));
            ((b - a).cross(&(c - a)), [b - a, c - b, a - c])
        };
        let sum: Vector3<f64> = self.triangles.iter().map(|triangle| area(*triangle).0).sum();
        let axis = sum / sum.norm();
        let (sin, cos) = WIDEST.sin_cos();
        let of_triangle = |triangle: &u32| {
            let (area, sides) = area(*triangle);
            let twice = area.norm();
            // Each radian by which the normal turns is a motion of a corner over the opposite edge of one altitude. From
            // the cosine instead of the angle: the sine is concave, so that the angle left is larger than this.
            (area.dot(&axis) / twice - cos) / sin * (twice / longest(&sides))
        };
        let least = self.triangles.iter().map(of_triangle).fold(f64::INFINITY, f64::min);
        if least.is_nan() { 0.0 } else { least }
    }

    /// Fits the volumes to the film at `position`, which moves by no more than `margin` (m) over itself until the next
    /// search.
    pub(super) fn refit(&mut self, surface: &Surface, position: &Vectors, margin: f64) {
        for k in (0..self.volumes.len()).rev() {
            let Volume { ref range, second, .. } = self.volumes[k];
            let fitted = match second {
                0 => self.leaf(surface, position, margin, range.clone()),
                second => self.volumes[k + 1].with(&self.volumes[second as usize]),
            };
            self.volumes[k] = Volume { second, ..fitted };
        }
    }

    fn leaf(&self, surface: &Surface, position: &Vectors, margin: f64, range: Range<u32>) -> Volume {
        let [low, high] = [f64::INFINITY, f64::NEG_INFINITY].map(Vector3::repeat);
        let mut leaf = Volume { low, high, area: Vector3::zeros(), angle: 0.0, range: range.clone(), second: 0 };
        let of_leaf = &self.triangles[range.start as usize..range.end as usize];
        let mut normals = vec![];
        for triangle in of_leaf.iter().filter(|triangle| surface.is_intact[**triangle as usize]) {
            let [a, b, c] = surface.corners[*triangle as usize].map(|n| place(position, n as usize));
            for corner in [a, b, c] {
                (leaf.low, leaf.high) = (leaf.low.inf(&corner), leaf.high.sup(&corner));
            }
            let area = (b - a).cross(&(c - a));
            leaf.area += area;
            normals.push((area, margin * longest(&[b - a, c - b, a - c]) / area.norm()));
            if self.is_open(surface, *triangle) {
                leaf.angle = f64::INFINITY;
            }
        }
        let turned = normals.iter().map(|(area, turn)| angle(area, &leaf.area) + turn);
        leaf.angle = turned.fold(leaf.angle, worse);
        leaf
    }

    /// Calls `meet` with all pairs of intact triangles of which any points may lie within `reach` (m) of each other, and
    /// with each triangle and itself, but for those on film that cannot meet itself.
    pub(super) fn for_each_pair(&self, surface: &Surface, reach: f64, meet: &mut impl FnMut(u32, u32)) {
        let mut left = vec![[0_usize; 2]];
        while let Some([one, other]) = left.pop() {
            let (a, b) = (&self.volumes[one], &self.volumes[other]);
            let is_same = one == other;
            if is_same && a.angle < WIDEST {
                continue;
            }
            if !is_same && !a.is_within(reach, b) {
                continue;
            }
            match (a.second as usize, b.second as usize) {
                (0, 0) => self.pairs_of_leaves(surface, [a, b], is_same, meet),
                (second, _) if is_same => left.extend([[one + 1, one + 1], [second, second], [one + 1, second]]),
                // The larger one is divided.
                (second, of_other) if of_other == 0 || (second != 0 && a.range.len() >= b.range.len()) => {
                    left.extend([[one + 1, other], [second, other]]);
                }
                (_, second) => left.extend([[one, other + 1], [one, second]]),
            }
        }
    }

    fn pairs_of_leaves(&self, surface: &Surface, of: [&Volume; 2], is_same: bool, meet: &mut impl FnMut(u32, u32)) {
        let intact = |volume: &Volume| {
            let triangles = &self.triangles[volume.range.start as usize..volume.range.end as usize];
            triangles.iter().copied().filter(|triangle| surface.is_intact[*triangle as usize]).collect::<Vec<_>>()
        };
        let [ones, others] = of.map(intact);
        for (k, one) in ones.iter().enumerate() {
            let first = if is_same { k + 1 } else { 0 };
            others[first..].iter().for_each(|other| meet(*one, *other));
        }
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        bytes(&self.triangles) + bytes(&self.volumes) + bytes(&self.hull)
    }
}

impl Volume {
    /// Both halves.
    fn with(&self, other: &Volume) -> Volume {
        let area = self.area + other.area;
        let [here, there] = [self, other].map(|half| half.angle + angle(&half.area, &area));
        Volume {
            low: self.low.inf(&other.low),
            high: self.high.sup(&other.high),
            area,
            angle: worse(here, there),
            range: self.range.start..other.range.end,
            second: 0,
        }
    }

    /// Whether points of both may lie within `reach` (m) of each other.
    fn is_within(&self, reach: f64, other: &Volume) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] + reach && other.low[k] <= self.high[k] + reach)
    }
}

/// Divides triangles with their middles into halves along the longest side of their box until they are leaves.
fn divide(triangles: &mut [(u32, Vector3<f64>)], range: Range<u32>, volumes: &mut Vec<Volume>) {
    let zero = Vector3::zeros();
    let at = volumes.len();
    volumes.push(Volume { low: zero, high: zero, area: zero, angle: 0.0, range: range.clone(), second: 0 });
    if triangles.len() <= LEAF {
        return;
    }
    let low = triangles.iter().fold(Vector3::repeat(f64::INFINITY), |low, (_, middle)| low.inf(middle));
    let high = triangles.iter().fold(Vector3::repeat(f64::NEG_INFINITY), |high, (_, middle)| high.sup(middle));
    let axis = (high - low).imax();
    triangles.sort_by(|(a, p), (b, q)| p[axis].total_cmp(&q[axis]).then(a.cmp(b)));
    let half = triangles.len() / 2;
    let middle = range.start + half as u32;
    let (first, second) = triangles.split_at_mut(half);
    divide(first, range.start..middle, volumes);
    volumes[at].second = volumes.len() as u32;
    divide(second, middle..range.end, volumes);
}

/// Edges of the outline of a face that all of its outline lies on one side of, if it is mounted in a plane of constant
/// height; none otherwise.
fn hull(surface: &Surface, position: &Vectors, triangles: &[u32]) -> Vec<u32> {
    let sides = triangles.iter().flat_map(|triangle| (0..3).map(move |k| (*triangle as usize, k)));
    let outline: Vec<u32> =
        sides.filter(|(t, k)| surface.across[*t][*k] == NONE).map(|(t, k)| surface.edges_of[t][k]).collect();
    let at = |n: &u32| place(position, *n as usize);
    let corners: Vec<Vector3<f64>> =
        triangles.iter().flat_map(|triangle| &surface.corners[*triangle as usize]).map(at).collect();
    let low = corners.iter().fold(Vector3::repeat(f64::INFINITY), |low, corner| low.inf(corner));
    let high = corners.iter().fold(Vector3::repeat(f64::NEG_INFINITY), |high, corner| high.sup(corner));
    let size = (high - low).norm();
    if high.z - low.z > FLAT * size {
        return vec![];
    }
    let ends: Vec<Vector3<f64>> =
        outline.iter().flat_map(|edge| &surface.edges[*edge as usize]).map(at).collect();
    let is_hull = |edge: &u32| {
        let [a, b] = surface.edges[*edge as usize].each_ref().map(at);
        let along = (b - a) / (b - a).norm();
        let beside = ends.iter().map(|p| along.x * (p.y - a.y) - along.y * (p.x - a.x));
        let (least, most) = beside.fold((0.0_f64, 0.0_f64), |(least, most), d| (least.min(d), most.max(d)));
        least > -FLAT * size || most < FLAT * size
    };
    let mut hull: Vec<u32> = outline.iter().copied().filter(is_hull).collect();
    hull.sort_unstable();
    hull
}

fn longest(sides: &[Vector3<f64>; 3]) -> f64 {
    sides.iter().map(Vector3::norm_squared).fold(0.0, f64::max).sqrt()
}

/// Angle between two vectors, rad; zero where one is zero, as of a volume without triangles.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let product = (a.norm_squared() * b.norm_squared()).sqrt();
    if product == 0.0 { 0.0 } else { (a.dot(b) / product).clamp(-1.0, 1.0).acos() }
}

/// The larger of two angles; infinite where one is not a number.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
}
