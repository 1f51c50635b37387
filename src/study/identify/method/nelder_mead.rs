//! The simplex search of Nelder and Mead with bounds and restarts.

use super::simplex::{Limits, Simplex, SimplexValues};
use super::speculation;
use super::trials::{SearchContext, Trials};
use crate::identify::error::SearchError;
use crate::identify::iteration::{Iteration, StopReason};
use crate::identify::result::StartResult;

/// Largest number of restarts with a best vertex on a bound.
const MAX_RESTARTS: usize = 5;

/// Searches from `start`.
///
/// A simplex that collapsed onto a bound cannot leave it. Where one converges with its best vertex on a bound, the
/// search restarts with a new simplex around that vertex until a restart brings no improvement.
pub(in crate::identify) fn search(
    start: &[f64],
    context: SearchContext<'_, '_, '_>,
) -> Result<StartResult, SearchError> {
    let SearchContext { search, trials, start: number, observer } = context;
    let mut values = Projected(trials);
    let limits = Limits {
        tol_x: search.tol_x,
        tol_f: search.tol_f,
        max_iterations: search.max_iterations,
        max_evaluations: search.max_evaluations,
    };
    let mut history = Vec::new();
    let mut observe = |simplex: &Simplex| {
        let iteration = iteration(simplex, number);
        observer(&iteration);
        history.push(iteration);
    };
    let mut simplex = Simplex::around(start, &mut values)?;
    let mut restarts = 0;
    loop {
        observe(&simplex);
        let before = simplex.vertices[0].f;
        while !simplex.has_converged(&limits) && !limits.are_met(&simplex) {
            simplex.advance(&mut values)?;
            observe(&simplex);
        }
        let best = simplex.vertices[0].clone();
        let is_on_bound = !search.bounds.active(&best.x).is_empty() && !limits.are_met(&simplex);
        // A first simplex may have collapsed onto the bound at once: it is restarted even without any improvement.
        let improved = restarts == 0 || before - best.f > search.tol_f;
        if !is_on_bound || !improved || restarts == MAX_RESTARTS {
            break;
        }
        restarts += 1;
        let so_far = [simplex.iterations, simplex.evaluations];
        simplex = Simplex::around(&best.x, &mut values)?.after(so_far);
    }
    let converged = simplex.has_converged(&limits);
    let reason = if converged { StopReason::SimplexTolerance } else { StopReason::limit(simplex.iterations, search) };
    let best = &simplex.vertices[0];
    let (iterations, evaluations) = (simplex.iterations, simplex.evaluations);
    let (x, f, size) = (best.x.clone(), best.f, Some(simplex.size()));
    Ok(StartResult { x, f, iterations, evaluations, converged, reason, size, history })
}

/// The trials of a simplex, projected onto the bounds.
struct Projected<'s, 'c, 'a>(&'s Trials<'c, 'a>);

impl SimplexValues for Projected<'_, '_, '_> {
    type Error = SearchError;

    fn value(&mut self, x: &[f64]) -> Result<f64, SearchError> {
        Ok(self.0.value(x)?.map_or(f64::INFINITY, |value| value.value()))
    }

    fn speculate(&mut self, points: &[Vec<f64>]) {
        self.0.speculate(points);
    }

    fn predict(&self, simplex: &Simplex) -> Vec<Vec<f64>> {
        match self.0.max_speculative() {
            0 => vec![],
            max => speculation::points(simplex, self.0, max),
        }
    }

    fn project(&self, x: &mut [f64]) {
        self.0.search.bounds.project(x);
    }
}

fn iteration(simplex: &Simplex, start: usize) -> Iteration {
    let best = &simplex.vertices[0];
    Iteration {
        start,
        iteration: simplex.iterations,
        evaluations: simplex.evaluations,
        x: best.x.clone(),
        f: best.f,
        size: Some(simplex.size()),
        spread: Some(simplex.spread()),
        step: simplex.step,
    }
}
