//! Explicit dynamics of films under a rigid impactor, jaws or pressure.
//!
//! [`Engine::step`] advances by one central-difference step: forces of the elements, kick and drift of the nodes,
//! contact, drift of the body (theory.md, section 4). Signals and snapshots are taken by an [`Observer`], which is
//! shown a read-only [`View`].

mod adjacency;
mod clamp;
mod collision;
mod colouring;
mod constraint;
mod contact;
mod cushion;
mod disjoint;
mod element;
mod energy;
mod failure;
mod film;
mod film_contact;
mod guide_friction;
mod impact;
mod loads;
mod mount;
mod nodes;
mod observer;
mod pressure;
mod relaxation;
mod resolution;
mod rigid_body;
mod springs;
#[cfg(test)]
mod springs_tests;
mod state;
mod sync;
mod thread_pool;
#[cfg(test)]
mod thread_pool_tests;
#[cfg(test)]
mod tearing_tests;
mod time_step;
mod tips;

pub use clamp::{Clamp, ClampedNode};
pub use contact::{Contact, ContactState, Surface, SurfaceError};
pub use cushion::{Cushion, area};
pub use element::{ElementDetail, ElementEnergy, ElementStrain, StressFree, TooWide, Torn, UndefinedFibreDirection};
pub use energy::{Energies, EnergyTerm};
pub use failure::{Failures, Fault};
pub use film::{AddedMass, Film};
pub use film_contact::FilmContactState;
pub use guide_friction::GuideFriction;
pub use impact::Impact;
pub use loads::{Jaw, Loads};
pub use mount::{Mesh, Patch, Section};
pub use nodes::{Nodes, Vectors};
pub use observer::{BodyTrack, Observer, Track, Unobserved, View};
pub use pressure::{Filling, Inflation};
pub use relaxation::{Relaxation, Settling};
pub use rigid_body::{Freedom, RigidBody};
pub use springs::{Spring, SpringLoad, Springs, SpringsState};
pub use state::{State, StateMismatch};
pub use thread_pool::ThreadPool;
use time_step::TimeStep;
pub use time_step::add_mass;

use std::ops::Range;

use clamp::Clamping;
use colouring::Colouring;
use cushion::CushionState;
use disjoint::Disjoint;
use element::Forces;
use energy::EnergyLedger;
use film::Chunk;
use film_contact::FilmContact;
use nodes::{Kick, StepSums};
use observer::PreviousStep;
use pressure::{Enclosed, Gas};
use serde::{Deserialize, Serialize};

/// Films, nodes, impactors and loads, and their integration in time.
pub struct Engine {
    films: Vec<Film>,
    nodes: Nodes,
    impacts: Vec<Impact>,
    /// Contact between faces, where it is computed.
    film_contact: Option<FilmContact>,
    /// The frame's clamp, where film may slip in it.
    clamp: Option<Clamp>,
    /// The springs between film and frame, where it hangs on them.
    springs: Option<Springs>,
    loads: Loads,
    progress: Progress,
    previous: PreviousStep,
    /// Volume between the first two faces as mounted, up to the constant of [`Enclosed::volume`], m³.
    mounted_volume: f64,
    /// Volume under the last film as mounted, up to the constant of [`pressure::volume`], m³.
    flat_volume: f64,
    pool: ThreadPool,
    /// All chunks: film and index of the chunk in it.
    chunks: Vec<(usize, usize)>,
    /// Of `chunks`, which are added to their nodes colour by colour.
    colouring: Colouring,
    /// Ranges of nodes, each a task of one thread, with the film that they are of.
    node_ranges: Vec<(usize, Range<usize>)>,
    /// Elements that failed since [`Engine::step`] last returned.
    failed: usize,
}

/// What a run has come to, besides film, impactors and contact.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Progress {
    /// Of the full step, s.
    time: f64,
    /// Steps so far.
    steps: u64,
    time_step: TimeStep,
    ledger: EnergyLedger,
    /// Pressure and enclosed volume of the last step.
    inflated: Option<Gas>,
    /// Air between the first two faces in the last step.
    cushion: Option<CushionState>,
    /// Of the elements that started to tear the one that stored most of what its tear takes, where it stored more.
    too_wide: Option<TooWide>,
    /// Share of the work done on film around the tip of a tear that it would have returned where, for the first time, all work
    /// would have sufficed for the tear and that share did not.
    returned: Option<f64>,
}

/// Steps from one look at tips of tears where film stores little of the work done on it to the next.
const NOW_AND_THEN: u64 = 16;

/// Nodes of a range.
const NODES_PER_RANGE: usize = 1024;

impl Engine {
    /// An engine at time zero with one thread; `impacts` are the impactors, and after them the frame's bars if there
    /// are any.
    ///
    /// # Panics
    /// Where `films` are not those mounted on `nodes`, in their order.
    pub fn new(films: Vec<Film>, nodes: Nodes, impacts: impl IntoIterator<Item = Impact>, loads: Loads) -> Engine {
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
        let cut = |(f, film): (usize, &Film)| {
            let Range { start, end } = film.nodes;
            (start..end).step_by(NODES_PER_RANGE).map(move |from| (f, from..end.min(from + NODES_PER_RANGE)))
        };
        let node_ranges = films.iter().enumerate().flat_map(cut).collect();
        let mounted_volume = loads.cushion.map_or(0.0, |_| Enclosed::between(&films, &nodes).volume);
        let is_inflated = loads.inflation.is_some() || loads.filling.is_some();
        let flat_volume = if is_inflated { pressure::volume(&films, &nodes) } else { 0.0 };
        let mut impacts: Vec<Impact> = impacts.into_iter().collect();
        if impacts.len() > 1 {
            impacts = impacts.into_iter().map(Impact::beside_others).collect();
        }
        let mut engine = Engine {
            films,
            nodes,
            impacts,
            film_contact: None,
            clamp: None,
            springs: None,
            loads,
            progress: Progress::default(),
            previous: PreviousStep::default(),
            mounted_volume,
            flat_volume,
            pool: ThreadPool::new(1),
            chunks,
            colouring,
            node_ranges,
            failed: 0,
        };
        // The stiffness depends on history variables, which pre-strain changes.
        // With no time: viscous film is mounted by this pass, and no strain rate arises from the pre-strain.
        engine.forces(0.0);
        engine.nodes.clear_forces();
        engine.progress.time_step = engine.first_time_step();
        engine
    }

    /// This engine with `pool`, on which no result depends.
    pub fn with_pool(self, pool: ThreadPool) -> Engine {
        Engine { pool, ..self }
    }

    /// This engine with contact between its faces, with the coefficient `friction`.
    pub fn with_film_contact(mut self, friction: f64) -> Engine {
        self.film_contact(friction).meet_each_other();
        self
    }

    /// This engine with contact of each face, which has not moved since it was mounted, with itself, with the coefficient
    /// `friction`, which is also that between faces.
    pub fn with_self_contact(mut self, friction: f64) -> Engine {
        self.film_contact(friction);
        let Engine { films, nodes, film_contact, .. } = &mut self;
        film_contact.iter_mut().for_each(|contact| contact.meet_themselves(films, nodes));
        self
    }

    /// Contact of film with film, which is new where there was none.
    fn film_contact(&mut self, friction: f64) -> &mut FilmContact {
        let Engine { films, nodes, film_contact, loads, .. } = self;
        film_contact.get_or_insert_with(|| FilmContact::new(films, nodes, friction, loads.multiplicity))
    }

    /// This engine with film that slips in `clamp`, whose nodes are held in every direction.
    pub fn with_clamp(self, clamp: Clamp) -> Engine {
        Engine { clamp: Some(clamp), ..self }
    }

    /// This engine with film that hangs on `springs`, by nodes that nothing else holds.
    pub fn with_springs(self, springs: Springs) -> Engine {
        let mut engine = Engine { springs: Some(springs), ..self };
        engine.progress.time_step = engine.first_time_step();
        engine
    }

    /// The time step of the film at rest where it is, on its springs; reduced where elements failed as it was mounted.
    fn first_time_step(&self) -> TimeStep {
        let on_springs = self.springs.as_ref().map_or(0.0, |springs| springs.squared_frequency(&self.nodes));
        let mut step = TimeStep::new(&self.films, &self.nodes, &self.pool, &self.loads, on_springs);
        if self.progress.time_step.is_torn() {
            step.tear();
        }
        step
    }

    /// The time step that the film would have without the springs on which it hangs, s; none where it hangs on none.
    pub fn time_step_without_springs(&self) -> Option<f64> {
        self.springs.as_ref()?;
        Some(TimeStep::new(&self.films, &self.nodes, &self.pool, &self.loads, 0.0).now())
    }

    /// The frame's bars, where there are any.
    fn bars(&self) -> Option<&Impact> {
        self.impacts.last().filter(|impact| impact.is_frame)
    }

    /// Whether faces that have not moved since they were mounted or settled lie in the order in which they were
    /// mounted; also where their contact is not computed.
    pub fn has_faces_in_order(&mut self) -> bool {
        let Engine { films, nodes, film_contact, .. } = self;
        film_contact.as_mut().is_none_or(|contact| contact.find_in_order(films, nodes))
    }

    /// Its threads.
    pub fn pool(&self) -> &ThreadPool {
        &self.pool
    }

    /// Time of the full step, s.
    pub fn time(&self) -> f64 {
        self.progress.time
    }

    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.progress.steps
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.films.iter().map(Film::elements).sum()
    }

    /// Surfaces of the impactors, and after them that of the frame's bars.
    pub fn impactors(&self) -> impl Iterator<Item = &Surface> {
        self.impacts.iter().map(|impact| impact.contact.surface())
    }

    /// The present time step, s.
    pub fn time_step(&self) -> f64 {
        self.progress.time_step.now()
    }

    /// Advances by one step. Returns the number of elements that failed in it.
    pub fn step(&mut self, observer: &mut dyn Observer) -> Result<usize, Fault> {
        let (last, dt) = self.progress.time_step.next(&self.films, &self.nodes, &self.pool, self.progress.time)?;
        // Velocities stand half a step after positions (theory.md, equation 15); initial ones stand at the start.
        let over = if self.progress.steps == 0 { 0.5 * dt } else { 0.5 * (last + dt) };
        let observed = observer.needs_state(self.progress.time);
        self.release()?;
        // Over the step by which the nodes came here: rates of strain are those of the last step, not of the next.
        self.forces(last);
        self.fill(over, dt);
        self.add_jaw_work(dt, over);
        let jaw_force = self.jaw_force();
        if observed {
            // Energies of a full step need the velocities on both sides of it (theory.md, equation 23), so it is shown
            // after the kick.
            self.previous.store(&self.nodes, &self.impacts);
        }
        let fastest = self.advance(over, dt);
        if observed {
            self.show(observer)?;
        }
        self.finish(dt, fastest, jaw_force, observer);
        Ok(std::mem::take(&mut self.failed))
    }

    /// Forces at the full step, to which the nodes moved in `dt` (s); fibres past their break strain break.
    fn forces(&mut self, dt: f64) {
        self.inflate();
        self.press(dt);
        self.add_forces(dt);
        // What film returns at tips is only a finding: now and then, until it is one.
        let looks = self.progress.returned.is_none() && self.progress.steps.is_multiple_of(NOW_AND_THEN);
        let mut failures = Failures::default();
        for (face, film) in self.films.iter_mut().enumerate() {
            let of_film = film.fail(self.nodes.position.axes(), dt, looks);
            if let Some(cushion) = self.progress.cushion.as_mut().filter(|_| face < 2 && of_film.failed > 0) {
                cushion.is_open = true;
            }
            let energy = of_film.energy;
            self.progress.ledger.rupture += self.loads.multiplicity * (energy.stored + energy.hourglass);
            self.progress.ledger.absorbed += self.loads.multiplicity * energy.absorbed;
            failures.add(&of_film);
        }
        self.progress.too_wide = TooWide::worse(self.progress.too_wide, failures.too_wide);
        self.progress.returned = self.progress.returned.or(failures.returned);
        if failures.broken > 0 {
            self.progress.time_step.tear();
            self.impacts.iter_mut().for_each(|impact| impact.contact.invalidate_neighbours());
            self.film_contact.iter_mut().for_each(|contact| contact.remove_deleted(&self.films));
        }
        // Collected, as forces are also computed outside of a step.
        self.failed += failures.failed;
    }

    /// Adds the forces of the films and of the frame's springs to those of the nodes.
    fn add_forces(&mut self, dt: f64) {
        let position = self.nodes.position.axes();
        let forces = Forces::new(self.nodes.force.axes_mut());
        let films: Vec<Disjoint<'_, Chunk>> = self.films.iter_mut().map(Film::share).collect();
        let width = self.pool.width();
        // Colour after colour: chunks of one share no node, so each node is summed in one order for any number of
        // threads.
        for colour in self.colouring.colours() {
            self.pool.each(colour.len(), |part| {
                let (film, chunk) = self.chunks[colour[part]];
                // SAFETY: the colouring holds each chunk once, and those of one colour share no node; it counts the nodes of
                // all films.
                let (chunk, force) = unsafe { (films[film].entry(chunk), forces.own()) };
                chunk.add_forces(width, &position, dt, force);
            });
        }
        if let Some(springs) = &mut self.springs {
            springs.add_forces(&mut self.nodes);
        }
    }

    /// Adds the work of the jaws against the forces of the film to the ledger; these act over the halves of both
    /// adjacent steps.
    fn add_jaw_work(&mut self, dt: f64, kick: f64) {
        let power = |jaw: &Jaw| -self.nodes.total_force(&jaw.nodes, 0) * jaw.velocity;
        let power = self.loads.multiplicity * self.loads.jaws.iter().map(power).sum::<f64>();
        self.progress.ledger.external.add([-power * (kick - 0.5 * dt), -power * 0.5 * dt]);
    }

    /// Kicks nodes and bodies over `over` (s), moves the nodes by `dt` (s) and resolves their contact with the bodies
    /// and with each other. Returns the largest speed of a node, m/s.
    fn advance(&mut self, over: f64, dt: f64) -> f64 {
        // From the forces before they are used up by the integration below.
        let clamping = self.predict_clamp(over, dt);
        let Engine { films, nodes, impacts, film_contact, .. } = self;
        if let Some(contact) = film_contact {
            contact.prepare(films, nodes);
        }
        // Lists must be built before the nodes move: each records the velocities that its contact will need.
        let released = impacts.iter_mut().filter(|impact| !impact.is_held());
        let records = released.map(|Impact { body, contact, .. }| contact.prepare(films, nodes, body)).collect();
        let earlier = (self.loads.damping > 0.0).then(|| nodes.velocity.clone());
        let kick = Kick::new(over, self.loads.damping);
        let integration = nodes.integration(kick, dt, records);
        let (width, ranges) = (self.pool.width(), &self.node_ranges);
        let (films, loads) = (&*films, &self.loads);
        let mut parts = vec![StepSums::default(); ranges.len()];
        let sums_of = Disjoint::new(&mut parts);
        self.pool.each(ranges.len(), |part| {
            let (film, range) = &ranges[part];
            // SAFETY: every range comes up once.
            unsafe {
                *sums_of.entry(part) = integration.advance(width, range.clone(), loads.film_gravity(&films[*film]));
            };
        });
        // A slot a range, added in order: sums over threads as they finish would differ from run to run.
        let mut sums = parts.iter().fold(StepSums::default(), |all, part| all.and(part));
        if self.clamp.as_mut().is_some_and(|clamp| clamp.advance(&mut self.nodes)) {
            // Film that nothing holds any more snaps back as torn film does.
            self.progress.time_step.tear();
        }
        let fastest = sums.largest_speed_squared.max(clamping.fastest_squared).sqrt();
        let fastest = fastest.max(self.resolve_contact([over, dt], earlier.as_ref(), &mut sums));
        self.film_contact.iter_mut().for_each(|contact| contact.reduce_margin(fastest * dt));
        let half = 0.5 * self.loads.multiplicity * self.loads.damping * over * sums.damped;
        // Evenly, which is off by the second order of the step at a full one, and by nothing in the sum.
        self.progress.ledger.damping.add([half, half]);
        fastest
    }

    /// Finds how film moves in the clamp, and adds what is dissipated there to the ledger.
    fn predict_clamp(&mut self, over: f64, dt: f64) -> Clamping {
        let Some(mut clamp) = self.clamp.take() else { return Clamping::default() };
        let clamping = clamp.predict(&self.nodes, self.bars(), &|node| self.gravity_at(node), [over, dt]);
        self.clamp = Some(clamp);
        self.progress.ledger.clamp.add(clamping.loss);
        clamping
    }

    /// Acceleration of a node that is free, m/s², downward.
    fn gravity_at(&self, node: usize) -> f64 {
        let film = self.films.iter().find(|film| film.nodes.contains(&node));
        film.map_or(0.0, |film| self.loads.film_gravity(film))
    }

    /// Shows the stored full step, with the velocities that follow it.
    fn show(&mut self, observer: &mut dyn Observer) -> Result<(), Fault> {
        self.exchange();
        let result = observer.observe(&self.view());
        self.exchange();
        result
    }

    /// Exchanges positions and forces of the nodes with the stored ones.
    fn exchange(&mut self) {
        std::mem::swap(&mut self.nodes.position, &mut self.previous.position);
        std::mem::swap(&mut self.nodes.force, &mut self.previous.force);
    }

    /// Moves the bodies and reports their tracks.
    fn finish(&mut self, dt: f64, fastest: f64, jaw_force: f64, observer: &mut dyn Observer) {
        let bodies = self.track_bodies();
        self.drift_bodies(dt, fastest);
        let (bodies, frame) = match bodies.split_last() {
            Some((frame, impactors)) if self.bars().is_some() => (impactors, Some(*frame)),
            _ => (bodies.as_slice(), None),
        };
        let track = Track { time: self.progress.time, dt, bodies, frame, jaw_force };
        observer.track(&track);
        self.progress.time += dt;
        self.progress.steps += 1;
    }

    /// Mean force of the computed part of film on the jaws along x, N.
    fn jaw_force(&self) -> f64 {
        let force = |jaw: &Jaw| -jaw.velocity.signum() * self.nodes.total_force(&jaw.nodes, 0);
        let count = self.loads.jaws.len().max(1) as f64;
        self.loads.jaws.iter().map(force).sum::<f64>() / count
    }

    /// The state that observers see.
    fn view(&self) -> View<'_> {
        View {
            time: self.progress.time,
            steps: self.progress.steps,
            films: &self.films,
            nodes: &self.nodes,
            too_wide: self.progress.too_wide,
            returned: self.progress.returned,
            engine: self,
        }
    }
}
