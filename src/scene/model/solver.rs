//! How time is stepped.

use super::Solver;
use crate::scenario::Scenario;

/// The solver's settings; their range is the language's own.
pub fn check(scenario: &Scenario) -> Solver {
    let solver = &scenario.solver;
    Solver { step_factor: solver.step_factor, smallest_step: solver.smallest_step.map(|step| step.0) }
}
