//! Contact between bodies (theory.md, section 6).

use nalgebra::Vector3;

use super::constraint::{Constraint, Points, Response};
use super::contact::Meeting;
use super::impact::{Impact, released_pairs};
use super::rigid_body::{InverseMass, RigidBody};

/// Overlap over the size of the smaller body that is round-off.
pub(super) const TOUCH: f64 = 1e-9;

/// Share of an overlap that is recovered in one step, so that bodies do not gain velocity from it.
const RECOVERY: f64 = 0.02;

/// Largest number of sweeps over the points of all pairs.
const SWEEPS: usize = 100;

/// The points at which bodies may meet in a step, and the impulses there.
#[derive(Default)]
pub(super) struct Collisions {
    points: Vec<Collision>,
}

/// Points of two bodies: of the second one over the first.
pub(super) struct BodyPoints {
    bodies: [usize; 2],
    /// From the centres of mass, m.
    arms: [Vector3<f64>; 2],
    /// Of each.
    inverse_masses: [InverseMass; 2],
}

impl BodyPoints {
    /// Of two of the bodies, by their numbers, at `arms` (m) from their centres of mass.
    pub(super) fn new(impacts: &[Impact], bodies: [usize; 2], arms: [Vector3<f64>; 2]) -> BodyPoints {
        let inverse_masses = [0, 1].map(|k| impacts[bodies[k]].body.inverse_mass_at(&arms[k]));
        BodyPoints { bodies, arms, inverse_masses }
    }

    /// Their constraint along `normal`.
    pub(super) fn along(self, normal: Vector3<f64>) -> Constraint<BodyPoints> {
        let response = self.response(&normal).dot(&normal);
        Constraint::new(self, normal, response)
    }

    /// Velocity of the second point over the first of bodies that move as `body` tells by their number, m/s.
    fn velocity_of<'a>(&self, body: impl Fn(usize) -> &'a RigidBody) -> Vector3<f64> {
        let [a, b] = [0, 1].map(|k| body(self.bodies[k]).velocity_at(&self.arms[k]));
        b - a
    }
}

impl Response for BodyPoints {
    fn response(&self, impulse: &Vector3<f64>) -> Vector3<f64> {
        let [a, b] = &self.inverse_masses;
        a.response(impulse) + b.response(impulse)
    }
}

impl Points<[Impact]> for BodyPoints {
    fn velocity(&self, impacts: &[Impact]) -> Vector3<f64> {
        self.velocity_of(|k| &impacts[k].body)
    }

    fn apply(&self, impulse: &Vector3<f64>, impacts: &mut [Impact]) {
        let ([a, b], [of_a, of_b]) = (self.bodies, &self.arms);
        impacts[a].body.apply_impulse_at(&-impulse, of_a);
        impacts[b].body.apply_impulse_at(impulse, of_b);
    }
}

/// A point at which two bodies may meet.
struct Collision {
    /// Its normal is from the first body to the second.
    contact: Constraint<BodyPoints>,
    /// m; negative where they overlap.
    gap: f64,
    /// m.
    tolerance: f64,
    restitution: f64,
    friction: f64,
    /// Whether neither body can yield.
    is_blocked: bool,
}

impl Collisions {
    /// The points at which released bodies may meet in the next `dt` (s).
    pub(super) fn within(impacts: &[Impact], dt: f64) -> Collisions {
        let mut points = vec![];
        for ([first, second], [a, b]) in released_pairs(impacts) {
            // Twice the travel: a collision may make a body faster.
            let reach = 2.0 * (travel(a, dt) + travel(b, dt));
            let tolerance = TOUCH * a.contact.surface().size().min(b.contact.surface().size());
            // Points and arms hold for the whole step, and velocities alone change: so a sweep needs no search.
            let found = meetings(a, b, reach + tolerance + a.cover + b.cover);
            points.extend(found.into_iter().map(|Meeting { point, normal, gap }| {
                let arms = [a, b].map(|of| point - of.body.centre());
                Collision {
                    contact: BodyPoints::new(impacts, [first, second], arms).along(normal),
                    gap: gap - a.cover - b.cover,
                    tolerance,
                    restitution: a.restitution.min(b.restitution),
                    friction: a.contact.friction().min(b.contact.friction()),
                    is_blocked: false,
                }
            }));
        }
        Collisions { points }
    }

    /// Lets the bodies collide, one point after the other, until none closes its gap within `dt` (s). Returns whether
    /// there was an impulse.
    pub(super) fn solve(&mut self, impacts: &mut [Impact], dt: f64) -> bool {
        for sweep in 0..SWEEPS {
            let mut any = false;
            for point in &mut self.points {
                // One after the other, each with the velocities that the one before left: a row of balls passes an
                // impact on by this.
                any |= point.solve(impacts, dt);
            }
            if !any {
                // The first sweep has found nothing to do, so there was no impulse.
                return sweep > 0;
            }
        }
        true
    }

    /// Energy that the impulses of the step dissipate in the half step before the full one, and in that after it, J; `before`
    /// are the bodies before the step.
    pub(super) fn losses(&self, impacts: &[Impact], before: &[RigidBody]) -> [f64; 2] {
        // Summed impulses times the mean of the velocities before and after the step: exact, whatever the sweeps did in
        // between.
        let mut losses = [0.0; 2];
        for contact in self.points.iter().map(|point| &point.contact).filter(|contact| contact.is_active()) {
            let [behind, ahead] = [contact.points.velocity_of(|k| &before[k]), contact.points.velocity(impacts)];
            losses[0] -= contact.half_work(&behind).iter().sum::<f64>();
            losses[1] -= contact.half_work(&ahead).iter().sum::<f64>();
        }
        losses
    }

    /// Adds the impulses of the step to those that the bodies have got, and marks those that met the frame.
    pub(super) fn record(&self, impacts: &mut [Impact]) {
        impacts.iter_mut().for_each(|impact| impact.meets_frame = false);
        for Collision { contact, is_blocked, .. } in &self.points {
            let [a, b] = contact.points.bodies;
            let with_frame = impacts[a].is_frame || impacts[b].is_frame;
            if with_frame && (contact.is_active() || *is_blocked) {
                (impacts[a].meets_frame, impacts[b].meets_frame) = (true, true);
            }
            let along_z = contact.impulse().z;
            impacts[a].collision_impulse -= along_z;
            impacts[b].collision_impulse += along_z;
        }
    }
}

impl Collision {
    /// Newton's law of restitution and Coulomb's of friction for a gap that would close within `dt` (s) (theory.md,
    /// equations 58 and 59). Returns whether there was an impulse.
    fn solve(&mut self, impacts: &mut [Impact], dt: f64) -> bool {
        let velocity = self.contact.points.velocity(impacts).dot(&self.contact.normal);
        let recovery = if self.gap < -self.tolerance { -RECOVERY * self.gap / dt } else { 0.0 };
        // `velocity` < 0 closes the gap. The larger one, not the sum: an overlap adds nothing to a rebound.
        let target = recovery.max(-self.restitution * velocity);
        let is_fixed = self.contact.effective_mass == 0.0;
        // Only a gap that would close in this step gets an impulse, so resting bodies are not held at a distance.
        let closes = self.gap + velocity * dt < -self.tolerance;
        // Neither body yields, but they meet all the same, which `record` notes of the frame.
        self.is_blocked = is_fixed && closes;
        if is_fixed || !closes || velocity >= target {
            return false;
        }
        self.contact.target = target;
        self.contact.solve(self.friction, impacts);
        true
    }
}

/// The points of two bodies that are within `reach` (m) of each other.
fn meetings(a: &Impact, b: &Impact, reach: f64) -> Vec<Meeting> {
    let (first, second) = (a.contact.surface(), b.contact.surface());
    let spheres = first.bounding_radius() + second.bounding_radius() + reach;
    if (a.body.centre() - b.body.centre()).norm_squared() > spheres * spheres {
        return vec![];
    }
    first.meetings(&a.body.pose, second, &b.body.pose, reach)
}

/// Bound on the way of a point of the body in `dt` (s), m.
fn travel(impact: &Impact, dt: f64) -> f64 {
    let Impact { body, contact, .. } = impact;
    (body.velocity.norm() + body.spin.norm() * contact.surface().bounding_radius()) * dt
}

/// Depth by which two bodies overlap, m; none where they do not.
pub(super) fn overlap(a: &Impact, b: &Impact) -> Option<f64> {
    let tolerance = TOUCH * a.contact.surface().size().min(b.contact.surface().size());
    let cover = a.cover + b.cover;
    let depth = meetings(a, b, cover).iter().map(|meeting| cover - meeting.gap).fold(0.0, f64::max);
    (depth > tolerance).then_some(depth)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Matrix3, UnitQuaternion};

    use super::*;
    use crate::engine::contact::{Contact, Surface};
    use crate::engine::rigid_body::Freedom;

    const DT: f64 = 1e-6;

    /// A free body of `surface` without film.
    fn body(
        surface: &Surface,
        mass: f64,
        at: [f64; 3],
        velocity: [f64; 3],
        [restitution, friction]: [f64; 2],
    ) -> Impact {
        let inertia = surface.inertia_per_mass() * mass;
        let body = RigidBody::free(Isometry3::translation(at[0], at[1], at[2]), velocity.into(), mass, inertia);
        let contact = Contact::new(surface.clone(), friction, 1.0, vec![]);
        Impact::new(body, contact).with_restitution(restitution)
    }

    /// Steps over `time` (s) without gravity. Returns what the collisions dissipated and the deepest overlap.
    fn step(bodies: &mut [Impact], time: f64) -> [f64; 2] {
        let (mut lost, mut deepest) = (0.0, 0.0_f64);
        for _ in 0..(time / DT).round() as usize {
            let before: Vec<RigidBody> = bodies.iter().map(|impact| impact.body.clone()).collect();
            let mut collisions = Collisions::within(bodies, DT);
            collisions.solve(bodies, DT);
            lost += collisions.losses(bodies, &before).iter().sum::<f64>();
            deepest = collisions.points.iter().fold(deepest, |deepest, point| deepest.max(-point.gap));
            bodies.iter_mut().for_each(|impact| impact.body.drift(DT));
        }
        [lost, deepest]
    }

    fn kinetic(bodies: &[Impact]) -> f64 {
        bodies.iter().map(|impact| impact.body.kinetic_energy(&impact.body)).sum()
    }

    /// Momentum and angular momentum about the origin.
    fn momenta(bodies: &[Impact], inertia: &[Matrix3<f64>]) -> [Vector3<f64>; 2] {
        let of = |(impact, inertia): (&Impact, &Matrix3<f64>)| {
            let body = &impact.body;
            let rotation = body.pose.rotation.to_rotation_matrix();
            let momentum = body.velocity * body.mass;
            let own = rotation * inertia * rotation.transpose() * body.spin;
            [momentum, body.centre().coords.cross(&momentum) + own]
        };
        let all = bodies.iter().zip(inertia).map(of);
        all.fold([Vector3::zeros(); 2], |[p, l], [dp, dl]| [p + dp, l + dl])
    }

    /// v' = (m v + m w + m e (w − v)) / (m + m), the same law for the other.
    #[test]
    fn balls_head_on_have_their_velocities_of_the_closed_form() {
        let ball = Surface::sphere(0.05).unwrap();
        let (m, n, v, w) = (2.0, 0.7, 3.0, -1.0);
        for e in [0.0, 0.3, 0.8, 1.0] {
            let mut bodies = [
                body(&ball, m, [0.0, 0.0, 0.0], [v, 0.0, 0.0], [e, 0.0]),
                body(&ball, n, [0.102, 0.0, 0.0], [w, 0.0, 0.0], [1.0, 0.5]),
            ];
            let energy = kinetic(&bodies);
            let [lost, deepest] = step(&mut bodies, 1e-3);
            let mean = (m * v + n * w) / (m + n);
            let expected = [mean - n * e * (v - w) / (m + n), mean + m * e * (v - w) / (m + n)];
            for (impact, expected) in bodies.iter().zip(expected) {
                let found = impact.body.velocity;
                assert!((found.x - expected).abs() < 1e-12 && found.yz().norm() < 1e-12, "{found} for {expected}");
            }
            let formula = 0.5 * m * n / (m + n) * (1.0 - e * e) * (v - w) * (v - w);
            assert!((lost - formula).abs() < 1e-9, "{lost} for {formula}");
            assert!((energy - kinetic(&bodies) - lost).abs() < 1e-12);
            assert!(deepest < 1e-9, "{deepest}");
        }
    }

    /// Without friction only the velocities along the line of centres change.
    #[test]
    fn balls_that_meet_obliquely_without_friction_do_not_spin() {
        let ball = Surface::sphere(0.05).unwrap();
        let mut bodies = [
            body(&ball, 2.0, [0.0, 0.0, 0.0], [3.0, 0.4, 0.0], [0.6, 0.0]),
            body(&ball, 0.7, [0.09, 0.05, 0.02], [-1.0, 0.0, 0.3], [0.6, 0.0]),
        ];
        let start = bodies.each_ref().map(|impact| impact.body.velocity);
        step(&mut bodies, 3e-3);
        let change = bodies.each_ref().map(|impact| impact.body.velocity).map(|v| v);
        let impulse = (change[1] - start[1]) * 0.7;
        assert!(impulse.norm() > 0.1 && ((change[0] - start[0]) * 2.0 + impulse).norm() < 1e-14);
        let line = impulse.normalize();
        let closing = [start, change].map(|[a, b]| (b - a).dot(&line));
        assert!((closing[1] + 0.6 * closing[0]).abs() < 1e-12, "{closing:?}");
        assert!(bodies.iter().all(|impact| impact.body.spin.norm() < 1e-14));
    }

    /// Spinning bodies of all shapes that meet off centre with friction.
    #[test]
    fn momentum_and_angular_momentum_are_conserved() {
        let shapes = [
            Surface::sphere(0.05),
            Surface::capsule(0.02, 0.1),
            Surface::cuboid([0.1, 0.08, 0.12], 0.01),
            Surface::cylinder(0.03, 0.1, 0.005),
        ]
        .map(Result::unwrap);
        for (k, (first, second)) in shapes.iter().flat_map(|a| shapes.iter().map(move |b| (a, b))).enumerate() {
            let mut bodies = [
                body(first, 2.0, [0.0, 0.0, 0.0], [4.0, 0.3, 0.0], [0.5, 0.3]),
                body(second, 0.7, [0.16, 0.012, -0.009], [-1.0, 0.0, 0.3], [0.7, 0.4]),
            ];
            bodies[0].body.spin = Vector3::new(10.0, -20.0, 5.0);
            bodies[1].body.pose.rotation = UnitQuaternion::from_euler_angles(0.3, -0.5, 0.2);
            let inertia = [first.inertia_per_mass() * 2.0, second.inertia_per_mass() * 0.7];
            let ([p, l], energy) = (momenta(&bodies, &inertia), kinetic(&bodies));
            let [lost, deepest] = step(&mut bodies, 0.03);
            let [now, turned] = momenta(&bodies, &inertia);
            assert!((now - p).norm() < 1e-12 * p.norm(), "pair {k}: {now} {p}");
            // The rotation of a free body keeps its angular momentum to its own accuracy.
            assert!((turned - l).norm() < 1e-9 * l.norm(), "pair {k}: {turned} {l}");
            assert!(lost > 1e-2 && (energy - kinetic(&bodies) - lost).abs() < 2e-6 * energy, "pair {k}: {lost}");
            assert!(deepest < 1e-5, "pair {k}: {deepest}");
        }
    }

    /// The cradle: of a row of equal balls in touch, only the last leaves.
    #[test]
    fn a_chain_passes_the_velocity_on() {
        let ball = Surface::sphere(0.05).unwrap();
        let at = |k: f64, v: f64| body(&ball, 1.0, [0.1 * k, 0.0, 0.0], [v, 0.0, 0.0], [1.0, 0.0]);
        let mut bodies = [at(-0.01, 2.0), at(1.0, 0.0), at(2.0, 0.0), at(3.0, 0.0)];
        step(&mut bodies, 5e-3);
        for (impact, expected) in bodies.iter().zip([0.0, 0.0, 0.0, 2.0]) {
            assert!((impact.body.velocity.x - expected).abs() < 1e-9, "{}", impact.body.velocity.x);
        }
    }

    /// A guided body that falls on a fixed one, and on a tilted line.
    #[test]
    fn guides_take_what_they_do_not_admit() {
        let ball = Surface::sphere(0.05).unwrap();
        let contact = || Contact::new(ball.clone(), 0.0, 1.0, vec![]);
        let fixed = RigidBody::prescribed(Isometry3::translation(0.03, 0.0, 0.0), 0.0);
        let falling = RigidBody::guided(Isometry3::translation(0.0, 0.0, 0.1), -2.0, 3.0);
        let mut bodies = [fixed, falling].map(|body| Impact::new(body, contact()).with_restitution(0.5));
        step(&mut bodies, 0.01);
        assert_eq!(bodies[0].body.velocity, Vector3::zeros());
        assert!((bodies[1].body.velocity - Vector3::new(0.0, 0.0, 1.0)).norm() < 1e-12, "{}", bodies[1].body.velocity);
        let line = nalgebra::Unit::new_normalize(Vector3::new(0.0, 1.0, 1.0));
        let mut bodies = [
            body(&ball, 1.0, [0.0, 0.0, 0.105], [0.0, 0.0, -2.0], [1.0, 0.0]),
            body(&ball, 2.0, [0.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0]),
        ];
        bodies[1].body = bodies[1].body.clone().with_freedom(Freedom::Line(line));
        step(&mut bodies, 0.005);
        // Effective mass of the ball on the line along z: m / cos² 45°.
        let expected = [-2.0 * (1.0 - 4.0) / (1.0 + 4.0), -2.0 * 2.0 / (1.0 + 4.0)];
        for (impact, expected) in bodies.iter().zip(expected) {
            assert!((impact.body.velocity.z - expected).abs() < 1e-9, "{} for {expected}", impact.body.velocity.z);
        }
    }
}
