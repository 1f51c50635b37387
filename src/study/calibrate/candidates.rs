//! Which test would tell more: what a candidate adds to what is known, by its derivatives at the best point.

use rayon::prelude::*;
use rhai::{Array, Dynamic, Map};
use serde_json::json;

use super::error_model::Noise;
use super::fit::Fit;
use super::plan::Plan;
use super::pulled;
use super::rows::object;
use super::test::{Test, Tolerances};
use super::verdict;
use crate::scenario_functions::Scenarios;
use crate::script::{HostResult, Row, Session, refuse};
use nalgebra::DMatrix;

/// Noise of a signal that was not recorded, as a share of it (assumed).
const ASSUMED_NOISE: f64 = 0.01;

/// One row a candidate and unknown: its half width now, and with the candidate beside the tests.
pub(super) fn compared(
    candidates: &Array,
    plan: &Plan,
    fit: &Fit,
    scenarios: &Scenarios,
    session: &Session,
) -> HostResult<Vec<Row>> {
    let mut rows = Vec::new();
    for given in candidates {
        let test = candidate(given, plan, fit, scenarios, session)?;
        let added = derivatives(&test, plan, fit, session)?;
        let information = verdict::information(plan, &fit.jacobian) + added.transpose() * &added;
        let covariance = verdict::inverse(&information);
        for (index, unknown) in plan.unknowns.iter().enumerate() {
            let alone = information[(index, index)].sqrt().recip();
            let then = verdict::judged(plan, &fit.x, index, &covariance, alone, &[]);
            let now = &fit.known[index];
            rows.push(object(json!({
                "candidate": test.name, "parameter": unknown.name, "half_width_now": now.half_width,
                "half_width_then": then.half_width, "reduction": 1.0 - then.deviation / now.deviation,
                "verdict_then": then.verdict.to_string(),
            })));
        }
    }
    Ok(rows)
}

/// A candidate, whose recording would be its own simulation at the best point.
fn candidate(given: &Dynamic, plan: &Plan, fit: &Fit, scenarios: &Scenarios, session: &Session) -> HostResult<Test> {
    let mut map = match given.read_lock::<Map>() {
        Some(map) => map.clone(),
        None => [("scenario".into(), given.clone())].into_iter().collect(),
    };
    if map.contains_key("recordings") {
        return Err(refuse("a candidate has no recordings yet: its own simulation stands for them"));
    }
    if map.contains_key("own") {
        return Err(refuse("a candidate has the values that all tests share: `own` is not supported"));
    }
    if let Some(key) = ["outcome", "failure_mass", "rupture_time"].into_iter().find(|key| map.contains_key(*key)) {
        return Err(refuse(format!("a candidate is compared by signals: what `{key}` would tell is not computed")));
    }
    let mut study =
        scenarios.named(map.get("scenario").ok_or_else(|| refuse("a candidate needs its `scenario`"))?, session)?;
    if let Some(changes) = map.get("set").and_then(|changes| changes.read_lock::<Map>().map(|map| map.clone())) {
        study = study.with(changes, session)?;
    }
    let best = study.with(plan.shared_changes(&fit.values, &plan.taken_by(&study, session)), session)?;
    let signals = match map.get("pull") {
        Some(given) => pulled::as_recorded(given, &best).map_err(refuse)?,
        None => super::test::as_recorded(&map, &study, &best.simulate(session)?)?,
    };
    map.insert("recordings".into(), signals.into());
    let tolerances = Tolerances { noise: Noise::Share(ASSUMED_NOISE), correlation: plan.correlation };
    let mut test = Test::read(&map.into(), scenarios, tolerances, session)?;
    // Contact makes simulated signals rough, which is noise as it is of the tests.
    for signal in &mut test.signals {
        let own = signal.measured.clone();
        signal.errors.add_roughness(&own).map_err(|error| refuse(format!("{}: {error}", test.name)))?;
    }
    Ok(test)
}

/// Derivatives of the residuals of a test by the coordinates of all unknowns, by central differences.
fn derivatives(test: &Test, plan: &Plan, fit: &Fit, session: &Session) -> HostResult<DMatrix<f64>> {
    let shared: Vec<usize> = (0..plan.unknowns.len()).filter(|index| plan.unknowns[*index].test.is_none()).collect();
    let step = |index: usize| {
        let [low, high] = plan.parameter_of(&plan.unknowns[index]).within;
        let size = if fit.values[index] == 0.0 { 1.0 } else { fit.values[index].abs() };
        (plan.search.difference * size).min(0.25 * (high - low))
    };
    let points: Vec<(usize, f64)> = shared.iter().flat_map(|index| [(*index, 1.0), (*index, -1.0)]).collect();
    let taken = plan.taken_by(&test.study, session);
    // Tests without differences along a signal tell nothing of the model's error there: what is expected of it before.
    let share = if plan.has_residuals() { fit.share } else { plan.share_before() };
    let at = |(index, sign): &(usize, f64)| -> HostResult<Vec<f64>> {
        let mut values = fit.values.clone();
        let [low, high] = plan.parameter_of(&plan.unknowns[*index]).within;
        values[*index] = (values[*index] + sign * step(*index)).clamp(low, high);
        let study = test.study.with(plan.shared_changes(&values, &taken), session)?;
        let simulated = test.simulated(&study, session)?;
        let mut residuals = vec![values[*index]];
        for (signal, simulated) in test.signals.iter().zip(&simulated) {
            let variances = signal.variances(share);
            residuals.extend(signal.residuals(simulated, &variances).map_err(refuse)?);
        }
        Ok(residuals)
    };
    let found = points.par_iter().map(at).collect::<HostResult<Vec<_>>>()?;
    let length = found.first().map_or(0, |own| own.len() - 1);
    let mut jacobian = DMatrix::zeros(length, plan.unknowns.len());
    for (place, index) in shared.iter().enumerate() {
        let (up, down) = (&found[2 * place], &found[2 * place + 1]);
        let slope = plan.parameter_of(&plan.unknowns[*index]).slope(fit.values[*index]);
        for row in 0..length {
            jacobian[(row, *index)] = slope * (up[row + 1] - down[row + 1]) / (up[0] - down[0]);
        }
    }
    Ok(jacobian * test.weight.sqrt())
}
