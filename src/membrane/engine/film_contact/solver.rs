//! Gauss–Seidel sweeps over the constraints of a step, and what the step leaves for the next one.

use nalgebra::Vector3;

use super::constraint::{FilmConstraint, Source};
use super::due::Pairs;
use super::surface::NONE;
use super::{FilmContact, History};
use crate::engine::nodes::Nodes;
use crate::engine::thread_pool::ThreadPool;

/// Largest number of Gauss–Seidel sweeps in a step.
pub(in crate::engine) const SWEEPS: usize = 128;

/// How often film that comes too close by the impulses of other contacts is added to them in a step.
pub(in crate::engine) const ROUNDS: usize = 6;

/// Change of the normal distance in a sweep, over the least allowed one, below which the sweeps have converged.
pub(in crate::engine) const TOLERANCE: f64 = 0.02;

/// Motion by contact that a detection allows for, over that of the last step.
const MARGIN: f64 = 1.5;

/// Largest motion that a detection allows for, over the thickness of the thinnest film: where film moves farther it is
/// looked at again.
const LARGEST_MARGIN: f64 = 0.02;

/// Where the sweeps of a step are.
#[derive(Default)]
pub(super) struct Sweeps {
    /// Whether the last one ended the sweeps.
    has_converged: bool,
    /// Whether the next one is over those that have impulses only.
    skips: bool,
    /// Places of those of the last one, or of these.
    active: Vec<usize>,
}

impl Sweeps {
    /// The next sweep is over all constraints.
    fn restart(&mut self) {
        self.skips = false;
    }
}

impl FilmContact {
    /// Moves the nodes, which have their predicted positions without contact at the end of a step of `dt` (s), by the
    /// impulses of the last step: those of this one are nearly the same.
    pub(in crate::engine) fn predict(&mut self, nodes: &mut Nodes, dt: f64) {
        self.history.carried.iter().for_each(|carried| carried.apply(1.0, nodes, dt));
        self.has_begun = false;
    }

    /// Finds what is too close at the predicted positions, and gives it the impulses of the last step; in further calls
    /// of a step, adds what comes too close by the impulses of other contacts. Returns whether there is any constraint,
    /// or was one in the last step.
    pub(in crate::engine) fn begin(&mut self, nodes: &mut Nodes, dt: f64, pool: &ThreadPool) -> bool {
        // Several bodies each resolve film on film in their turn; only the first of a step starts from the last one.
        if self.has_begun {
            self.extend(nodes, dt, pool);
            return self.has_impulses();
        }
        self.has_begun = true;
        self.sweeps.restart();
        self.add_path(&nodes.position, self.motion(&nodes.position, pool.width()));
        self.detected_within = (MARGIN * self.history.pushed).min(self.largest_margin());
        self.history.pushed = 0.0;
        // Whatever had an impulse must be found, however far `predict` has moved it apart by that impulse.
        self.mark_carried(|place| place);
        self.detect(nodes, [dt, 2.0 * self.detected_within], pool);
        for carried in &self.history.carried {
            carried.apply(-1.0, nodes, dt);
        }
        for k in 0..self.constraints.len() {
            let marked = self.place(self.constraints[k].source).map_or(NONE, |(pairs, place)| pairs.carried[place]);
            if let Some(carried) = self.history.carried.get(marked as usize) {
                // Along the present normal, which has turned since: the old impulse was taken back above and is not
                // simply kept.
                let constraint = &mut self.constraints[k];
                constraint.contact.start_from(carried.pressing, &carried.dragging.into(), &mut nodes.velocity);
                constraint.contact.move_nodes(&mut nodes.position, dt);
            }
        }
        self.mark_carried(|_| NONE);
        self.has_impulses()
    }

    /// Largest motion of nodes that a detection allows for, m.
    pub(super) fn largest_margin(&self) -> f64 {
        // The thinnest film limits it for all: beyond, most of what is found would never touch.
        LARGEST_MARGIN * 2.0 * self.half.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Whether films have or had impulses in this step, under which nodes move differently from how they were
    /// predicted.
    fn has_impulses(&self) -> bool {
        !self.constraints.is_empty() || !self.history.carried.is_empty()
    }

    /// Motion of nodes that the constraints allow for, m.
    pub(in crate::engine) fn detected_within(&self) -> f64 {
        self.detected_within
    }

    /// Marks what has impulses of the last step with `mark`, a function of the place of that impulse.
    fn mark_carried(&mut self, mark: impl Fn(u32) -> u32) {
        for k in 0..self.history.carried.len() {
            if let Some((pairs, place)) = self.place(self.history.carried[k].source) {
                pairs.carried[place] = mark(k as u32);
            }
        }
    }

    /// The pairs of the kind to which a constraint belongs, and the place of its own one.
    pub(super) fn place(&mut self, source: Source) -> Option<(&mut Pairs, usize)> {
        let History { tracking, crossings, .. } = &mut self.history;
        match source {
            Source::Node { side, node } => Some((&mut tracking[side].pairs, node as usize)),
            Source::Crossing(edges) => crossings.place(edges).map(|place| (&mut crossings.pairs, place)),
            Source::Itself(parts) => {
                let of_faces = &mut self.itself.as_mut()?.state.pairs;
                of_faces.place(parts).map(|place| (&mut of_faces.pairs, place))
            }
        }
    }

    /// Moves the nodes by the impulses so far. Where they have moved by these and by other contacts farther than the
    /// detection allows for, adds what has come too close, and returns true.
    pub(in crate::engine) fn extend(&mut self, nodes: &mut Nodes, dt: f64, pool: &ThreadPool) -> bool {
        self.constraints.iter_mut().for_each(|constraint| constraint.contact.move_nodes(&mut nodes.position, dt));
        let motion = self.motion(&nodes.position, pool.width());
        self.history.pushed = self.history.pushed.max(motion);
        // Both films may have moved by that.
        if motion <= self.detected_within {
            return false;
        }
        self.add_path(&nodes.position, motion);
        self.sweeps.restart();
        let known = self.constraints.len();
        // Constraints of before keep their place and their impulse: they are not due in this step any more.
        self.detect(nodes, [dt, 2.0 * self.detected_within], pool);
        // Those that the last round adds are not solved in this step.
        self.sweeps.has_converged &= self.constraints.len() == known;
        true
    }

    /// One sweep over the constraints of a step of `dt` (s), and one back: over all of them first, then over those that
    /// have impulses until these do not change any more, then over all of them again. Returns whether all have
    /// converged.
    pub(in crate::engine) fn sweep(&mut self, nodes: &mut Nodes, dt: f64) -> bool {
        let Sweeps { has_converged, skips, active } = &mut self.sweeps;
        let (friction, velocity) = (self.friction, &mut nodes.velocity);
        let is_whole = !*skips;
        if is_whole {
            active.clear();
            active.extend(0..self.constraints.len());
        }
        for place in &*active {
            self.constraints[*place].contact.solve(friction, velocity);
        }
        let mut largest = 0.0_f64;
        // There and back: against the order of the constraints, an impulse passes through a stack by one face a sweep.
        for place in active.iter().rev() {
            let FilmConstraint { contact, bound, .. } = &mut self.constraints[*place];
            let pressed = contact.solve(friction, velocity).dot(&contact.normal);
            largest = largest.max(pressed.abs() * dt / (contact.effective_mass * *bound));
        }
        let is_settled = largest <= TOLERANCE;
        // Sweeps over active constraints cost a fraction of one over all; these end only after a whole one has
        // confirmed it.
        *skips = !is_settled;
        if is_whole && !is_settled {
            active.retain(|place| self.constraints[*place].contact.is_active());
        }
        *has_converged = is_whole && is_settled;
        *has_converged
    }

    /// Sweeps of a step without another body.
    pub(in crate::engine) fn resolve(&mut self, nodes: &mut Nodes, dt: f64, pool: &ThreadPool) {
        if !self.begin(nodes, dt, pool) {
            return;
        }
        for _ in 0..ROUNDS {
            for _ in 0..SWEEPS {
                if self.sweep(nodes, dt) {
                    break;
                }
            }
            if !self.extend(nodes, dt, pool) {
                return;
            }
        }
    }

    /// Moves the nodes by the impulses of a step of `dt` (s), stores these, and adds their work. Returns the largest
    /// speed of these nodes, m/s.
    pub(in crate::engine) fn finish(&mut self, nodes: &mut Nodes, dt: f64) -> f64 {
        let Nodes { position, velocity, .. } = nodes;
        let (mut fastest, mut impact, mut friction) = (0.0_f64, [0.0; 2], [0.0; 2]);
        self.history.carried.clear();
        for constraint in &mut self.constraints {
            // What the last sweep changed since `extend`.
            constraint.contact.move_nodes(position, dt);
            let FilmConstraint { contact, .. } = &*constraint;
            if !contact.is_active() {
                continue;
            }
            self.history.carried.push(constraint.carried());
            for (half, velocity) in [&self.previous_velocity, &*velocity].into_iter().enumerate() {
                let [normal, tangential] = contact.half_work(&contact.points.sum(velocity));
                impact[half] -= self.multiplicity * normal;
                friction[half] -= self.multiplicity * tangential;
            }
            let squared = |n: &u32| Vector3::from(velocity.value_at(*n as usize)).norm_squared();
            fastest = contact.points.nodes.iter().map(squared).fold(fastest, f64::max);
        }
        self.history.loss.impact.add(impact);
        self.history.loss.friction.add(friction);
        self.make_constrained_due();
        self.history.unresolved += u64::from(!self.constraints.is_empty() && !self.sweeps.has_converged);
        fastest.sqrt()
    }

    /// Nodes that press on another face.
    pub(super) fn pressed_nodes(&self) -> usize {
        let active =
            self.constraints.iter().map(|constraint| &constraint.contact).filter(|contact| contact.is_active());
        let mut pressed: Vec<u32> = active.flat_map(|contact| contact.points.weighted()).collect();
        pressed.sort_unstable();
        pressed.dedup();
        pressed.len()
    }
}
