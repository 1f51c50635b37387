//! One run: from a checked model to its outcome.

mod build;
mod energy_check;
mod fault;
mod frame;
mod loading;
mod monitor;
mod mount;
mod outcome;
mod probe;
mod pull;
mod rows;
mod springs;
mod tracks;
mod warning;

use std::time::{Duration, Instant};

use mount::Mounting;
use probe::{Probe, Record};
use serde::{Deserialize, Serialize};

use crate::model::{Hold, Model};
pub use base::cancellation::Cancellation;
pub use energy_check::{RateHistogram, energy_columns};
pub use fault::{Failure, Fault, Refusal, RunError, check};
use lab::signal::Recording;
pub use loading::ends_loaded;
pub use membrane::engine::EnergyTerm;
use membrane::engine::{self, Engine, Relaxation, Settling, State, StateMismatch, Surface, ThreadPool};
use membrane::lane::Width;
pub use mount::{rigid_body, section, surface};
pub use outcome::{Detail, FaceMotion, FaceState, Film, FilmSpring, FilmState, Image, Outcome, Snapshot, SpringDetail};
pub use pull::{Across, PullError, pull, pull_along, section_between_jaws};
pub use springs::SpringStep;
pub use warning::{BREAK_STRAIN_OF_COUPONS, BodySize, COARSE_CONTACT, CODES, FRAME_HIT, ImpactorName, Warning};

/// Progress of a run.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Simulated so far, s.
    pub time: f64,
    /// Simulated time of the whole run, s.
    pub duration: f64,
    /// Steps so far.
    pub steps: u64,
    /// The present time step, s.
    pub time_step: f64,
    /// Number of elements.
    pub elements: usize,
    /// While the film is brought to equilibrium before its first step: how far it is.
    pub settling: Option<Settling>,
}

/// Element steps between two reports of progress: about a millisecond.
const REPORT_AFTER: usize = 30_000;

/// Simulates `model`; `progress` is called every few steps.
///
/// # Errors
/// Film or impactor cannot be meshed or mounted, or the run fails numerically.
pub fn run(model: &Model, progress: &mut dyn FnMut(Progress)) -> Result<Outcome, RunError> {
    run_with(model, RunOptions::default(), progress)
}

/// Options of a run that its model does not hold. None changes a bit of the outcome apart from its wall time and the
/// detail of its snapshots.
#[derive(Default)]
pub struct RunOptions<'a> {
    /// Where an interrupted run resumes.
    pub restart: Option<Restart>,
    /// When checkpoints are taken; never if left out.
    pub checkpoints: Option<Checkpoints<'a>>,
    /// Its threads; left out, their number follows from the elements and the processor.
    pub pool: Option<ThreadPool>,
    /// Its vector instructions; left out, those of its pool, which are the widest that the processor has.
    pub width: Option<Width>,
    /// Ends the run early, without an outcome.
    pub cancellation: Cancellation,
    /// Called with every snapshot as soon as it is taken.
    pub on_snapshot: Option<&'a mut dyn FnMut(&SnapshotEvent<'_>)>,
    /// Whether snapshots have their [`Detail`]; of a very fine mesh fewer fit into memory.
    pub detailed: bool,
}

/// A run up to a snapshot that was just taken.
#[derive(Clone, Copy)]
pub struct SnapshotEvent<'a> {
    /// Topology of the films, one entry a face.
    pub films: &'a [Film],
    /// Surfaces of the impactors, and after them that of the frame's bars.
    pub impactors: &'a [Surface],
    /// The snapshot.
    pub snapshot: &'a Snapshot,
    /// Channels of `signals.csv` so far, without the filtered one.
    pub signals: &'a Recording,
    /// The energy audit so far.
    pub energies: &'a Recording,
}

/// The engine of a run before its first step.
///
/// # Errors
/// Film or impactor cannot be meshed.
pub fn engine(model: &Model) -> Result<Engine, RunError> {
    Ok(build::scene(model)?.engine)
}

/// Simulates `model` as [`run`] does, with options.
///
/// # Errors
/// As [`run`]; also a checkpoint of another scene, and [`RunError::Cancelled`].
pub fn run_with(
    model: &Model,
    options: RunOptions<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, RunError> {
    let RunOptions { restart, mut checkpoints, pool, width, cancellation, on_snapshot, detailed } = options;
    let begin = Instant::now();
    let mut scene = build::scene(model)?;
    let pool = pool.unwrap_or_else(|| build::pool(scene.engine.elements()));
    let pool = match width {
        Some(width) => pool.at_width(width),
        None => pool,
    };
    let mut engine = scene.engine.with_pool(pool);
    let mut probe = Probe::new(model, &scene.mounting, detailed);
    let mut before = Duration::ZERO;
    let mut settled = Ok(());
    if let Some(restart) = restart {
        before = restart.wall;
        restart.restore(&mut engine, &mut probe)?;
    } else {
        settled = settle(model, &mut engine, progress, &cancellation).map(|relaxation| {
            probe.record_relaxation(relaxation);
            let took_steps = relaxation.is_some_and(|relaxation| relaxation.steps > 0);
            // Equilibrium of a fine mesh takes longer than its test: a run that resumes does not repeat it.
            if let Some(checkpoints) = checkpoints.as_mut().filter(|_| took_steps && !cancellation.is_cancelled()) {
                (checkpoints.write)(&Checkpoint::capture(&engine, &probe, begin.elapsed()));
            }
        });
    }
    if cancellation.is_cancelled() {
        return Err(RunError::Cancelled);
    }
    if engine.steps() == 0 && settled.is_ok() && !engine.has_faces_in_order() {
        let hint = "mount them further apart, or leave contact between them out with `contact.film = false`";
        return Err(RunError::at_key("contact", "two faces pass through each other before the test", hint));
    }
    let lifted = scene.mounting.bodies.iter_mut().filter(|body| body.in_contact);
    lifted.for_each(|body| body.start += probe.lift());
    if let Some(overlap) = engine.overlap_of_impactors(|_| true).filter(|_| engine.steps() == 0) {
        return Err(RunError::of_overlap(model, overlap));
    }
    let wall = || before + begin.elapsed();
    let mut events = SnapshotEvents { on_snapshot, mounting: &scene.mounting, reported: 0 };
    let stepped = settled
        .and_then(|()| advance(&mut engine, &mut probe, checkpoints, progress, &wall, &cancellation, &mut events));
    if cancellation.is_cancelled() {
        return Err(RunError::Cancelled);
    }
    let fault = match stepped {
        Ok(()) | Err(engine::Fault::Stopped) => probe.fault(),
        Err(fault) => Some(Fault::of_engine(fault, model)),
    };
    let outcome = probe.finish(&engine, scene.mounting, wall());
    match fault {
        None => Ok(outcome),
        Some(cause) => Err(RunError::Failure(Box::new(Failure { cause, so_far: outcome }))),
    }
}

/// Brings the film to equilibrium before its first step, unless nothing holds it or its model leaves that out.
fn settle(
    model: &Model,
    engine: &mut Engine,
    progress: &mut dyn FnMut(Progress),
    cancellation: &Cancellation,
) -> Result<Option<Relaxation>, engine::Fault> {
    if model.frame.hold == Hold::None {
        return Ok(None);
    }
    let wanted: Vec<bool> = model.faces.iter().map(|face| face.settle).collect();
    let (elements, time_step, duration) = (engine.elements(), engine.time_step(), model.run_time());
    let stride = stride(elements);
    let proceed = |settling: Settling| {
        if settling.steps.is_multiple_of(stride) {
            progress(Progress { time: 0.0, duration, steps: 0, time_step, elements, settling: Some(settling) });
        }
        !cancellation.is_cancelled()
    };
    engine.relax(&wanted, proceed).map(Some)
}

/// Steps of so many elements between two reports of progress.
fn stride(elements: usize) -> u64 {
    (REPORT_AFTER / elements.max(1)).max(1) as u64
}

/// Reports snapshots to [`RunOptions::on_snapshot`].
struct SnapshotEvents<'a, 'm> {
    on_snapshot: Option<&'a mut dyn FnMut(&SnapshotEvent<'_>)>,
    mounting: &'m Mounting,
    /// Snapshots reported so far.
    reported: usize,
}

impl SnapshotEvents<'_, '_> {
    /// Reports the snapshots taken since the last call.
    fn report(&mut self, probe: &Probe<'_>, engine: &Engine) {
        let new = &probe.snapshots()[self.reported..];
        let Some(on_snapshot) = self.on_snapshot.as_mut().filter(|_| !new.is_empty()) else { return };
        let (signals, energies) = (probe.signals(self.mounting), probe.energies());
        let impactors: Vec<Surface> = engine.impactors().cloned().collect();
        for snapshot in new {
            let films = &self.mounting.films;
            let (impactors, signals, energies) = (&impactors, &signals, &energies);
            on_snapshot(&SnapshotEvent { films, impactors, snapshot, signals, energies });
        }
        self.reported = probe.snapshots().len();
    }
}

fn advance(
    engine: &mut Engine,
    probe: &mut Probe<'_>,
    mut checkpoints: Option<Checkpoints<'_>>,
    progress: &mut dyn FnMut(Progress),
    wall: &dyn Fn() -> Duration,
    cancellation: &Cancellation,
    events: &mut SnapshotEvents<'_, '_>,
) -> Result<(), engine::Fault> {
    let elements = engine.elements();
    let stride = stride(elements);
    let after = |time: f64, every: f64| ((time / every).floor() + 1.0) * every;
    let mut due = checkpoints.as_ref().map_or(f64::INFINITY, |c| after(engine.time(), c.every));
    while !probe.is_done(engine.time()) && !cancellation.is_cancelled() {
        if let Some(checkpoints) = checkpoints.as_mut().filter(|_| engine.time() >= due) {
            (checkpoints.write)(&Checkpoint::capture(engine, probe, wall()));
            due = after(engine.time(), checkpoints.every);
        }
        let time = engine.time();
        if engine.step(probe)? > 0 {
            probe.record_rupture(time);
        }
        events.report(probe, engine);
        if engine.steps().is_multiple_of(stride) {
            let (time, steps, time_step) = (engine.time(), engine.steps(), engine.time_step());
            progress(Progress { time, duration: probe.duration(), steps, time_step, elements, settling: None });
        }
    }
    Ok(())
}

/// State of a run between two steps, to be written. What follows from the model (meshes, laws, masses, the impactor's
/// shape) is regenerated when a run resumes; a checkpoint holds only what the steps change.
#[derive(Serialize)]
pub struct Checkpoint<'a> {
    engine: State,
    record: &'a Record,
    wall: Duration,
}

/// A [`Checkpoint`] read back: the same fields in the same order.
#[derive(Deserialize)]
pub struct Restart {
    engine: State,
    record: Record,
    /// Wall time of the run up to the checkpoint.
    wall: Duration,
}

/// When checkpoints are taken, and what writes them.
pub struct Checkpoints<'a> {
    /// Simulated time between two, s.
    pub every: f64,
    /// Writes one.
    pub write: &'a mut dyn FnMut(&Checkpoint<'_>),
}

impl<'a> Checkpoint<'a> {
    /// The present state of a run; `wall` is its wall time so far.
    fn capture(engine: &Engine, probe: &'a Probe<'_>, wall: Duration) -> Checkpoint<'a> {
        Checkpoint { engine: engine.state(), record: probe.record(), wall }
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.engine.time()
    }

    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.engine.steps()
    }
}

impl Restart {
    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.engine.time()
    }

    /// Restores `engine` and `probe`, newly built from the same model, to the state of the checkpoint.
    fn restore(self, engine: &mut Engine, probe: &mut Probe<'_>) -> Result<(), StateMismatch> {
        engine.restore(self.engine)?;
        probe.resume(self.record)
    }
}
