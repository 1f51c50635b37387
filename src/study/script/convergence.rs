//! The convergence history of a search: its iterates, and the curves at the best of them.

use super::Target;
use base::units::Unit;

/// The convergence history of one search.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergenceHistory {
    /// The title that the script gave, or `search 1`.
    pub title: String,
    /// Whether it goes on where the search before it ended: both are phases of one search.
    pub continues: bool,
    /// Names of the unknowns.
    pub unknowns: Vec<String>,
    /// Lowest objective value after each iteration, one list for each start: iteration and value.
    pub objectives: Vec<Vec<(usize, f64)>>,
    /// The iterates of the best start.
    pub history: Vec<Iterate>,
    /// The fits to the references that the objective compares with, at the best point.
    pub fits: Vec<Fit>,
    /// Whether all references are virtual recordings.
    pub is_virtual: bool,
}

impl ConvergenceHistory {
    /// This phase of a search behind those `before` it: iterations are counted on. Objective values are of this phase alone, since each weighs its signals in its own way.
    pub(super) fn behind(mut self, before: ConvergenceHistory) -> ConvergenceHistory {
        let offset = before.history.last().map_or(0, |at| at.iteration);
        self.history.iter_mut().for_each(|at| at.iteration += offset);
        self.objectives.iter_mut().flatten().for_each(|(iteration, _)| *iteration += offset);
        self.history.splice(..0, before.history);
        ConvergenceHistory { continues: before.continues, ..self }
    }
}

/// A simulated curve and its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The quantity of the curves, such as `acceleration`.
    pub quantity: String,
    /// Its unit, where one is known; a curve over strain is shown in it.
    pub unit: Option<Unit>,
    /// The reference.
    pub target: Target,
    /// Simulated values at the abscissae of the reference.
    pub values: Vec<f32>,
}

impl Fit {
    /// Quantity and unit, such as `acceleration (m/s²)`.
    pub fn label(&self) -> String {
        self.unit
            .as_ref()
            .map_or_else(|| self.quantity.clone(), |unit| format!("{} ({})", self.quantity, unit.symbol()))
    }
}

/// The best trial up to an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// Number of the iteration, from one.
    pub iteration: usize,
    /// Objective value.
    pub f: f64,
    /// Values of the unknowns.
    pub x: Vec<f64>,
}
