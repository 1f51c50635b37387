//! The impactors in a step: their release, their contact and its place in the energy ledger, their motion.

use super::impact::Impact;
use super::nodes::StepSums;
use super::rigid_body::RigidBody;
use super::{BodyTrack, Engine, Fault, collision, resolution};

impl Engine {
    /// The first two impactors that move from the start and overlap, by their indices, and how deep, m; of those pairs
    /// that `are_looked_at`.
    pub fn overlap_of_impactors(&self, are_looked_at: impl Fn([&Impact; 2]) -> bool) -> Option<([usize; 2], f64)> {
        let released = || self.impacts.iter().enumerate().filter(|(_, impact)| !impact.is_held());
        released().find_map(|(second, b)| {
            let before = released().take_while(|(first, _)| *first < second);
            let mut before = before.into_iter().filter(|(_, a)| are_looked_at([a, b]));
            before.find_map(|(first, a)| Some(([first, second], collision::overlap(a, b)?)))
        })
    }

    /// Releases the impactors whose time has come; the work of what launches them is external.
    pub(super) fn release(&mut self) -> Result<(), Fault> {
        for k in 0..self.impacts.len() {
            if !self.impacts[k].is_due(self.time) {
                continue;
            }
            let (impact, impactor, time) = (&self.impacts[k], k + 1, self.time);
            let gap = impact.contact.smallest_gap(&self.nodes, &impact.body.pose);
            if gap < -collision::TOUCH * impact.contact.surface().size() {
                return Err(Fault::ReleasedInFilm { time, impactor, depth: -gap });
            }
            // Those that are released in this step, too, as far as they come before it: two bodies must not appear in
            // one place.
            let others = self.impacts.iter().enumerate().filter(|(_, other)| !other.is_held());
            for (other, at) in others {
                if let Some(depth) = collision::overlap(at, impact) {
                    return Err(Fault::ReleasedInImpactor { time, impactor, other: other + 1, depth });
                }
            }
            let impact = &mut self.impacts[k];
            impact.release();
            self.ledger.external -= impact.body.kinetic_energy(&impact.body);
        }
        Ok(())
    }

    /// Kicks the bodies, resolves their contact and adds its losses to the ledger and to `sums`. Returns the largest
    /// speed of a node in contact, m/s.
    pub(super) fn resolve_contact(&mut self, over: f64, dt: f64, sums: &mut StepSums) -> f64 {
        // Before the kick: works take the mean of the velocities on both sides of the full step.
        let before: Vec<RigidBody> = self.impacts.iter().map(|impact| impact.body.clone()).collect();
        let damped = self.loads.damping > 0.0;
        let between = &mut self.film_contact;
        between
            .iter_mut()
            // Only damping needs them: its force is that of the predictor, its work is done along the corrected motion.
            .filter(|between| damped && between.is_near())
            .for_each(|between| between.record_prediction(&self.nodes));
        for impact in &mut self.impacts {
            impact.kick([over, dt], self.loads.gravity);
            if damped && !impact.is_held() {
                impact.contact.record_prediction(&self.nodes);
            }
        }
        let nodes = &mut self.nodes;
        let resolved = resolution::resolve(&mut self.impacts, &before, nodes, [over, dt], &self.pool, between.as_mut());
        self.ledger.guide_ahead = 0.0;
        for (Impact { body, contact, .. }, before) in self.impacts.iter().zip(&before) {
            let work = contact.guide_impulse.map_or([0.0; 2], |impulse| {
                [before.velocity.z, body.velocity.z].map(|velocity| -0.5 * impulse * velocity)
            });
            self.ledger.guide += work[0] + work[1];
            self.ledger.guide_ahead += work[1];
        }
        let [collision, ahead] = resolved.collisions;
        self.ledger.collision += collision;
        self.ledger.collision_ahead = ahead;
        if let Some(between) = between.as_mut().filter(|between| between.is_near()) {
            let fastest = resolved.fastest.max(between.finish(nodes, dt));
            if damped {
                sums.damped += between.damping_correction(nodes);
            }
            return fastest;
        }
        for (place, impact) in self.impacts.iter().enumerate().filter(|(_, impact)| damped && !impact.is_held()) {
            let earlier = self.impacts[..place].iter().filter(|other| !other.is_held());
            // A node that two bodies list changes its velocity once.
            let is_counted = |node| earlier.clone().any(|other| other.contact.lists(node));
            sums.damped += impact.contact.damping_correction(&self.nodes, is_counted);
        }
        resolved.fastest
    }

    /// The impactors at the full step, with the velocities that follow it.
    pub(super) fn track_bodies(&self) -> Vec<BodyTrack> {
        let of_body = |impact: &Impact| {
            let launched = impact.is_held().then(|| impact.launched());
            let (body, work) = (launched.as_ref().unwrap_or(&impact.body), &impact.contact.work);
            BodyTrack {
                centre: body.centre().into(),
                velocity: body.velocity.into(),
                lateral_energy: body.lateral_energy(),
                work: work.on_film,
                impulse: work.impulse,
                collision: impact.collision_impulse,
                meets_frame: impact.meets_frame,
            }
        };
        self.impacts.iter().map(of_body).collect()
    }

    /// Moves the released impactors by `dt` (s); the nodes moved at most `fastest` (m/s).
    pub(super) fn drift_bodies(&mut self, dt: f64, fastest: f64) {
        for Impact { body, contact, .. } in self.impacts.iter_mut().filter(|impact| !impact.is_held()) {
            let rotation = body.spin.norm() * contact.surface().bounding_radius();
            // A bound by sizes: film and body may move towards each other.
            contact.reduce_skin((fastest + body.velocity.norm() + rotation) * dt);
            body.drift(dt);
        }
    }
}
