//! Which test would tell more: what a candidate adds to what is known, by its derivatives at the best point.

use rhai::{Array, Dynamic, Map};
use serde_json::json;

use super::bindings::Calibrated;
use super::error_model::Noise;
use super::objective::CalibrationObjective;
use super::pulled;
use super::recorded_test::{Test, Tolerances, share_errors};
use super::verdict::{self, Verdict};
use super::warning::Warning;
use crate::script::{HostResult, Options, Row, object, refuse, run_list};
use nalgebra::DMatrix;
use scene::model::Identity;

/// Noise of a signal that was not recorded, as a share of it (assumed).
const ASSUMED_NOISE: f64 = 0.01;

/// Part of an interval by which a candidate must narrow it to be worth a test.
const WORTH: f64 = 0.1;

/// What candidates would tell.
pub(super) struct Compared {
    pub(super) rows: Vec<Row>,
    /// The one to measure next; none where none is worth it.
    pub(super) advice: Option<Warning>,
}

/// One row a candidate and unknown: its half width now, and with the candidate beside the tests.
pub(super) fn compared(candidates: &Array, done: &Calibrated<'_>) -> HostResult<Compared> {
    let Calibrated { plan, fit, session, .. } = *done;
    let mut rows = Vec::new();
    // Whether the tests leave an unknown open, how much is gained, and of what.
    let mut best: Option<(bool, f64, Warning)> = None;
    let objective = CalibrationObjective::new(plan, fit.share, session);
    let ends = objective.ends();
    for given in candidates {
        let mut test = candidate(given, done)?;
        let repeated = plan.tests.iter().position(|own| is_repeat(&test, own));
        let mut tests = plan.tests.clone();
        if let Some(index) = repeated {
            // One more recording of a test has less noise, and the same error of the model.
            test = Test { name: test.name, ..tests[index].clone() };
            test.signals.iter_mut().for_each(|own| own.errors.repeat(own.recordings.len()));
            // Its signals with it stand for those without.
            tests[index].of_signals = 0.0;
        }
        tests.push(test);
        if repeated.is_none() {
            share_errors(&mut tests);
        }
        let mut known = fit.jacobian.clone();
        for (place, (now, then)) in plan.tests.iter().zip(&tests).enumerate() {
            let mut rows = known.rows_mut(ends[place], objective.compared(place));
            rows *= (then.of_signals / now.of_signals).sqrt();
        }
        let test = &tests[plan.tests.len()];
        let added = derivatives(test, repeated, done)?;
        let information = verdict::information(plan, &known) + added.tr_mul(&added);
        let covariance = verdict::inverse(&information);
        for (index, unknown) in plan.unknowns.iter().enumerate() {
            let alone = information[(index, index)].sqrt().recip();
            let then = verdict::judged(plan, &fit.x, index, &covariance, alone, &[]);
            let now = &fit.known[index];
            let open = matches!(now.verdict, Verdict::NotDetermined | Verdict::OnlyTogether(_));
            let gain = 1.0 - then.deviation / now.deviation;
            if gain > WORTH
                && now.verdict != Verdict::MeshLimited
                && best.as_ref().is_none_or(|(of_open, most, _)| (open, gain) > (*of_open, *most))
            {
                let (candidate, parameter) = (test.name.clone(), unknown.name.clone());
                let (now, then) = (now.half_width, then.half_width);
                best = Some((open, gain, Warning::MeasureNext { candidate, parameter, now, then }));
            }
            rows.push(object(json!({
                "candidate": test.name, "parameter": unknown.name, "half_width_now": now.half_width,
                "half_width_then": then.half_width, "reduction": 1.0 - then.deviation / now.deviation,
                "verdict_then": then.verdict.to_string(), "repeats": repeated.map(|index| &plan.tests[index].name),
            })));
        }
    }
    Ok(Compared { rows, advice: best.map(|(_, _, advice)| advice) })
}

/// Whether a candidate is a test that was made: the same run, compared by the same signals.
fn is_repeat(candidate: &Test, test: &Test) -> bool {
    let names = |own: &Test| own.signals.iter().map(|signal| signal.name).collect::<Vec<_>>();
    let runs = [candidate, test].map(|own| Identity::from_model(own.study.model()).ok());
    !test.signals.is_empty() && names(candidate) == names(test) && runs[0].is_some() && runs[0] == runs[1]
}

/// A candidate, whose recording would be its own simulation at the best point.
fn candidate(given: &Dynamic, Calibrated { plan, fit, around, session }: &Calibrated<'_>) -> HostResult<Test> {
    let scenarios = &around.scenarios;
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
        return Err(refuse!("a candidate is compared by signals: what `{key}` would tell is not computed"));
    }
    let study = scenarios.changed(&Options { of: "a candidate", map: &map }, "`set` of a candidate", session)?;
    let best = study.with(plan.shared_changes(&fit.values, &plan.taken_by(&study, session)), session)?;
    let signals = match map.get("pull") {
        Some(given) => pulled::as_recorded(given, &best)?,
        None => super::recorded_test::as_recorded(&map, &study, &best.simulate(session)?)?,
    };
    map.insert("recordings".into(), signals.into());
    let tolerances = Tolerances { noise: Noise::Share(ASSUMED_NOISE), correlation: plan.correlation };
    let mut test = Test::read(&map.into(), scenarios, tolerances, session)?;
    let along = plan.tests.iter().flat_map(|test| &test.signals).find(|own| own.distance.is_residuals());
    // Contact makes simulated signals rough, which is noise as it is of the tests; the model's error is as smooth as theirs.
    for signal in &mut test.signals {
        let own = signal.recordings[0].clone();
        signal.errors.set_simulated(&own).map_err(|error| refuse!("{}: {error}", test.name))?;
        if let Some(along) = along {
            signal.errors.set_shape(along.errors.shape());
        }
    }
    Ok(test)
}

/// Derivatives of the residuals of a test by the coordinates of all unknowns, by central differences; of one that repeats a test,
/// by those that are its own, too.
fn derivatives(test: &Test, repeated: Option<usize>, done: &Calibrated<'_>) -> HostResult<DMatrix<f64>> {
    let Calibrated { plan, fit, session, .. } = *done;
    let shared = |index: &usize| plan.unknowns[*index].test.is_none();
    let shared = repeated.map_or_else(|| (0..plan.unknowns.len()).filter(shared).collect(), |own| plan.acting_on(own));
    let step = |index: usize| {
        let [low, high] = plan.parameter_at(index).within;
        let size = if fit.values[index] == 0.0 { 1.0 } else { fit.values[index].abs() };
        (plan.search.difference * size).min(0.25 * (high - low))
    };
    let points: Vec<(usize, f64)> = shared.iter().flat_map(|index| [(*index, 1.0), (*index, -1.0)]).collect();
    let taken = plan.taken_by(&test.study, session);
    // Tests without differences along a signal tell nothing of the model's error there: what is expected of it before.
    let share = if plan.has_residuals() { fit.share } else { plan.share_before() };
    let at = |(index, sign): &(usize, f64)| -> HostResult<Vec<f64>> {
        let mut values = fit.values.clone();
        let [low, high] = plan.parameter_at(*index).within;
        values[*index] = (values[*index] + sign * step(*index)).clamp(low, high);
        let shared = || plan.shared_changes(&values, &taken);
        let changes = repeated.map_or_else(shared, |own| plan.changes(own, &values));
        let study = test.compared_study().with(changes, session)?;
        let simulated = test.simulated(&study, session)?;
        let mut residuals = vec![values[*index]];
        for (signal, simulated) in test.signals.iter().zip(&simulated) {
            residuals.extend(signal.residuals(simulated, share, false).map_err(refuse)?);
        }
        Ok(residuals)
    };
    let found = run_list(session, &points, at)?;
    let length = found.first().map_or(0, |own| own.len() - 1);
    let mut jacobian = DMatrix::zeros(length, plan.unknowns.len());
    for (place, index) in shared.iter().enumerate() {
        let (up, down) = (&found[2 * place], &found[2 * place + 1]);
        let slope = plan.parameter_at(*index).slope(fit.values[*index]);
        for row in 0..length {
            jacobian[(row, *index)] = slope * (up[row + 1] - down[row + 1]) / (up[0] - down[0]);
        }
    }
    Ok(jacobian * (test.weight * test.of_signals).sqrt())
}
