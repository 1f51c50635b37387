//! The result of a search.

use super::iteration::{Iteration, StopReason};
use super::warning::Warning;

/// The result of one start.
#[derive(Clone, Debug, PartialEq)]
pub struct StartResult {
    /// The best point.
    pub x: Vec<f64>,
    /// Its objective value.
    pub f: f64,
    /// Number of iterations.
    pub iterations: usize,
    /// Points that the search requested.
    pub evaluations: usize,
    /// Whether a tolerance was met.
    pub converged: bool,
    /// Why the search stopped.
    pub reason: StopReason,
    /// [`Iteration::size`] at the end.
    pub size: Option<f64>,
    /// All iterations.
    pub history: Vec<Iteration>,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchResult {
    /// The best of all starts.
    pub best: StartResult,
    /// The results of all starts, in their order.
    pub starts: Vec<StartResult>,
    /// Points that were evaluated to choose starts among them.
    pub screened: usize,
    /// Doubts about the result.
    pub warnings: Vec<Warning>,
}
