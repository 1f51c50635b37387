//! How a search came to its result, iteration by iteration.

use std::sync::Arc;

use super::Target;

/// A search as people look at it.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    /// What the script calls it, or `search 1`.
    pub title: String,
    /// Names of the unknowns.
    pub unknowns: Vec<String>,
    /// Best so far after every iteration, one list a start: iteration and objective.
    pub objectives: Vec<Vec<(usize, f64)>>,
    /// Of the start that ended best: where it stood after every iteration.
    pub course: Vec<Waypoint>,
    /// What the objective held simulations against, while the best start improved.
    pub pursuits: Vec<Pursuit>,
    /// Whether what it was held against comes from virtual recordings alone.
    pub is_virtual: bool,
}

/// Simulations that close in on a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Pursuit {
    /// Quantity and unit, e.g. `acceleration (m/s²)`.
    pub words: String,
    pub target: Arc<Target>,
    /// In the order of iterations; the first is the start, the last the best.
    pub improvements: Vec<Improvement>,
}

/// Where a search stood after an iteration: its best trial so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Waypoint {
    pub iteration: usize,
    /// What the objective gave.
    pub f: f64,
    /// The unknowns.
    pub x: Vec<f64>,
}

/// A trial that was better than all before.
#[derive(Clone, Debug, PartialEq)]
pub struct Improvement {
    pub at: Waypoint,
    /// What was simulated, at the places of the target.
    pub values: Vec<f32>,
}
