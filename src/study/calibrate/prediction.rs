//! What follows from a posterior for scenarios that are no tests: bands on signals, quantiles of figures, probabilities.

use rayon::prelude::*;
use serde_json::json;

use super::objective::cause;
use super::plan::Plan;
use super::posterior::Posterior;
use super::rows::object;
use super::warning::Warning;
use crate::post::Run;
use crate::scenario_functions::Study;
use crate::script::{HostResult, Row, Session, refuse};
use lab::signal::Series;
use plot::{Curve, Look, Plot};
use uncertainty::statistics::{mean, quantiles, variance, wilson};

/// Places of a band.
const PLACES: usize = 200;
/// Probabilities of the ends of a band, and of its middle.
const BAND: [f64; 3] = [0.025, 0.5, 0.975];

/// What is asked of a prediction.
pub(super) struct Asked {
    /// Draws of the posterior.
    pub(super) samples: usize,
    /// Figures; all numbers that vary where none are named.
    pub(super) figures: Vec<String>,
    /// Signals with a band.
    pub(super) signals: Vec<String>,
    /// Figures and limits whose probability of being exceeded is asked for.
    pub(super) above: Vec<(String, f64)>,
    pub(super) seed: u64,
}

/// The prediction of one scenario.
#[derive(Clone)]
pub(super) struct Prediction {
    /// Rows of figures: quantiles, and which part of the variance is whose.
    pub(super) figures: Vec<Row>,
    /// Rows of probabilities.
    pub(super) probabilities: Vec<Row>,
    pub(super) bands: Vec<Plot>,
    /// Share of a recording that lies in the band of 95 %, where the scenario names one.
    pub(super) covered: Vec<Row>,
    pub(super) warnings: Vec<Warning>,
}

impl Prediction {
    /// Runs a scenario, which tables call `name`, with draws of the posterior.
    pub(super) fn of(
        name: &str,
        study: &Study,
        plan: &Plan,
        posterior: &Posterior,
        asked: &Asked,
        session: &Session,
    ) -> HostResult<Prediction> {
        let draws = posterior.draws(plan, asked.samples, asked.seed);
        let taken = plan.taken_by(study, session);
        let all: Vec<(Result<Run, String>, f64)> =
            draws.par_iter().map(|(x, share)| (run(study, plan, (x, &taken), session), *share)).collect();
        if session.cancellation().is_cancelled() {
            return Err(refuse("the study was stopped"));
        }
        let mut warnings = Vec::new();
        for unknown in plan.unknowns.iter().filter(|unknown| !taken.contains(&unknown.parameter)) {
            let (scenario, parameter) = (name.into(), unknown.name.clone());
            warnings.push(Warning::PredictionWithout { scenario, parameter });
        }
        let failed = all.iter().filter(|(run, _)| run.is_err()).count();
        if let Some(cause) = all.iter().find_map(|(run, _)| run.as_ref().err().cloned()) {
            let runs = all.len();
            warnings.push(Warning::PredictionFailed { scenario: name.into(), failed, runs, cause });
        }
        let runs: Vec<(Run, f64)> = all.into_iter().filter_map(|(run, share)| Some((run.ok()?, share))).collect();
        if runs.len() < 2 {
            let cause = warnings.last().map(ToString::to_string).unwrap_or_default();
            return Err(refuse(format!("{name} has no prediction: {cause}")));
        }
        let (mut bands, mut covered) = (Vec::new(), Vec::new());
        for signal in &asked.signals {
            let (plot, inside) = band((name, study), signal, &runs)?;
            bands.push(plot);
            covered.extend(inside);
        }
        Ok(Prediction {
            figures: figures(name, plan, asked, &draws, &runs),
            probabilities: probabilities(name, asked, &runs),
            bands,
            covered,
            warnings,
        })
    }
}

/// The run of a scenario with the shared unknowns of a draw.
fn run(study: &Study, plan: &Plan, (x, taken): (&[f64], &[usize]), session: &Session) -> Result<Run, String> {
    study
        .with(plan.shared_changes(&plan.values(x), taken), session)
        .and_then(|own| own.simulate(session))
        .map_err(|error| cause(&error))
}

/// The number of a figure in a run; whether something is so counts as one or zero.
fn number(run: &Run, figure: &str) -> Option<f64> {
    let value = run.summary().get(figure)?;
    value.as_f64().or_else(|| value.as_bool().map(|own| f64::from(u8::from(own)))).filter(|own| own.is_finite())
}

/// A row a figure: quantiles, and the shares of the variance that one parameter alone explains, by a linear fit.
fn figures(scenario: &str, plan: &Plan, asked: &Asked, draws: &[(Vec<f64>, f64)], runs: &[(Run, f64)]) -> Vec<Row> {
    let names: Vec<String> = match asked.figures.is_empty() {
        false => asked.figures.clone(),
        true => {
            let all = runs[0].0.summary();
            let varies = |name: &&String| {
                let own: Vec<f64> = runs.iter().filter_map(|(run, _)| number(run, name)).collect();
                own.len() == runs.len() && own.iter().any(|value| *value != own[0]) && crate::post::is_key_figure(name)
            };
            all.keys().filter(varies).cloned().collect()
        }
    };
    let row = |name: &String| {
        let own: Vec<f64> = runs.iter().filter_map(|(run, _)| number(run, name)).collect();
        let ends = quantiles(&own, &BAND)?;
        let mut row = object(json!({
            "scenario": scenario, "figure": name, "median": ends[1], "lower_95": ends[0], "upper_95": ends[2],
            "mean": mean(&own), "runs": own.len(),
        }));
        if own.len() == draws.len() {
            for (index, unknown) in plan.unknowns.iter().enumerate().filter(|(_, unknown)| unknown.test.is_none()) {
                let along: Vec<f64> = draws.iter().map(|(x, _)| x[index]).collect();
                let share = correlation(&along, &own).map(|r| r * r);
                row.insert(format!("share_of_{}", unknown.name), json!(share));
            }
        }
        Some(row)
    };
    names.iter().filter_map(row).collect()
}

/// Pearson's correlation; none where one of the two does not vary.
fn correlation(one: &[f64], other: &[f64]) -> Option<f64> {
    let (a, b) = (mean(one)?, mean(other)?);
    let product: f64 = one.iter().zip(other).map(|(x, y)| (x - a) * (y - b)).sum::<f64>() / (one.len() as f64 - 1.0);
    let size = (variance(one)? * variance(other)?).sqrt();
    (size > 0.0).then(|| product / size)
}

/// Probabilities of a rupture and of limits that are exceeded, with their interval of 95 % (Wilson).
fn probabilities(scenario: &str, asked: &Asked, runs: &[(Run, f64)]) -> Vec<Row> {
    let ruptured = ("ruptured".to_owned(), 0.5);
    let all = std::iter::once(&ruptured).chain(&asked.above);
    let row = |(figure, limit): &(String, f64)| {
        let found: Vec<f64> = runs.iter().filter_map(|(run, _)| number(run, figure)).collect();
        let count = found.iter().filter(|value| **value > *limit).count();
        let interval = (!found.is_empty()).then(|| wilson(count as u64, found.len() as u64, 0.95))?;
        let what = if figure == "ruptured" { "film breaks".to_owned() } else { format!("{figure} above {limit}") };
        Some(object(json!({
            "scenario": scenario, "what": what, "probability": count as f64 / found.len() as f64,
            "lower_95": interval.low, "upper_95": interval.high, "runs": found.len(),
        })))
    };
    all.filter_map(row).collect()
}

/// The band of a signal: of the parameters, and with the model's error of each draw; and what of the recording lies in it.
fn band((scenario, study): (&str, &Study), name: &str, runs: &[(Run, f64)]) -> HostResult<(Plot, Option<Row>)> {
    let signals = runs.iter().map(|(run, share)| Ok((run.channel(name)?, *share))).collect::<HostResult<Vec<_>>>()?;
    let end = signals.iter().filter_map(|(own, _)| own.time().last().copied()).fold(f64::INFINITY, f64::min);
    let start = signals.iter().filter_map(|(own, _)| own.time().first().copied()).fold(f64::NEG_INFINITY, f64::max);
    let column = lab::signal::column::COLUMNS.iter().find(|column| column.short == name);
    let (factor, axis) = column.map_or((1.0, name), |column| (column.factor, column.axis));
    let level = |own: &Series| {
        let values = own.values();
        (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
    };
    let levels: Vec<f64> = signals.iter().map(|(own, _)| level(own)).collect();
    let (mut inner, mut outer) = (Vec::new(), Vec::new());
    let places: Vec<f64> =
        (0..=PLACES).map(|place| (start + (end - start) * place as f64 / PLACES as f64).min(end)).collect();
    for place in &places {
        let own: Vec<(f64, f64)> = signals
            .iter()
            .zip(&levels)
            .filter_map(|((own, share), level)| Some((own.value_at(*place)?, share * level)))
            .collect();
        let values: Vec<f64> = own.iter().map(|(value, _)| *value).collect();
        inner.push(quantiles(&values, &BAND).ok_or_else(|| refuse(format!("{name} has no value at {place}")))?);
        outer.push(mixture(&own));
    }
    let curve = |title: &str, look, of: &dyn Fn(usize) -> f64| Curve {
        name: title.into(),
        points: places.iter().enumerate().map(|(at, place)| [1e3 * place, factor * of(at)]).collect(),
        look,
    };
    let mut curves = vec![
        curve("median", Look::Line, &|at| inner[at][1]),
        curve("2.5 %, parameters", Look::Dashed, &|at| inner[at][0]),
        curve("97.5 %, parameters", Look::Dashed, &|at| inner[at][2]),
        curve("2.5 %, with the model's error", Look::Dashed, &|at| outer[at][0]),
        curve("97.5 %, with the model's error", Look::Dashed, &|at| outer[at][1]),
    ];
    let comparison = study.comparison().ok();
    let recorded = comparison.and_then(|own| match name {
        "acceleration" => own.acceleration.clone(),
        "displacement" => own.displacement.clone(),
        _ => None,
    });
    let covered = recorded.zip(comparison).map(|(recorded, comparison)| {
        let inside = recorded.window(comparison.window);
        let points = inside.samples().map(|[time, value]| [1e3 * time, factor * value]).collect();
        curves.push(Curve { name: "recording".into(), points, look: Look::Line }.thinned(3 * PLACES));
        let found: Vec<bool> = places
            .iter()
            .zip(&outer)
            .filter_map(|(place, [low, high])| inside.value_at(*place).map(|value| (*low..=*high).contains(&value)))
            .collect();
        let share = found.iter().filter(|own| **own).count() as f64 / found.len().max(1) as f64;
        object(json!({ "scenario": scenario, "signal": name, "share_within_band": share, "places": found.len() }))
    });
    let title = format!("{scenario}: {name}, predicted");
    Ok((Plot::new(title, ["time (ms)", axis], curves), covered))
}

/// Ends of 95 % of a mixture of normal distributions of equal weight, by bisection.
fn mixture(own: &[(f64, f64)]) -> [f64; 2] {
    let below = |y: f64| {
        let part = |(value, deviation): &(f64, f64)| match *deviation > 0.0 {
            true => uncertainty::normal::cumulative((y - value) / deviation),
            false => f64::from(u8::from(y >= *value)),
        };
        own.iter().map(part).sum::<f64>() / own.len() as f64
    };
    let reach = own.iter().map(|(_, deviation)| 8.0 * deviation).fold(0.0, f64::max);
    let low = own.iter().map(|(value, _)| *value).fold(f64::INFINITY, f64::min) - reach;
    let high = own.iter().map(|(value, _)| *value).fold(f64::NEG_INFINITY, f64::max) + reach;
    [BAND[0], BAND[2]].map(|probability| {
        let (mut from, mut to) = (low, high);
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if below(middle) < probability { from = middle } else { to = middle }
        }
        0.5 * (from + to)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mixture_has_the_ends_of_its_normal_distributions() {
        let found = mixture(&[(1.0, 2.0), (1.0, 2.0)]);
        assert!((found[0] - (1.0 - 1.959_964 * 2.0)).abs() < 1e-5 && (found[1] - (1.0 + 1.959_964 * 2.0)).abs() < 1e-5);
        // Two values far apart: 5 % of the left one lie below, of the right one above.
        let found = mixture(&[(0.0, 1.0), (100.0, 1.0)]);
        assert!((found[0] + 1.644_854).abs() < 1e-5 && (found[1] - 101.644_854).abs() < 1e-5, "{found:?}");
    }
}
