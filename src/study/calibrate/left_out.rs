//! Cross-validation: how well a test is predicted by a fit that has not seen it.

use rhai::{Array, Dynamic};
use serde_json::json;

use super::fit::{Fit, ended, labels};
use super::objective::CalibrationObjective;
use super::parameter::Unknown;
use super::plan::Plan;
use super::rows::object;
use super::warning::Warning;
use crate::identify::{HostSearch, SearchHost};
use crate::script::{HostResult, Row, Session, refuse};
use lab::signal::Series;

/// The fit without some tests.
pub(super) struct LeftOut {
    /// Indices of the tests that are left out.
    pub(super) tests: Vec<usize>,
    /// Simulated signals of all tests of the calibration, by the parameters of the others.
    pub(super) simulated: Vec<Vec<Series>>,
    /// Those parameters.
    pub(super) values: Vec<f64>,
    pub(super) converged: bool,
}

impl LeftOut {
    /// Names of the tests that are left out.
    fn names(&self, plan: &Plan) -> String {
        self.tests.iter().map(|test| plan.tests[*test].name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// The finding where its search has not converged.
    pub(super) fn doubt(&self, plan: &Plan) -> Option<Warning> {
        (!self.converged).then(|| Warning::LeftOutNotConverged { test: self.names(plan) })
    }
}

/// The tests that a script wants left out: each alone, or several together in a list of their own.
pub(super) fn groups(given: Option<&Array>, plan: &Plan) -> HostResult<Vec<Vec<usize>>> {
    let Some(given) = given else { return Ok((0..plan.tests.len()).map(|test| vec![test]).collect()) };
    let index = |name: &Dynamic| {
        let found = plan.tests.iter().position(|test| name.clone().into_string().is_ok_and(|name| name == test.name));
        let known = || plan.tests.iter().map(|test| test.name.as_str()).collect::<Vec<_>>().join(", ");
        found.ok_or_else(|| refuse(format!("there is no test `{name}`; there are {}", known())))
    };
    let group = |item: &Dynamic| match item.read_lock::<Array>() {
        Some(list) => list.iter().map(index).collect(),
        None => Ok(vec![index(item)?]),
    };
    given.iter().map(group).collect()
}

/// Searches without each group of tests, all from the best point of the calibration, with the model's error of its result.
pub(super) fn searched(
    groups: &[Vec<usize>],
    plan: &Plan,
    fit: &Fit,
    host: &SearchHost,
    session: &Session,
) -> HostResult<Vec<LeftOut>> {
    let plans = groups.iter().map(|group| {
        if group.len() >= plan.tests.len() {
            return Err(refuse("one test at least stays in a fit"));
        }
        let mut own = plan.clone();
        group.iter().for_each(|test| own.tests[*test].weight = 0.0);
        // What is an unknown of these tests alone would be searched without a test.
        let has_none = |unknown: &&Unknown| plan.tests_of(unknown).iter().all(|test| group.contains(test));
        match own.unknowns.iter().find(has_none) {
            Some(unknown) => Err(refuse(format!("without its tests, `{}` is not determined at all", unknown.name))),
            None => Ok(own),
        }
    });
    let plans = plans.collect::<HostResult<Vec<_>>>()?;
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
    let found = host.minimize_all(session, &searches)?;
    let found = found.map_err(|(_, error)| ended(session, &error))?;
    let whole = CalibrationObjective::new(plan, fit.share, session);
    let trial = session.with_trial(session.cancellation());
    let predicted = groups.iter().zip(found).map(|(group, found)| {
        let simulated = (0..plan.tests.len()).map(|test| Ok(whole.simulated(test, &found.best.x, &trial)?.0));
        let simulated = simulated.collect::<HostResult<_>>()?;
        Ok(LeftOut { tests: group.clone(), simulated, converged: found.best.converged, values: found.best.x })
    });
    predicted.collect()
}

/// One row a signal of each test that was left out: its error in the whole fit, and when it is predicted.
pub(super) fn rows(found: &[LeftOut], plan: &Plan, fit: &Fit) -> Vec<Row> {
    let mut rows = Vec::new();
    for left in found {
        let together = left.names(plan);
        for index in &left.tests {
            let simulated = &left.simulated[*index];
            let test = &plan.tests[*index];
            for ((signal, predicted), fitted) in test.signals.iter().zip(simulated).zip(&fit.simulated[*index]) {
                rows.push(object(json!({
                    "test": test.name, "signal": signal.name, "left_out": together, "converged": left.converged,
                    "relative_error": signal.errors.relative_error(fitted).ok(),
                    "relative_error_left_out": signal.errors.relative_error(predicted).ok(),
                })));
            }
        }
    }
    rows
}
