//! Probabilities of failure and the staircase in scripts.

use rhai::{Array, Dynamic, EvalAltResult};
use serde_json::{Value, json};
use uncertainty::normal;
use uncertainty::random::Stream;
use uncertainty::reliability::{
    Probability, ReliabilityError, SamplingOptions, SubsetOptions, monte_carlo, subset_simulation,
};
use uncertainty::staircase::{Counts, Outcome, ProbitError, ProbitFit, Staircase, probit};

use super::common::{Host, assignment, refused, varied, whole};
use crate::scenario_functions::Study;
use crate::script::{Entry, HostResult, Options, Session, from_json, number, refuse, refuse_key};
use crate::sweep::{Sweep, SweepError, Warning};
use base::finding::Finding;
use base::removed;
use scene::model;
use scene::scenario::Document;

/// Confidence of intervals.
const CONFIDENCE: f64 = 0.95;

/// The condition of a failure: a figure above or below a limit.
struct Limit {
    figure: String,
    limit: f64,
    above: bool,
}

impl Limit {
    fn read(options: &Options<'_>) -> HostResult<Limit> {
        let figure = options.value("figure")?.clone().into_string();
        let figure = figure.map_err(|found| refuse(format!("expected the name of a figure, found {found}")))?;
        match (options.map.contains_key("above"), options.map.contains_key("below")) {
            (true, false) => Ok(Limit { figure, limit: options.needed_number("above")?, above: true }),
            (false, true) => Ok(Limit { figure, limit: options.needed_number("below")?, above: false }),
            _ => Err(refuse("give either `above` or `below`, the limit beyond which the test fails")),
        }
    }

    /// The limit state: below zero where the test fails.
    fn state(&self, value: f64) -> f64 {
        if self.above { self.limit - value } else { value - self.limit }
    }
}

/// `failure_probability(scenario, #{ … })`.
pub(super) fn failure_probability(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "figure", "above", "below", "method", "samples", "seed"])?;
    let limit = Limit::read(options)?;
    let document = varied(study, options)?;
    let variation = model::variation(&document).map_err(|mistakes| refused(SweepError::Scenario(mistakes)))?;
    let inputs = variation.ok_or_else(|| refused(SweepError::NothingVaries))?.factors.len();
    let seed = whole(options, "seed", 1)? as u64;
    let samples = whole(options, "samples", 500)?;
    let mut failed: Option<Box<EvalAltResult>> = None;
    let mut limit_state = |points: &[Vec<f64>]| {
        let outputs = if failed.is_some() { None } else { Some(outputs(&document, points, &limit, host)) };
        match outputs {
            Some(Ok(outputs)) => outputs,
            Some(Err(error)) => {
                failed = Some(error);
                vec![None; points.len()]
            }
            None => vec![None; points.len()],
        }
    };
    let method = options.map.get("method").map_or_else(|| "subset".to_owned(), Dynamic::to_string);
    let sampling = SamplingOptions { samples, seed, confidence: CONFIDENCE, ..SamplingOptions::default() };
    let mut warning = None;
    let found = match method.as_str() {
        "subset" => {
            let options = SubsetOptions { samples, seed, confidence: CONFIDENCE, ..SubsetOptions::default() };
            subset_simulation(inputs, &options, &mut limit_state).map(|found| {
                if !found.reached {
                    let below = found.probability.interval.high;
                    let (figure, levels) = (limit.figure.clone(), found.thresholds.len());
                    warning = Some(Warning::NotReached { figure, levels, below });
                }
                let mut map = figures(&found.probability);
                map["thresholds"] = json!(found.thresholds);
                map
            })
        }
        "monte-carlo" => monte_carlo(inputs, &sampling, &mut limit_state).map(|found| figures(&found)),
        other => {
            let message = format!("method is \"subset\" or \"monte-carlo\", not \"{other}\"");
            return Err(refuse_key("method", &message, removed::function(&format!("failure_probability.{other}"))));
        }
    };
    if let Some(error) = failed {
        return Err(error);
    }
    host.session.report(warning.iter().map(Finding::new));
    found.map(|found| from_json(&found)).map_err(|error| match error {
        ReliabilityError::NoProgress { .. } => {
            let hint = "a figure with few values, such as `ruptured`, takes method: \"monte-carlo\"";
            refuse_key("figure", &error.to_string(), Some(hint.into()))
        }
        _ => refuse(error),
    })
}

/// The figures of a probability.
fn figures(found: &Probability) -> Value {
    let Probability { value, variation, interval, evaluations, missing } = found;
    json!({
        "probability": value, "variation": variation, "interval": [interval.low, interval.high], "runs": evaluations,
        "missing": missing,
    })
}

/// The limit state at points of the standard normal space.
fn outputs(document: &Document, points: &[Vec<f64>], limit: &Limit, host: &Host<'_>) -> HostResult<Vec<Option<f64>>> {
    let unit = |z: &f64| normal::cumulative(*z).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON);
    let places: Vec<Vec<f64>> = points.iter().map(|point| point.iter().map(unit).collect()).collect();
    let sweep = Sweep::prepare_at(document, &places).map_err(refused)?;
    let results = host.results(&sweep)?;
    let values = match results.table.column(&limit.figure) {
        Some(column) => column.values.numbers(),
        None if results.failed == points.len() => return Ok(vec![None; points.len()]),
        None => return Err(refuse(format!("the runs have no figure `{}`", limit.figure))),
    };
    let state = |(row, value): (usize, Option<f64>)| match results.table.failure(row) {
        Some(_) => None,
        None => value.map(|value| limit.state(value)),
    };
    Ok(values.into_iter().enumerate().map(state).collect())
}

/// `staircase(scenario, #{ … })`.
pub(super) fn staircase(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "key", "start", "step", "specimens", "figure", "above", "below", "seed"])?;
    let key = options.value("key")?.to_string();
    let count = whole(options, "specimens", 20)?;
    let mut stream = Stream::new(whole(options, "seed", 1)? as u64);
    let limit = if options.map.contains_key("figure") {
        Limit::read(options)?
    } else {
        Limit { figure: "ruptured".into(), limit: 0.5, above: true }
    };
    let step = options.needed_number("step")?;
    let stairs = Staircase::new(options.needed_number("start")?, step).map_err(refuse)?;
    let document = varied(study, options)?;
    let factors = document.varied_keys().len();
    let mut outcomes: Vec<Outcome> = vec![];
    for _ in 0..count {
        let level = stairs.next_level(&outcomes);
        let specimen = specimen(&document, &key, level, step)?;
        let place: Vec<f64> = (0..factors).map(|_| stream.normal()).collect();
        let output = outputs(&specimen, &[place], &limit, host)?;
        let state = output.first().copied().flatten();
        let state = state.ok_or_else(|| refuse(format!("the run at {key} = {level} failed")))?;
        outcomes.push(if state < 0.0 { Outcome::Failed } else { Outcome::Survived });
    }
    let reduction = stairs.reduce(&outcomes, CONFIDENCE).map_err(refuse)?;
    let fit = strength(&stairs.counts(&outcomes), &host.session)?;
    let failed: Vec<bool> = outcomes.iter().map(|outcome| *outcome == Outcome::Failed).collect();
    let found = json!({
        "level": reduction.mean,
        "deviation": reduction.deviation,
        "interval": reduction.interval.map(|interval| [interval.low, interval.high]),
        "levels": stairs.levels(&outcomes),
        "failed": failed,
        "probit": fit.as_ref().map(fitted),
    });
    Ok(from_json(&found))
}

/// The scenario with the key at a level.
fn specimen(document: &Document, key: &str, level: f64, step: f64) -> HostResult<Document> {
    // Sums of steps leave zero by round-off.
    let level = if level.abs() < 1e-9 * step.abs() { 0.0 } else { level };
    let is_whole = level.fract() == 0.0 && level.abs() < 1e15;
    let value = if is_whole { json!(level as i64) } else { json!(level) };
    let specimen = document.with(&[assignment(key, &value)?]);
    model::check(&specimen).map_err(|mistakes| {
        let why = mistakes.first().map_or_else(String::new, |mistake| mistake.message.to_string());
        let hint = "start further from what the key may be, or with a smaller step";
        refuse_key(
            "start",
            &format!("the staircase came to {key} = {level}, which the scenario does not take: {why}"),
            Some(hint.into()),
        )
    })?;
    Ok(specimen)
}

/// A fit as scripts see it; ends of intervals that are infinite are ().
fn fitted(fit: &ProbitFit) -> Value {
    json!({
        "level": fit.mean.value,
        "interval": fit.mean.interval.map(|interval| [interval.low, interval.high]),
        "deviation": fit.deviation.value,
        "deviation_interval": fit.deviation.interval.map(|interval| [interval.low, interval.high]),
    })
}

/// The fit of specimens; none, and a finding that says why, where they have none.
fn strength(counts: &[Counts], session: &Session) -> HostResult<Option<ProbitFit>> {
    match probit(counts, CONFIDENCE) {
        Ok(fit) => Ok(Some(fit)),
        Err(error @ ProbitError::Counts { .. }) => Err(refuse(error.to_string())),
        Err(reason) => {
            session.report([Finding::new(&Warning::NoStrengthFit { reason })]);
            Ok(None)
        }
    }
}

/// `probit(levels, failed)`: () and a finding where the outcomes have no fit.
pub(super) fn probit_of(levels: &Array, failed: &Array, session: &Session) -> HostResult<Dynamic> {
    if levels.len() != failed.len() {
        return Err(refuse(format!("{} levels, but {} outcomes", levels.len(), failed.len())));
    }
    let specimen = |(level, failed): (&Dynamic, &Dynamic)| {
        let failed =
            failed.as_bool().map_err(|found| refuse(format!("expected a Boolean, found a value of type {found}")))?;
        Ok(Counts { level: number(level, "a level")?, trials: 1, failures: u64::from(failed) })
    };
    let counts = levels.iter().zip(failed).map(specimen).collect::<HostResult<Vec<Counts>>>()?;
    Ok(strength(&counts, session)?.map_or(Dynamic::UNIT, |fit| from_json(&fitted(&fit))))
}

/// The reference of reliability in scripts.
pub(super) const ENTRIES: &[Entry] = &[
    Entry {
        call: "failure_probability(scenario, #{ figure, above, method, samples, vary, seed })",
        gives: "the probability that a figure is above a limit (or `below`), a figure equal to it being neither: `probability`, its \
                `interval` (95 %; of subset simulation a bound that covers at least 95 %) and coefficient of `variation` (of subset \
                simulation at most), `runs`, `missing`. Methods: \"subset\" simulation (so many samples a level, 500 where none are \
                given), \"monte-carlo\". Where no run fails, the probability is 0 and the end of its interval a bound",
        example: "failure_probability(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ figure: \"peak_displacement_m\", above: -4.1e-3, method: \"monte-carlo\", samples: 16, \
                  vary: #{ \"loading.impact.velocity\": #{ uniform: [4.0, 4.2] } } }).probability > 0.2",
    },
    Entry {
        call: "staircase(scenario, #{ key, start, step, specimens, vary, seed })",
        gives: "the level of a key (SI) at which half of the specimens rupture, by the up-and-down method (Dixon and Mood; 20 specimens where \
                none are given): `level`, `deviation`, `interval`, `levels`, `failed`, and the fit of `probit`; with `figure` and `above` \
                or `below`, what else counts as failure",
        example: "let found = staircase(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ key: \"loading.impact.velocity\", start: 4.0, step: 0.05, specimens: 8, figure: \"peak_displacement_m\", below: -4.1e-3, \
                  vary: #{ \"impactor.friction\": #{ uniform: [0.1, 0.3] } } }); found.level > 3.9 && found.levels.len() == 8",
    },
    Entry {
        call: "probit(levels, failed)",
        gives: "the normal distribution of the strength by maximum likelihood from specimens that each failed (true) or not at a level: \
                `level` at which half fail, `deviation`, and their 95 % intervals `interval` and `deviation_interval` by the profile \
                likelihood, of which an end that the outcomes leave open is (); () and a finding (`no-strength-fit`) \
                that says why where the outcomes have no fit, as where the levels of both do not overlap",
        example: "let fit = probit([1.0, 2.0, 3.0, 2.0, 3.0, 4.0, 3.0, 2.0], [false, false, true, false, false, true, true, true]); \
                  fit.level > 2.0 && fit.level < 3.0 && fit.deviation_interval[0] < fit.deviation && probit([1, 2], [false, true]) == ()",
    },
];
