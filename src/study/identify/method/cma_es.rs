//! Evolution of a normal distribution (CMA-ES, Hansen and Ostermeier, Evol. Comput. 9, 2001) for rough objectives.
//!
//! A generation is evaluated at once. The distribution is over u: the unknowns divided by their values at the start, or
//! their transforms within bounds, see [`Bounds`](crate::identify::Bounds).

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use cmaes::{CMAESOptions, DVector, TerminationReason};

use super::{SearchContext, limit, onto_bounds, order};
use crate::identify::objective::{SearchError, refused};
use crate::identify::search::{Iteration, StartResult};

/// Initial standard deviation: relative to an unknown without bounds, in u for one with bounds.
const DEVIATION: f64 = 0.25;

/// Value of a failed trial. The method only ranks values.
const WORST: f64 = 1e300;

/// Searches from `start`.
pub(in crate::identify) fn search(start: &[f64], context: SearchContext<'_>) -> Result<StartResult, SearchError> {
    let SearchContext { search, trials, start: number, observer } = context;
    let mut start = start.to_vec();
    search.bounds.inwards(&mut start);
    let origin = search.bounds.u_of(&start);
    let bounded: Vec<bool> = search.bounds.pairs().map(|pair| pair.iter().any(|bound| bound.is_finite())).collect();
    // The transform of bounds scales an unknown already.
    let scale = |index: usize| if bounded[index] || origin[index] == 0.0 { 1.0 } else { origin[index].abs() };
    let scale: Vec<f64> = (0..origin.len()).map(scale).collect();
    let x_of = |v: &DVector<f64>| {
        let u: Vec<f64> = v.iter().zip(&scale).map(|(v, scale)| v * scale).collect();
        search.bounds.x_of(&u)
    };
    let errors = Mutex::new(Vec::new());
    let before = AtomicUsize::new(0);
    let objective = |v: &DVector<f64>| {
        let x = x_of(v);
        match trials.value_of_several(&x, before.load(Ordering::Relaxed)) {
            Ok(value) => value.map_or(WORST, |value| value.value()),
            Err(error) => {
                // The rest of the generation is still evaluated: the order in which trials end does not matter.
                base::lock(&errors).push((x, error));
                WORST
            }
        }
    };
    let mean: Vec<f64> = origin.iter().zip(&scale).map(|(u, scale)| u / scale).collect();
    let options = CMAESOptions::new(mean, DEVIATION)
        .seed(search.seed)
        .tol_fun(search.tol_f)
        .tol_fun_hist(search.tol_f)
        .tol_x(search.tol_x)
        .max_generations(search.max_iterations)
        .max_function_evals(search.max_evaluations);
    let mut state = options.build(objective).map_err(|why| refused!("cma-es cannot start: {why:?}"))?;
    let mut history: Vec<Iteration> = Vec::new();
    let end = loop {
        before.store(trials.evaluations(), Ordering::Relaxed);
        let end = state.next_parallel();
        let errors = std::mem::take(&mut *base::lock(&errors));
        if let Some((_, error)) = errors.into_iter().min_by(|(a, _), (b, _)| order(a, b)) {
            return Err(error);
        }
        if let Some(best) = state.overall_best_individual() {
            let iteration = Iteration {
                start: number,
                iteration: state.generation(),
                evaluations: state.function_evals(),
                x: x_of(&best.point),
                f: best.value,
                size: Some(state.sigma()),
                spread: None,
                step: "generation",
            };
            observer(&iteration);
            history.push(iteration);
        }
        if let Some(end) = end {
            break end;
        }
    };
    let converged = end.reasons.iter().any(has_converged);
    let (x, f) = end.overall_best.map_or((start, f64::INFINITY), |best| (x_of(&best.point), best.value));
    let (iterations, evaluations) = (state.generation(), state.function_evals());
    let reason = match end.reasons.first() {
        Some(TerminationReason::MaxFunctionEvals | TerminationReason::MaxGenerations) => limit(iterations, search),
        Some(TerminationReason::TolFun | TerminationReason::TolFunHist) => {
            "the objective changes by less than tol_f".into()
        }
        Some(TerminationReason::TolX) => "the distribution is narrower than tol_x".into(),
        Some(other) => format!("the method stopped ({other})"),
        None => "the method stopped (none)".into(),
    };
    let size = Some(state.sigma());
    onto_bounds(StartResult { x, f, iterations, evaluations, converged, reason, size, history }, search, trials)
}

fn has_converged(reason: &TerminationReason) -> bool {
    use TerminationReason as R;
    matches!(reason, R::TolFun | R::TolFunRel | R::TolFunHist | R::TolX)
}
