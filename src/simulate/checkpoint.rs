//! A run laid down in the middle and taken up again, with the same bits as one that went through.
//!
//! Whatever follows from the model (meshes, laws, masses, the impactor's shape) is made again on taking up; only what the
//! steps so far have left is kept: the engine's state and what the probe gathered.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::probe::{Probe, Record};
use crate::engine::{Engine, Misfit, State};

/// A run between two steps, as it is saved.
#[derive(Serialize)]
pub struct Checkpoint<'a> {
    engine: State,
    record: &'a Record,
    wall: Duration,
}

/// A checkpoint as it is read back; its fields are those of [`Checkpoint`], in their order.
#[derive(Deserialize)]
pub struct Saved {
    engine: State,
    record: Record,
    /// What the run took until then.
    pub(super) wall: Duration,
}

/// When checkpoints are taken, and by whom.
pub struct Checkpoints<'a> {
    /// Simulated time between two, s.
    pub every: f64,
    /// Takes them.
    pub keep: &'a mut dyn FnMut(&Checkpoint<'_>),
}

impl<'a> Checkpoint<'a> {
    /// The run as it stands; `wall` is what it took until now.
    pub(super) fn of(engine: &Engine, probe: &'a Probe<'_>, wall: Duration) -> Checkpoint<'a> {
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

impl Saved {
    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.engine.time
    }

    /// Puts engine and probe, just made of the same model, where the saved run stood.
    pub(super) fn put_back(self, engine: &mut Engine, probe: &mut Probe<'_>) -> Result<(), Misfit> {
        engine.restore(self.engine)?;
        probe.resume(self.record);
        Ok(())
    }
}
