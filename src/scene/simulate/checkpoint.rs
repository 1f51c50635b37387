//! Checkpoints of a run, from which it resumes with the bits of one that was not interrupted.
//!
//! What follows from the model (meshes, laws, masses, the impactor's shape) is regenerated when a run resumes; a
//! checkpoint holds only what the steps change: the state of the engine and the record of the probe.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::probe::{Probe, Record};
use membrane::engine::{Engine, State, StateMismatch};

/// State of a run between two steps, to be written.
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
    pub(super) wall: Duration,
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
    pub(super) fn capture(engine: &Engine, probe: &'a Probe<'_>, wall: Duration) -> Checkpoint<'a> {
        Checkpoint { engine: engine.state(), record: probe.record(), wall }
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.engine.time
    }

    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.engine.steps
    }
}

impl Restart {
    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.engine.time
    }

    /// Restores `engine` and `probe`, newly built from the same model, to the state of the checkpoint.
    pub(super) fn restore(self, engine: &mut Engine, probe: &mut Probe<'_>) -> Result<(), StateMismatch> {
        engine.restore(self.engine)?;
        probe.resume(self.record)
    }
}
