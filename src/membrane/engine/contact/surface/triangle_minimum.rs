//! The point of a triangle with the least signed distance from a convex body, by tangents.
//!
//! The signed distance from a convex body is a convex function, so that its tangent planes bound it from below
//! (theory.md, equation 212).

use nalgebra::Vector3;

use super::convex::Solid;
use super::projection::Projection;

/// Largest number of tangents along one edge.
const TANGENTS: usize = 40;

/// Largest number of places on the edge that the nearest point was on before.
const FOLLOWED: usize = 5;

/// Weight of a corner below which a point counts as being on the opposite edge.
const ON_EDGE: f64 = 1e-9;

/// Knowledge of the least signed distance of a triangle.
pub(super) enum Minimum {
    /// No point is nearer than `bound` (m), which is beyond what counts; `place` is where this was seen, and `normal`
    /// that of a plane on the body which tells it.
    Beyond { bound: f64, place: [f64; 2], normal: Vector3<f64> },
    /// The nearest point, to within the tolerance.
    At { projection: Projection, place: [f64; 2] },
    /// The plane of the triangle cuts the core, perhaps within the triangle.
    Cut,
}

/// A signed distance and the values of its tangent plane at the corners of the triangle, m.
#[derive(Clone, Copy)]
struct Tangent {
    projection: Projection,
    weights: [f64; 3],
    at: [f64; 3],
}

impl Tangent {
    /// The least value on the triangle, m.
    fn least(&self) -> f64 {
        least(&self.at)
    }
}

#[inline(always)]
fn least(of: &[f64; 3]) -> f64 {
    of[0].min(of[1]).min(of[2])
}

/// A value of each of three corners. Written out, since an array's own `map` is a call in a build without optimisation
/// across units.
#[inline(always)]
fn of_each<T>(corners: &[T; 3], value: impl Fn(&T) -> f64) -> [f64; 3] {
    [value(&corners[0]), value(&corners[1]), value(&corners[2])]
}

/// The search on one triangle.
struct Descent<'a> {
    solid: &'a Solid,
    corners: &'a [Vector3<f64>; 3],
    best: Tangent,
    /// Lower bound, m.
    bound: f64,
    /// Of the plane from which it follows.
    normal: Vector3<f64>,
}

impl Descent<'_> {
    #[inline(always)]
    fn tangent(&self, weights: [f64; 3]) -> Tangent {
        tangent(self.solid, self.corners, weights)
    }

    /// Takes a tangent, and a lower bound (m).
    fn take(&mut self, tangent: &Tangent, bound: f64) {
        if tangent.projection.distance < self.best.projection.distance {
            self.best = *tangent;
        }
        self.raise(bound, || tangent.projection.normal);
    }

    /// Takes a lower `bound` (m) that a plane with a `normal` tells.
    #[inline(always)]
    fn raise(&mut self, bound: f64, normal: impl FnOnce() -> Vector3<f64>) {
        if bound > self.bound {
            (self.bound, self.normal) = (bound, normal());
        }
    }

    /// Finds the least distance on the edge between the corners `ends`, where the slope along it is zero to within
    /// `tolerance` (m over its length), from the tangents at its ends. Further ones are, in turn, where the two about
    /// the least distance intersect, which is best at a bend, and where the slope between them is zero, which is best
    /// on a curve.
    fn edge(&mut self, ends: [usize; 2], tolerance: f64) {
        let slope = |tangent: &Tangent| tangent.at[ends[1]] - tangent.at[ends[0]];
        let corner = |k: usize| of_each(&[0, 1, 2], |i| f64::from(u8::from(*i == ends[k])));
        let [mut left, mut right] = [self.tangent(corner(0)), self.tangent(corner(1))];
        self.take(&left, left.least());
        self.take(&right, right.least());
        for turn in 0..TANGENTS {
            let (falls, rises) = (slope(&left), slope(&right));
            for (is_level, tangent) in [(falls >= -tolerance, &left), (rises <= tolerance, &right)] {
                if is_level {
                    // Its normal is that of the least distance, where a nearer point may have one on the other side of
                    // it.
                    if tangent.projection.distance <= self.best.projection.distance + tolerance {
                        self.best = *tangent;
                    }
                    return;
                }
            }
            // The sum of both with these shares is constant along the edge, and a bound of its own for all of the
            // triangle.
            // `falls` < 0 < `rises` here, so the share lies within 0 and 1.
            let share = rises / (rises - falls);
            let level = least(&of_each(&[0, 1, 2], |k: &usize| left.at[*k] * share + right.at[*k] * (1.0 - share)));
            self.raise(level, || left.projection.normal * share + right.projection.normal * (1.0 - share));
            let [from, to] = [left.weights[ends[1]], right.weights[ends[1]]];
            let along = if turn % 2 == 0 {
                (right.at[ends[0]] - left.at[ends[0]]) / (falls - rises)
            } else {
                from + (to - from) * (1.0 - share)
            };
            // Negated, so that a NaN ends it as well as a bracket that numbers resolve no further.
            if !(from < along && along < to) {
                return;
            }
            let mut weights = [0.0; 3];
            (weights[ends[0]], weights[ends[1]]) = (1.0 - along, along);
            let next = self.tangent(weights);
            self.take(&next, next.least());
            if slope(&next) < 0.0 {
                left = next;
            } else {
                right = next;
            }
        }
    }

    /// Finds the nearest point on the edge that it was on before, from the tangent there. Where a sharp edge of the body
    /// meets the edge of the triangle, normals turn within micrometres along it, and a tangent is far below the distance
    /// next to its point. A plane on the body that is level along the edge of the triangle is as far below at the
    /// second order alone. The next place is under the point of the body that this plane touches; then where the slopes
    /// at the last two places say that the edge is level.
    fn follow(&mut self, first: Tangent, within: f64, tolerance: f64) -> Option<Minimum> {
        let opposite = (0..3).find(|k| first.weights[*k] <= ON_EDGE)?;
        let ends = [(opposite + 1) % 3, (opposite + 2) % 3];
        let [a, b] = [self.corners[ends[0]], self.corners[ends[1]]];
        let along = b - a;
        let squared = along.norm_squared();
        let mut from = first;
        // Share of the edge and slope along it at the place before.
        let mut before: Option<[f64; 2]> = None;
        for _ in 0..FOLLOWED {
            let Tangent { projection: Projection { distance, normal: outward }, weights, at } = from;
            let normal = (outward - along * (outward.dot(&along) / squared)).try_normalize(0.0)?;
            let support = self.solid.support_of_core(&normal)?;
            let reach = normal.dot(&support) + self.solid.edge();
            // The whole body lies below that plane, so no point of the triangle is nearer than its corners are to it.
            let bound = least(&of_each(self.corners, |corner| normal.dot(corner) - reach));
            self.raise(bound, || normal);
            let place = [weights[0], weights[1]];
            if bound >= within {
                return Some(Minimum::Beyond { bound, place, normal });
            }
            if distance - bound <= tolerance {
                return Some(Minimum::At { projection: Projection { distance, normal }, place });
            }
            let (share, slope) = (weights[ends[1]], at[ends[1]] - at[ends[0]]);
            let level = before
                .map(|[share_before, slope_before]| share - slope * (share - share_before) / (slope - slope_before));
            // Also where both slopes are the same and that place is not a number.
            let next = level.filter(|level| (0.0..=1.0).contains(level));
            let next = next.unwrap_or_else(|| ((support - a).dot(&along) / squared).clamp(0.0, 1.0));
            before = Some([share, slope]);
            let mut weights = [0.0; 3];
            (weights[ends[0]], weights[ends[1]]) = (1.0 - next, next);
            from = self.tangent(weights);
            self.take(&from, from.least());
        }
        None
    }

    fn place(&self) -> [f64; 2] {
        [self.best.weights[0], self.best.weights[1]]
    }

    /// Looks at the point of the triangle under the farthest point of the core towards its plane, which is the nearest
    /// of the whole plane. Returns whether the core lies on one side of the plane.
    fn under_core(&mut self) -> bool {
        let [p, q, m] = self.corners;
        let (u, v) = (p - m, q - m);
        let cross = u.cross(&v);
        // The side on which film is; the farthest point of the core towards it decides whether the plane cuts the core.
        let outward = if cross.dot(&self.best.projection.normal) < 0.0 { -cross } else { cross };
        let Some(support) = self.solid.support_of_core(&outward) else { return false };
        let arm = support - m;
        let doubled = cross.norm_squared();
        let [a, b] = [arm.cross(&v).dot(&cross) / doubled, u.cross(&arm).dot(&cross) / doubled];
        // Outside of the triangle that point is no candidate: the least distance is then on a side, since it is convex.
        if a >= 0.0 && b >= 0.0 && a + b <= 1.0 {
            let under = self.tangent([a, b, 1.0 - a - b]);
            self.take(&under, under.least());
        }
        arm.dot(&outward) <= 0.0
    }
}

/// The least height of a triangle over a plane on a convex body, m: no point of it is nearer. The plane is upright to
/// `direction`, or levelled along the edge between the two lowest corners where the first is not `within` (m) below.
/// None without a direction.
#[inline(always)]
pub(super) fn over_plane(
    solid: &Solid,
    corners: &[Vector3<f64>; 3],
    direction: &Vector3<f64>,
    within: f64,
) -> Option<(f64, Vector3<f64>)> {
    let mut normal = direction.try_normalize(0.0)?;
    for is_last in [false, true] {
        let reach = normal.dot(&solid.support_of_core(&normal)?) + solid.edge();
        let heights = of_each(corners, |corner| normal.dot(corner) - reach);
        let bound = least(&heights);
        if bound >= within || is_last {
            return Some((bound, normal));
        }
        let highest = (0..3).fold(0, |highest, k| if heights[k] > heights[highest] { k } else { highest });
        let along = corners[(highest + 1) % 3] - corners[(highest + 2) % 3];
        normal = (normal - along * (normal.dot(&along) / along.norm_squared())).try_normalize(0.0)?;
    }
    None
}

/// The signed distance at the point of a triangle that has these `weights` of its `corners`.
fn tangent(solid: &Solid, corners: &[Vector3<f64>; 3], weights: [f64; 3]) -> Tangent {
    let point = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
    let projection = solid.project_local(&point);
    let at = of_each(corners, |corner| projection.distance + projection.normal.dot(&(corner - point)));
    Tangent { projection, weights, at }
}

/// The point of a triangle of `corners` (body axes, m) that is nearest to a convex `solid`, to within `tolerance` (m),
/// if it is nearer than `within` (m): from the `place` of a point that was the nearest before, given by its shares of
/// the first two corners.
pub(super) fn minimum(
    solid: &Solid,
    corners: &[Vector3<f64>; 3],
    place: [f64; 2],
    within: f64,
    tolerance: f64,
) -> Minimum {
    let first = tangent(solid, corners, [place[0], place[1], 1.0 - place[0] - place[1]]);
    let mut descent = Descent { solid, corners, best: first, bound: first.least(), normal: first.projection.normal };
    let ends = |descent: &Descent<'_>| {
        let Descent { best, bound, .. } = descent;
        if *bound >= within {
            return Some(Minimum::Beyond { bound: *bound, place: descent.place(), normal: descent.normal });
        }
        let projection = best.projection;
        // Its own tangent must say so: where several together do, as in the core, none of their normals is that of the
        // contact.
        (projection.distance - best.least() <= tolerance).then(|| Minimum::At { projection, place: descent.place() })
    };
    if let Some(minimum) = ends(&descent) {
        return minimum;
    }
    if let Some(minimum) = descent.follow(first, within, tolerance).or_else(|| ends(&descent)) {
        return minimum;
    }
    let is_apart = descent.under_core();
    if let Some(minimum) = ends(&descent) {
        return minimum;
    }
    // First the edge that the nearest point so far is next to.
    let weights = descent.best.weights;
    let mut opposite = [0, 1, 2];
    // A small weight means that the point is next to the side opposite to that corner.
    opposite.sort_by(|a, b| weights[*a].total_cmp(&weights[*b]));
    for corner in opposite {
        descent.edge([(corner + 1) % 3, (corner + 2) % 3], 0.5 * tolerance);
        if let Some(minimum) = ends(&descent) {
            return minimum;
        }
    }
    // Inside the core the distance has no single normal, and tangents bound nothing there.
    if !is_apart || descent.best.projection.distance <= -solid.edge() {
        return Minimum::Cut;
    }
    // The nearest point of the whole plane lies outside the triangle, so that the nearest of the triangle is on its
    // edges.
    let Descent { best, bound, .. } = descent;
    if best.projection.distance >= within {
        return Minimum::Beyond { bound: bound.max(within), place: descent.place(), normal: descent.normal };
    }
    Minimum::At { projection: best.projection, place: descent.place() }
}
