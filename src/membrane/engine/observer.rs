//! Observers of a run and the state that they are shown.

use super::film_contact::FilmContactState;
use super::impact::Impact;
use super::nodes::{Nodes, Vectors};
use super::rigid_body::RigidBody;
use super::springs::Springs;
use super::{ContactState, ElementStrain, Engine, Fault, Film, TooWide, Torn, film};

/// Follows a run without changing it.
pub trait Observer {
    /// Whether it needs the state at the full step at `time` (s).
    fn needs_state(&self, time: f64) -> bool;
    /// Is shown the state at that step.
    ///
    /// # Errors
    /// A [`Fault`] ends the run.
    fn observe(&mut self, view: &View<'_>) -> Result<(), Fault>;
    /// Is shown impactors and jaws at every step.
    fn track(&mut self, _track: &Track<'_>) {}
}

/// An observer that needs no state.
#[derive(Clone, Copy, Debug)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn needs_state(&self, _: f64) -> bool {
        false
    }

    fn observe(&mut self, _: &View<'_>) -> Result<(), Fault> {
        Ok(())
    }
}

/// Shows every state to a function.
struct Reading<F>(F);

impl<F: FnMut(&View<'_>)> Observer for Reading<F> {
    fn needs_state(&self, _: f64) -> bool {
        true
    }

    fn observe(&mut self, view: &View<'_>) -> Result<(), Fault> {
        (self.0)(view);
        Ok(())
    }
}

impl Engine {
    /// Advances by one step. Returns what `read` returns for its state.
    ///
    /// # Errors
    /// A [`Fault`] of the step.
    ///
    /// # Panics
    /// Never: a step shows its state to an observer that needs it.
    pub fn read_step<T>(&mut self, mut read: impl FnMut(&View<'_>) -> T) -> Result<T, Fault> {
        let mut result = None;
        self.step(&mut Reading(|view: &View<'_>| result = Some(read(view))))?;
        Ok(result.expect("a step shows its state"))
    }
}

/// The impactors and the jaws at one step.
#[derive(Clone, Copy, Debug)]
pub struct Track<'a> {
    /// Full step, s.
    pub time: f64,
    /// The step after it, s.
    pub dt: f64,
    /// The impactors.
    pub bodies: &'a [BodyTrack],
    /// The frame's bars, where there are any.
    pub frame: Option<BodyTrack>,
    /// Force of the film on the jaws, mean over all of them, N; zero where there is none.
    pub jaw_force: f64,
}

/// An impactor at one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyTrack {
    /// Centre of mass at the full step, m.
    pub centre: [f64; 3],
    /// Its velocity in the middle of the step after it, m/s; while it is held, that with which it is released.
    pub velocity: [f64; 3],
    /// Kinetic energy there of its motion besides that along z, J; zero where its motion is prescribed.
    pub lateral_energy: f64,
    /// Work of the impactor on the film so far, J.
    pub work: f64,
    /// Impulse of the film on the impactor along z so far, N s.
    pub impulse: f64,
    /// Impulse of other impactors and of the frame's bars on it along z so far, N s.
    pub collision: f64,
    /// Whether it meets the frame's bars in this step.
    pub meets_frame: bool,
}

/// The state at a full step, read-only.
pub struct View<'a> {
    /// Time of the full step, s.
    pub time: f64,
    /// Steps so far.
    pub steps: u64,
    /// Faces of film.
    pub films: &'a [Film],
    /// Nodes: positions and forces at `time`, velocities half a step after it.
    pub nodes: &'a Nodes,
    /// Of the elements that started to tear the one that stored most of what its tear takes, where it stored more.
    pub too_wide: Option<TooWide>,
    /// Share of the work done on film around the tip of a tear that it would have returned where, for the first time, all work
    /// would have sufficed for the tear and that share did not.
    pub returned: Option<f64>,
    pub(super) engine: &'a Engine,
}

impl View<'_> {
    /// Strains of every element of each face, quads first, into `out`.
    pub fn strains(&self, out: &mut Vec<Vec<ElementStrain>>) {
        film::strains(self.films, &self.engine.pool, self.nodes.position.axes(), out);
    }

    /// Velocity of a node at this step, m/s: the mean of those half a step before and after.
    pub fn velocity(&self, node: usize) -> [f64; 3] {
        let (before, after) = (self.engine.previous.velocity.value_at(node), self.nodes.velocity.value_at(node));
        // At the start it is known itself.
        if self.steps == 0 { before } else { [0, 1, 2].map(|axis| 0.5 * (before[axis] + after[axis])) }
    }

    /// Pressure of the air between the first two faces over that of the surroundings, Pa; none where it is not
    /// computed.
    pub fn cushion_pressure(&self) -> Option<f64> {
        self.engine.progress.cushion.map(|cushion| cushion.gas.pressure)
    }

    /// Pressure under the last film (Pa) and the volume between it and where it was mounted, of the whole film (m³);
    /// none where it is not inflated.
    pub fn inflated(&self) -> Option<[f64; 2]> {
        let Engine { progress, flat_volume, loads, .. } = self.engine;
        progress.inflated.map(|now| [now.pressure, loads.multiplicity * (now.volume - flat_volume)])
    }

    /// State of contact between faces, where it is computed.
    pub fn film_contact_state(&self) -> Option<FilmContactState> {
        Some(self.engine.film_contact.as_ref()?.state(self.nodes, &self.engine.pool))
    }

    /// Largest slip in the frame's clamp (m) and the share of its force that holds film no longer, where film may slip.
    pub fn clamp_slip(&self) -> Option<[f64; 2]> {
        self.engine.clamp.as_ref().map(|clamp| [clamp.slip(self.nodes), clamp.gone()])
    }

    /// The frame's springs, where film hangs on them.
    pub fn springs(&self) -> Option<&Springs> {
        self.engine.springs.as_ref()
    }

    /// Tears of the whole film so far; none where no face has a rupture criterion of its own.
    pub fn torn(&self) -> Option<Torn> {
        let mut total = Torn::default();
        for film in self.films.iter().filter(|film| film.has_rupture()) {
            total.add(&film.torn());
        }
        let copies = self.engine.loads.multiplicity;
        let whole = Torn { length: copies * total.length, area: copies * total.area, energy: copies * total.energy };
        self.films.iter().any(Film::has_rupture).then_some(whole)
    }

    /// The impactors, and after them the frame's bars, their velocities half a step after `time`.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = &RigidBody> {
        self.engine.impacts.iter().map(|impact| &impact.body)
    }

    /// State of contact of each impactor, and after them of the frame's bars, and half the smallest extent of each, m;
    /// the radius of bars.
    pub fn contact_states(&self) -> impl Iterator<Item = (ContactState, f64)> {
        let state =
            |Impact { body, contact, .. }: &Impact| (contact.state(self.nodes, &body.pose), contact.surface().size());
        self.engine.impacts.iter().map(state)
    }

    /// Nodes in contact with an impactor or the frame's bars in this step.
    pub fn nodes_in_contact(&self) -> Vec<usize> {
        let mut nodes: Vec<usize> =
            self.engine.impacts.iter().flat_map(|impact| impact.contact.nodes_in_contact()).collect();
        if self.engine.impacts.len() > 1 {
            nodes.sort_unstable();
            nodes.dedup();
        }
        nodes
    }
}

/// State of the full step, stored for an observer while the nodes move on.
#[derive(Default)]
pub(super) struct PreviousStep {
    pub(super) position: Vectors,
    pub(super) force: Vectors,
    /// Half a step before the full one.
    pub(super) velocity: Vectors,
    pub(super) bodies: Vec<RigidBody>,
}

impl PreviousStep {
    /// Stores the present state.
    pub(super) fn store(&mut self, nodes: &Nodes, impacts: &[Impact]) {
        self.position.clone_from(&nodes.position);
        self.force.clone_from(&nodes.force);
        self.velocity.clone_from(&nodes.velocity);
        self.bodies.clear();
        self.bodies.extend(impacts.iter().map(|impact| impact.body.clone()));
    }
}
