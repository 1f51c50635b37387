//! The points at which two bodies meet.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d_f64::shape::Shape as ParryShape;

use super::bars::{Bars, Piece};
use super::projection::Projection;
use super::{Part, Shape, Surface, vector};

/// A point at which one body is near another.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Meeting {
    /// In the middle of the gap, m.
    pub(in crate::engine) point: Point3<f64>,
    /// Unit normal, from the first body to the second.
    pub(in crate::engine) normal: Vector3<f64>,
    /// m; negative where they overlap.
    pub(in crate::engine) gap: f64,
}

impl Surface {
    /// The points of the body at `pose` that are within `reach` (m) of the `other` one, at `other_pose`: one of each
    /// pair of parts of which one is a ball, else those of parry's contact manifold. Bars meet a ball on each of their
    /// lines, other bodies with their straight pieces.
    pub(in crate::engine) fn meetings(
        &self,
        pose: &Isometry3<f64>,
        other: &Surface,
        other_pose: &Isometry3<f64>,
        reach: f64,
    ) -> Vec<Meeting> {
        if let Shape::Bars(bars) = &self.shape {
            return on_bars(bars, pose, &other.shape, other_pose, reach);
        }
        if matches!(other.shape, Shape::Bars(_)) {
            let turned = |meeting: Meeting| Meeting { normal: -meeting.normal, ..meeting };
            return other.meetings(other_pose, self, pose, reach).into_iter().map(turned).collect();
        }
        let mut found = vec![];
        self.shape.for_each_part(pose, &mut |first, at| {
            other.shape.for_each_part(other_pose, &mut |second, other_at| {
                meet([first, second], [at, other_at], reach, &mut found)
            });
        });
        found
    }
}

impl Shape {
    /// Calls `act` with every part that is no compound, and its pose where the whole is at `pose`.
    fn for_each_part(&self, pose: &Isometry3<f64>, act: &mut dyn FnMut(&Shape, &Isometry3<f64>)) {
        match self {
            Shape::Compound(parts) => {
                parts.iter().for_each(|Part { place, shape, .. }| shape.for_each_part(&(pose * place), act));
            }
            Shape::Ball(_) | Shape::Capsule(_) | Shape::Solid(_) | Shape::Bars(_) => act(self, pose),
        }
    }

    /// The shape of which this one, no compound, is everything within a radius (m), and its place.
    fn core(&self) -> Option<(&dyn ParryShape, Pose, f64)> {
        match self {
            Shape::Ball(ball) => Some((ball, Pose::IDENTITY, 0.0)),
            Shape::Capsule(capsule) => Some((capsule, Pose::IDENTITY, 0.0)),
            Shape::Solid(solid) => Some((solid.core(), *solid.place(), solid.edge())),
            Shape::Compound(_) | Shape::Bars(_) => None,
        }
    }
}

/// The points of `bars` at `pose` that are within `reach` (m) of the `other` shape.
fn on_bars(bars: &Bars, pose: &Isometry3<f64>, other: &Shape, other_pose: &Isometry3<f64>, reach: f64) -> Vec<Meeting> {
    let mut found = vec![];
    other.for_each_part(other_pose, &mut |part, at| {
        let arm = at.translation.vector - pose.translation.vector;
        if let Shape::Ball(ball) = part {
            let meetings = bars.project_on_each(pose, &arm).map(|Projection { distance, normal }| {
                let gap = distance - ball.radius;
                let point = Point3::from(at.translation.vector - normal * (ball.radius + 0.5 * gap));
                Meeting { point, normal, gap }
            });
            found.extend(meetings.filter(|meeting| meeting.gap <= reach));
            return;
        }
        // By spheres before manifolds: a polygon has a bar along each edge.
        let bound = part.bounding_radius() + reach;
        if bars.project(pose, &arm).distance > bound {
            return;
        }
        let local = pose.rotation.inverse_transform_vector(&arm);
        for Piece { solid, place, reach: extent } in bars.pieces() {
            if (place.translation.vector - local).norm_squared() <= (extent + bound) * (extent + bound) {
                manifold([&Shape::Solid(solid.clone()), part], [&(pose * place), at], reach, &mut found);
            }
        }
    });
    found
}

/// Adds the points of two shapes at their poses.
fn meet(shapes: [&Shape; 2], poses: [&Isometry3<f64>; 2], reach: f64, found: &mut Vec<Meeting>) {
    let centre = |k: usize| poses[k].translation.vector;
    // The distance from the centre of a ball is exact for every shape.
    let ball = |ball: usize, radius: f64| {
        let other = 1 - ball;
        let projection = shapes[other].project(poses[other], &(centre(ball) - centre(other)));
        let (gap, outward) = (projection.distance - radius, projection.normal);
        let point = Point3::from(centre(ball) - outward * (radius + 0.5 * gap));
        Meeting { point, normal: if ball == 1 { outward } else { -outward }, gap }
    };
    match shapes {
        [_, Shape::Ball(second)] => found.extend(Some(ball(1, second.radius)).filter(|meeting| meeting.gap <= reach)),
        [Shape::Ball(first), _] => found.extend(Some(ball(0, first.radius)).filter(|meeting| meeting.gap <= reach)),
        _ => manifold(shapes, poses, reach, found),
    }
}

/// Adds the points of parry's contact manifold.
fn manifold(shapes: [&Shape; 2], poses: [&Isometry3<f64>; 2], reach: f64, found: &mut Vec<Meeting>) {
    let [Some((first, place, edge)), Some((second, other_place, other_edge))] = shapes.map(Shape::core) else { return };
    let from_first = place.inverse() * to_parry(&poses[0].inv_mul(poses[1])) * other_place;
    // Manifolds are not kept from step to step: they would outlive a checkpoint.
    let mut manifolds: Vec<ContactManifold<(), ()>> = vec![];
    let edges = edge + other_edge;
    let supported =
        DefaultQueryDispatcher.contact_manifolds(&from_first, first, second, reach + edges, &mut manifolds, &mut None);
    debug_assert!(supported.is_ok(), "parry has the manifold of all shapes of impactors");
    for manifold in &manifolds {
        let part = manifold.subshape_pos1().copied().unwrap_or(Pose::IDENTITY);
        let normal = vector_of(place.rotation * (part.rotation * manifold.local_n1));
        let normal = poses[0].rotation * normal;
        for contact in &manifold.points {
            // Parry has the distance of the cores; the gap is that less the rounding of both.
            let gap = contact.dist - edges;
            if gap > reach {
                continue;
            }
            let on_core = vector_of(place.transform_point(part.transform_point(contact.local_p1)));
            // From the core to the surface, and on to the middle of the gap: both bodies have the same point, which
            // conserves angular momentum.
            let point = poses[0] * Point3::from(on_core) + normal * (edge + 0.5 * gap);
            found.push(Meeting { point, normal, gap });
        }
    }
}

fn vector_of(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// A pose as one of parry.
fn to_parry(pose: &Isometry3<f64>) -> Pose {
    let q = pose.rotation.coords;
    Pose::from_parts(vector(&pose.translation.vector), Rotation::from_xyzw(q.x, q.y, q.z, q.w))
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::engine::contact::surface::convex_tests::test_shapes;

    /// Every shape over every other, both upright, and the same the other way round.
    #[test]
    fn the_gap_of_bodies_over_each_other_is_that_of_their_extents() {
        for (lower, low) in test_shapes().iter().enumerate() {
            for (upper, high) in test_shapes().iter().enumerate() {
                let turned = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
                let extents = -low.lowest(&turned) - high.lowest(&UnitQuaternion::identity());
                for gap in [1e-4, -1e-4] {
                    let below = Isometry3::translation(0.2, 0.1, 0.4);
                    let above = Isometry3::translation(0.2, 0.1, 0.4 + extents + gap);
                    let found = low.meetings(&below, high, &above, 1e-3);
                    let least = found.iter().map(|meeting| meeting.gap).fold(f64::INFINITY, f64::min);
                    assert!((least - gap).abs() < 1e-7, "{upper} on {lower}: {least} for {gap}");
                    for Meeting { normal, point, .. } in &found {
                        assert!((normal - Vector3::z()).norm() < 1e-5, "{upper} on {lower}: {normal}");
                        let middle = 0.4 - low.lowest(&turned) + 0.5 * gap;
                        assert!((point.z - middle).abs() < 1e-6, "{upper} on {lower}: {point} for {middle}");
                    }
                    let back = high.meetings(&above, low, &below, 1e-3);
                    let other = back.iter().map(|meeting| meeting.gap).fold(f64::INFINITY, f64::min);
                    assert!((other - gap).abs() < 1e-7 && back.iter().all(|meeting| meeting.normal.z < 0.0));
                }
            }
        }
    }
}
