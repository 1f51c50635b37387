//! Explicit dynamics of films that meet a rigid impactor or are pulled by jaws.
//!
//! [`Engine::step`] advances by one central-difference step: forces of the elements, kick and drift of the nodes,
//! contact, drift of the body (theory.md, section 4). Whoever wants signals or pictures brings an [`Observer`], which is
//! shown a read-only [`View`].

mod colouring;
mod contact;
mod disjoint;
mod element;
mod element_group;
mod energy;
mod failure;
mod film;
mod film_history;
mod footprint;
mod mount;
mod nodes;
mod observer;
mod patch;
mod pressure;
mod rigid_body;
mod section;
mod state;
mod sync;
mod thread_pool;
#[cfg(test)]
mod thread_pool_tests;
mod time_step;

pub use contact::{Contact, ContactState, Surface, SurfaceError};
pub use element::{ElementDetail, ElementEnergy, ElementStrain, StressFree, UndefinedFibreDirection};
pub use energy::Energies;
pub use film::Film;
use nodes::Kick;
pub use nodes::{Nodes, Vectors};
pub use observer::{Observer, Track, View};
pub use patch::Patch;
pub use pressure::Inflation;
pub use rigid_body::RigidBody;
pub use section::Section;
pub use state::{State, StateMismatch};
pub use thread_pool::ThreadPool;
use time_step::TimeStep;

use std::ops::Range;

use colouring::Colouring;
use disjoint::Disjoint;
use film::SharedFilm;
use nodes::Moved;
use pressure::Inflated;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Everything that moves, and how it is driven.
pub struct Engine {
    films: Vec<Film>,
    nodes: Nodes,
    impact: Option<Impact>,
    loads: Loads,
    time_step: TimeStep,
    time: f64,
    steps: u64,
    ledger: EnergyLedger,
    previous: PreviousStep,
    /// What pressure did last.
    inflated: Option<Inflated>,
    pool: ThreadPool,
    /// All chunks: film and number of the chunk in it.
    chunks: Vec<(usize, usize)>,
    /// Which of `chunks` share no node.
    colouring: Colouring,
    /// Nodes that are moved together, none of them on two faces.
    node_ranges: Vec<Range<usize>>,
    /// Elements that failed since [`Engine::step`] last returned.
    failed: usize,
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
pub struct Loads {
    /// m/s², downward.
    pub gravity: f64,
    /// Mass-proportional damping of the film, 1/s.
    pub damping: f64,
    /// Nodes moved at a prescribed velocity along x.
    pub jaws: Vec<Jaw>,
    /// Pressure on the lower side of the film, whose edge is held.
    pub inflation: Option<Inflation>,
    /// Mirror images that one computed part of film stands for.
    pub multiplicity: f64,
    /// Factor on the stable time step, 0 < factor ≤ 1.
    pub step_factor: f64,
}

impl Default for Loads {
    /// Nothing acts on a film that is computed whole.
    fn default() -> Loads {
        Loads { gravity: 0.0, damping: 0.0, jaws: vec![], inflation: None, multiplicity: 1.0, step_factor: 1.0 }
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

/// Nodes that one thread moves together.
const NODES_AT_ONCE: usize = 1024;

/// Energy that left the elements for good, J.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct EnergyLedger {
    rupture: f64,
    absorbed: f64,
    damping: f64,
    external: f64,
    /// Part of `external` that belongs to the half step after the full one.
    external_ahead: f64,
}

/// The full step that an observer wants to see, kept while the nodes move on.
#[derive(Default)]
struct PreviousStep {
    position: Vectors,
    force: Vectors,
    /// Half a step before it.
    velocity: Vectors,
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
    /// The observer ended the run.
    #[error("the observer ended the run")]
    Stopped,
}

impl Engine {
    /// An engine at rest at time zero, worked on by one thread; `impact` is the impactor, if any.
    ///
    /// # Panics
    /// Where `films` are not those that were mounted on `nodes`, in their order.
    pub fn new(films: Vec<Film>, nodes: Nodes, impact: Option<Impact>, loads: Loads) -> Engine {
        let ends = films.iter().map(|film| film.nodes.end);
        let begins = films.iter().map(|film| film.nodes.start).chain([nodes.mass.len()]);
        assert!(begins.eq(std::iter::once(0).chain(ends)), "films follow each other on their nodes");
        let (mut chunks, mut colours, mut chunk_nodes) = (vec![], vec![], vec![]);
        for (f, film) in films.iter().enumerate() {
            for (chunk, (colour, nodes)) in film.chunks().enumerate() {
                chunks.push((f, chunk));
                colours.push(colour);
                chunk_nodes.push(nodes);
            }
        }
        let colouring = Colouring::new(&colours, &chunk_nodes).expect("films colour their chunks");
        let cut = |Range { start, end }: Range<usize>| {
            (start..end).step_by(NODES_AT_ONCE).map(move |from| from..end.min(from + NODES_AT_ONCE))
        };
        let node_ranges = films.iter().flat_map(|film| cut(film.nodes.clone())).collect();
        let mut engine = Engine {
            films,
            nodes,
            impact,
            loads,
            time_step: TimeStep::default(),
            time: 0.0,
            steps: 0,
            ledger: EnergyLedger::default(),
            previous: PreviousStep::default(),
            inflated: None,
            pool: ThreadPool::new(1),
            chunks,
            colouring,
            node_ranges,
            failed: 0,
        };
        // The stiffness depends on history variables, which pre-strain changes.
        engine.forces(0.0);
        engine.nodes.forget_forces();
        engine.time_step = TimeStep::new(&engine.films, &engine.nodes, &engine.pool, &engine.loads);
        engine
    }

    /// The same engine worked on by `pool`: the bits of what comes out stay the same.
    pub fn with_pool(self, pool: ThreadPool) -> Engine {
        Engine { pool, ..self }
    }

    /// Who works on it.
    pub fn pool(&self) -> &ThreadPool {
        &self.pool
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

    /// Surface of the impactor.
    pub fn impactor(&self) -> Option<&Surface> {
        self.impact.as_ref().map(|impact| impact.contact.surface())
    }

    /// Bytes of all arrays that grow with the mesh: nodes, elements, contact, and the previous step stored for observers.
    /// Spare capacity does not count.
    pub fn bytes(&self) -> usize {
        let films: usize = self.films.iter().map(Film::bytes).sum();
        let contact = self.impact.as_ref().map_or(0, |impact| impact.contact.bytes());
        self.nodes.bytes() + self.previous.bytes() + films + contact
    }

    /// The present time step, s.
    pub fn time_step(&self) -> f64 {
        self.time_step.now()
    }

    /// Advances by one step. Returns the number of elements that failed in it.
    pub fn step(&mut self, observer: &mut dyn Observer) -> Result<usize, Fault> {
        let (last, dt) = self.time_step.next(&self.films, &self.nodes, &self.pool, self.time)?;
        let over = if self.steps == 0 { 0.5 * dt } else { 0.5 * (last + dt) };
        let wanted = observer.wants(self.time);
        self.forces(last);
        self.pull(dt, over);
        let jaw_force = self.jaw_force();
        if wanted {
            self.previous.keep(&self.nodes, self.impact.as_ref());
        }
        let fastest = self.advance(over, dt);
        if wanted {
            self.show(observer)?;
        }
        self.finish(dt, fastest, jaw_force, observer);
        Ok(std::mem::take(&mut self.failed))
    }

    /// Forces at the full step, where the nodes came in `dt` (s); elements past their break strain are deleted.
    fn forces(&mut self, dt: f64) {
        self.inflate();
        self.add_forces(dt);
        let mut failed = 0;
        for film in &mut self.films {
            let (count, held) = film.delete_failed(self.nodes.position.axes());
            self.ledger.rupture += self.loads.multiplicity * (held.stored + held.hourglass);
            self.ledger.absorbed += self.loads.multiplicity * held.absorbed;
            failed += count;
        }
        if failed > 0 {
            self.time_step.tear();
            self.impact.iter_mut().for_each(|impact| impact.contact.forget());
        }
        self.failed += failed;
    }

    /// Adds the load of the pressure, if there is one, and books its work.
    fn inflate(&mut self) {
        let Some(inflation) = &self.loads.inflation else { return };
        let now = pressure::inflate(&self.films, &mut self.nodes, inflation.at(self.time));
        self.ledger.external -= self.loads.multiplicity * now.work_since(self.inflated);
        self.inflated = Some(now);
    }

    /// Adds the films' forces to those of their nodes, which hold the load alone.
    fn add_forces(&mut self, dt: f64) {
        let position = self.nodes.position.axes();
        let mut rest = self.nodes.force.axes_mut();
        let mut films: Vec<SharedFilm<'_>> = Vec::with_capacity(self.films.len());
        for film in &mut self.films {
            let own = rest.each_mut().map(|axis| {
                let (own, others) = std::mem::take(axis).split_at_mut(film.nodes.len());
                *axis = others;
                own
            });
            films.push(film.share(own));
        }
        let width = self.pool.width();
        for colour in self.colouring.colours() {
            self.pool.each(colour.len(), |part| {
                let (film, chunk) = self.chunks[colour[part]];
                // SAFETY: the colouring holds each chunk once, and those of one colour share no node.
                unsafe { films[film].add_forces(width, chunk, position, dt) };
            });
        }
    }

    /// Work of the jaws against the film's forces; these act over the halves of the steps on both sides.
    fn pull(&mut self, dt: f64, kick: f64) {
        let power = |jaw: &Jaw| -self.nodes.pull(&jaw.nodes, 0) * jaw.velocity;
        let power = self.loads.multiplicity * self.loads.jaws.iter().map(power).sum::<f64>();
        self.ledger.external -= power * kick;
        self.ledger.external_ahead = -0.5 * power * dt;
    }

    /// Accelerates nodes and body over `over` (s), moves the nodes on by `dt` (s) and lets them meet the body. Returns the
    /// largest speed of a node, m/s.
    fn advance(&mut self, over: f64, dt: f64) -> f64 {
        let Engine { films, nodes, impact, .. } = self;
        let remembered = impact.as_mut().map(|Impact { body, contact }| contact.prepare(films, nodes, body));
        let kick = Kick::over(over, self.loads.damping);
        let moving = nodes.moving(kick, dt, self.loads.gravity, remembered);
        let (width, ranges) = (self.pool.width(), &self.node_ranges);
        let mut parts = vec![Moved::default(); ranges.len()];
        let answers = Disjoint::new(&mut parts);
        self.pool.each(ranges.len(), |part| {
            // SAFETY: every range comes up once.
            unsafe { *answers.at(part) = moving.advance(width, ranges[part].clone()) };
        });
        let mut moved = parts.iter().fold(Moved::default(), |all, part| all.and(part));
        let mut fastest = moved.fastest.sqrt();
        if let Some(Impact { body, contact }) = &mut self.impact {
            let before = body.clone();
            body.kick(over, self.loads.gravity);
            let damped = self.loads.damping > 0.0;
            if damped {
                contact.let_be(&self.nodes);
            }
            fastest = fastest.max(contact.meet(&mut self.nodes, body, &before, dt, &self.pool));
            if damped {
                moved.damped += contact.damped_on_the_way(&self.nodes);
            }
        }
        self.ledger.damping += self.loads.multiplicity * self.loads.damping * over * moved.damped;
        fastest
    }

    /// Shows the full step that was kept, with the velocities that follow it.
    fn show(&mut self, observer: &mut dyn Observer) -> Result<(), Fault> {
        self.exchange();
        let seen = observer.see(&self.view());
        self.exchange();
        seen
    }

    /// Exchanges places and forces of the nodes with those kept.
    fn exchange(&mut self) {
        std::mem::swap(&mut self.nodes.position, &mut self.previous.position);
        std::mem::swap(&mut self.nodes.force, &mut self.previous.force);
    }

    /// Moves the body on and tells where it is.
    fn finish(&mut self, dt: f64, fastest: f64, jaw_force: f64, observer: &mut dyn Observer) {
        let mut track = Track { time: self.time, dt, jaw_force, ..Track::default() };
        if let Some(Impact { body, contact }) = &mut self.impact {
            track.z = body.centre().z;
            track.velocity = body.velocity.z;
            track.work = contact.work.given;
            track.impulse = contact.work.impulse;
            let turning = body.spin.norm() * contact.surface().bounding_radius();
            contact.moved((fastest + body.velocity.norm() + turning) * dt);
            body.drift(dt);
        }
        observer.follow(&track);
        self.time += dt;
        self.steps += 1;
    }

    /// Mean pull of the film on the jaws along x, N, on the computed part of the film.
    fn jaw_force(&self) -> f64 {
        let pull = |jaw: &Jaw| -jaw.velocity.signum() * self.nodes.pull(&jaw.nodes, 0);
        let count = self.loads.jaws.len().max(1) as f64;
        self.loads.jaws.iter().map(pull).sum::<f64>() / count
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
            loads: &self.loads,
            ledger: self.ledger,
            previous: &self.previous,
            pool: &self.pool,
        }
    }
}

impl PreviousStep {
    /// Bytes of its arrays.
    fn bytes(&self) -> usize {
        self.position.bytes() + self.force.bytes() + self.velocity.bytes()
    }

    fn keep(&mut self, nodes: &Nodes, impact: Option<&Impact>) {
        self.position.clone_from(&nodes.position);
        self.force.clone_from(&nodes.force);
        self.velocity.clone_from(&nodes.velocity);
        self.body = impact.map(|impact| impact.body.clone());
    }
}
