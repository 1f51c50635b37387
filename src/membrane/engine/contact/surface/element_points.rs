//! Points of an element that are nearer to a body than a distance, and where they were in the last step.

use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::projection::Projection;

/// The point of an element with the least signed distance.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine::contact) struct DeepestPoint {
    /// Its projection.
    pub(in crate::engine::contact) projection: Projection,
    /// Weights of the element's corners in it.
    pub(in crate::engine::contact) weights: [f64; 4],
    /// The corner from which the side of its triangle begins.
    pub(in crate::engine::contact) side: usize,
    /// Its distance along the normal from the farthest point of the body (m), whose edges count as sharp as they are.
    /// No point of the element is deeper inside the body than this is below zero.
    pub(in crate::engine::contact) extent: f64,
}

/// The points of an element that are nearer to a body than a distance.
pub(in crate::engine::contact) struct DeepPoints {
    /// One for each part of the element and edge of the body; of a round one those within triangles, and the deepest.
    pub(in crate::engine::contact) points: Vec<DeepestPoint>,
    /// No point of the element is nearer than that, m.
    pub(in crate::engine::contact) least: f64,
}

/// Weights of an element's corners at the barycentric coordinates of its triangle between the corners `a`, `b` and the
/// mean of all corners.
#[inline(always)]
pub(super) fn corner_weights(a: usize, b: usize, [wa, wb, wm]: [f64; 3]) -> [f64; 4] {
    let mut weights = [0.25 * wm; 4];
    weights[a] += wa;
    weights[b] += wb;
    weights
}

/// The point of an element that has these `weights` of its corners.
#[inline(always)]
pub(in crate::engine::contact) fn point_of(corners: &[Point3<f64>; 4], weights: &[f64; 4]) -> Vector3<f64> {
    // A loop, as in `WeightedNodes`: a sum of vectors is a call.
    let mut point = Vector3::zeros();
    for a in 0..4 {
        point += corners[a].coords * weights[a];
    }
    point
}

/// The points of an element that are nearer to a body than a distance: the deepest one, or one of each triangle, corner
/// and edge.
pub(super) struct Search {
    /// Distance below which a point counts, m.
    pub(super) within: f64,
    /// Whether all of them are kept, or the deepest alone.
    pub(super) keeps_all: bool,
    /// Points found.
    pub(super) found: Vec<DeepestPoint>,
    /// Where the points of the triangles were in the last step.
    pub(super) followed: Option<Followed>,
    /// By which these may be off the deepest, m.
    pub(super) tolerance: f64,
    /// No point of the element is nearer than that, m.
    pub(super) least: f64,
    /// No point of the element is deeper inside the body than that, m.
    pub(super) depth: f64,
}

/// Where the corners of an element were, body axes, when no point of it was near the body, and how far they may move
/// until one is.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::engine::contact) struct Clearance {
    corners: [[f64; 3]; 4],
    /// m; negative where nothing is known.
    margin: f64,
}

impl Clearance {
    /// Nothing is known.
    pub(in crate::engine::contact) const NONE: Clearance = Clearance { corners: [[0.0; 3]; 4], margin: -1.0 };

    /// Clearance of an element with these `corners` (m) which may move by `margin` (m).
    pub(in crate::engine::contact) fn new(corners: &[Vector3<f64>; 4], margin: f64) -> Clearance {
        Clearance { corners: corners.map(Into::into), margin }
    }

    /// Whether an element that has moved to these `corners` (m) is still not near.
    #[inline(always)]
    pub(in crate::engine::contact) fn holds(&self, corners: &[Vector3<f64>; 4]) -> bool {
        let moved = |k: usize| (corners[k] - Vector3::from(self.corners[k])).norm_squared();
        self.margin > 0.0 && (0..4).all(|k| moved(k) < self.margin * self.margin)
    }
}

/// The deepest point of each triangle of an element in the last step.
pub(in crate::engine::contact) type Followed = [FollowedPoint; 4];

/// The deepest point of a triangle in the last step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::engine::contact) struct FollowedPoint {
    /// Shares of the two sides from the mean of the corners; negative where it is not known.
    pub(super) place: [f64; 2],
    /// Upright to a plane on the body, body axes, that had all of the triangle beyond it; zero where none is known.
    pub(super) beyond: [f64; 3],
    /// Mean force on the film there, N.
    pub(in crate::engine::contact) force: [f64; 3],
}

/// Deepest points that are not known.
pub(in crate::engine::contact) const UNKNOWN: Followed =
    [FollowedPoint { place: [-1.0; 2], beyond: [0.0; 3], force: [0.0; 3] }; 4];

/// Difference of the weights of corners and of the normals below which two points are one.
pub(super) const SAME: f64 = 1e-3;

impl Search {
    /// A search that has found nothing yet.
    pub(super) fn within(within: f64, keeps_all: bool) -> Search {
        let (least, depth) = (f64::INFINITY, f64::INFINITY);
        Search { within, keeps_all, found: vec![], followed: None, tolerance: 0.0, least, depth }
    }

    /// Records where the deepest point of the triangle of the side from corner `side` is, and the normal of a plane on
    /// the body beyond which it lies, or zero.
    pub(super) fn follow(&mut self, side: usize, place: [f64; 2], beyond: Vector3<f64>) {
        if let Some(followed) = &mut self.followed {
            (followed[side].place, followed[side].beyond) = (place, beyond.into());
        }
    }

    /// Takes a point that is near enough.
    pub(super) fn offer(&mut self, point: DeepestPoint) {
        self.least = self.least.min(point.projection.distance);
        if point.projection.distance >= self.within {
            return;
        }
        // Two triangles share the points of the line between them.
        let is_same = |other: &DeepestPoint| {
            (0..4).all(|a| (other.weights[a] - point.weights[a]).abs() < SAME)
                && (other.projection.normal - point.projection.normal).norm_squared() < SAME * SAME
        };
        if self.keeps_all && self.found.iter().any(is_same) {
            return;
        }
        if !self.keeps_all {
            self.within = point.projection.distance;
            self.found.clear();
        }
        self.found.push(point);
    }
}

/// Weights of a corner alone, or of the mean.
pub(super) fn weights_of(point: usize) -> [f64; 4] {
    if point == 4 { [0.25; 4] } else { std::array::from_fn(|a| if a == point { 1.0 } else { 0.0 }) }
}

/// The corners at the ends of each side of an element of `count` corners, of which a triangle repeats its last.
pub(super) fn sides(count: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..4).filter(move |a| count == 4 || *a != 2).map(|a| [a, (a + 1) % 4])
}
