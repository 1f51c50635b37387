//! How time is stepped.

use super::Solver;
use crate::scenario::Scenario;

/// The solver's settings; their range is the language's own.
pub fn check(scenario: &Scenario) -> Solver {
    Solver { step_factor: scenario.solver.step_factor }
}
