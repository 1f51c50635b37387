//! Contact between bodies (theory.md, section 6).

use nalgebra::Vector3;

use super::contact::Meeting;
use super::impact::{Impact, released_pairs};
use super::rigid_body::RigidBody;
use super::weighted_nodes::ContactImpulse;

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

/// A point at which two bodies may meet.
struct Collision {
    bodies: [usize; 2],
    /// On the second body; its normal is from the first body to it.
    impulse: ContactImpulse,
    /// From the centres of mass, m.
    arms: [Vector3<f64>; 2],
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
            points.extend(found.into_iter().map(|Meeting { point, normal, gap }| Collision {
                bodies: [first, second],
                impulse: ContactImpulse::none(normal),
                arms: [a, b].map(|of| point - of.body.centre()),
                gap: gap - a.cover - b.cover,
                tolerance,
                restitution: a.restitution.min(b.restitution),
                friction: a.contact.friction().min(b.contact.friction()),
                is_blocked: false,
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
                let Ok([a, b]) = impacts.get_disjoint_mut(point.bodies) else { continue };
                // One after the other, each with the velocities that the one before left: a row of balls passes an
                // impact on by this.
                any |= point.solve(&mut a.body, &mut b.body, dt);
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
        let (mut behind, mut ahead) = (0.0, 0.0);
        for Collision { bodies: [a, b], arms, impulse, .. } in &self.points {
            let impulse = impulse.total();
            // Summed impulses times the mean of the velocities before and after the step: exact, whatever the sweeps
            // did in between.
            let half_power =
                |a: &RigidBody, b: &RigidBody| -0.5 * impulse.dot(&(b.velocity_at(&arms[1]) - a.velocity_at(&arms[0])));
            behind += half_power(&before[*a], &before[*b]);
            ahead += half_power(&impacts[*a].body, &impacts[*b].body);
        }
        [behind, ahead]
    }

    /// Adds the impulses of the step to those that the bodies have got, and marks those that met the frame.
    pub(super) fn record(&self, impacts: &mut [Impact]) {
        impacts.iter_mut().for_each(|impact| impact.meets_frame = false);
        for Collision { bodies: [a, b], impulse, is_blocked, .. } in &self.points {
            let with_frame = impacts[*a].is_frame || impacts[*b].is_frame;
            if with_frame && (impulse.is_active() || *is_blocked) {
                (impacts[*a].meets_frame, impacts[*b].meets_frame) = (true, true);
            }
            let along_z = impulse.total().z;
            impacts[*a].collision_impulse -= along_z;
            impacts[*b].collision_impulse += along_z;
        }
    }
}

impl Collision {
    /// Velocity of the second body over the first at the point, m/s.
    fn relative_velocity(&self, a: &RigidBody, b: &RigidBody) -> Vector3<f64> {
        b.velocity_at(&self.arms[1]) - a.velocity_at(&self.arms[0])
    }

    /// Relative velocity per impulse along `direction`, 1/kg.
    fn inverse_effective_mass(&self, direction: &Vector3<f64>, a: &RigidBody, b: &RigidBody) -> f64 {
        a.inverse_effective_mass(direction, &self.arms[0]) + b.inverse_effective_mass(direction, &self.arms[1])
    }

    fn apply(&self, impulse: &Vector3<f64>, a: &mut RigidBody, b: &mut RigidBody) {
        a.apply_impulse_at(&-impulse, &self.arms[0]);
        b.apply_impulse_at(impulse, &self.arms[1]);
    }

    /// Newton's law of restitution and Coulomb's of friction for a gap that would close within `dt` (s) (theory.md,
    /// equations 58 and 59). Returns whether there was an impulse.
    fn solve(&mut self, a: &mut RigidBody, b: &mut RigidBody, dt: f64) -> bool {
        let normal = self.impulse.normal;
        let velocity = self.relative_velocity(a, b).dot(&normal);
        let recovery = if self.gap < -self.tolerance { -RECOVERY * self.gap / dt } else { 0.0 };
        // `velocity` < 0 closes the gap. The larger one, not the sum: an overlap adds nothing to a rebound.
        let target = recovery.max(-self.restitution * velocity);
        let mass = self.inverse_effective_mass(&normal, a, b);
        // Only a gap that would close in this step gets an impulse, so resting bodies are not held at a distance.
        if self.gap + velocity * dt >= -self.tolerance || velocity >= target || mass == 0.0 {
            // Neither body yields, but they meet all the same, which `record` notes of the frame.
            self.is_blocked = mass == 0.0 && self.gap + velocity * dt < -self.tolerance;
            return false;
        }
        let change = (target - velocity) / mass;
        self.impulse.press(change);
        self.apply(&(normal * change), a, b);

        let relative = self.relative_velocity(a, b);
        let slip = relative - normal * relative.dot(&normal);
        let Some(direction) = slip.try_normalize(0.0) else { return true };
        // Along the slip: a spinning ball responds 3.5 times as much along its surface as across it.
        let mass = self.inverse_effective_mass(&direction, a, b);
        if mass > 0.0 {
            let dragged = self.impulse.drag(slip / mass, self.friction);
            self.apply(&dragged, a, b);
        }
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
