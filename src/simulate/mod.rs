//! One run: from a checked model to its outcome.

mod build;
mod cancellation;
mod checkpoint;
mod energy_check;
mod fault;
mod frame_force;
mod snapshot;
mod grid;
mod image;
mod impact;
mod indent;
mod monitor;
mod pressure;
mod probe;
mod pull;
mod rates;
mod rows;
mod slow;
mod stretch;
mod tracks;
mod warning;

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::engine::{self, Engine, Surface, ThreadPool};
use crate::lane::Width;
use crate::mesh::Quality;
use crate::model::Model;
use crate::signal::Recording;
use build::Mounting;
pub use build::{falling, section, surface};
pub use cancellation::Cancellation;
pub use checkpoint::{Checkpoint, Checkpoints, Restart};
pub use fault::{Failure, Fault, RunError};
pub use image::Image;
use probe::Probe;
pub use pull::{Across, PullError, pull};
pub use warning::{CODES, Warning};

/// What came out of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Channels of `signals.csv`, in its order, without the filtered one (that is post-processing).
    pub signals: Recording,
    /// The energy audit, sampled with the signals: one channel a term, J.
    pub energies: Recording,
    /// States of films and impactor over time.
    pub snapshots: Vec<Snapshot>,
    /// Topology of the films, one entry a face.
    pub films: Vec<Film>,
    /// Surface of the impactor that moves in the snapshots.
    pub impactor: Option<Surface>,
    pub rates: RateHistogram,
    /// What puts figures in doubt.
    pub warnings: Vec<Warning>,
    /// First time at which an element broke, s.
    pub rupture_time: Option<f64>,
    /// Largest |ΣE − E₀| over the energy exchanged.
    pub energy_balance_error: f64,
    /// Largest share of kinetic energy in the film's energy, once a tenth of it is there (only quasi-static loadings).
    pub kinetic_share: Option<f64>,
    /// Energy lost to damping over the film's (only quasi-static loadings).
    pub damping_share: Option<f64>,
    /// Change of an inflated film's deflection over the last tenth of the test, over the deflection; none where it broke.
    pub settling: Option<f64>,
    /// Factor on the film's mass that the run used (only quasi-static loadings).
    pub mass_scaling: Option<f64>,
    /// Largest penetration over the impactor's radius.
    pub penetration: Option<f64>,
    pub elements: usize,
    /// What the engine's own arrays take, bytes.
    pub bytes: usize,
    /// Threads that worked on it.
    pub threads: usize,
    /// Vector instructions that its kernels were run with.
    pub instructions: Width,
    pub steps: u64,
    /// Mean time step, s.
    pub time_step: f64,
    pub wall: Duration,
}

/// Topology of one face, as pictures need it.
#[derive(Clone, Debug)]
pub struct Film {
    pub nodes: usize,
    pub quads: Vec<[u32; 4]>,
    pub tris: Vec<[u32; 3]>,
    /// Edges by which the frame or the jaws hold it, as pairs of nodes.
    pub held: Vec<[u32; 2]>,
    /// Mirror planes that complete the picture: x, y.
    pub mirrored: [bool; 2],
    /// How well its elements are shaped.
    pub quality: Quality,
}

/// State of the whole scene at one time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Snapshot {
    /// s.
    pub time: f64,
    /// One entry a face.
    pub films: Vec<FilmState>,
    /// Position (m) and rotation (unit quaternion i, j, k, w) of the impactor.
    pub impactor: Option<([f64; 3], [f64; 4])>,
}

/// State of one face at one time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FilmState {
    pub positions: Vec<[f32; 3]>,
    /// Engineering strain of the MD and TD fibres and shear angle, one entry an element (quads, then triangles).
    pub strains: Vec<[f32; 3]>,
    /// Broken elements.
    pub failed: Vec<bool>,
    /// Nodes of the face that the impactor touches, ascending.
    pub touching: Vec<u32>,
    /// Stress and more, where the run was asked for it ([`RunOptions::detailed`]).
    pub detail: Option<Detail>,
}

/// What only some want to know of the state of a face.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Detail {
    /// m/s, one entry a node.
    pub velocities: Vec<[f32; 3]>,
    /// Engineering stresses along MD and TD and in shear, Pa of one layer on its stress-free cross-section, one entry an
    /// element, as all that follow.
    pub stresses: Vec<[f32; 3]>,
    /// Largest MD and TD strain so far.
    pub peaks: Vec<[f32; 2]>,
    /// Thickness over that of stress-free film; NaN where the law says nothing of it.
    pub thickness_ratio: Vec<f32>,
    /// Images of unit vectors along MD and TD of the stress-free film: directions of the fibres, as long as they are stretched.
    pub fibres: Vec<[[f32; 3]; 2]>,
}

/// Share of the film's straining (volume × strain beyond the largest so far, loading only) by strain rate.
#[derive(Clone, Debug, Default)]
pub struct RateHistogram {
    /// Edges of the bins, 1/s, logarithmic.
    pub edges: Vec<f64>,
    /// Share in each bin; sums to one when anything was strained.
    pub shares: Vec<f64>,
    /// Range in which the curves were measured, 1/s.
    pub measured: Option<[f64; 2]>,
    /// Share outside that range.
    pub outside: f64,
}

/// Where a run stands.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Simulated so far, s.
    pub time: f64,
    /// To be simulated in all, s.
    pub duration: f64,
    /// Steps so far.
    pub steps: u64,
    /// The present time step, s.
    pub time_step: f64,
    /// Elements that every step works on.
    pub elements: usize,
}

/// Element steps between two reports of progress: about a millisecond.
const REPORT_AFTER: usize = 30_000;

/// Simulates `model`; `progress` is told every few steps where the run stands.
pub fn run(model: &Model, progress: &mut dyn FnMut(Progress)) -> Result<Outcome, RunError> {
    run_with(model, RunOptions::default(), progress)
}

/// Options of a run that its model does not hold. None changes a bit of the outcome apart from its wall time and the detail
/// of its snapshots.
#[derive(Default)]
pub struct RunOptions<'a> {
    /// Where an interrupted run resumes.
    pub restart: Option<Restart>,
    /// When checkpoints are taken; never if left out.
    pub checkpoints: Option<Checkpoints<'a>>,
    /// Its threads; left out, their number follows from the elements and the processor.
    pub pool: Option<ThreadPool>,
    /// Ends the run early, without an outcome.
    pub cancellation: Cancellation,
    /// Called with every snapshot as soon as it is taken.
    pub on_snapshot: Option<&'a mut dyn FnMut(&SnapshotEvent<'_>)>,
    /// Whether kept states have their [`Detail`]. Of a film so fine that its states do not all fit into memory, fewer are kept.
    pub detailed: bool,
}

/// A run up to a snapshot that was just taken.
#[derive(Clone, Copy)]
pub struct SnapshotEvent<'a> {
    /// Topology of the films, one entry a face.
    pub films: &'a [Film],
    pub impactor: Option<&'a Surface>,
    pub snapshot: &'a Snapshot,
    /// Channels of `signals.csv` until then, without the filtered one.
    pub signals: &'a Recording,
    /// The energy audit until then.
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
    let RunOptions { restart, checkpoints, pool, cancellation, on_snapshot, detailed } = options;
    let begin = Instant::now();
    let scene = build::scene(model)?;
    let pool = pool.unwrap_or_else(|| build::pool(scene.engine.elements()));
    let mut engine = scene.engine.with_pool(pool);
    let mut probe = Probe::new(model, &scene.mounting, detailed);
    let mut before = Duration::ZERO;
    if let Some(restart) = restart {
        before = restart.wall;
        restart.restore(&mut engine, &mut probe)?;
    }
    let wall = || before + begin.elapsed();
    let mut events = SnapshotEvents { on_snapshot, mounting: &scene.mounting, reported: 0 };
    let stepped = advance(&mut engine, &mut probe, checkpoints, progress, &wall, &cancellation, &mut events);
    if cancellation.is_cancelled() {
        return Err(RunError::Cancelled);
    }
    let fault = match stepped {
        Ok(()) | Err(engine::Fault::Stopped) => probe.fault(),
        Err(fault) => Some(fault.into()),
    };
    let outcome = probe.finish(&engine, scene.mounting, wall());
    match fault {
        None => Ok(outcome),
        Some(cause) => Err(RunError::Failure(Box::new(Failure { cause, so_far: outcome }))),
    }
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
    fn report(&mut self, probe: &Probe<'_>, impactor: Option<&Surface>) {
        let new = &probe.snapshots()[self.reported..];
        let Some(on_snapshot) = self.on_snapshot.as_mut().filter(|_| !new.is_empty()) else { return };
        let (signals, energies) = (probe.signals(self.mounting), probe.energies());
        for snapshot in new {
            let films = &self.mounting.films;
            on_snapshot(&SnapshotEvent { films, impactor, snapshot, signals: &signals, energies: &energies });
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
    let stride = (REPORT_AFTER / elements.max(1)).max(1) as u64;
    let after = |time: f64, every: f64| ((time / every).floor() + 1.0) * every;
    let mut due = checkpoints.as_ref().map_or(f64::INFINITY, |c| after(engine.time(), c.every));
    while !probe.is_done(engine.time()) && !cancellation.is_cancelled() {
        if let Some(checkpoints) = checkpoints.as_mut().filter(|_| engine.time() >= due) {
            (checkpoints.write)(&Checkpoint::of(engine, probe, wall()));
            due = after(engine.time(), checkpoints.every);
        }
        let time = engine.time();
        if engine.step(probe)? > 0 {
            probe.broke(time);
        }
        events.report(probe, engine.impactor());
        if engine.steps().is_multiple_of(stride) {
            let (time, steps, time_step) = (engine.time(), engine.steps(), engine.time_step());
            progress(Progress { time, duration: probe.duration(), steps, time_step, elements });
        }
    }
    Ok(())
}
