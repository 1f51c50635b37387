//! Evolution of a normal distribution (CMA-ES, Hansen and Ostermeier, Evol. Comput. 9, 2001) for rough objectives.
//!
//! A generation is evaluated at once. The distribution lives in u: the unknowns over their size at the start, or what stands
//! for them within bounds, see [`Bounds`](super::Bounds).

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use cmaes::{CMAESOptions, DVector, TerminationReason};

use super::search::{Course, Ended, Iteration, SearchError, limit, order};

/// What a failed trial counts as. The method ranks trials; only their order matters.
const WORST: f64 = 1e300;

/// Searches from `start`.
pub(super) fn search(start: &[f64], course: Course<'_, '_, '_>) -> Result<Ended, SearchError> {
    let Course { search, trials, number, listener } = course;
    let mut start = start.to_vec();
    search.bounds.inwards(&mut start);
    let origin = search.bounds.u_of(&start);
    let bounded: Vec<bool> = search.bounds.pairs().map(|pair| pair.iter().any(|bound| bound.is_finite())).collect();
    // Where a bound has given the unknown a scale of its own, that is taken.
    let scale = |place: usize| if bounded[place] || origin[place] == 0.0 { 1.0 } else { origin[place].abs() };
    let scale: Vec<f64> = (0..origin.len()).map(scale).collect();
    let x_of = |v: &DVector<f64>| {
        let u: Vec<f64> = v.iter().zip(&scale).map(|(v, scale)| v * scale).collect();
        search.bounds.x_of(&u)
    };
    let errors = Mutex::new(Vec::new());
    let before = AtomicUsize::new(0);
    let objective = |v: &DVector<f64>| {
        let x = x_of(v);
        match trials.answer_of_several(&x, before.load(Ordering::Relaxed)) {
            Ok(answer) => answer.map_or(WORST, |answer| answer.value()),
            Err(why) => {
                // The others of the generation are still tried, so that it does not matter which of them was quicker.
                errors.lock().unwrap_or_else(PoisonError::into_inner).push((x, why));
                WORST
            }
        }
    };
    let mean: Vec<f64> = origin.iter().zip(&scale).map(|(u, scale)| u / scale).collect();
    let options = CMAESOptions::new(mean, search.spread)
        .seed(search.seed)
        .tol_fun(search.tol_f)
        .tol_fun_hist(search.tol_f)
        .tol_x(search.tol_x)
        .max_generations(search.most_iterations)
        .max_function_evals(search.most_evaluations);
    let mut state = options.build(objective).map_err(|why| SearchError::CmaEs(format!("{why:?}")))?;
    let mut history: Vec<Iteration> = Vec::new();
    let ended = loop {
        before.store(trials.evaluations(), Ordering::Relaxed);
        let ended = state.next_parallel();
        let errors = std::mem::take(&mut *errors.lock().unwrap_or_else(PoisonError::into_inner));
        if let Some((_, why)) = errors.into_iter().min_by(|(a, _), (b, _)| order(a, b)) {
            return Err(why);
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
            listener(&iteration);
            history.push(iteration);
        }
        if let Some(ended) = ended {
            break ended;
        }
    };
    let converged = ended.reasons.iter().any(has_converged);
    let (x, f) = ended.overall_best.map_or((start, f64::INFINITY), |best| (x_of(&best.point), best.value));
    let (iterations, evaluations) = (state.generation(), state.function_evals());
    let reason = match ended.reasons.first() {
        Some(TerminationReason::MaxFunctionEvals | TerminationReason::MaxGenerations) => {
            limit(iterations, search).into()
        }
        Some(reason) => words(reason),
        None => String::new(),
    };
    Ok(Ended { x, f, iterations, evaluations, converged, reason, size: Some(state.sigma()), history })
}

fn has_converged(reason: &TerminationReason) -> bool {
    use TerminationReason as R;
    matches!(reason, R::TolFun | R::TolFunRel | R::TolFunHist | R::TolX)
}

fn words(reason: &TerminationReason) -> String {
    match reason {
        TerminationReason::TolFun | TerminationReason::TolFunHist => "the objective changes by less than tol_f".into(),
        TerminationReason::TolX => "the distribution is narrower than tol_x".into(),
        other => format!("the method stopped ({other})"),
    }
}
