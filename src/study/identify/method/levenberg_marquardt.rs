//! Damped least squares (Levenberg 1944, Marquardt 1963; Moré's implementation in MINPACK) on a vector of residuals.
//!
//! The differences of the Jacobian are evaluated at once. A failed trial counts as a point with large residuals, so
//! that the trust region shrinks. Bounds are kept by transform, see [`Bounds`](crate::identify::Bounds).

use lab::experiment::fit::{Residuals, minimize, moved};
use levenberg_marquardt::{LevenbergMarquardt, TerminationReason};

use super::{SearchContext, Trials, falls_beyond, limit, onto_bounds};
use crate::identify::objective::{ObjectiveValue, SearchError, refused};
use crate::identify::options::Search;
use crate::identify::search::{Iteration, StartResult};

/// Norm of the residuals of a failed trial over that at the start.
const WORST: f64 = 1e3;

/// Iterations in a row that reduce the sum of squares by less than the tolerance after which a descent ends: the crate also asks
/// whether the linear model promises no more, which it does for ever where an objective is rough.
const SLOW_ITERATIONS: usize = 3;

/// What the first step may be, over the size of the point: as in MINPACK.
const STEP_BOUND: f64 = 100.0;

/// Why such a descent ended.
const SLOW: &str = "three steps in a row changed the sum of squares by less than tol_f of itself";

/// Largest number of restarts with the best point on a bound.
const MAX_RESTARTS: usize = 5;

/// Searches from `start`.
///
/// The transform has no slope on a bound, which a search cannot leave. Where one converges there, and the objective does not
/// fall beyond, it restarts beside the bound until a restart brings no improvement.
pub(in crate::identify) fn search(start: &[f64], context: SearchContext<'_>) -> Result<StartResult, SearchError> {
    let SearchContext { search, trials, start: number, observer } = context;
    let context = SearchContext { search, trials, start: number, observer: &mut *observer };
    let mut result = onto_bounds(descend(start, context, None)?, search, trials)?;
    for _ in 0..MAX_RESTARTS {
        if !result.converged || falls_beyond_all(&result.x, search, trials)? {
            break;
        }
        let before = result.f;
        let context = SearchContext { search, trials, start: number, observer: &mut *observer };
        result = match descend(&result.x.clone(), context, Some(&result)) {
            Err(SearchError::Trial { .. }) => break,
            restarted => onto_bounds(restarted?, search, trials)?,
        };
        // Of sums of squares, as the tolerance of the crate is.
        if before * before - result.f * result.f <= search.tol_f * before * before {
            break;
        }
    }
    Ok(result)
}

/// Whether `x` lies on no bound, or the objective falls beyond all on which it lies.
fn falls_beyond_all(x: &[f64], search: &Search, trials: &Trials<'_>) -> Result<bool, SearchError> {
    for active in search.bounds.active(x) {
        if falls_beyond(active, x, search, trials)? != Some(true) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// One descent from `start`, which continues the iterations of `before`.
fn descend(
    start: &[f64],
    context: SearchContext<'_>,
    before: Option<&StartResult>,
) -> Result<StartResult, SearchError> {
    let search = context.search;
    let mut start = start.to_vec();
    // On a bound the transform has no slope, and a column of the Jacobian would vanish.
    search.bounds.inwards(&mut start);
    let first = residuals(context.trials.at_start(&start)?)?;
    if first.len() < start.len() {
        return Err(refused!(
            "the objective gave {found} residuals for {unknowns} unknowns: levenberg-marquardt needs at least as many",
            found = first.len(),
            unknowns = start.len()
        ));
    }
    // The crate stops after patience × (n + 1) evaluations: rounded up, so that the limit of the search comes first.
    let patience = search.max_evaluations.div_ceil(start.len() + 1);
    let method = LevenbergMarquardt::new().with_ftol(search.tol_f).with_xtol(search.tol_x).with_patience(patience);
    let u = search.bounds.u_of(&start);
    // The first steps are bounded by a multiple of the size of u, which at the centre of all bounds is nothing but rounding.
    let size = norm(&u);
    let reach = if size > 0.0 { norm(&search.bounds.scales(&u)) / size } else { 1.0 };
    let method = method.with_stepbound(STEP_BOUND * reach);
    let mut descent = Descent {
        context,
        worst: WORST * norm(&first),
        count: first.len(),
        best: before.map_or((start, f64::INFINITY), |before| (before.x.clone(), before.f)),
        here: vec![],
        before: before.map_or(0, |before| before.iterations),
        iterations: before.map_or(0, |before| before.iterations),
        history: before.map_or_else(Vec::new, |before| before.history.clone()),
        squares: vec![],
        end: None,
    };
    let (_, report) = minimize(method, u, &mut descent);
    if let Some(End::Error(error)) = descent.end {
        return Err(error);
    }
    descent.iterations += 1;
    descent.observe("final");
    let Descent { context, best: (x, f), iterations, history, end, .. } = descent;
    let (converged, reason) = match end {
        Some(End::Slow) => (true, SLOW.into()),
        Some(_) => (false, limit(iterations, search)),
        None => (report.termination.was_successful(), stop_reason(&report.termination)),
    };
    let evaluations = context.trials.evaluations();
    Ok(StartResult { x, f, iterations, evaluations, converged, reason, size: None, history })
}

/// Residuals as a function of u, the transform of a point within the bounds.
struct Descent<'s> {
    context: SearchContext<'s>,
    /// Norm of the residuals of a failed trial.
    worst: f64,
    /// Number of residuals.
    count: usize,
    best: (Vec<f64>, f64),
    /// Residuals of the last trial that did not fail.
    here: Vec<f64>,
    /// Iterations before this descent.
    before: usize,
    iterations: usize,
    history: Vec<Iteration>,
    /// Sums of squares at the iterations of this descent.
    squares: Vec<f64>,
    end: Option<End>,
}

/// Why the crate was stopped.
enum End {
    Limit,
    /// Iterations reduce the sum of squares by less than the tolerance.
    Slow,
    Error(SearchError),
}

impl Descent<'_> {
    fn observe(&mut self, step: &'static str) {
        let (x, f) = self.best.clone();
        let (iteration, evaluations) = (self.iterations, self.context.trials.evaluations());
        let start = self.context.start;
        let iteration = Iteration { start, iteration, evaluations, x, f, size: None, spread: None, step };
        (self.context.observer)(&iteration);
        self.history.push(iteration);
    }

    fn x_of(&self, u: &[f64]) -> Vec<f64> {
        self.context.search.bounds.x_of(u)
    }

    /// Steps of u for the differences, towards the centre of its range.
    fn steps(&self, u: &[f64]) -> Vec<f64> {
        let search = self.context.search;
        let step =
            |(u, scale): (&f64, f64)| if *u > 0.0 { -search.difference * scale } else { search.difference * scale };
        u.iter().zip(search.bounds.scales(u)).map(step).collect()
    }

    /// The points of the differences around u.
    fn difference_points(&self, u: &[f64]) -> Vec<Vec<f64>> {
        let steps = self.steps(u).into_iter().enumerate();
        steps.map(|(index, step)| self.x_of(&moved(u, index, step))).collect()
    }

    fn checked(&self, x: &[f64], value: Option<ObjectiveValue>) -> Result<Option<Vec<f64>>, SearchError> {
        let found = value.map(residuals).transpose()?;
        match &found {
            Some(found) if found.len() != self.count => {
                let expected = self.count;
                Err(refused!(
                    "the objective gave {found} residuals at {x:?}, and {expected} at the start",
                    found = found.len()
                ))
            }
            _ => Ok(found),
        }
    }

    fn evaluate_residuals(&mut self, u: &[f64]) -> Result<Vec<f64>, SearchError> {
        let x = self.x_of(u);
        // If the step is accepted, as most are, the Jacobian is requested next.
        self.context.trials.prepare(std::slice::from_ref(&x), &self.difference_points(u))?;
        let Some(found) = self.checked(&x, self.context.trials.value(&x)?)? else {
            // Spread evenly, with the norm `worst`: the crate refuses the step and shortens the next one.
            return Ok(vec![self.worst / (self.count as f64).sqrt(); self.count]);
        };
        let f = norm(&found);
        if f < self.best.1 {
            self.best = (x, f);
        }
        self.here.clone_from(&found);
        Ok(found)
    }

    /// Differences from u, the last point that did not fail; to the other side where a trial fails.
    fn evaluate_derivatives(&self, u: &[f64]) -> Result<Vec<Vec<f64>>, SearchError> {
        let points = self.difference_points(u);
        let found = self.context.trials.values(&points)?;
        let column = |(index, (value, step)): (usize, (Option<ObjectiveValue>, f64))| {
            let (there, step) = match self.checked(&points[index], value)? {
                Some(there) => (there, step),
                None => (self.residuals_at(&moved(u, index, -step))?, -step),
            };
            Ok(there.iter().zip(&self.here).map(|(there, here)| (there - here) / step).collect())
        };
        found.into_iter().zip(self.steps(u)).enumerate().map(column).collect()
    }

    /// The residuals behind u, where those before it failed.
    fn residuals_at(&self, u: &[f64]) -> Result<Vec<f64>, SearchError> {
        let x = self.x_of(u);
        self.checked(&x, self.context.trials.value(&x)?)?
            .ok_or_else(|| refused!("a trial failed at {x:?}: the trials on both sides failed, there is no derivative"))
    }

    /// The value; none, which stops the crate, where the search ends.
    fn unless_ended<T>(&mut self, value: Result<T, SearchError>) -> Option<T> {
        match value {
            Ok(_) if self.context.trials.evaluations() > self.context.search.max_evaluations => {
                self.end = Some(End::Limit);
                None
            }
            Ok(value) => Some(value),
            Err(error) => {
                self.end = Some(End::Error(error));
                None
            }
        }
    }
}

impl Residuals for Descent<'_> {
    fn at(&mut self, u: &[f64]) -> Option<Vec<f64>> {
        let found = self.evaluate_residuals(u);
        self.unless_ended(found)
    }

    fn derivatives(&mut self, u: &[f64]) -> Option<Vec<Vec<f64>>> {
        self.iterations += 1;
        // The crate asks for derivatives at the start and after each accepted step: iterations are counted by these.
        self.observe(if self.iterations == self.before + 1 { "initial" } else { "step" });
        self.squares.push(norm(&self.here).powi(2));
        let search = self.context.search;
        let is_over = (self.iterations >= search.max_iterations).then_some(End::Limit);
        self.end = is_over.or_else(|| is_slow(&self.squares, search.tol_f).then_some(End::Slow));
        if self.end.is_some() {
            return None;
        }
        let found = self.evaluate_derivatives(u);
        self.unless_ended(found)
    }
}

fn residuals(value: ObjectiveValue) -> Result<Vec<f64>, SearchError> {
    match value {
        ObjectiveValue::Residuals(residuals) => Ok(residuals),
        ObjectiveValue::Scalar(_) => Err(refused!(
            "levenberg-marquardt needs residuals, and the objective gave a number: return a signal or a list, or use nelder-mead",
        )),
    }
}

/// Whether the last iterations each reduced the sum of squares by less than `tolerance` of itself.
fn is_slow(squares: &[f64], tolerance: f64) -> bool {
    let last = squares.len().checked_sub(SLOW_ITERATIONS + 1).map(|first| &squares[first..]);
    last.is_some_and(|last| last.windows(2).all(|pair| pair[0] - pair[1] < tolerance * pair[0]))
}

fn norm(residuals: &[f64]) -> f64 {
    residuals.iter().map(|r| r * r).sum::<f64>().sqrt()
}

/// Why the crate stopped, in words.
fn stop_reason(reason: &TerminationReason) -> String {
    match reason {
        TerminationReason::ResidualsZero => "the residuals are zero".into(),
        TerminationReason::Orthogonal => "the gradient is zero".into(),
        TerminationReason::Converged { ftol: true, .. } => {
            "the sum of squares changes by less than tol_f of itself".into()
        }
        TerminationReason::Converged { .. } => "x changes by less than tol_x of itself".into(),
        // Its name in MINPACK: the tolerance is below what rounding allows.
        TerminationReason::NoImprovementPossible(tolerance) => format!("no improvement is possible ({tolerance})"),
        TerminationReason::LostPatience => "max_evaluations was reached".into(),
        TerminationReason::Numerical(quantity) => format!("{quantity} is not finite"),
        TerminationReason::User(quantity) | TerminationReason::WrongDimensions(quantity) => {
            format!("{quantity} unavailable")
        }
        TerminationReason::NoParameters | TerminationReason::NoResiduals => {
            "there are no unknowns or no residuals".into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_small_reductions_in_a_row_end_a_descent() {
        for (squares, expected) in [
            (&[9.0, 4.0, 3.9999, 3.9998, 3.9997][..], true),
            (&[9.0, 4.0, 3.9999, 3.9998], false),
            (&[4.0, 3.9999, 3.9, 3.8999, 3.8998], false),
            (&[4.0, 3.9999, 3.9998], false),
            (&[], false),
        ] {
            assert_eq!(is_slow(squares, 1e-4), expected, "{squares:?}");
        }
    }
}
