//! What springs of the frame make of the stable time step.

use serde::{Deserialize, Serialize};

use membrane::engine::Engine;

/// The time step of film on springs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpringStep {
    /// On its springs, s.
    pub step: f64,
    /// Without them, s.
    pub free: f64,
    /// Whether their dashpots bound it, and not their stiffness.
    pub by_damping: bool,
}

impl SpringStep {
    /// Step without springs over that with them, above which these are what a run takes long for.
    const MUCH: f64 = 4.0;

    /// That of an engine before its first step; none where its film hangs on no springs.
    pub fn of_engine(engine: &Engine) -> Option<SpringStep> {
        let step = engine.time_step();
        let [undamped, free] = engine.time_steps_beside_springs()?;
        Some(SpringStep { step, free, by_damping: undamped > 2.0 * step })
    }

    /// Whether the springs shorten the step much.
    pub fn is_much_shorter(&self) -> bool {
        self.free > SpringStep::MUCH * self.step
    }

    /// The key that bounds the step.
    pub fn key(&self) -> &'static str {
        if self.by_damping { "frame.springs.damping" } else { "frame.springs.stiffness" }
    }
}
