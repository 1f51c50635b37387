//! The convergence history of a search: its iterates, and the fits at improvements.

use std::sync::Arc;

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
    /// The fits to the references that the objective compares with, at the improvements of the best start.
    pub fits: Vec<FitHistory>,
    /// Whether all references are virtual recordings.
    pub is_virtual: bool,
}

impl ConvergenceHistory {
    /// This phase of a search behind those `before` it: iterations are counted on, and curves approach the same references from
    /// the first start on. Objective values are of this phase alone, since each weighs its signals in its own way.
    pub(super) fn behind(mut self, before: ConvergenceHistory) -> ConvergenceHistory {
        let offset = before.history.last().map_or(0, |at| at.iteration);
        self.history.iter_mut().for_each(|at| at.iteration += offset);
        self.objectives.iter_mut().flatten().for_each(|(iteration, _)| *iteration += offset);
        self.fits.iter_mut().flat_map(|fit| &mut fit.improvements).for_each(|own| own.at.iteration += offset);
        self.history.splice(..0, before.history);
        for (fit, before) in self.fits.iter_mut().zip(before.fits) {
            // Stages may compare with other references.
            if fit.target == before.target {
                fit.improvements.splice(..0, before.improvements);
            }
        }
        ConvergenceHistory { continues: before.continues, ..self }
    }
}

/// Simulated curves that approach one reference.
#[derive(Clone, Debug, PartialEq)]
pub struct FitHistory {
    /// The quantity of the curves, such as `acceleration`.
    pub quantity: String,
    /// Its unit, where one is known; a curve over strain is shown in it.
    pub unit: Option<Unit>,
    /// The reference.
    pub target: Arc<Target>,
    /// By iteration; the first is the start, the last the best.
    pub improvements: Vec<Improvement>,
}

impl FitHistory {
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

/// An iterate with a lower objective value than all before it, and its simulated curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Improvement {
    /// The iterate.
    pub at: Iterate,
    /// Simulated values at the abscissae of the reference.
    pub values: Vec<f32>,
}
