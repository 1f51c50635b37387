//! What follows from a posterior for scenarios that are no tests: bands on signals, quantiles of figures, probabilities.

use std::collections::BTreeMap;

use serde_json::json;

use super::error_model::{ErrorModel, ErrorSize, Noise, Recorded, Shape, root_mean_square};
use super::outcome::{self, BREAK_FACTORS};
use super::parameter::{Role, Unknown};
use super::plan::{BreakUnknowns, Plan};
use super::posterior::{Draw, Posterior};
use super::recorded_test::found_column;
use super::warning::Warning;
use crate::post::{self, Run, is_known, is_result};
use crate::scenario_functions::ScenarioHandle;
use crate::script::{HostResult, Row, Session, cause, object, refuse, run_list};
use base::diagnostic::did_you_mean;
use lab::signal::Series;
use plot::{Curve, Look, Plot};
use uncertainty::normal::{cumulative, quantile};
use uncertainty::statistics::{mean, predictive_quantiles, variance, wilson};

/// Places of a band.
const PLACES: usize = 200;
/// Probabilities of the ends of a band, and of its middle.
const BAND: [f64; 3] = [0.025, 0.5, 0.975];

/// Share of a recording within the band of 95 % below which a finding says so.
const LEAST_WITHIN: f64 = 0.8;

/// What is asked of a prediction.
pub(super) struct Asked {
    /// Draws of the posterior.
    pub(super) samples: usize,
    /// Figures; all that vary of those by which films are judged where none are named.
    pub(super) figures: Vec<String>,
    /// Signals with a band.
    pub(super) signals: Vec<String>,
    /// Figures and limits whose probability of being exceeded is asked for.
    pub(super) above: Vec<(String, f64)>,
    /// Errors of the model in figures, relative standard deviations, where any are known.
    pub(super) errors: BTreeMap<String, f64>,
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
    pub(super) fn new(
        name: &str,
        study: &ScenarioHandle,
        posterior: &Posterior,
        asked: &Asked,
        session: &Session,
    ) -> HostResult<Prediction> {
        let plan = &*posterior.plan;
        let draws = posterior.draws(asked.samples, asked.seed);
        let drawn = Drawn::new(study, plan, session);
        let all = run_list(session, &draws, |draw| Ok((drawn.run(draw, session), draw.error)))?;
        let mut warnings = Vec::new();
        for unknown in plan.unknowns.iter().filter(|unknown| !drawn.takes(unknown)) {
            let (scenario, parameter, why) = (name.into(), unknown.name.clone(), drawn.why_without(unknown));
            warnings.push(Warning::PredictionWithout { scenario, parameter, why });
        }
        let failed = all.iter().filter(|(run, _)| run.is_err()).count();
        if let Some(cause) = all.iter().find_map(|(run, _)| run.as_ref().err().cloned()) {
            let runs = all.len();
            warnings.push(Warning::PredictionFailed { scenario: name.into(), failed, runs, cause });
        }
        let (mut of_runs, mut runs) = (Vec::new(), Vec::new());
        for (draw, (run, error)) in draws.iter().zip(all) {
            if let Ok(run) = run {
                of_runs.push(draw);
                runs.push((run, error));
            }
        }
        if runs.len() < 2 {
            let cause = warnings.last().map(ToString::to_string).unwrap_or_default();
            return Err(refuse!("{name} has no prediction: {cause}"));
        }
        if let Some(held) = held_by_extremes(runs.len()) {
            warnings.push(Warning::PredictionOfFewRuns { scenario: name.into(), runs: runs.len(), held });
        }
        asked.check(&runs)?;
        let (mut bands, mut covered) = (Vec::new(), Vec::new());
        for signal in &asked.signals {
            let (plot, inside) = band((name, study), signal, &runs)?;
            bands.push(plot);
            if let Some(share) = inside.as_ref().and_then(|row| row["share_within_band"].as_f64())
                && share < LEAST_WITHIN
            {
                let (scenario, signal) = (name.into(), signal.clone());
                warnings.push(Warning::PredictionOutside { scenario, signal, share });
            }
            covered.extend(inside);
        }
        Ok(Prediction {
            figures: figures(name, &drawn, asked, &of_runs, &runs),
            probabilities: probabilities(name, asked, &runs),
            bands,
            covered,
            warnings,
        })
    }
}

/// A scenario whose runs take draws of a posterior.
struct Drawn<'a> {
    study: &'a ScenarioHandle,
    plan: &'a Plan,
    /// Indices of the parameters that it takes.
    taken: Vec<usize>,
    /// Its break strains, where the tests tell of them, or why they cannot be set.
    breaks: Result<Option<BreakUnknowns>, String>,
}

impl<'a> Drawn<'a> {
    fn new(study: &'a ScenarioHandle, plan: &'a Plan, session: &Session) -> Drawn<'a> {
        // Break strains are drawn for each run where the tests tell of them and the scenario's film has some.
        let breaks = match plan.has_outcomes() {
            false => Ok(None),
            true => outcome::factors(study, session)
                .map(|factors| Some(plan.shared_breaks(factors)))
                .map_err(|error| cause(&error)),
        };
        // Each run has break strains of its own.
        let mut taken = plan.taken_by(study, session);
        taken.retain(|index| plan.parameters[*index].role == Role::Key);
        Drawn { study, plan, taken, breaks }
    }
    /// Whether it depends on an unknown.
    fn takes(&self, unknown: &Unknown) -> bool {
        unknown.test.is_none()
            && match self.plan.parameter_of(unknown).role {
                Role::Key => self.taken.contains(&unknown.parameter),
                Role::Break(_) | Role::Scatter(_) => {
                    matches!(self.breaks, Ok(Some(_))) && self.plan.rivals(unknown.parameter).next().is_none()
                }
            }
    }

    /// Why it does not depend on an unknown.
    fn why_without(&self, unknown: &Unknown) -> String {
        if unknown.test.is_some() {
            return "it is of one test".into();
        }
        let is_key = self.plan.parameter_of(unknown).role == Role::Key;
        match (&self.breaks, self.plan.rivals(unknown.parameter).next()) {
            (Err(why), _) if !is_key => why.clone(),
            (_, Some(other)) => format!("`{}` writes the same key in other tests: set it in the scenario", other.name),
            _ => "its scenario has no such key, or none that can be set".into(),
        }
    }

    /// A run with the shared unknowns of a draw, of a specimen with break strains of its own (equation 335).
    fn run(&self, draw: &Draw, session: &Session) -> Result<Run, String> {
        let values = self.plan.values(&draw.x);
        let mut changes = self.plan.shared_changes(&values, &self.taken);
        if let Ok(Some(breaks)) = &self.breaks {
            let breaks = breaks.with_values(&values);
            for (along, key) in BREAK_FACTORS.into_iter().enumerate() {
                let logarithm = breaks.log_factors[along] + breaks.scatter[along] * draw.breaks[along];
                changes.insert(key.into(), logarithm.exp().into());
            }
        }
        let run = self.study.with(changes, session).and_then(|own| own.simulate_with_post(session));
        run.map_err(|error| cause(&error))
    }
}

impl Asked {
    /// Names of figures.
    fn names(&self) -> impl Iterator<Item = &String> {
        self.figures.iter().chain(self.above.iter().map(|(name, _)| name)).chain(self.errors.keys())
    }

    /// Refuses a figure that no run of a scenario can have, before any runs. A post script may make up names that it does not hold,
    /// but hardly ones that are nearly those of all runs.
    pub(super) fn check_names(&self, study: &ScenarioHandle) -> HostResult<()> {
        let has_several = study.model().impactors.len() > 1;
        let (script, figures) = (study.plan().whole_script(), post::figures());
        let known = || figures.iter().map(|own| own.name.as_str());
        let may_be_of = |script: &String, name| script.contains(name) || did_you_mean(name, known()).is_none();
        let may_be =
            |name| is_known(name, has_several) || script.as_ref().is_some_and(|script| may_be_of(script, name));
        self.names().find(|name| !may_be(name)).map_or(Ok(()), |name| Err(no_figure(name, known())))
    }

    /// Whether the runs have the figures that are asked for.
    fn check(&self, runs: &[(Run, ErrorSize)]) -> HostResult<()> {
        let is_missing = |name: &&String| !runs.iter().any(|(run, _)| number(run, name).is_some());
        match self.names().find(is_missing) {
            None => Ok(()),
            Some(name) => Err(no_figure(name, runs[0].0.summary().keys().map(String::as_str))),
        }
    }

    /// Values of a figure, each with the deviation that its model's error gives it.
    fn values(&self, figure: &str, runs: &[(Run, ErrorSize)]) -> Vec<(f64, f64)> {
        let error = self.errors.get(figure).copied().unwrap_or(0.0);
        runs.iter().filter_map(|(run, _)| number(run, figure)).map(|value| (value, error * value.abs())).collect()
    }
}

fn no_figure<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Box<rhai::EvalAltResult> {
    let all = "`droptower explain figures` lists those of all runs";
    refuse(match did_you_mean(name, known) {
        Some(hint) => format!("no run has a figure `{name}` ({hint})"),
        None => format!("no run has a figure `{name}`: {all}"),
    })
}

/// How much the least and the largest value of so few runs hold that no ends of 95 % lie between them.
fn held_by_extremes(runs: usize) -> Option<f64> {
    let held = (runs as f64 - 1.0) / (runs as f64 + 1.0);
    (held < BAND[2] - BAND[0] - 1e-9).then_some(held)
}

/// The number of a figure in a run; whether something is so counts as one or zero.
fn number(run: &Run, figure: &str) -> Option<f64> {
    let value = run.summary().get(figure)?;
    value.as_f64().or_else(|| value.as_bool().map(|own| f64::from(u8::from(own)))).filter(|own| own.is_finite())
}

/// A row a figure: quantiles, and the shares of the variance that one parameter alone explains, by a linear fit.
fn figures(scenario: &str, drawn: &Drawn<'_>, asked: &Asked, draws: &[&Draw], runs: &[(Run, ErrorSize)]) -> Vec<Row> {
    let names: Vec<String> = match asked.figures.is_empty() {
        false => asked.figures.clone(),
        true => {
            let all = runs[0].0.summary();
            let varies = |name: &&String| {
                let own: Vec<f64> = runs.iter().filter_map(|(run, _)| number(run, name)).collect();
                is_result(name) && own.len() == runs.len() && own.iter().any(|value| *value != own[0])
            };
            all.keys().filter(varies).cloned().collect()
        }
    };
    let row = |name: &String| {
        let values = asked.values(name, runs);
        let own: Vec<f64> = values.iter().map(|(value, _)| *value).collect();
        let median = predictive_quantiles(&own, &[0.5])?[0];
        let [low, high] = ends(&values);
        let mut row = object(json!({
            "scenario": scenario, "figure": name, "median": median, "lower_95": low, "upper_95": high,
            "mean": mean(&own), "runs": own.len(), "model_error": asked.errors.get(name),
        }));
        if own.len() == draws.len() {
            let of_errors = values.iter().map(|(_, deviation)| deviation * deviation).sum::<f64>() / own.len() as f64;
            let whole = variance(&own).unwrap_or(0.0) + of_errors;
            let mut insert = |name: &str, along: Vec<f64>| {
                let share = correlation(&along, &own).map(|r| r * r * (1.0 - of_errors / whole));
                row.insert(format!("share_of_{name}"), json!(share));
            };
            let plan = drawn.plan;
            for (index, unknown) in plan.unknowns.iter().enumerate().filter(|(_, unknown)| drawn.takes(unknown)) {
                insert(&unknown.name, draws.iter().map(|draw| draw.x[index]).collect());
            }
            for (along, name) in ["specimen_md_break", "specimen_td_break"].into_iter().enumerate() {
                if matches!(drawn.breaks, Ok(Some(_))) {
                    insert(name, draws.iter().map(|draw| draw.breaks[along]).collect());
                }
            }
            if of_errors > 0.0 {
                row.insert("share_of_model_error".into(), json!(of_errors / whole));
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
fn probabilities(scenario: &str, asked: &Asked, runs: &[(Run, ErrorSize)]) -> Vec<Row> {
    let ruptured = ("ruptured".to_owned(), 0.5);
    let all = std::iter::once(&ruptured).chain(&asked.above);
    let row = |(figure, limit): &(String, f64)| {
        let found = asked.values(figure, runs);
        let exceeds = |(value, deviation): &(f64, f64)| match *deviation > 0.0 {
            true => cumulative((value - limit) / deviation),
            false => f64::from(u8::from(value > limit)),
        };
        let count = found.iter().map(exceeds).sum::<f64>();
        let interval = (!found.is_empty()).then(|| wilson(count.round() as u64, found.len() as u64, 0.95))?;
        let what = if figure == "ruptured" { "film breaks".to_owned() } else { format!("{figure} above {limit}") };
        Some(object(json!({
            "scenario": scenario, "what": what, "probability": count / found.len() as f64,
            "lower_95_probability": interval.low, "upper_95_probability": interval.high, "runs": found.len(),
        })))
    };
    all.filter_map(row).collect()
}

/// The band of a signal: of the parameters, and with the model's error of each draw; and what of the recording lies in it.
fn band(
    (scenario, study): (&str, &ScenarioHandle),
    name: &str,
    runs: &[(Run, ErrorSize)],
) -> HostResult<(Plot, Option<Row>)> {
    let signals = runs.iter().map(|(run, error)| Ok((run.channel(name)?, *error))).collect::<HostResult<Vec<_>>>()?;
    let end = signals.iter().filter_map(|(own, _)| own.time().last().copied()).fold(f64::INFINITY, f64::min);
    let start = signals.iter().filter_map(|(own, _)| own.time().first().copied()).fold(f64::NEG_INFINITY, f64::max);
    let column = found_column(name).map_err(refuse)?;
    let comparison = study.comparison().ok();
    // The model's error is a share of the root mean square where a test of this kind is compared.
    let levels = runs.iter().zip(&signals).map(|((run, _), (own, _))| {
        let window = comparison.map_or_else(|| loading(run, [start, end]), |comparison| comparison.window);
        root_mean_square(own.window(window).values())
    });
    let levels: Vec<f64> = levels.collect();
    let (mut inner, mut outer) = (Vec::new(), Vec::new());
    let places: Vec<f64> =
        (0..=PLACES).map(|place| (start + (end - start) * place as f64 / PLACES as f64).min(end)).collect();
    for place in &places {
        let own: Vec<(f64, f64)> = signals
            .iter()
            .zip(&levels)
            .filter_map(|((own, error), level)| {
                let value = own.value_at(*place)?;
                Some((value, error.deviation(value, *level)))
            })
            .collect();
        let values: Vec<f64> = own.iter().map(|(value, _)| *value).collect();
        inner.push(predictive_quantiles(&values, &BAND).ok_or_else(|| refuse!("{name} has no value at {place}"))?);
        outer.push(ends(&own));
    }
    let curve = |title: &str, look, of: &dyn Fn(usize) -> f64| Curve {
        name: title.into(),
        points: places.iter().enumerate().map(|(at, place)| [1e3 * place, column.factor * of(at)]).collect(),
        look,
    };
    let has_errors = runs.iter().any(|(_, error)| error.share > 0.0);
    let mut curves = vec![
        curve("median", Look::Line, &|at| inner[at][1]),
        curve("2.5 %, parameters", Look::Dashed, &|at| inner[at][0]),
        curve("97.5 %, parameters", Look::Dashed, &|at| inner[at][2]),
    ];
    if has_errors {
        curves.push(curve("2.5 %, with the model's error", Look::Dashed, &|at| outer[at][0]));
        curves.push(curve("97.5 %, with the model's error", Look::Dashed, &|at| outer[at][1]));
    }
    let recorded = comparison.and_then(|own| match name {
        "acceleration" => own.acceleration.clone(),
        "displacement" => own.displacement.clone(),
        _ => None,
    });
    let covered = recorded.zip(comparison).map(|(recorded, comparison)| {
        let inside = recorded.window(comparison.window);
        let points = inside.samples().map(|[time, value]| [1e3 * time, column.factor * value]).collect();
        curves.push(Curve { name: "recording".into(), points, look: Look::Line }.thinned(3 * PLACES));
        let class = study.model().output.filter.filter(|_| name == "acceleration");
        let found = within_band(&recorded, comparison.window, class, &signals);
        let share = (!found.is_empty()).then(|| found.iter().filter(|own| **own).count() as f64 / found.len() as f64);
        object(json!({ "scenario": scenario, "signal": name, "share_within_band": share, "places": found.len() }))
    });
    let title = format!("{scenario}: {name}, predicted");
    Ok((Plot::new(title, ["time (ms)", column.axis], curves), covered))
}

/// Whether the mean of a recording over each bin, as tests are compared by, lies within the ends of 95 % of the runs' means with
/// the model's error and the noise of the recording; of bins that all runs reach.
fn within_band(recorded: &Series, window: [f64; 2], class: Option<f64>, signals: &[(Series, ErrorSize)]) -> Vec<bool> {
    let reached = signals.iter().filter_map(|(own, _)| own.time().last().copied()).fold(window[1], f64::min);
    let recorded = Recorded::new(recorded, [window[0], reached], class);
    // Of noise and means alone.
    let errors = recorded.and_then(|own| ErrorModel::new(&[own], Noise::FromRecording, Shape::all(None)[0]));
    let Ok(errors) = errors else { return Vec::new() };
    let of_run = |(own, error): &(Series, ErrorSize)| {
        let means = errors.means(own).ok()?;
        let level = root_mean_square(&means);
        let of_bin = |mean: f64| (mean, error.deviation(mean, level).hypot(errors.noise()));
        Some(means.into_iter().map(of_bin).collect::<Vec<_>>())
    };
    let Some(runs) = signals.iter().map(of_run).collect::<Option<Vec<_>>>() else { return Vec::new() };
    let is_within = |(bin, [_, measured]): (usize, [f64; 2])| {
        let own: Vec<(f64, f64)> = runs.iter().map(|means| means[bin]).collect();
        let [low, high] = ends(&own);
        (low..=high).contains(&measured)
    };
    errors.middles().enumerate().map(is_within).collect()
}

/// Where a run without a recording would be compared: an impact from its begin to the lowest point, any other all along.
fn loading(run: &Run, all: [f64; 2]) -> [f64; 2] {
    match number(run, "time_of_peak_displacement_s") {
        Some(lowest) if lowest > all[0] => [all[0].max(0.0), lowest],
        _ => all,
    }
}

/// Ends of 95 % of what one more run would have, of some runs' values, each with the deviation of its model's error: ends at the
/// ranks p (n + 1), or those of a mixture of normal distributions of equal weight where there are errors, by bisection
/// (methods.md, equation 337c).
fn ends(own: &[(f64, f64)]) -> [f64; 2] {
    let values: Vec<f64> = own.iter().map(|(value, _)| *value).collect();
    if own.iter().all(|(_, deviation)| *deviation == 0.0)
        && let Some(found) = predictive_quantiles(&values, &[BAND[0], BAND[2]])
    {
        return [found[0], found[1]];
    }
    let count = own.len() as f64;
    let below = |y: f64| {
        let part = |(value, deviation): &(f64, f64)| match *deviation > 0.0 {
            true => cumulative((y - value) / deviation),
            false => f64::from(u8::from(y >= *value)),
        };
        own.iter().map(part).sum::<f64>() / count
    };
    let of_errors = own.iter().map(|(_, deviation)| deviation * deviation).sum::<f64>() / count;
    let share = of_errors / (of_errors + variance(&values).unwrap_or(0.0));
    let reach = own.iter().map(|(_, deviation)| 8.0 * deviation).fold(0.0, f64::max);
    let low = values.iter().copied().fold(f64::INFINITY, f64::min) - reach;
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) + reach;
    [BAND[0], BAND[2]].map(|probability| {
        // What one more run counts itself; no end lies beyond the step of the outermost run.
        let of_next = cumulative(quantile(probability) * (share / (2.0 - share)).sqrt());
        let least = of_next.min(1.0 - of_next);
        let sought = (probability * (count + 1.0) - of_next).clamp(least, count - least) / count;
        let (mut from, mut to) = (low, high);
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if below(middle) < sought { from = middle } else { to = middle }
        }
        0.5 * (from + to)
    })
}

#[cfg(test)]
mod tests {
    use uncertainty::random::Stream;

    use super::*;

    const NONE: ErrorSize = ErrorSize { share: 0.0, in_proportion: 0.0 };

    #[test]
    fn a_mixture_has_the_ends_of_its_normal_distributions() {
        let found = ends(&[(1.0, 2.0), (1.0, 2.0)]);
        assert!((found[0] - (1.0 - 1.959_964 * 2.0)).abs() < 1e-5 && (found[1] - (1.0 + 1.959_964 * 2.0)).abs() < 1e-5);
        // Two groups far apart: 5 % of each lie beyond its end, a little less for the part of one more run.
        let runs: Vec<(f64, f64)> = (0..1000).map(|at| (f64::from(at % 2) * 100.0, 1.0)).collect();
        let found = ends(&runs);
        let end = quantile(2.0 * (0.025 * 1001.0 - cumulative(-1.959_964 * (1.0_f64 / 5003.5).sqrt())) / 1000.0);
        assert!((found[0] - end).abs() < 1e-3 && (found[1] - 100.0 + end).abs() < 1e-3, "{found:?}");
    }

    /// A recording whose amplitude is another draw of that of the runs, with noise that is more: 95 % of its means lie within the
    /// ends.
    #[test]
    fn as_much_of_a_recording_lies_within_the_band_as_it_says() {
        let mut random = Stream::new(11);
        let time: Vec<f64> = (0..=960).map(|sample| 0.1 / 960.0 * f64::from(sample)).collect();
        // A run goes on behind the window.
        let later: Vec<f64> = (0..=1100).map(|sample| 0.1 / 960.0 * f64::from(sample)).collect();
        let shape = |t: &f64| (std::f64::consts::PI * t / 0.1).sin() + 2.0;
        let trials = 100;
        let (mut within, mut all) = (0, 0);
        for _ in 0..trials {
            let mut signal = |time: &[f64], noise: f64| {
                let size = 100.0 * (1.0 + 0.05 * random.normal());
                let values: Vec<f64> = time.iter().map(|t| size * shape(t) + noise * random.normal()).collect();
                Series::new(time.to_vec(), values)
            };
            let runs: Vec<(Series, ErrorSize)> = (0..40).map(|_| (signal(&later, 0.0), NONE)).collect();
            let found = within_band(&signal(&time, 80.0), [0.0, 0.1], None, &runs);
            assert!(found.len() > 50);
            within += found.iter().filter(|own| **own).count();
            all += found.len();
        }
        let share = f64::from(within as u32) / f64::from(all as u32);
        assert!((share - 0.95).abs() < 0.02, "{share}");
        let zero = Series::new(time.clone(), vec![0.0; time.len()]);
        assert!(within_band(&zero, [0.0, 0.1], None, &[(zero.clone(), NONE)]).is_empty());
    }

    /// Recordings with an error of the law, a wave of random phase that is even or in proportion to the signal: 95 % of their means lie
    /// within the ends, of those where the signal is small and of the others alike.
    #[test]
    fn bands_hold_where_the_signal_is_small_and_where_it_is_large() {
        const SHARE: f64 = 0.1;
        let mut random = Stream::new(13);
        let time: Vec<f64> = (0..=160).map(|sample| 0.1 / 160.0 * f64::from(sample)).collect();
        let along = |t: f64| std::f64::consts::PI * t / 0.1;
        let signal = |size: f64, error: &dyn Fn(f64, f64) -> f64| {
            let value = |t: &f64| 100.0 * (along(*t).sin() + 0.1);
            Series::new(time.clone(), time.iter().map(|t| size * value(t) + error(*t, value(t))).collect::<Vec<_>>())
        };
        let level = root_mean_square(signal(1.0, &|_, _| 0.0).values());
        for in_proportion in [0.0, 1.0] {
            // Of the fifth at either end and of the rest: means within, and all.
            let mut counts = [[0_usize; 2]; 2];
            for _ in 0..120 {
                let [own, sine, cosine] = [0, 1, 2].map(|_| random.normal());
                let wave = |t: f64| sine * (7.0 * along(t)).sin() + cosine * (7.0 * along(t)).cos();
                let even = |t: f64, _: f64| SHARE * level * wave(t);
                let of_value = |t: f64, value: f64| SHARE * value * wave(t);
                let error: &dyn Fn(f64, f64) -> f64 = if in_proportion > 0.0 { &of_value } else { &even };
                let recorded = signal(1.0 + 0.02 * own, error);
                let run =
                    |_| (signal(1.0 + 0.02 * random.normal(), &|_, _| 0.0), ErrorSize { share: SHARE, in_proportion });
                let runs: Vec<(Series, ErrorSize)> = (0..40).map(run).collect();
                let within = within_band(&recorded, [0.0, 0.1], None, &runs);
                for (bin, is_within) in within.iter().enumerate() {
                    let part = usize::from((within.len() / 5..within.len() * 4 / 5).contains(&bin));
                    counts[part][0] += usize::from(*is_within);
                    counts[part][1] += 1;
                }
            }
            for [within, all] in counts {
                let share = within as f64 / all as f64;
                assert!((share - 0.95).abs() < 0.025, "{in_proportion}: {counts:?}");
            }
        }
    }

    /// Ends of some dozens of runs hold 95 % of what is drawn with them, whether the runs scatter more or the model's error.
    #[test]
    fn ends_hold_what_they_say() {
        let mut random = Stream::new(7);
        let trials = 800;
        for deviation in [0.0, 0.3, 1.0, 3.0] {
            for count in [40, 64] {
                let mut held = 0.0;
                for _ in 0..trials {
                    let runs: Vec<(f64, f64)> = (0..count).map(|_| (random.normal(), deviation)).collect();
                    let [low, high] = ends(&runs);
                    let whole = 1.0_f64.hypot(deviation);
                    held += (cumulative(high / whole) - cumulative(low / whole)) / f64::from(trials);
                }
                assert!((held - 0.95).abs() < 0.006, "{count} runs, error of {deviation}: {held}");
            }
        }
    }
}
