//! Triangles of a face in bounding volumes with their deformation gradients, built once and refitted.
//!
//! Film over a convex region does not meet itself where its gradients are all near one ([`gradient`](super::gradient)).
//! The triangles of a volume have a ragged outline; the region of a volume is a rectangle around them, with all triangles
//! that it cuts. The face has to be convex as mounted, and no cut, tear, hole or notch may lie in the rectangle: between
//! two lips of a slit, or around a notch, film lies beside film that it may meet.

use std::ops::Range;

use nalgebra::Vector3;

use super::gradient::{Gradient, Gradients, Mounted, Plane};
use crate::engine::film_contact::surface::{NONE, Surface, place};
use crate::engine::nodes::Vectors;

/// Triangles of a leaf at most.
const LEAF: usize = 4;

/// Share of the size of a face by which it may lie beside a line and still counts as on it.
const FLAT: f64 = 1e-6;

/// Share of the size of a face by which a triangle may reach into a rectangle that it only touches.
const TOUCH: f64 = 1e-9;

/// A face in bounding volumes.
pub(super) struct Hierarchy {
    /// Triangles, those of each volume next to each other.
    triangles: Vec<u32>,
    /// From the root, each followed by all that are inside its first half.
    volumes: Vec<Volume>,
    /// Bounds of each triangle in this order, as of the last fit.
    boxes: Vec<Bounds>,
    /// Edges of the outline as mounted that all of the face lies on one side of, seen along z, in order.
    hull: Vec<u32>,
    /// The triangles as mounted in this order; none where film was not a single-valued surface over the plane across z.
    mounted: Option<Mounted>,
    /// Their deformation gradients when they were measured last.
    gradients: Vec<Gradient>,
    /// Their least altitudes as mounted, m; zero where film has ended at one of their edges, or they have no gradient.
    altitudes: Vec<f64>,
    /// Places of the triangles that the rectangles of the leaves cut.
    covers: Vec<u32>,
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
    /// Of the triangles that its rectangle cuts.
    gradients: Gradients,
    /// Least altitude of these as mounted, m; zero where film in the rectangle may meet itself whatever the gradients.
    altitude: f64,
    /// Of [`Hierarchy::triangles`].
    range: Range<u32>,
    /// Of [`Hierarchy::covers`]; of leaves only.
    cover: Range<u32>,
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
        let mounted = Mounted::new(surface, position, &triangles);
        let corners = |triangle: &u32| surface.corners_at(position, *triangle).map(|corner| [corner.x, corner.y]);
        let covers = if mounted.is_some() {
            let corners: Vec<[[f64; 2]; 3]> = triangles.iter().map(corners).collect();
            cover(&corners, &mut volumes)
        } else {
            vec![]
        };
        Hierarchy { triangles, volumes, boxes, hull, mounted, gradients: vec![], altitudes: vec![], covers }
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

    /// Takes the gradients of film at `position`.
    pub(super) fn measure(&mut self, surface: &Surface, position: &Vectors) {
        let Some(mounted) = &self.mounted else { return };
        self.gradients.clear();
        let triangles = self.triangles.iter().enumerate();
        self.gradients.extend(triangles.map(|(k, t)| mounted.gradient(k, &surface.corners_at(position, *t))));
    }

    /// Distance by which two points of a face without open edges may come nearer to each other, after it was measured,
    /// until parts of it that share no node may be nearer than `bound` (m), m; not positive where they may be already.
    pub(super) fn spared(&self, bound: f64) -> f64 {
        let Some(mounted) = &self.mounted else { return 0.0 };
        let Some(plane) = Plane::of(&mounted.mean(&self.gradients)) else { return 0.0 };
        // Parts that share no node were at least that far apart as mounted.
        let least = bound / mounted.least_altitude;
        let mut spared = f64::INFINITY;
        for (k, gradient) in self.gradients.iter().enumerate() {
            let of_triangle = mounted.altitude(k) * (plane.monotonicity(gradient) - least);
            // Also what is not a number.
            if of_triangle < spared || of_triangle.is_nan() {
                spared = of_triangle;
            }
        }
        if spared.is_nan() { 0.0 } else { spared }
    }

    /// Fits the volumes to the film at `position`, where it was measured.
    pub(super) fn refit(&mut self, surface: &Surface, position: &Vectors) {
        self.altitudes.clear();
        if let Some(mounted) = &self.mounted {
            for (k, triangle) in self.triangles.iter().enumerate() {
                let is_whole = surface.is_intact[*triangle as usize] && !self.is_open(surface, *triangle);
                let is_finite = self.gradients[k].iter().sum::<f64>().is_finite();
                self.altitudes.push(if is_whole && is_finite { mounted.altitude(k) } else { 0.0 });
            }
        }
        for k in (0..self.volumes.len()).rev() {
            let fitted = match self.volumes[k].second {
                0 => self.leaf(surface, position, k),
                second => self.volumes[k + 1].with(&self.volumes[second as usize]),
            };
            let Volume { bounds, gradients, altitude, .. } = &mut self.volumes[k];
            (*bounds, *gradients, *altitude) = fitted;
        }
    }

    fn leaf(&mut self, surface: &Surface, position: &Vectors, at: usize) -> (Bounds, Gradients, f64) {
        let Volume { ref range, ref cover, .. } = self.volumes[at];
        let mut bounds = Bounds::EMPTY;
        for k in range.start as usize..range.end as usize {
            let triangle = self.triangles[k];
            self.boxes[k] = Bounds::EMPTY;
            if surface.is_intact[triangle as usize] {
                let [a, b, c] = surface.corners_at(position, triangle);
                self.boxes[k] = Bounds::EMPTY.around(&a).around(&b).around(&c);
                bounds = bounds.with(&self.boxes[k]);
            }
        }
        let mut gradients = Gradients::EMPTY;
        let mut altitude = if cover.is_empty() { 0.0 } else { f64::INFINITY };
        for k in &self.covers[cover.start as usize..cover.end as usize] {
            gradients = gradients.around(&self.gradients[*k as usize]);
            altitude = self.altitudes[*k as usize].min(altitude);
        }
        (bounds, gradients, altitude)
    }

    /// Calls `meet` with all pairs of intact triangles of which any points may lie within `reach` (m) of each other, but for
    /// those on film whose parts that share no node are farther from each other.
    pub(super) fn for_each_pair(&self, surface: &Surface, reach: f64, meet: &mut impl FnMut(u32, u32)) {
        let mut left = vec![[0_usize; 2]];
        while let Some([one, other]) = left.pop() {
            let (a, b) = (&self.volumes[one], &self.volumes[other]);
            let is_same = one == other;
            if is_same && a.is_apart(reach) {
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
}

impl Volume {
    /// Bounds, gradients and altitude of both halves.
    fn with(&self, other: &Volume) -> (Bounds, Gradients, f64) {
        let (bounds, gradients) = (self.bounds.with(&other.bounds), self.gradients.with(&other.gradients));
        (bounds, gradients, self.altitude.min(other.altitude))
    }

    /// Whether its parts that share no node are farther than `reach` (m) from each other.
    fn is_apart(&self, reach: f64) -> bool {
        self.altitude > 0.0 && self.altitude * self.gradients.monotonicity() > reach
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
    let (bounds, gradients) = (Bounds::EMPTY, Gradients::EMPTY);
    volumes.push(Volume { bounds, gradients, altitude: 0.0, range: range.clone(), cover: 0..0, second: 0 });
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

/// A rectangle in the plane across z.
#[derive(Clone, Copy)]
struct Rectangle {
    low: [f64; 2],
    high: [f64; 2],
}

impl Rectangle {
    fn around(corners: &[[f64; 2]]) -> Rectangle {
        let by = |of: fn(f64, f64) -> f64, k: usize| corners.iter().map(|corner| corner[k]).reduce(of).unwrap_or(0.0);
        Rectangle { low: [0, 1].map(|k| by(f64::min, k)), high: [0, 1].map(|k| by(f64::max, k)) }
    }

    /// Whether the inside of a triangle, counterclockwise, reaches into it by more than `touch` (m).
    fn cuts(&self, corners: &[[f64; 2]; 3], touch: f64) -> bool {
        let of = Rectangle::around(corners);
        let overlap = (0..2).all(|k| of.high[k] > self.low[k] + touch && of.low[k] < self.high[k] - touch);
        overlap
            && (0..3).all(|k| {
                let ([a, b], [c, d]) = (corners[k], corners[(k + 1) % 3]);
                // To the left of the side.
                let [x, y] = [b - d, c - a];
                let farthest = [
                    if x > 0.0 { self.high[0] } else { self.low[0] },
                    if y > 0.0 { self.high[1] } else { self.low[1] },
                ];
                x * (farthest[0] - a) + y * (farthest[1] - b) > touch * x.hypot(y)
            })
    }
}

/// Gives the leaves of `volumes` the triangles that their rectangles cut, from the corners of all as mounted: the places of
/// these, leaf by leaf. The rectangle of a volume holds its triangles and is that of its halves together.
fn cover(corners: &[[[f64; 2]; 3]], volumes: &mut [Volume]) -> Vec<u32> {
    let mut own: Vec<Rectangle> = volumes
        .iter()
        .map(|Volume { range, .. }| Rectangle::around(corners[range.start as usize..range.end as usize].as_flattened()))
        .collect();
    let Rectangle { low, high } = own[0];
    let touch = TOUCH * (high[0] - low[0]).hypot(high[1] - low[1]);
    let mut covers = vec![];
    let all: Vec<u32> = (0..corners.len() as u32).collect();
    let mut left = vec![(0_usize, all)];
    while let Some((at, mut within)) = left.pop() {
        let whole = own[at];
        within.retain(|k| whole.cuts(&corners[*k as usize], touch));
        let (first, second) = (at + 1, volumes[at].second as usize);
        if second == 0 {
            let from = covers.len() as u32;
            covers.extend(within);
            volumes[at].cover = from..covers.len() as u32;
            continue;
        }
        // Divided where the halves overlap least.
        let [a, b] = [own[first], own[second]];
        let axis = usize::from(a.high[1] - b.low[1] < a.high[0] - b.low[0]);
        let middle = 0.5 * (a.high[axis] + b.low[axis]);
        [own[first], own[second]] = [whole; 2];
        own[first].high[axis] = a.high[axis].max(middle);
        own[second].low[axis] = b.low[axis].min(middle);
        left.extend([(second, within.clone()), (first, within)]);
    }
    covers
}

/// Edges of the outline of a face that all of its outline lies on one side of, seen along z.
fn hull(surface: &Surface, position: &Vectors, triangles: &[u32]) -> Vec<u32> {
    let sides = triangles.iter().flat_map(|triangle| (0..3).map(move |k| (*triangle as usize, k)));
    let outline: Vec<u32> =
        sides.filter(|(t, k)| surface.across[*t][*k] == NONE).map(|(t, k)| surface.edges_of[t][k]).collect();
    let at = |n: &u32| place(position, *n as usize);
    let corners: Vec<Vector3<f64>> =
        triangles.iter().flat_map(|triangle| &surface.corners[*triangle as usize]).map(at).collect();
    let low = corners.iter().fold(Vector3::repeat(f64::INFINITY), |low, corner| low.inf(corner));
    let high = corners.iter().fold(Vector3::repeat(f64::NEG_INFINITY), |high, corner| high.sup(corner));
    let size = (high - low).xy().norm();
    let ends: Vec<Vector3<f64>> = outline.iter().flat_map(|edge| &surface.edges[*edge as usize]).map(at).collect();
    let is_hull = |edge: &u32| {
        let [a, b] = surface.edges[*edge as usize].each_ref().map(at);
        let along = (b - a).xy().normalize();
        let beside = ends.iter().map(|p| along.x * (p.y - a.y) - along.y * (p.x - a.x));
        let (least, most) = beside.fold((0.0_f64, 0.0_f64), |(least, most), d| (least.min(d), most.max(d)));
        least > -FLAT * size || most < FLAT * size
    };
    let mut hull: Vec<u32> = outline.iter().copied().filter(is_hull).collect();
    hull.sort_unstable();
    hull
}
