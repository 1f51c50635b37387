//! Many runs in scripts: sweeps, sensitivity, reliability, the staircase.

use std::sync::Arc;

use rhai::{Array, Dynamic, Engine, EvalAltResult, Map, NativeCallContext};
use serde_json::{Value, json};

use crate::evaluate::Evaluations;
use crate::scenario_functions::ScenarioHandle;
use crate::script::{HostResult, Options, Session, check_stop, from_json, number, refuse, refuse_key, to_json};
use crate::sweep::table::Table;
use crate::sweep::work::{Done, Stop, Work};
use crate::sweep::{Sweep, SweepError, SweepResults, Warning};
use base::finding::Finding;
use base::removed;
use base::table::{Column, Values};
use scene::model::{self, Factor, Variation};
use scene::scenario::{Assignment, Document};
use uncertainty::design::{self, Levels, Method};
use uncertainty::distribution::Family as Distributed;
use uncertainty::random::Stream;
use uncertainty::reliability::{Probability, Sampling, monte_carlo, subset_simulation};
use uncertainty::staircase::{Counts, Outcome, ProbitFit, Staircase, probit};
use uncertainty::statistics::Interval;
use uncertainty::surrogate::{Family, HIGHEST_DEGREE, Surrogate};
use uncertainty::{Kind, normal};

/// A function of a scenario and options.
type Function = fn(&ScenarioHandle, &Options<'_>, &Host<'_>) -> HostResult<Dynamic>;

/// Their names in scripts.
const FUNCTIONS: [(&str, Function); 4] = [
    ("sweep", sweep),
    ("surrogate", surrogate),
    ("failure_probability", failure_probability),
    ("staircase", staircase),
];

/// Offers sweeps to scripts; their runs are taken from `evaluations` and added to them.
pub fn register(engine: &mut Engine, evaluations: &Arc<Evaluations>) {
    for (name, function) in FUNCTIONS {
        let evaluations = Arc::clone(evaluations);
        engine.register_fn(name, move |context: NativeCallContext, scenario: &mut ScenarioHandle, options: Map| {
            let host = Host { evaluations: &evaluations, session: Session::from_context(&context) };
            function(scenario, &Options { of: name, map: &options }, &host)
        });
    }
    engine.register_fn("probit", |context: NativeCallContext, levels: Array, failed: Array| {
        probit_of(&levels, &failed, &Session::from_context(&context))
    });
}

/// The surroundings of a script's sweeps: kept evaluations and the session.
struct Host<'a> {
    evaluations: &'a Evaluations,
    session: Session,
}

impl Host<'_> {
    /// The results of a sweep.
    fn results(&self, sweep: &Sweep) -> HostResult<SweepResults> {
        let done = self.done(sweep)?;
        let found = SweepResults::from_evaluations(sweep, &done, self.evaluations).map_err(refuse)?;
        self.session.count_runs(&found.run_findings());
        Ok(found)
    }

    fn done(&self, sweep: &Sweep) -> HostResult<Done> {
        let (requested, given_up) = (self.session.stop().clone(), self.session.cancellation().clone());
        let stop = Stop { requested, given_up, deadline: None };
        let work = Work { sweep, evaluations: self.evaluations, waits: true, stop: &stop, gather: false };
        let done = work.run(&|_| {}).map_err(refuse)?;
        if done.len() < sweep.len() {
            check_stop(&self.session)?;
            return Err(refuse("the sweep was cancelled"));
        }
        Ok(done)
    }
}

/// The document of a scenario with what the options vary in place of what it varies itself.
fn varied(scenario: &ScenarioHandle, options: &Options<'_>) -> HostResult<Document> {
    let Some(keys) = options.map.get("vary") else { return Ok(scenario.document().clone()) };
    let unset = scenario.document().find("variation").map(|_| Assignment::unset("variation", "vary"));
    let changes: Vec<Assignment> = unset.into_iter().chain([assignment("variation", &to_json(keys)?)?]).collect();
    Ok(scenario.document().with(&changes))
}

/// What varies in a scenario.
fn variation(document: &Document) -> HostResult<Variation> {
    let variation = model::variation(document).map_err(|mistakes| refused(SweepError::Scenario(mistakes)))?;
    let variation = variation.ok_or_else(|| refused(SweepError::NothingVaries))?;
    if variation.is_table() {
        return Err(refuse("the rows of a table are given, nothing is drawn from them: `sweep` runs them"));
    }
    Ok(variation)
}

fn assignment(path: &str, value: &Value) -> HostResult<Assignment> {
    let value = toml::Value::try_from(value).map_err(|error| refuse!("{path}: {error}"))?;
    Assignment::from_value(path, &value, "options").map_err(|mistakes| refused(SweepError::Scenario(mistakes)))
}

fn refused(error: SweepError) -> Box<rhai::EvalAltResult> {
    refuse(match error {
        SweepError::Scenario(mistakes) => crate::sweep::refusal(&mistakes, &[]),
        SweepError::NothingVaries => "nothing varies: give `vary`, or a scenario with [variation]".into(),
        SweepError::Points(mistake) => mistake.message,
        SweepError::Prepare(error) => error.to_string(),
    })
}

/// The whole number in an option.
fn whole(options: &Options<'_>, name: &str, default: usize) -> HostResult<usize> {
    let Some(value) = options.map.get(name) else { return Ok(default) };
    let number = value.as_int().ok().and_then(|number| usize::try_from(number).ok()).filter(|number| *number > 0);
    number.ok_or_else(|| refuse!("expected a whole number above zero as {name}, found {value}"))
}

/// `sweep(scenario, #{ … })`.
fn sweep(scenario: &ScenarioHandle, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "samples", "seed", "method"])?;
    let sweep = Sweep::prepare(&designed(&varied(scenario, options)?, options)?, None).map_err(refused)?;
    let results = host.results(&sweep)?;
    let mut summary = results.summary(&sweep, 0.0);
    ["seconds", "engine_s", "scenario", "title", "droptower"].iter().for_each(|name| drop(summary.remove(*name)));
    summary.insert("table".into(), columns(&results.table));
    Ok(from_json(&Value::Object(summary)))
}

/// The scenario with what the options say of the design of its runs.
fn designed(document: &Document, options: &Options<'_>) -> HostResult<Document> {
    let given = ["samples", "seed", "method"].into_iter().filter_map(|name| Some((name, options.map.get(name)?)));
    let change = |(name, value): (&str, &Dynamic)| assignment(&format!("variation.{name}"), &to_json(value)?);
    Ok(document.with(&given.map(change).collect::<HostResult<Vec<_>>>()?))
}

/// The columns of a table by name.
fn columns(table: &Table) -> Value {
    let values = |column: &Column| match &column.values {
        Values::Numbers(values) => json!(values),
        Values::Flags(values) => json!(values),
        Values::Texts(values) => json!(values),
    };
    table.columns.iter().map(|column| (column.name.clone(), values(column))).collect()
}

/// `surrogate(scenario, #{ … })`.
fn surrogate(scenario: &ScenarioHandle, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "samples", "seed", "figures"])?;
    let samples = whole(options, "samples", 128)?;
    let seed = whole(options, "seed", 1)? as u64;
    let asked = options.map.get("figures").cloned().map(Dynamic::into_typed_array::<String>).transpose();
    let asked = asked.map_err(|found| refuse!("expected a list of names as figures, found {found}"))?;
    let document = varied(scenario, options)?;
    let variation = variation(&document)?;
    if !variation.is_independent() {
        return Err(refuse(
            "the shares of a surrogate are of independent keys, and these are correlated; `sweep` takes correlated ones",
        ));
    }
    let factors = variation.factors;
    let axes = vec![Levels::Continuous; factors.len()];
    let points = design::points(Method::Sobol, &axes, samples, seed).map_err(refuse)?;
    let sweep = Sweep::prepare_at(&document, points.clone()).map_err(refused)?;
    let results = host.results(&sweep)?;
    let families: Vec<Family> = factors.iter().map(family).collect();
    let of_keys = |values: Option<Vec<f64>>| -> Value {
        factors.iter().map(|factor| factor.path.clone()).zip(values.into_iter().flatten()).collect()
    };
    let varying = || results.effects.iter().map(|effects| effects.figure.clone()).collect();
    let mut found = serde_json::Map::new();
    for name in asked.unwrap_or_else(varying) {
        let column = results.table.column(&name);
        let column = column.ok_or_else(|| refuse!("the runs have no figure `{name}`"))?;
        let fit = Surrogate::fit(&families, &points, &column.values.numbers(), HIGHEST_DEGREE);
        let fit = fit.map_err(|error| refuse!("{name}: {error}"))?;
        let figures = json!({
            "q2": fit.q2(), "degree": fit.degree(), "terms": fit.terms(), "mean": fit.mean(), "deviation": fit.variance().sqrt(),
            "first": of_keys(fit.first()), "total": of_keys(fit.total()),
        });
        found.insert(name, figures);
    }
    Ok(from_json(&Value::Object(found)))
}

/// Polynomials that suit the distribution of a key.
fn family(factor: &Factor) -> Family {
    let model::Values::Distribution(distribution) = &factor.values else { return Family::Legendre };
    let is_whole = distribution.ends() == (None, None);
    match distribution.family() {
        Distributed::Normal { .. } | Distributed::LogNormal { .. } if is_whole => Family::Hermite,
        _ => Family::Legendre,
    }
}

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
        let figure = figure.map_err(|found| refuse!("expected the name of a figure, found {found}"))?;
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
fn failure_probability(scenario: &ScenarioHandle, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "figure", "above", "below", "method", "samples", "seed"])?;
    let limit = Limit::read(options)?;
    let document = varied(scenario, options)?;
    let inputs = variation(&document)?.factors.len();
    let seed = whole(options, "seed", 1)? as u64;
    let samples = whole(options, "samples", 500)?;
    let mut failed: Option<Box<EvalAltResult>> = None;
    let mut limit_state = |points: &[Vec<f64>]| {
        let none = vec![None; points.len()];
        if failed.is_some() {
            return none;
        }
        outputs(&document, points, &limit, host).unwrap_or_else(|error| {
            failed = Some(error);
            none
        })
    };
    let method = options.map.get("method").map_or_else(|| "subset".to_owned(), Dynamic::to_string);
    let sampling = Sampling { samples, seed, confidence: CONFIDENCE };
    let mut warning = None;
    let found = match method.as_str() {
        "subset" => subset_simulation(inputs, &sampling, &mut limit_state).map(|found| {
            if !found.reached {
                let below = found.probability.interval.high;
                let (figure, levels) = (limit.figure.clone(), found.thresholds.len());
                warning = Some(Warning::NotReached { figure, levels, below });
            }
            let mut map = figures(&found.probability);
            map["thresholds"] = json!(found.thresholds);
            map
        }),
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
    found.map(|found| from_json(&found)).map_err(|error| match error.kind {
        Kind::NoProgress => {
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
        "probability": value, "variation": variation, "interval": interval.ends(), "runs": evaluations,
        "missing": missing,
    })
}

/// The limit state at points of the standard normal space.
fn outputs(document: &Document, points: &[Vec<f64>], limit: &Limit, host: &Host<'_>) -> HostResult<Vec<Option<f64>>> {
    let unit = |z: &f64| normal::cumulative(*z).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON);
    let places: Vec<Vec<f64>> = points.iter().map(|point| point.iter().map(unit).collect()).collect();
    let sweep = Sweep::prepare_at(document, places).map_err(refused)?;
    let results = host.results(&sweep)?;
    let values = match results.table.column(&limit.figure) {
        Some(column) => column.values.numbers(),
        None if results.failed == points.len() => return Ok(vec![None; points.len()]),
        None => return Err(refuse!("the runs have no figure `{}`", limit.figure)),
    };
    let state = |(row, value): (usize, Option<f64>)| match results.table.failure(row) {
        Some(_) => None,
        None => value.map(|value| limit.state(value)),
    };
    Ok(values.into_iter().enumerate().map(state).collect())
}

/// `staircase(scenario, #{ … })`.
fn staircase(scenario: &ScenarioHandle, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
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
    let document = varied(scenario, options)?;
    let factors = variation(&document)?.factors.len();
    let mut outcomes: Vec<Outcome> = vec![];
    for _ in 0..count {
        let level = stairs.next_level(&outcomes);
        let specimen = specimen(&document, &key, level, step)?;
        let place: Vec<f64> = (0..factors).map(|_| stream.normal()).collect();
        let output = outputs(&specimen, &[place], &limit, host)?;
        let state = output.first().copied().flatten();
        let state = state.ok_or_else(|| refuse!("the run at {key} = {level} failed"))?;
        outcomes.push(if state < 0.0 { Outcome::Failed } else { Outcome::Survived });
    }
    let reduction = stairs.reduce(&outcomes, CONFIDENCE).map_err(refuse)?;
    let fit = strength(&stairs.counts(&outcomes), &host.session)?;
    let failed: Vec<bool> = outcomes.iter().map(|outcome| *outcome == Outcome::Failed).collect();
    let found = json!({
        "level": reduction.mean,
        "deviation": reduction.deviation,
        "interval": reduction.interval.map(Interval::ends),
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
        "interval": fit.mean.interval.map(Interval::ends),
        "deviation": fit.deviation.value,
        "deviation_interval": fit.deviation.interval.map(Interval::ends),
    })
}

/// The fit of specimens; none, and a finding that says why, where they have none.
fn strength(counts: &[Counts], session: &Session) -> HostResult<Option<ProbitFit>> {
    match probit(counts, CONFIDENCE) {
        Ok(fit) => Ok(Some(fit)),
        Err(reason) if reason.kind == Kind::NoFit => {
            session.report([Finding::new(&Warning::NoStrengthFit { reason })]);
            Ok(None)
        }
        Err(error) => Err(refuse(error)),
    }
}

/// `probit(levels, failed)`: () and a finding where the outcomes have no fit.
fn probit_of(levels: &Array, failed: &Array, session: &Session) -> HostResult<Dynamic> {
    if levels.len() != failed.len() {
        return Err(refuse!("{} levels, but {} outcomes", levels.len(), failed.len()));
    }
    let specimen = |(level, failed): (&Dynamic, &Dynamic)| {
        let failed = failed.as_bool().map_err(|found| refuse!("expected a Boolean, found a value of type {found}"))?;
        Ok(Counts { level: number(level, "a level")?, trials: 1, failures: u64::from(failed) })
    };
    let counts = levels.iter().zip(failed).map(specimen).collect::<HostResult<Vec<Counts>>>()?;
    Ok(strength(&counts, session)?.map_or(Dynamic::UNIT, |fit| from_json(&fitted(&fit))))
}
