//! Explicit dynamics of films that meet a rigid impactor or are pulled by jaws.
//!
//! [`Engine::step`] advances by one central-difference step: forces of the elements, kick, contact, drift
//! (theory.md, section 4). Whoever wants signals or pictures brings an [`Observer`], which is shown a read-only [`View`].

mod contact;
mod element;
mod energy;
mod failure;
mod film;
mod nodes;
mod observer;
mod rigid_body;
mod time_step;

use contact::Kicked;
pub use contact::{Contact, Inspection, Surface, SurfaceError};
pub use element::UprightElement;
pub use energy::Energies;
pub use film::{ElementStrain, Film};
pub use nodes::Nodes;
pub use observer::{Observer, Track, View};
pub use rigid_body::RigidBody;
pub use time_step::TimeStep;

use rayon::prelude::*;
use thiserror::Error;

/// Everything that moves, and how it is driven.
pub struct Engine {
    films: Vec<Film>,
    nodes: Nodes,
    impact: Option<Impact>,
    drive: Drive,
    time_step: TimeStep,
    time: f64,
    steps: u64,
    gone: Gone,
    before: Before,
    /// Elements that broke and were not told yet.
    broken: usize,
}

/// The impactor and its contact.
pub struct Impact {
    /// The impactor.
    pub body: RigidBody,
    /// Its contact with the film.
    pub contact: Contact,
}

/// What acts besides contact.
#[derive(Clone, Debug)]
pub struct Drive {
    /// m/s², downward.
    pub gravity: f64,
    /// Mass-proportional damping of the film, 1/s.
    pub damping: f64,
    /// Nodes moved at a prescribed velocity along x.
    pub jaws: Vec<Jaw>,
    /// Mirror images that one computed part of film stands for.
    pub multiplicity: f64,
    /// Factor on the stable time step, 0 < factor ≤ 1.
    pub step_factor: f64,
}

impl Default for Drive {
    /// Nothing acts on a film that is computed whole.
    fn default() -> Drive {
        Drive { gravity: 0.0, damping: 0.0, jaws: vec![], multiplicity: 1.0, step_factor: 1.0 }
    }
}

/// Nodes that are moved together at their initial velocity, held across it.
#[derive(Clone, Debug)]
pub struct Jaw {
    /// Its nodes.
    pub nodes: Vec<u32>,
    /// Along x, m/s.
    pub velocity: f64,
}

/// Elements from which faces are worked on in parallel: below, waking a thread costs what it saves.
const PARALLEL_FROM: usize = 5_000;

/// Energy that left the elements for good, J.
#[derive(Clone, Copy, Debug, Default)]
struct Gone {
    rupture: f64,
    absorbed: f64,
    damping: f64,
    external: f64,
    /// Part of `external` that belongs to the half step after the full one.
    external_ahead: f64,
}

/// Velocities half a step ago, kept where an observer wants energies.
#[derive(Default)]
struct Before {
    velocity: Vec<[f64; 3]>,
    body: Option<RigidBody>,
}

/// Why a run cannot go on.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    #[error("the motion of the impactor is not a number any more at {time:.6} s")]
    ImpactorLost { time: f64 },
    #[error("element {element} of face {face} is not a number any more at {time:.6} s")]
    NotANumber { time: f64, face: usize, element: usize },
    #[error("the time step fell from {first:.3e} s to {now:.3e} s at {time:.6} s, limited by face {face}")]
    TimeStepCollapsed { time: f64, first: f64, now: f64, face: usize },
    #[error("the energy balance is off by {:.1} % of the energy exchanged at {time:.6} s", 100.0 * .error)]
    EnergyLost { time: f64, error: f64 },
}

impl Engine {
    /// An engine at rest at time zero; `impact` is the impactor, if any.
    pub fn new(films: Vec<Film>, nodes: Nodes, impact: Option<Impact>, drive: Drive) -> Engine {
        let mut engine = Engine {
            films,
            nodes,
            impact,
            drive,
            time_step: TimeStep::default(),
            time: 0.0,
            steps: 0,
            gone: Gone::default(),
            before: Before::default(),
            broken: 0,
        };
        // Pre-strain has to be in the laws' memory before anyone asks how stiff the film is.
        engine.forces();
        engine.time_step = TimeStep::new(&engine.films, &engine.nodes, &engine.drive);
        engine
    }

    /// s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.films.iter().map(Film::elements).sum()
    }

    /// The present time step, s.
    pub fn time_step(&self) -> f64 {
        self.time_step.now()
    }

    /// Advances by one step. Returns the number of elements that broke in it.
    pub fn step(&mut self, observer: &mut dyn Observer) -> Result<usize, Fault> {
        let (last, dt) = self.time_step.next(&self.films, &self.nodes, self.time)?;
        let kick = if self.steps == 0 { 0.5 * dt } else { 0.5 * (last + dt) };
        let wanted = observer.wants(self.time);
        self.forces();
        if wanted {
            self.before.velocity.clone_from(&self.nodes.velocity);
            self.before.body = self.impact.as_ref().map(|i| i.body.clone());
        }
        self.pull(dt, kick);
        self.kick(kick);
        self.meet(dt, kick);
        if wanted {
            observer.see(&self.view())?;
        }
        self.drift(dt, observer);
        Ok(std::mem::take(&mut self.broken))
    }

    /// Forces at the full step; elements past their break strain lose theirs from the next step on.
    fn forces(&mut self) {
        self.nodes.start_forces(self.drive.gravity);
        let past = self.add_forces();
        let mut broken = 0;
        for (film, _) in self.films.iter_mut().zip(past).filter(|(_, past)| *past) {
            let (count, held) = film.break_elements(&self.nodes.position);
            self.gone.rupture += self.drive.multiplicity * (held.stored + held.hourglass);
            self.gone.absorbed += self.drive.multiplicity * held.absorbed;
            broken += count;
        }
        if broken > 0 {
            self.time_step.tear();
            self.impact.iter_mut().for_each(|impact| impact.contact.forget());
        }
        self.broken += broken;
    }

    /// Adds the films' forces; tells which of them have a fibre past its break strain. Faces share no node, so they are
    /// worked on at the same time where they are large enough to be worth it.
    fn add_forces(&mut self) -> Vec<bool> {
        let elements = self.elements();
        let (position, mut rest) = (&self.nodes.position, self.nodes.force.as_mut_slice());
        let mut own = |film: &Film| {
            let (own, others) = std::mem::take(&mut rest).split_at_mut(film.nodes.len());
            rest = others;
            own
        };
        if elements < PARALLEL_FROM {
            return self.films.iter_mut().map(|film| film.add_forces(position, own(film))).collect();
        }
        let faces: Vec<_> = self.films.iter_mut().map(|film| (own(film), film)).collect();
        faces.into_par_iter().map(|(force, film)| film.add_forces(position, force)).collect()
    }

    /// Work of the jaws against the film's forces; these act over the halves of the steps on both sides.
    fn pull(&mut self, dt: f64, kick: f64) {
        let power = |jaw: &Jaw| -self.nodes.pull(&jaw.nodes) * jaw.velocity;
        let power = self.drive.multiplicity * self.drive.jaws.iter().map(power).sum::<f64>();
        self.gone.external -= power * kick;
        self.gone.external_ahead = -0.5 * power * dt;
    }

    /// Accelerates the nodes; books what damping takes.
    fn kick(&mut self, kick: f64) {
        let damping = self.drive.damping;
        if damping == 0.0 {
            return self.nodes.kick(kick, 0.0);
        }
        let earlier = self.nodes.velocity.clone();
        self.nodes.kick(kick, damping);
        let mut lost = 0.0;
        for n in 0..earlier.len() {
            for axis in 0..3 {
                if self.nodes.inverse_mass[n][axis] > 0.0 {
                    let mean = 0.5 * (earlier[n][axis] + self.nodes.velocity[n][axis]);
                    lost += damping * self.nodes.mass[n] * mean * mean * kick;
                }
            }
        }
        self.gone.damping += self.drive.multiplicity * lost;
    }

    fn meet(&mut self, dt: f64, kick: f64) {
        if let Some(Impact { body, contact }) = &mut self.impact {
            let before = body.clone();
            body.kick(kick, self.drive.gravity);
            let (keep, gain) = Nodes::damped(kick, self.drive.damping);
            contact.meet(&self.films, &mut self.nodes, body, &Kicked { before: &before, keep, gain }, dt);
        }
    }

    fn drift(&mut self, dt: f64, observer: &mut dyn Observer) {
        let mut track = Track { time: self.time, dt, jaw_force: self.jaw_force(), ..Track::default() };
        let fastest = self.nodes.drift(dt);
        if let Some(Impact { body, contact }) = &mut self.impact {
            track.z = body.centre().z;
            track.velocity = body.velocity.z;
            track.work = contact.work.given;
            track.impulse = contact.work.impulse;
            let turning = body.spin.norm() * contact.surface().reach();
            contact.moved((fastest + body.velocity.norm() + turning) * dt);
            body.drift(dt);
        }
        observer.follow(&track);
        self.time += dt;
        self.steps += 1;
    }

    /// Mean pull of the film on the jaws along x, N, on the computed part of the film.
    fn jaw_force(&self) -> f64 {
        let pull = |jaw: &Jaw| -jaw.velocity.signum() * self.nodes.pull(&jaw.nodes);
        let count = self.drive.jaws.len().max(1) as f64;
        self.drive.jaws.iter().map(pull).sum::<f64>() / count
    }

    fn view(&self) -> View<'_> {
        let impact = self.impact.as_ref();
        let (body, contact) = (impact.map(|i| &i.body), impact.map(|i| &i.contact));
        View {
            time: self.time,
            steps: self.steps,
            films: &self.films,
            nodes: &self.nodes,
            body,
            contact,
            drive: &self.drive,
            gone: self.gone,
            before: &self.before,
        }
    }
}
