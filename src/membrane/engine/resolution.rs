//! The impactors in a step: their release, their contact with the film and with each other (theory.md, section 6) and its
//! place in the energy ledger, their motion.

use super::collision::{BodyPoints, Collisions};
use super::constraint::Points;
use super::contact::{Contact, Impulse};
use super::film_contact::FilmContact;
use super::impact::{Impact, released_pairs};
use super::nodes::{Nodes, StepSums, Vectors};
use super::rigid_body::RigidBody;
use super::thread_pool::ThreadPool;
use super::{BodyTrack, Engine, Fault, collision};

/// Penetration of a node that two bodies may touch, over the size of the body, at which another sweep is due.
const TOLERANCE: f64 = 1e-5;

/// Largest number of sweeps over all bodies in a step.
const SWEEPS: usize = 12;

/// Largest number of sweeps over the nodes between two bodies after each of those.
const PINCHES: usize = 10;

/// Cosine of the angle between the normals of two bodies at a node above which it can yield to both.
const YIELDING: f64 = -0.9;

/// Losses and reports of contact in a step, besides the motion of nodes and bodies.
pub(super) struct Resolved {
    /// Largest speed of a node in contact, m/s.
    pub(super) fastest: f64,
    /// Energy that bodies lose where they meet each other in the half step before the full one, and in that after it, J.
    pub(super) collisions: [f64; 2],
}

/// Resolves the contact of all released bodies: the nodes have their predicted positions, the bodies have not moved;
/// `before` are the bodies before the forces of this step, which acted `over` (s), and the nodes move on for `dt` (s).
/// Bodies that share no film and do not meet are resolved in one sweep; contact `between` faces together with each.
pub(super) fn resolve(
    impacts: &mut [Impact],
    before: &[RigidBody],
    nodes: &mut Nodes,
    [over, dt]: [f64; 2],
    pool: &ThreadPool,
    mut between: Option<&mut FilmContact>,
) -> Resolved {
    let mut between = between.take_if(|between| between.is_near());
    if let Some(between) = &mut between {
        // Before the bodies: they see film where the faces will hold it, which is nearly so from step to step.
        between.predict(nodes, dt);
    }
    let mut collisions = Collisions::within(impacts, dt);
    let shared = SharedNodes::from_impacts(impacts);
    // Before the film as well, which then follows bodies that move as their impact leaves them.
    collisions.solve(impacts, dt);
    for sweep in 0..SWEEPS {
        for (impact, before) in impacts.iter_mut().zip(before).filter(|(impact, _)| !impact.is_held()) {
            let Impact { body, contact, .. } = impact;
            // The guide acts once a step, on the motion before it.
            let before = (sweep == 0).then_some(before);
            contact.correct(nodes, body, before, [over, dt], pool, between.as_deref_mut());
        }
        let met = collisions.solve(impacts, dt);
        let pinched = shared.pinch(impacts, nodes, dt);
        // Bodies with nothing in common are through after one sweep.
        if !met && !pinched {
            break;
        }
    }
    // Any released body has resolved it in its own sweeps.
    if let Some(between) = between.filter(|_| impacts.iter().all(Impact::is_held)) {
        between.resolve(nodes, dt, pool);
    }
    let mut fastest = 0.0_f64;
    for (impact, before) in impacts.iter_mut().zip(before).filter(|(impact, _)| !impact.is_held()) {
        fastest = fastest.max(impact.contact.account(nodes, &impact.body, before));
    }
    // Works and losses come last, with the velocities at the end of the step (theory.md, equation 22).
    collisions.record(impacts);
    Resolved { fastest, collisions: collisions.losses(impacts, before) }
}

/// Nodes that two bodies may touch in this step.
struct SharedNodes {
    pairs: Vec<([usize; 2], Vec<usize>)>,
}

impl SharedNodes {
    fn from_impacts(impacts: &[Impact]) -> SharedNodes {
        let mut pairs = vec![];
        for (bodies, [a, b]) in released_pairs(impacts) {
            // By the lists, not by positions: they hold whatever may be in contact until the end of the step.
            let of_both = a.contact.listed().filter(|node| b.contact.lists(*node));
            let nodes: Vec<usize> = of_both.map(|node| node as usize).collect();
            if !nodes.is_empty() {
                pairs.push((bodies, nodes));
            }
        }
        SharedNodes { pairs }
    }

    /// Finds the nodes that penetrate one of two bodies. Where such a node cannot yield, the bodies press on each other
    /// through it (theory.md, equation 55). Returns whether there was one, so that another sweep is due.
    fn pinch(&self, impacts: &mut [Impact], nodes: &Nodes, dt: f64) -> bool {
        let mut any = false;
        for (bodies, shared) in &self.pairs {
            for _ in 0..PINCHES {
                let found: Vec<Pinch> = shared.iter().map(|node| pinch(impacts, *bodies, nodes, *node, dt)).collect();
                // Also by a node that yields: it moved for one body and may now be inside the other.
                any |= found.iter().any(|found| *found != Pinch::None);
                if !found.contains(&Pinch::Pressed) {
                    break;
                }
            }
        }
        any
    }
}

/// Effect of a node between two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pinch {
    /// It penetrates neither, or both are fixed.
    None,
    /// It penetrates one, and can yield.
    Yields,
    /// The bodies got an impulse under which they leave room for it.
    Pressed,
}

/// Looks at `node` between two bodies, which press on each other where it cannot yield.
fn pinch(impacts: &mut [Impact], bodies: [usize; 2], nodes: &Nodes, node: usize, dt: f64) -> Pinch {
    let [a, b] = bodies.map(|k| &impacts[k]);
    // Anew for each node: the impulse at the one before has changed the bodies' motion.
    let poses = [a, b].map(|of| of.body.predicted(dt));
    let [(gap, normal), (other_gap, other_normal)] =
        [(&a.contact, &poses[0]), (&b.contact, &poses[1])].map(|(contact, pose)| contact.gap(nodes, pose, node));
    let tolerance = |contact: &Contact| TOLERANCE * contact.surface().size();
    if nodes.is_held(node) || (gap >= -tolerance(&a.contact) && other_gap >= -tolerance(&b.contact)) {
        return Pinch::None;
    }
    // Between opposite surfaces the sum of the gaps does not depend on where in between the node lies.
    let (overlap, allowed) = (-(gap + other_gap), tolerance(&a.contact).min(tolerance(&b.contact)));
    if normal.dot(&other_normal) > YIELDING || overlap <= allowed {
        return Pinch::Yields;
    }
    // Out of the first body into the second: the mean of one normal and the reverse of the other.
    let Some(direction) = (normal - other_normal).try_normalize(0.0) else { return Pinch::Yields };
    let point = nodes.position_of(node);
    let arms = poses.map(|pose| point.coords - pose.translation.vector);
    let mut contact = BodyPoints::new(impacts, bodies, arms).along(direction);
    if contact.effective_mass == 0.0 {
        return Pinch::None;
    }
    contact.target = contact.points.velocity(impacts).dot(&direction) + overlap / dt;
    let impulse = contact.solve(0.0, impacts);
    impacts[bodies[0]].contact.record(Impulse::pressing(node, arms[0], impulse));
    impacts[bodies[1]].contact.record(Impulse::pressing(node, arms[1], -impulse));
    Pinch::Pressed
}

/// What contact changes in the work of mass-proportional damping, kg m²/s²: m v̄·½Δv with the mean `v̄` of the velocities
/// `earlier` than the step and as `predicted` and the change `Δv` by contact. The damping force is that of the predictor,
/// but its work is done along the corrected motion.
fn damping_correction(nodes: &Nodes, earlier: &Vectors, predicted: &Vectors) -> f64 {
    let (earlier, predicted, after) = (earlier.axes(), predicted.axes(), nodes.velocity.axes());
    let mut total = 0.0;
    for (n, mass) in nodes.mass.iter().enumerate() {
        let mut work = 0.0;
        for axis in 0..3 {
            work += (after[axis][n] - predicted[axis][n]) * (earlier[axis][n] + predicted[axis][n]);
        }
        total += 0.25 * mass * work;
    }
    total
}

impl Engine {
    /// The first two impactors that move from the start and overlap, by their indices, and how deep, m; of those pairs
    /// that `are_looked_at`.
    pub fn overlap_of_impactors(&self, are_looked_at: impl Fn([&Impact; 2]) -> bool) -> Option<([usize; 2], f64)> {
        let mut pairs = released_pairs(&self.impacts).filter(|(_, bodies)| are_looked_at(*bodies));
        pairs.find_map(|(bodies, [a, b])| Some((bodies, collision::overlap(a, b)?)))
    }

    /// Releases the impactors whose time has come; the work of what launches them is external.
    pub(super) fn release(&mut self) -> Result<(), Fault> {
        for k in 0..self.impacts.len() {
            if !self.impacts[k].is_due(self.progress.time) {
                continue;
            }
            let (impact, impactor, time) = (&self.impacts[k], k + 1, self.progress.time);
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
            self.progress.ledger.external.add_at_once(-impact.body.kinetic_energy(&impact.body));
        }
        Ok(())
    }

    /// Kicks the bodies and resolves their contact in a step in which forces act `over` (s) and nodes move on for `dt` (s),
    /// and adds its losses to the ledger and to `sums`; with damping, nodes moved at `earlier` (m/s) before the step.
    /// Returns the largest speed of a node in contact, m/s.
    pub(super) fn resolve_contact(
        &mut self,
        [over, dt]: [f64; 2],
        earlier: Option<&Vectors>,
        sums: &mut StepSums,
    ) -> f64 {
        // Before the kick: works take the mean of the velocities on both sides of the full step.
        let before: Vec<RigidBody> = self.impacts.iter().map(|impact| impact.body.clone()).collect();
        let predicted = earlier.map(|_| self.nodes.velocity.clone());
        let between = &mut self.film_contact;
        self.impacts.iter_mut().for_each(|impact| impact.kick([over, dt], self.loads.gravity));
        let nodes = &mut self.nodes;
        let resolved = resolve(&mut self.impacts, &before, nodes, [over, dt], &self.pool, between.as_mut());
        let of_guide = |(Impact { body, contact, .. }, before): (&Impact, &RigidBody)| {
            let half = |body: &RigidBody| contact.guide_impulse.map_or(0.0, |impulse| -0.5 * impulse * body.velocity.z);
            [half(before), half(body)]
        };
        let guides = self.impacts.iter().zip(&before).map(of_guide);
        self.progress.ledger.guide.add(guides.fold([0.0; 2], |[a, b], [behind, ahead]| [a + behind, b + ahead]));
        self.progress.ledger.collision.add(resolved.collisions);
        let mut fastest = resolved.fastest;
        if let Some(between) = between {
            // Also where films are apart now: then nothing of it is ahead of this step any more.
            fastest = fastest.max(between.finish(nodes, dt));
        }
        if let (Some(earlier), Some(predicted)) = (earlier, predicted) {
            sums.damped += damping_correction(nodes, earlier, &predicted);
        }
        fastest
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
                work: work.on_film.total(),
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

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Point3};

    use crate::engine::{Contact, Engine, Film, Impact, Loads, Mesh, Nodes, RigidBody, Section, Surface, Unobserved};
    use crate::material::{Elastic, Law};

    /// Two balls press on the node of film between them until they have one velocity, with the momentum of both.
    #[test]
    fn bodies_press_on_each_other_through_a_node() {
        const THICKNESS: f64 = 1e-4;
        let corners = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.3], [0.0, 0.3]].map(|[x, y]| Point3::new(x, y, 0.0));
        let mesh = Mesh { nodes: corners.into(), quads: vec![[0, 1, 2, 3]], ..Mesh::default() };
        let section = Section::new(Law::Elastic(Elastic { young: 2e8, poisson: 0.3 }), 1000.0, THICKNESS);
        let mut nodes = Nodes::default();
        let film = Film::mount(&mesh, &section, 0.0, &mut nodes).unwrap();
        let ball = |mass: f64, side: f64, velocity: f64| {
            let pose = Isometry3::translation(0.0, 0.0, side * (0.05 + 0.5 * THICKNESS));
            let contact = Contact::new(Surface::sphere(0.05).unwrap(), 0.3, 1.0, vec![0.5 * THICKNESS; 4]);
            Impact::new(RigidBody::guided(pose, velocity, mass), contact).starting_in_contact(true)
        };
        let mut engine = Engine::new(vec![film], nodes, [ball(2.0, 1.0, -1.0), ball(0.5, -1.0, 2.0)], Loads::default());
        for _ in 0..3 {
            engine.step(&mut Unobserved).unwrap();
            let of_film: f64 = (0..4).map(|n| engine.nodes.mass[n] * engine.nodes.velocity_of(n).z).sum();
            let [upper, lower] = [0, 1].map(|k| engine.impacts[k].body.velocity.z);
            assert!((2.0 * upper + 0.5 * lower + of_film + 1.0).abs() < 1e-14, "{upper} {lower} {of_film}");
            // Of both balls; the node between them has a thousandth of their mass.
            assert!((upper + 0.4).abs() < 1e-3 && (lower + 0.4).abs() < 1e-3, "{upper} {lower}");
        }
    }
}
