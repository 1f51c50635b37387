//! Friction of the guide that a body moves along.

use serde::{Deserialize, Serialize};

/// The force of a guide against the motion of its body (theory.md, equation 52): `constant` + `per_speed` |v| + that of
/// `curve`. A body at rest is held by up to its value at zero.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GuideFriction {
    /// N.
    #[serde(rename = "constant_N")]
    pub constant: f64,
    /// N s/m.
    #[serde(rename = "per_speed_N_s_m")]
    pub per_speed: f64,
    /// Speed (m/s) and force (N), the speed ascending: straight between the points, constant before and beyond them.
    #[serde(rename = "curve_m_s_N")]
    pub curve: Vec<[f64; 2]>,
}

impl GuideFriction {
    /// The force at `speed` (m/s, of any sign), N.
    pub fn force_at(&self, speed: f64) -> f64 {
        self.constant + self.per_speed * speed.abs() + self.on_curve(speed.abs())
    }

    fn on_curve(&self, speed: f64) -> f64 {
        let above = self.curve.partition_point(|point| point[0] <= speed);
        match (above.checked_sub(1).map(|below| self.curve[below]), self.curve.get(above)) {
            (Some([from, force]), Some([to, next])) => force + (next - force) * (speed - from) / (to - from),
            (Some([_, force]), None) | (None, Some(&[_, force])) => force,
            (None, None) => 0.0,
        }
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        *self == GuideFriction::default()
    }

    /// The impulse (N s) on a body of `mass` (kg, with all that follows it) that would move at `velocity` (m/s) after
    /// `dt` (s) without friction and moved at `before`: against the velocity, and no more than stops it.
    pub(super) fn impulse(&self, velocity: f64, before: f64, mass: f64, dt: f64) -> f64 {
        -velocity.signum() * (self.force_at(before) * dt).min(mass * velocity.abs())
    }

    /// Energy (J) that the guide dissipates up to each sample of a motion with `velocity` (m/s) and `displacement` (m).
    pub fn dissipated(&self, velocity: &[f64], displacement: &[f64]) -> Vec<f64> {
        let mut sum = 0.0;
        let steps = velocity.windows(2).zip(displacement.windows(2)).map(|(v, d)| {
            sum += 0.5 * (self.force_at(v[0]) + self.force_at(v[1])) * (d[1] - d[0]).abs();
            sum
        });
        std::iter::once(0.0).take(velocity.len()).chain(steps).collect()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Isometry3;

    use super::*;
    use crate::engine::RigidBody;

    /// A block of `mass` (kg) that slides at 3 m/s without gravity: steps of 0.1 ms until 1 s; velocity, path, and what
    /// the guide took.
    fn sliding(friction: GuideFriction, mass: f64, gravity: f64) -> [f64; 3] {
        let dt = 1e-4;
        let mut body = RigidBody::guided(Isometry3::identity(), -3.0, mass).with_guide_friction(friction);
        let mut lost = 0.0;
        for step in 0..10_000 {
            let before = body.clone();
            let over = if step == 0 { 0.5 * dt } else { dt };
            body.kick(over, gravity);
            let impulse = body.guide_impulse(&before, body.velocity.z, body.mass, over);
            body.velocity.z += impulse / body.mass;
            lost -= 0.5 * impulse * (before.velocity.z + body.velocity.z);
            body.drift(dt);
        }
        [body.velocity.z, body.centre().z, lost]
    }

    /// Coulomb's friction stops it after v²M/2F, and then holds it.
    #[test]
    fn a_sliding_block_stops_and_is_held() {
        let (mass, force) = (2.0, 12.0);
        let [velocity, place, lost] = sliding(GuideFriction { constant: force, ..GuideFriction::default() }, mass, 0.0);
        assert!(velocity.abs() < 1e-12, "{velocity}");
        assert!((place + 9.0 * mass / (2.0 * force)).abs() < 1e-6, "{place}");
        assert!((lost - 0.5 * mass * 9.0).abs() < 1e-12, "{lost}");
        let [held, place, _] = sliding(GuideFriction { constant: force, ..GuideFriction::default() }, mass, 5.9);
        assert!(held.abs() < 3.0 && place < -1.0, "{held} {place}");
        let [held, ..] = sliding(GuideFriction { constant: 40.0, ..GuideFriction::default() }, mass, 9.81);
        assert!(held.abs() < 1e-12, "{held}");
    }

    /// M v' = −k v: v = v₀ exp(−k t/M).
    #[test]
    fn friction_of_the_speed_slows_exponentially() {
        let (mass, k) = (2.0, 3.0);
        let [velocity, place, lost] = sliding(GuideFriction { per_speed: k, ..GuideFriction::default() }, mass, 0.0);
        let expected = -3.0 * (-k / mass).exp();
        assert!((velocity / expected - 1.0).abs() < 3e-4, "{velocity} for {expected}");
        let path = -3.0 * mass / k * (1.0 - (-k / mass).exp());
        assert!((place / path - 1.0).abs() < 3e-4, "{place} for {path}");
        assert!((lost - 0.5 * mass * (9.0 - velocity * velocity)).abs() < 1e-12, "{lost}");
    }

    /// A curve that is straight through c + k |v| is that friction, and constant outside its points.
    #[test]
    fn a_curve_gives_the_force_at_every_speed() {
        let curve = GuideFriction { curve: vec![[0.0, 12.0], [1.0, 14.0], [4.0, 20.0]], ..GuideFriction::default() };
        let line = GuideFriction { constant: 12.0, per_speed: 2.0, curve: vec![] };
        for speed in [0.0, 0.3, -1.0, 2.5, 4.0] {
            assert!((curve.force_at(speed) - line.force_at(speed)).abs() < 1e-12, "{speed}");
        }
        assert_eq!(curve.force_at(7.0), 20.0);
        let late = GuideFriction { curve: vec![[1.0, 5.0], [2.0, 6.0]], ..GuideFriction::default() };
        assert_eq!([0.0, 1.5, 3.0].map(|speed| late.force_at(speed)), [5.0, 5.5, 6.0]);
        let [by_curve, by_line] = [curve, line].map(|friction| sliding(friction, 2.0, 0.0));
        assert!(by_curve.iter().zip(by_line).all(|(a, b)| (a - b).abs() < 1e-12), "{by_curve:?} {by_line:?}");
    }

    /// Down and up again along one metre.
    #[test]
    fn both_ways_dissipate() {
        let friction = GuideFriction { constant: 12.0, per_speed: 2.0, curve: vec![] };
        let lost = friction.dissipated(&[-1.0, -1.0, 1.0], &[0.0, -1.0, 0.0]);
        assert_eq!(lost, [0.0, 14.0, 28.0]);
        assert!(friction.dissipated(&[], &[]).is_empty());
    }
}
