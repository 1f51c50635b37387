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
    /// Bounds of each triangle in this order, as of the last fit.
    boxes: Vec<Bounds>,
    /// Edges of the outline as mounted that all of the face lies on one side of, in order.
    hull: Vec<u32>,
}

/// Lowest and highest coordinates, m.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

/// A bounding volume.
#[derive(Clone, Debug)]
struct Volume {
    bounds: Bounds,
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
        let boxes = vec![Bounds::EMPTY; triangles.len()];
        Hierarchy { triangles, volumes, boxes, hull }
    }

    /// Whether an edge of the triangle is one beside which film may meet film without a fold: of a cut, a tear, a hole or
    /// a notch.
    fn is_open(&self, surface: &Surface, triangle: u32) -> bool {
        let k = triangle as usize;
        (0..3)
            .any(|side| surface.across[k][side] == NONE && self.hull.binary_search(&surface.edges_of[k][side]).is_err())
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
            let [a, b, c] = surface.corners_at(position, triangle);
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
                0 => {
                    let range = range.clone();
                    self.leaf(surface, position, margin, range)
                }
                second => self.volumes[k + 1].with(&self.volumes[second as usize]),
            };
            self.volumes[k] = Volume { second, ..fitted };
        }
    }

    fn leaf(&mut self, surface: &Surface, position: &Vectors, margin: f64, range: Range<u32>) -> Volume {
        let (mut bounds, mut area, mut largest) = (Bounds::EMPTY, Vector3::zeros(), 0.0);
        let mut normals = [(Vector3::zeros(), 0.0); LEAF];
        let mut count = 0;
        for k in range.start as usize..range.end as usize {
            let triangle = self.triangles[k];
            self.boxes[k] = Bounds::EMPTY;
            if !surface.is_intact[triangle as usize] {
                continue;
            }
            let [a, b, c] = surface.corners_at(position, triangle);
            self.boxes[k] = Bounds::EMPTY.around(&a).around(&b).around(&c);
            bounds = bounds.with(&self.boxes[k]);
            let twice = (b - a).cross(&(c - a));
            area += twice;
            normals[count] = (twice, margin * longest(&[b - a, c - b, a - c]) / twice.norm());
            count += 1;
            if self.is_open(surface, triangle) {
                largest = f64::INFINITY;
            }
        }
        for (normal, turn) in &normals[..count] {
            largest = worse(largest, angle(normal, &area) + turn);
        }
        Volume { bounds, area, angle: largest, range, second: 0 }
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
            if !is_same && !a.bounds.is_within(reach, &b.bounds) {
                continue;
            }
            match (a.second as usize, b.second as usize) {
                (0, 0) => self.pairs_of_leaves(surface, [a, b], reach, meet),
                (second, _) if is_same => left.extend([[one + 1, one + 1], [second, second], [one + 1, second]]),
                // The larger one is divided.
                (second, of_other) if of_other == 0 || (second != 0 && a.range.len() >= b.range.len()) => {
                    left.extend([[one + 1, other], [second, other]]);
                }
                (_, second) => left.extend([[one, other + 1], [one, second]]),
            }
        }
    }

    fn pairs_of_leaves(&self, surface: &Surface, of: [&Volume; 2], reach: f64, meet: &mut impl FnMut(u32, u32)) {
        let [ones, others] = [of[0].range.clone(), of[1].range.clone()];
        for one in ones.start as usize..ones.end as usize {
            // Of one leaf each pair once.
            let first = if ones.start == others.start { one + 1 } else { others.start as usize };
            for other in first..others.end as usize {
                let [s, t] = [self.triangles[one], self.triangles[other]];
                let are_intact = surface.is_intact[s as usize] && surface.is_intact[t as usize];
                if are_intact && self.boxes[one].is_within(reach, &self.boxes[other]) {
                    meet(s, t);
                }
            }
        }
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        bytes(&self.triangles) + bytes(&self.volumes) + bytes(&self.boxes) + bytes(&self.hull)
    }
}

impl Volume {
    /// Both halves.
    fn with(&self, other: &Volume) -> Volume {
        let area = self.area + other.area;
        let of_half = |half: &Volume| half.angle + angle(&half.area, &area);
        Volume {
            bounds: self.bounds.with(&other.bounds),
            area,
            angle: worse(of_half(self), of_half(other)),
            range: self.range.start..other.range.end,
            second: 0,
        }
    }
}

// Written as loops: maps of arrays and methods of vectors are calls of other crates.
impl Bounds {
    /// Nothing is in it or near it.
    const EMPTY: Bounds = Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    #[inline(always)]
    fn around(mut self, point: &Vector3<f64>) -> Bounds {
        for k in 0..3 {
            self.low[k] = self.low[k].min(point[k]);
            self.high[k] = self.high[k].max(point[k]);
        }
        self
    }

    #[inline(always)]
    fn with(mut self, other: &Bounds) -> Bounds {
        for k in 0..3 {
            self.low[k] = self.low[k].min(other.low[k]);
            self.high[k] = self.high[k].max(other.high[k]);
        }
        self
    }

    /// Whether points of both may lie within `reach` (m) of each other.
    #[inline(always)]
    fn is_within(&self, reach: f64, other: &Bounds) -> bool {
        let mut is_within = true;
        for k in 0..3 {
            is_within &= self.low[k] <= other.high[k] + reach && other.low[k] <= self.high[k] + reach;
        }
        is_within
    }
}

/// Divides triangles with their middles into halves along the longest side of their box until they are leaves.
fn divide(triangles: &mut [(u32, Vector3<f64>)], range: Range<u32>, volumes: &mut Vec<Volume>) {
    let at = volumes.len();
    let area = Vector3::zeros();
    volumes.push(Volume { bounds: Bounds::EMPTY, area, angle: 0.0, range: range.clone(), second: 0 });
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
    let ends: Vec<Vector3<f64>> = outline.iter().flat_map(|edge| &surface.edges[*edge as usize]).map(at).collect();
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

#[inline(always)]
fn longest([a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    a.norm_squared().max(b.norm_squared()).max(c.norm_squared()).sqrt()
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
