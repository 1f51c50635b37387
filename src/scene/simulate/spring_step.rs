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
}

impl SpringStep {
    /// The key that bounds the step.
    pub const KEY: &str = "frame.springs.stiffness";

    /// Step without springs over that with them, above which these are what a run takes long for.
    const MUCH: f64 = 4.0;

    /// That of an engine before its first step; none where its film hangs on no springs.
    pub fn of_engine(engine: &Engine) -> Option<SpringStep> {
        Some(SpringStep { step: engine.time_step(), free: engine.time_step_without_springs()? })
    }

    /// Whether the springs shorten the step much.
    pub fn is_much_shorter(&self) -> bool {
        self.free > SpringStep::MUCH * self.step
    }
}
