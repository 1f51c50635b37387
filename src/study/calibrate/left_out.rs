//! Cross-validation: how well a test is predicted by a fit that has not seen it.

use rhai::{Array, Dynamic};
use serde_json::json;

use super::bindings::Calibrated;
use super::fit::{Fit, ended, labels};
use super::objective::CalibrationObjective;
use super::parameter::Unknown;
use super::plan::Plan;
use super::recorded_test::share_errors;
use super::warning::Warning;
use crate::identify::{HostSearch, SearchResult, StartResult};
use crate::script::{HostResult, Row, cause, object, one_or_several, refuse, run_list};
use lab::signal::Series;

/// The fit without some tests.
pub(super) struct LeftOut {
    /// Indices of the tests that are left out.
    pub(super) tests: Vec<usize>,
    /// Of each of these, its signals and what it demands of its film by the parameters of the others, or why there are none.
    predicted: Vec<Result<Simulated, String>>,
    /// The parameters by the other tests.
    pub(super) values: Vec<f64>,
    converged: bool,
}

/// Simulated signals of a test, and what it demands of its film.
type Simulated = (Vec<Series>, Vec<f64>);

impl LeftOut {
    /// Names of the tests that are left out.
    fn names(&self, plan: &Plan) -> String {
        self.tests.iter().map(|test| plan.tests[*test].name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// Findings where its search has not converged, and where what was left out could not be run.
    pub(super) fn doubts(&self, plan: &Plan) -> Vec<Warning> {
        let test = self.names(plan);
        let mut found = Vec::new();
        if !self.converged {
            found.push(Warning::LeftOutNotConverged { test: test.clone() });
        }
        for (index, predicted) in self.tests.iter().zip(&self.predicted) {
            if let Err(cause) = predicted {
                let (test, cause) = (plan.tests[*index].name.clone(), cause.clone());
                found.push(Warning::LeftOutFailed { test, cause });
            }
        }
        found
    }

    /// Simulated signals of a test that is left out.
    pub(super) fn signals(&self, test: usize) -> Option<&[Series]> {
        let place = self.tests.iter().position(|own| *own == test)?;
        self.predicted[place].as_ref().ok().map(|(signals, _)| signals.as_slice())
    }
}

/// The tests that a script wants left out: each alone, or several together in an array of their own. Where none are named, all
/// that can be.
pub(super) fn groups(given: Option<&Array>, plan: &Plan) -> HostResult<Vec<Vec<usize>>> {
    let Some(given) = given else {
        let alone = (0..plan.tests.len()).map(|test| vec![test]);
        return Ok(alone.filter(|group| without(plan, group).is_ok()).collect());
    };
    let index = |name: &Dynamic| plan.place_of(&name.to_string());
    let group = |item: &Dynamic| {
        let mut found = one_or_several(item).iter().map(index).collect::<HostResult<Vec<_>>>()?;
        found.sort_unstable();
        found.dedup();
        Ok(found)
    };
    given.iter().map(group).collect()
}

/// The plan in which these tests have no weight.
fn without(plan: &Plan, group: &[usize]) -> HostResult<Plan> {
    if group.len() >= plan.tests.len() {
        return Err(refuse("one test at least stays in a fit"));
    }
    let mut own = plan.clone();
    group.iter().for_each(|test| own.tests[*test].weight = 0.0);
    share_errors(&mut own.tests);
    // What is an unknown of these tests alone would be searched without a test.
    let has_none = |unknown: &&Unknown| plan.tests_of(unknown).iter().all(|test| group.contains(test));
    match own.unknowns.iter().find(has_none) {
        Some(unknown) => Err(refuse!("without its tests, `{}` is not determined at all", unknown.name)),
        None => Ok(own),
    }
}

/// Searches without each group of tests, all from the best point of the calibration, with the model's error of its result.
pub(super) fn searched(groups: &[Vec<usize>], done: &Calibrated<'_>) -> HostResult<Vec<LeftOut>> {
    let Calibrated { plan, fit, around, session } = *done;
    let plans = groups.iter().map(|group| without(plan, group)).collect::<HostResult<Vec<_>>>()?;
    let prepared = plans.iter().zip(groups).map(|(own, group)| {
        let names: Vec<&str> = group.iter().map(|test| plan.tests[*test].name.as_str()).collect();
        let mut labels = labels(own);
        labels.title = labels.title.map(|title| format!("{title} without {}", names.join(", ")));
        let search = own.search_from(fit.values.clone(), false, true)?;
        Ok((search, labels, CalibrationObjective::new(own, fit.share, session)))
    });
    let prepared = prepared.collect::<HostResult<Vec<_>>>()?;
    let searches: Vec<HostSearch<'_>> = prepared
        .iter()
        .map(|(search, labels, objective)| HostSearch { function: "left_out", search, labels, objective })
        .collect();
    let found = around.host.minimize_all(session, &searches)?;
    let found = found.map_err(|(_, error)| ended(session, &error))?;
    let whole = CalibrationObjective::new(plan, fit.share, session);
    let trial = session.with_trial(session.cancellation());
    let fits: Vec<(&Vec<usize>, SearchResult)> = groups.iter().zip(found).collect();
    run_list(session, &fits, |(group, found)| {
        let StartResult { x, converged, .. } = &found.best;
        // A test that fails by the parameters of the others is a result.
        let run = |test: &usize| Ok(whole.simulated(*test, x, &trial).map_err(|error| cause(&error)));
        let predicted = run_list(session, group, run)?;
        Ok(LeftOut { tests: group.to_vec(), predicted, converged: *converged, values: x.clone() })
    })
}

/// Signals of a test with these values of all unknowns.
pub(super) fn simulated(done: &Calibrated<'_>, test: usize, values: &[f64]) -> HostResult<Vec<Series>> {
    let Calibrated { plan, fit, session, .. } = *done;
    let trial = session.with_trial(session.cancellation());
    Ok(CalibrationObjective::new(plan, fit.share, session).simulated(test, values, &trial)?.0)
}

/// One row a signal and one an outcome of each test that was left out: how it is met in the whole fit, and when it is predicted.
pub(super) fn rows(found: &[LeftOut], plan: &Plan, fit: &Fit) -> Vec<Row> {
    let mut rows = Vec::new();
    for left in found {
        let together = left.names(plan);
        for (index, predicted) in left.tests.iter().zip(&left.predicted) {
            let test = &plan.tests[*index];
            let predicted = predicted.as_ref().ok();
            for (place, (signal, fitted)) in test.signals.iter().zip(&fit.simulated[*index]).enumerate() {
                let left_out = predicted.and_then(|(signals, _)| signal.errors.relative_error(&signals[place]).ok());
                rows.push(object(json!({
                    "test": test.name, "signal": signal.name, "left_out": together, "converged": left.converged,
                    "relative_error": signal.errors.relative_error(fitted).ok(), "relative_error_left_out": left_out,
                })));
            }
            let Some(outcomes) = &test.outcomes else { continue };
            let breaks = plan.break_unknowns(*index);
            let described = |demands: &[f64], values: &[f64]| outcomes.described(demands, &breaks.with_values(values));
            let then = predicted.map(|(_, demands)| described(demands, &left.values));
            for (place, fitted) in described(&fit.demands[*index], &fit.values).into_iter().enumerate() {
                let then = then.as_ref().map(|all| &all[place]);
                rows.push(object(json!({
                    "test": test.name, "outcome": fitted.outcome, "left_out": together, "converged": left.converged,
                    "probability": fitted.probability, "probability_left_out": then.and_then(|own| own.probability),
                    "failure_mass_kg": fitted.mass.map(|[given, _]| given),
                    "calibrated_failure_mass_kg": fitted.mass.map(|[_, found]| found),
                    "left_out_failure_mass_kg": then.and_then(|own| own.mass).map(|[_, found]| found),
                })));
            }
        }
    }
    rows
}
