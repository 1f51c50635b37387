//! The end of a search at bounds.

use super::trials::Trials;
use crate::identify::bounds::Side;
use crate::identify::error::SearchError;
use crate::identify::objective::ObjectiveValue;
use crate::identify::options::Search;
use crate::identify::result::StartResult;

/// The point with each unknown on the bound beside which it converged, where the objective is no higher there: towards
/// a bound the transform flattens, and the tolerances are met before it.
pub(super) fn onto_bounds(
    mut result: StartResult,
    search: &Search,
    trials: &Trials<'_, '_>,
) -> Result<StartResult, SearchError> {
    if !result.converged {
        return Ok(result);
    }
    // One unknown after the other: a bound that lowers the objective stays while the next one is tried.
    for (index, bound) in search.bounds.beside(&result.x) {
        let mut x = result.x.clone();
        x[index] = bound;
        // Not a trial that the search asks for: without a value there, the point beside the bound stands.
        let f = match trials.at_start(&x) {
            Err(SearchError::Start { .. }) => continue,
            value => value?.value(),
        };
        if f <= result.f {
            (result.x, result.f) = (x, f);
        }
    }
    Ok(result)
}

/// Whether the objective falls beyond the bound on which unknown `index` of `x` lies, by the gradient of the sum of
/// squares there, rᵀ ∂r/∂x, of a difference inwards; none where that has no residuals.
pub(in crate::identify) fn falls_beyond(
    (index, side): (usize, Side),
    x: &[f64],
    search: &Search,
    trials: &Trials<'_, '_>,
) -> Result<Option<bool>, SearchError> {
    let [lower, upper] = search.bounds.pairs().nth(index).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let size = if x[index] == 0.0 { 1.0 } else { x[index].abs() };
    // Within narrow bounds, a step of the usual size would leave them on the other side.
    let step = (search.difference * size).min(0.25 * (upper - lower));
    let mut inside = x.to_vec();
    inside[index] += if side == Side::Lower { step } else { -step };
    let mut found = Vec::new();
    for point in [x, &inside] {
        match trials.at_start(point) {
            Ok(ObjectiveValue::Residuals(residuals)) => found.push(residuals),
            Ok(ObjectiveValue::Scalar(_)) | Err(SearchError::Start { .. }) => return Ok(None),
            Err(error) => return Err(error),
        }
    }
    let [here, there] = &found[..] else { return Ok(None) };
    // Only the sign is asked for, so the difference is not divided by the step.
    let rise: f64 = here.iter().zip(there).map(|(here, there)| here * (there - here)).sum();
    Ok(Some(rise > 0.0))
}
