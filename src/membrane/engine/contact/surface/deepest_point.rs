//! The deepest point of an element in the impactor.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::details::closest_points_segment_segment_with_locations;
use parry3d_f64::query::{self, PointQuery};
use parry3d_f64::shape::{Segment, Triangle};

use super::convex::Solid;
use super::element_points::{
    DeepPoints, DeepestPoint, Followed, FollowedPoint, SAME, Search, corner_weights, point_of, sides,
};
use super::projection::{Projection, nearest_on_axis};
use super::triangle_minimum::{Minimum, minimum, over_plane};
use super::triangles::Nearest;
use super::{Part, Shape, Surface, vector};
use crate::lane::{larger, smaller};

/// By which a point may be off the deepest where nothing else is asked for, m.
const LEAST_TOLERANCE: f64 = 1e-9;

impl Surface {
    /// Bound on the penetration (m, negative outside) of any point of an element into a round body. No point of a
    /// triangle is nearer to the axis of a capsule or a bar, or the centre of a ball, than √(d² − l²/3), with the
    /// distance d of the nearest corner and the longest line l.
    pub(in crate::engine::contact) fn penetration_bound(
        &self,
        pose: &Isometry3<f64>,
        corners: &[Point3<f64>; 4],
    ) -> f64 {
        let mean = mean_of(corners);
        let nearest = corners.iter().chain([&mean]).map(|c| self.axis_distance_squared(pose, c));
        let lines = (0..4).flat_map(|a| [(corners[a], corners[(a + 1) % 4]), (corners[a], mean)]);
        let longest = lines.map(|(a, b)| nalgebra::distance_squared(&a, &b)).fold(0.0, f64::max);
        // No point of a triangle is farther than l/√3 from its nearest corner.
        self.size - larger(nearest.fold(f64::INFINITY, f64::min) - longest / 3.0, 0.0).sqrt()
    }

    /// A lower bound of the signed distance of all points of an element from the body at `pose`, whose `corners` have the
    /// projections `at`; where one has no normal, its distance is a bound itself. Of a convex body `outward` is the mean
    /// of the normals, and of a mesh a `nearest` triangle tells where to begin.
    ///
    /// No point is nearer than its distance from a corner admits, and from a convex body none lies below the tangents at
    /// the corners (theory.md, equation 212), or below the plane on the body that is upright to the mean of their
    /// normals, which is the closest of these where film lies on a curved face and looked for only where those admit
    /// less than `beyond` (m). With the bound goes the distance of the mean of the corners from that plane, or the bound
    /// again where there is none.
    pub(in crate::engine::contact) fn least_distance(
        &self,
        pose: &Isometry3<f64>,
        corners: &[Point3<f64>; 4],
        at: &[Projection; 4],
        outward: Option<&Vector3<f64>>,
        nearest: Option<&Nearest>,
        beyond: f64,
    ) -> [f64; 2] {
        let mut least = f64::NEG_INFINITY;
        for (Projection { distance, normal }, corner) in at.iter().zip(corners) {
            let is_tangent = outward.is_some() && *normal != Vector3::zeros();
            raise(&mut least, corners, |point| {
                let arm = point - corner;
                distance + if is_tangent { normal.dot(&arm) } else { -arm.norm() }
            });
        }
        let Some(outward) = outward.filter(|_| least < beyond) else { return [least; 2] };
        let reach = self.convex_reach(pose, outward, nearest);
        let height = |point: &Point3<f64>| outward.dot(&(point.coords - pose.translation.vector)) - reach;
        raise(&mut least, corners, height);
        [least, height(&mean_of(corners))]
    }

    /// A closer one of a convex body at `pose`, triangle by triangle: by the tangents at the corners and by the planes on
    /// the body that are parallel to a triangle, with the normal on the side of `outward`, or upright to that.
    pub(in crate::engine::contact) fn least_over_triangles(
        &self,
        pose: &Isometry3<f64>,
        corners: &[Point3<f64>; 4],
        at: &[Projection; 4],
        outward: &Vector3<f64>,
        nearest: Option<&Nearest>,
    ) -> f64 {
        let mean = mean_of(corners);
        let arm = |point: &Point3<f64>| point.coords - pose.translation.vector;
        let reach = self.convex_reach(pose, outward, nearest);
        let mut least = f64::INFINITY;
        for [a, b] in sides(4) {
            let triangle = [corners[a], corners[b], mean];
            let over = |height: &dyn Fn(&Point3<f64>) -> f64| triangle.iter().map(height).fold(f64::INFINITY, f64::min);
            let mut own = over(&|point| outward.dot(&arm(point))) - reach;
            for (Projection { distance, normal }, corner) in at.iter().zip(corners) {
                if *normal != Vector3::zeros() {
                    own = own.max(over(&|point| distance + normal.dot(&(point - corner))));
                }
            }
            let cross = (corners[a] - mean).cross(&(corners[b] - mean));
            if let Some(normal) = cross.try_normalize(0.0) {
                let normal = if cross.dot(outward) < 0.0 { -normal } else { normal };
                own = own.max(normal.dot(&arm(&mean)) - self.convex_reach(pose, &normal, nearest));
            }
            least = least.min(own);
        }
        least
    }

    /// Squared distance of `point` from the axis of a capsule or a bar, from the centre of other shapes, m².
    fn axis_distance_squared(&self, pose: &Isometry3<f64>, point: &Point3<f64>) -> f64 {
        let arm = point.coords - pose.translation.vector;
        match &self.shape {
            Shape::Capsule(capsule) => {
                let axis = pose.rotation * Vector3::z();
                (arm - axis * nearest_on_axis(capsule, arm.dot(&axis))).norm_squared()
            }
            Shape::Bars(bars) => bars.offset(&pose.rotation.inverse_transform_vector(&arm)).norm_squared(),
            Shape::Ball(_) | Shape::Solid(_) | Shape::Compound(_) => arm.norm_squared(),
        }
    }

    /// The point of an element with the least signed distance from the body at `pose`; `None` where that is not below
    /// `within` (m). The element is taken as the four triangles between its edges and the mean of its corners.
    ///
    /// The point is exact for all shapes but meshes, whose corners and edges each have one. No point of the element is
    /// known to be deeper than `depth` (m).
    pub(in crate::engine::contact) fn deepest_point(
        &self,
        pose: &Isometry3<f64>,
        corners: &[Point3<f64>; 4],
        within: f64,
        depth: f64,
    ) -> Option<DeepestPoint> {
        let mut search = Search { depth, ..Search::within(within, false) };
        deepest(&self.shape, pose, corners, &mut search);
        search.found.pop()
    }

    /// The points of an element where its signed distance from the body at `pose` is below `within` (m): one for each part
    /// of the element and edge, and in round bodies the deepest and those within triangles, which are deeper than the film about
    /// them. Those of a convex body are
    /// `followed` from step to step, to within a `tolerance` (m) of the deepest.
    pub(in crate::engine::contact) fn deep_points(
        &self,
        pose: &Isometry3<f64>,
        corners: &[Point3<f64>; 4],
        within: f64,
        followed: &mut Followed,
        tolerance: f64,
    ) -> DeepPoints {
        let mut search = Search::within(within, true);
        (search.followed, search.tolerance) = (Some(*followed), tolerance);
        deepest(&self.shape, pose, corners, &mut search);
        if let Some(places) = search.followed {
            *followed = places;
        }
        DeepPoints { points: search.found, least: search.least }
    }
}

/// Raises `bound` to the least value of an affine or concave function at the corners of an element, which is that of all
/// its points.
#[inline(always)]
fn raise(bound: &mut f64, corners: &[Point3<f64>; 4], value: impl Fn(&Point3<f64>) -> f64) {
    let least = value(&corners[0]).min(value(&corners[1])).min(value(&corners[2])).min(value(&corners[3]));
    *bound = bound.max(least);
}

/// The mean of the corners of an element.
#[inline(always)]
fn mean_of(corners: &[Point3<f64>; 4]) -> Point3<f64> {
    Point3::from((corners[0].coords + corners[1].coords + corners[2].coords + corners[3].coords) * 0.25)
}

/// Offers points in `shape` at `pose`.
fn deepest(shape: &Shape, pose: &Isometry3<f64>, corners: &[Point3<f64>; 4], search: &mut Search) {
    match shape {
        Shape::Ball(_) => deepest_of_triangles(shape, pose, corners, search, |triangle| {
            triangle.project_local_point(Vector::ZERO, false).point
        }),
        Shape::Capsule(capsule) => {
            deepest_of_triangles(shape, pose, corners, search, |triangle| nearest_to_axis(triangle, &capsule.segment))
        }
        Shape::Solid(solid) => deepest_in_solid(solid, pose, corners, search),
        Shape::Bars(bars) => {
            let mean = mean_of(corners);
            let extent = corners.iter().map(|corner| nalgebra::distance_squared(corner, &mean)).fold(0.0, f64::max);
            let of_mean = shape.project(pose, &(mean.coords - pose.translation.vector));
            // No point of the element is farther from the mean than a corner: one projection sorts out most elements
            // beside long bars.
            let least = of_mean.distance - extent.sqrt();
            if least >= search.within {
                search.least = search.least.min(least);
                return;
            }
            deepest_of_triangles(shape, pose, corners, search, |triangle| {
                bars.nearest(triangle.center(), |point| triangle.project_local_point(point, false).point)
            });
        }
        Shape::Compound(parts) => {
            // There is one place a triangle, and parts would overwrite those of each other.
            search.followed = None;
            for Part { place, shape, .. } in parts {
                deepest(shape, &(pose * place), corners, search);
            }
        }
    }
}

/// Offers the deepest point of the four triangles of an element in `shape` at `pose`, of which `nearest` has that of a
/// triangle about its centre, and those within other triangles: an element folded from side to side has two. If it were pushed
/// out at one alone, it would rock between them and gain energy from friction. One folded along a diagonal has both between
/// triangles, of which the deeper one alone is offered.
fn deepest_of_triangles(
    shape: &Shape,
    pose: &Isometry3<f64>,
    corners: &[Point3<f64>; 4],
    search: &mut Search,
    nearest: impl Fn(&Triangle) -> Vector,
) {
    let mean = mean_of(corners);
    let (mut points, mut least) = ([None; 4], f64::INFINITY);
    // A triangle repeats its last corner, which leaves one of the four without area.
    for [a, b] in sides(4) {
        let triangle = local(shape, pose, [&corners[a], &corners[b], &mean]);
        let place = barycentric(&triangle, nearest(&triangle));
        let weights = corner_weights(a, b, place);
        let projection = shape.project(pose, &(point_of(corners, &weights) - pose.translation.vector));
        least = least.min(projection.distance);
        // On a line to the mean, the next triangle may have a deeper one.
        let is_apart = place[0] > SAME && place[1] > SAME;
        points[a] = Some((DeepestPoint { projection, weights, side: a, extent: projection.distance }, is_apart));
    }
    // Also of points that are too far: it tells how far the element may move before it is looked at again.
    search.least = search.least.min(least);
    for (point, is_apart) in points.into_iter().flatten() {
        if is_apart || point.projection.distance <= least {
            search.offer(point);
        }
    }
}

/// Offers points in `solid` at `pose`.
fn deepest_in_solid(solid: &Solid, pose: &Isometry3<f64>, corners: &[Point3<f64>; 4], search: &mut Search) {
    let mut points = [mean_of(corners).coords; 5];
    for k in 0..4 {
        points[k] = corners[k].coords;
    }
    for point in &mut points {
        *point = pose.rotation.inverse_transform_vector(&(*point - pose.translation.vector));
    }
    let count = if corners[2] == corners[3] { 3 } else { 4 };
    let mut own = Search {
        followed: search.followed,
        tolerance: search.tolerance,
        depth: search.depth,
        ..Search::within(search.within, search.keeps_all)
    };
    match (solid.features(), solid.core().as_trimesh()) {
        (Some(features), Some(mesh)) => {
            let projected = points.each_ref().map(|point| solid.project_local(point));
            features.deepest(mesh, &points, &projected, count, &mut own);
        }
        _ => deepest_in_convex(solid, &points, count, &mut own),
    };
    search.followed = own.followed;
    search.least = search.least.min(own.least);
    for point in own.found {
        search.offer(DeepestPoint { projection: point.projection.turned(pose), ..point });
    }
}

/// Offers the deepest point of each triangle of an element in a convex solid; `points` are its corners and their mean
/// in body axes.
fn deepest_in_convex(solid: &Solid, points: &[Vector3<f64>; 5], count: usize, search: &mut Search) {
    for [a, b] in sides(count) {
        let corners = [points[a], points[b], points[4]];
        // Where film slides over an edge, its points move past it while the plane between both hardly turns.
        if let Some(FollowedPoint { place, beyond, .. }) = search.followed.map(|followed| followed[a])
            && let Some((bound, normal)) = over_plane(solid, &corners, &beyond.into(), search.within)
            && bound >= search.within
        {
            search.follow(a, place, normal);
            search.least = search.least.min(bound);
            continue;
        }
        // Negative where nothing is known: the search begins at the third corner, the mean.
        let known = search.followed.map(|followed| followed[a].place).filter(|place| place[0] >= 0.0);
        // Below round-off of a distance no tangent would ever confirm the minimum.
        let tolerance = search.tolerance.max(LEAST_TOLERANCE);
        let (projection, place) = match minimum(solid, &corners, known.unwrap_or([0.0; 2]), search.within, tolerance) {
            Minimum::Beyond { bound, place, normal } => {
                search.follow(a, place, normal);
                search.least = search.least.min(bound);
                continue;
            }
            Minimum::At { projection, place } => (projection, place),
            Minimum::Cut => match in_core(solid, &corners, search.within) {
                Some(found) => found,
                None => {
                    // Parry tells that there is nothing within reach, not how far it is.
                    search.least = search.least.min(search.within);
                    continue;
                }
            },
        };
        search.follow(a, place, Vector3::zeros());
        let [u, v] = place;
        let point = corners[0] * u + corners[1] * v + corners[2] * (1.0 - u - v);
        // Reported penetration is measured to the edges as given, not to the rounded ones (theory.md, section 6).
        let extent = projection.normal.dot(&point) - solid.sharp_reach(&projection.normal);
        search.offer(DeepestPoint { projection, weights: corner_weights(a, b, [u, v, 1.0 - u - v]), side: a, extent });
    }
}

/// The deepest point of a triangle in the core of a convex solid, if it is nearer to its surface than `within` (m).
fn in_core(solid: &Solid, corners: &[Vector3<f64>; 3], within: f64) -> Option<(Projection, [f64; 2])> {
    let [p, q, m] = corners.each_ref().map(vector);
    let triangle = Triangle::new(p, q, m);
    let reach = (within + solid.edge()).max(0.0);
    let contact = query::contact(&Pose::IDENTITY, &triangle, solid.place(), solid.core(), reach).ok()??;
    let normal = -Vector3::new(contact.normal1.x, contact.normal1.y, contact.normal1.z);
    let [u, v, _] = barycentric(&triangle, contact.point1);
    Some((Projection { distance: contact.dist - solid.edge(), normal }, [u, v]))
}

/// A triangle in body axes about the centre of mass; that of a ball is not rotated.
#[inline(always)]
fn local(shape: &Shape, pose: &Isometry3<f64>, [a, b, c]: [&Point3<f64>; 3]) -> Triangle {
    let is_ball = matches!(shape, Shape::Ball(_));
    let place = |corner: &Point3<f64>| {
        let arm = corner.coords - pose.translation.vector;
        vector(&if is_ball { arm } else { pose.rotation.inverse_transform_vector(&arm) })
    };
    Triangle::new(place(a), place(b), place(c))
}

/// The point of a triangle nearest to an axis along z that does not intersect it.
fn nearest_to_axis(triangle: &Triangle, axis: &Segment) -> Vector {
    let corners = [triangle.a, triangle.b, triangle.c];
    let under = |end: Vector| triangle.project_local_point(end, false).point;
    // Below the lower end, as film under a dart is: one projection instead of five.
    if corners.iter().all(|corner| corner.z <= axis.a.z) {
        return under(axis.a);
    }
    // An axis that does not cut the triangle is nearest to it at a side or under one of its own ends.
    let at_edges = triangle.edges().map(|edge| {
        let (on_edge, _) = closest_points_segment_segment_with_locations(&Pose::IDENTITY, &edge, axis);
        edge.point_at(&on_edge)
    });
    let candidates = at_edges.into_iter().chain([under(axis.a), under(axis.b)]);
    let squared = |point: &Vector| (*point - axis.project_local_point(*point, false).point).length_squared();
    candidates.min_by(|a, b| squared(a).total_cmp(&squared(b))).unwrap_or(triangle.a)
}

/// Barycentric coordinates of a point of a triangle; the first corner of one without area.
#[inline(always)]
fn barycentric(triangle: &Triangle, point: Vector) -> [f64; 3] {
    let (u, v, w) = (triangle.b - triangle.a, triangle.c - triangle.a, point - triangle.a);
    let (uu, uv, vv, wu, wv) = (u.dot(u), u.dot(v), v.dot(v), w.dot(u), w.dot(v));
    let determinant = uu * vv - uv * uv;
    // Triangles without area occur by design: see the repeated corner of a triangle.
    if determinant <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let b = smaller(larger((vv * wu - uv * wv) / determinant, 0.0), 1.0);
    // Clamped so that weights add up to one and none is negative: they share an impulse among nodes.
    let c = smaller(larger((uu * wv - uv * wu) / determinant, 0.0), 1.0 - b);
    [1.0 - b - c, b, c]
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::engine::contact::surface::convex_tests::test_shapes;

    /// A square and a triangle (which repeats its last corner), both with a penetration of 1 mm at the tip.
    #[test]
    fn the_deepest_point_of_an_element_lies_under_the_tip() {
        for surface in test_shapes() {
            let z = surface.lowest(&UnitQuaternion::identity()) + 1e-3;
            let [a, b, c, d] = [[-0.5, -0.4], [0.5, -0.4], [0.6, 0.5], [-0.4, 0.6]].map(|[x, y]| Point3::new(x, y, z));
            for corners in [[a, b, c, d], [a, b, c, c]] {
                let found = surface.deepest_point(&Isometry3::identity(), &corners, 0.0, f64::INFINITY).unwrap();
                assert!((found.projection.distance + 1e-3).abs() < 1e-6, "{found:?}");
                assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
    }

    /// Triangles beside, below and above a dart, compared with parry's distance between triangle and axis.
    #[test]
    fn the_deepest_point_on_a_capsule_is_the_nearest_to_its_axis() {
        let surface = &test_shapes()[1];
        let axis = Segment::new(Vector::new(0.0, 0.0, -0.05), Vector::new(0.0, 0.0, 0.05));
        let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::new(0.3, 0.2, -0.1));
        for k in 0..60 {
            let turn = f64::from(k);
            let (sin, cos) = (0.7 * turn).sin_cos();
            let middle = Vector3::new(0.025 * cos, 0.025 * sin, 0.09 * (1.3 * turn).sin());
            let side = Vector3::new(-sin, cos, 0.4 * (2.1 * turn).cos()) * 0.02;
            let up = Vector3::new(0.3 * cos, 0.3 * sin, 1.0) * 0.015;
            let corners = [middle - side, middle + side, middle + up, middle + up].map(|c| pose * Point3::from(c));
            let found = surface.deepest_point(&pose, &corners, f64::INFINITY, f64::INFINITY);
            let Some(found) = found else { panic!("no point at {k}") };
            let local = |a: usize| vector(&(pose.inverse() * corners[a]).coords);
            let triangle = Triangle::new(local(0), local(1), local(2));
            let distance = query::distance(&Pose::IDENTITY, &triangle, &Pose::IDENTITY, &axis).unwrap().distance;
            assert!((found.projection.distance + surface.size() - distance).abs() < 1e-7, "{k}: {found:?} {distance}");
            assert!(surface.penetration_bound(&pose, &corners) >= -found.projection.distance - 1e-12, "{k}");
        }
    }
}
