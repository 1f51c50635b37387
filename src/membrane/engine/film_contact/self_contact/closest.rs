//! Closest points of a point and a triangle, and of two segments, by parry.

use nalgebra::Vector3;
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::query::details::closest_points_segment_segment_with_locations;
use parry3d_f64::shape::{Segment, SegmentPointLocation, Triangle, TrianglePointLocation};

/// Part of a triangle on which the point nearest to another one lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feature {
    Inside,
    /// The edge opposite to this corner.
    Edge(usize),
    Corner(usize),
}

/// The weights of the corners at the point of a triangle next to `p`, and where it lies.
#[inline]
pub(super) fn on_triangle(p: &Vector3<f64>, [a, b, c]: &[Vector3<f64>; 3]) -> ([f64; 3], Feature) {
    let triangle = Triangle::new(vector(a), vector(b), vector(c));
    match triangle.project_local_point_and_get_location(vector(p), false).1 {
        TrianglePointLocation::OnVertex(corner) => {
            let mut weights = [0.0; 3];
            weights[corner as usize] = 1.0;
            (weights, Feature::Corner(corner as usize))
        }
        // Parry counts edges by their first corner: from a to b, b to c, and a to c.
        TrianglePointLocation::OnEdge(0, [u, v]) => ([u, v, 0.0], Feature::Edge(2)),
        TrianglePointLocation::OnEdge(1, [u, v]) => ([0.0, u, v], Feature::Edge(0)),
        TrianglePointLocation::OnEdge(_, [u, v]) => ([u, 0.0, v], Feature::Edge(1)),
        TrianglePointLocation::OnFace(_, weights) => (weights, Feature::Inside),
        TrianglePointLocation::OnSolid => unreachable!("a triangle in space is not solid"),
    }
}

/// Point of a triangle with these weights of its corners.
#[inline]
pub(super) fn at(weights: [f64; 3], [a, b, c]: &[Vector3<f64>; 3]) -> Vector3<f64> {
    a * weights[0] + b * weights[1] + c * weights[2]
}

/// Distance of a point from a triangle.
#[inline]
pub(super) fn distance_to_triangle(p: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> f64 {
    (p - at(on_triangle(p, corners).0, corners)).norm()
}

/// Distance of two segments.
#[inline]
pub(super) fn distance_of_segments(one: &[Vector3<f64>; 2], other: &[Vector3<f64>; 2]) -> f64 {
    let segment = |[a, b]: &[Vector3<f64>; 2]| Segment::new(vector(a), vector(b));
    let (first, second) = (segment(one), segment(other));
    let (on_first, on_second) = closest_points_segment_segment_with_locations(&Pose::IDENTITY, &first, &second);
    let place = |segment: &Segment, location: &SegmentPointLocation| segment.point_at(location);
    (place(&first, &on_first) - place(&second, &on_second)).length()
}

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::film_contact::tests::numbers::Numbers;

    /// No point of a fine division of a triangle or of two segments is nearer, and one is nearly as near; the weights are of the
    /// corners of the part that is told.
    #[test]
    fn distances_are_the_least() {
        let mut numbers = Numbers::new(7);
        let mut features = [0; 3];
        let share = |k: i32| f64::from(k) / 40.0;
        for _ in 0..500 {
            let [p, a, b, c] = [(); 4].map(|()| numbers.vector());
            let corners = [a, b, c];
            let (weights, feature) = on_triangle(&p, &corners);
            let is_zero = weights.map(|weight| weight == 0.0);
            match feature {
                Feature::Inside => assert_eq!(is_zero, [false; 3]),
                Feature::Edge(k) => assert_eq!(is_zero, [0, 1, 2].map(|corner| corner == k), "{weights:?}"),
                Feature::Corner(k) => assert_eq!(is_zero, [0, 1, 2].map(|corner| corner != k), "{weights:?}"),
            }
            features[match feature {
                Feature::Inside => 0,
                Feature::Edge(_) => 1,
                Feature::Corner(_) => 2,
            }] += 1;
            let distance = distance_to_triangle(&p, &corners);
            let places = (0..=40).flat_map(|i| (0..=40 - i).map(move |j| [share(i), share(j), share(40 - i - j)]));
            let nearest = places.map(|weights| (at(weights, &corners) - p).norm()).fold(f64::INFINITY, f64::min);
            let size = (b - a).norm() + (c - a).norm();
            assert!(distance <= nearest + 1e-12 && nearest < distance + 0.03 * size, "{distance} {nearest}");

            let distance = distance_of_segments(&[p, a], &[b, c]);
            let along = |q: Vector3<f64>| ((q - b).dot(&(c - b)) / (c - b).norm_squared()).clamp(0.0, 1.0);
            let from = |q: Vector3<f64>| (q - b - (c - b) * along(q)).norm();
            let nearest = (0..=40).map(|i| from(p + (a - p) * share(i))).fold(f64::INFINITY, f64::min);
            assert!(distance <= nearest + 1e-12 && nearest < distance + 0.03 * (a - p).norm(), "{distance} {nearest}");
        }
        assert!(features.iter().all(|count| *count > 25), "{features:?}");
    }
}
