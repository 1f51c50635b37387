//! The result of a calibration as rows of tables and as plots.

use serde_json::{Value, json};

use super::fit::Fit;
use super::outcome::Described;
use super::plan::Plan;
use super::posterior::Posterior;
use super::verdict::Knowledge;
use super::warning::Warning;
use crate::script::{Row, object};
use plot::{Curve, Look, Plot};
use uncertainty::statistics::{deviation, mean, quantiles};

/// Most points of a curve of a plot.
const MOST_POINTS: usize = 600;

/// One row a parameter: its value, its interval of 95 %, the verdict and the numbers that it rests on.
pub(super) fn parameters(plan: &Plan, values: &[f64], known: &[Knowledge], basis: &str) -> Vec<Row> {
    let row = |((unknown, value), known): ((&super::parameter::Unknown, &f64), &Knowledge)| {
        let parameter = plan.parameter_of(unknown);
        let tests: Vec<&str> = match unknown.test {
            Some(test) => vec![plan.tests[test].name.as_str()],
            None => plan.sharing(unknown.parameter).map(|test| plan.tests[test].name.as_str()).collect(),
        };
        object(json!({
            "parameter": unknown.name, "value": value, "unit": parameter.unit, "lower_95": known.interval[0],
            "upper_95": known.interval[1], "verdict": known.verdict.to_string(), "half_width": known.half_width,
            "half_width_if_others_known": known.half_width_alone, "share_of_prior": known.prior_share, "basis": basis,
            "tests": tests.join(", "),
        }))
    };
    plan.unknowns.iter().zip(values).zip(known).map(row).collect()
}

/// One row a signal: how well its recordings are met.
pub(super) fn tests(plan: &Plan, fit: &Fit) -> Vec<Row> {
    let mut rows = Vec::new();
    for (test, simulated) in plan.tests.iter().zip(&fit.simulated) {
        for (signal, simulated) in test.signals.iter().zip(simulated) {
            let error = signal.errors.relative_error(simulated).ok();
            let as_simulated = signal.errors.relative_error_as_simulated(simulated).ok();
            let scaled = signal.errors.scaled(simulated).ok();
            let contact = scaled.as_ref().map(|own| signal.errors.contact_found(own, fit.share));
            let shift = |place: usize| contact.filter(|_| signal.errors.contact_errors()[place]).map(|own| own[place]);
            let squares = scaled.map(|own| signal.errors.whitened(&own, fit.share).iter().map(|r| r * r).sum::<f64>());
            rows.push(object(json!({
                "test": test.name, "signal": signal.name, "relative_error": error,
                "relative_error_as_simulated": as_simulated, "noise": signal.errors.noise(),
                "unit": signal.column.unit, "bins": signal.errors.bins(),
                "mean_square_residual": squares.map(|sum| sum / signal.errors.bins() as f64), "weight": test.weight,
                "recordings": signal.recordings.len(), "contact_late_s": shift(0), "impact_speed_high_m_s": shift(1),
            })));
        }
    }
    rows
}

/// Errors over the median of the others' from which a test fits far worse than they do, and the least of them.
const FAR: (f64, f64) = (4.0, 0.02);

/// Signals of tests that fit far worse than the others, of which there are two at least.
pub(super) fn misfits(tests: &[Row]) -> Vec<Warning> {
    let error = |row: &Row| row["relative_error"].as_f64();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let misfit = |(place, row): (usize, &Row)| {
        let others = tests.iter().enumerate().filter(|(other, _)| *other != place);
        let others: Vec<f64> = others.filter_map(|(_, row)| error(row)).collect();
        let (error, median) = (error(row)?, *quantiles(&others, &[0.5])?.first()?);
        let (factor, least) = FAR;
        (others.len() > 1 && error > least.max(factor * median)).then(|| {
            let [test, signal] = [&row["test"], &row["signal"]].map(text);
            Warning::Misfit { test, signal, error, others: median }
        })
    };
    tests.iter().enumerate().filter_map(misfit).collect()
}

/// One row an outcome: how likely it is, or the failure mass that follows, with the best values.
pub(super) fn outcomes(plan: &Plan, fit: &Fit) -> Vec<Row> {
    let mut rows = Vec::new();
    for (place, (test, demands)) in plan.tests.iter().zip(&fit.demands).enumerate() {
        let Some(outcomes) = &test.outcomes else { continue };
        let breaks = plan.break_unknowns(place).with_values(&fit.values);
        for Described { outcome, specimens, probability, mass, demand } in outcomes.described(demands, &breaks) {
            let given = mass.map(|[given, _]| given);
            rows.push(object(json!({
                "test": test.name, "outcome": outcome, "specimens": specimens, "probability": probability, "failure_mass_kg": given,
                "calibrated_failure_mass_kg": mass.map(|[_, found]| found),
                "demand_md": (demand[0] - breaks.log_factors[0]).exp(), "demand_td": (demand[1] - breaks.log_factors[1]).exp(),
                "weight": test.weight,
            })));
        }
    }
    rows
}

/// One row an unknown, and one a test of an unknown that scatters: its posterior.
pub(super) fn posterior(found: &Posterior, known: &[Knowledge]) -> Vec<Row> {
    let plan = &*found.plan;
    let row = |name: String, values: &[f64]| {
        let at = quantiles(values, &[0.025, 0.1, 0.25, 0.5, 0.75, 0.9, 0.975]).unwrap_or_else(|| vec![f64::NAN; 7]);
        object(json!({
            "parameter": name, "median": at[3], "mean": mean(values), "deviation": deviation(values), "lower_95": at[0],
            "upper_95": at[6], "lower_80": at[1], "upper_80": at[5], "lower_50": at[2], "upper_50": at[4],
        }))
    };
    let with = |mut row: Row, more: Value| {
        row.extend(object(more));
        row
    };
    let mut rows = Vec::new();
    for (index, unknown) in plan.unknowns.iter().enumerate() {
        let values: Vec<f64> = found.unknowns().map(|x| plan.parameter_of(unknown).value(x[index])).collect();
        let more = json!({
            "verdict": known[index].verdict.to_string(), "share_of_prior": known[index].prior_share,
            "r_hat": found.r_hat[index], "effective": found.effective[index],
        });
        rows.push(with(row(unknown.name.clone(), &values), more));
    }
    // What scatters and the model's error have no verdict.
    rows.extend(found.beside_unknowns().map(|(name, values, [r_hat, effective])| {
        let more = json!({ "verdict": null, "share_of_prior": null, "r_hat": r_hat, "effective": effective });
        with(row(name, &values), more)
    }));
    rows
}

/// One row a test: the error of its surrogate.
pub(super) fn surrogates(found: &Posterior) -> Vec<Row> {
    let row = |((test, error), runs): ((&super::recorded_test::Test, &f64), &usize)| {
        object(json!({ "test": test.name, "surrogate_off": error, "runs": runs, "acceptance": found.acceptance }))
    };
    found.plan.tests.iter().zip(&found.errors).zip(&found.runs_of_tests).map(row).collect()
}

/// Measured and calibrated curves, a plot a signal of a test.
pub(super) fn plots(plan: &Plan, fit: &Fit) -> Vec<Plot> {
    let mut plots: Vec<Plot> = Vec::new();
    for (test, simulated) in plan.tests.iter().zip(&fit.simulated) {
        for (signal, simulated) in test.signals.iter().zip(simulated) {
            let (x, factor) = signal.abscissa();
            let curve = |name: &str, series: &lab::signal::Series, look| {
                let points = series.samples().map(|[x, y]| [x * factor, y * signal.column.factor]).collect();
                Curve { name: name.into(), points, look }.thinned(MOST_POINTS)
            };
            // Several recordings of one test have one calibrated curve.
            let end =
                signal.recordings.iter().flat_map(|own| own.time().last()).copied().fold(f64::NEG_INFINITY, f64::max);
            let start =
                signal.recordings.iter().flat_map(|own| own.time().first()).copied().fold(f64::INFINITY, f64::min);
            let recorded = if plan.is_virtual { "virtual recording" } else { "measured" };
            let mut curves = vec![curve("calibrated", &simulated.window([start, end]), Look::Line)];
            curves.extend(signal.recordings.iter().map(|own| curve(recorded, own, Look::Dashed)));
            let title = format!("{}: {}", test.name, signal.name);
            plots.push(Plot::new(title, [x, signal.column.axis], curves));
        }
    }
    plots
}

/// The share of films that broke over the demand of their test, and the probability that follows; none without such tests.
pub(super) fn breaking(plan: &Plan, fit: &Fit) -> Option<Plot> {
    /// Points of a curve of probability.
    const POINTS: usize = 120;
    let mut points = Vec::new();
    let mut scatters: Vec<(usize, f64)> = Vec::new();
    for (place, (test, demands)) in plan.tests.iter().zip(&fit.demands).enumerate() {
        let Some(outcomes) = &test.outcomes else { continue };
        let [held, broke] = outcomes.counts();
        if held + broke == 0 {
            continue;
        }
        let breaks = plan.break_unknowns(place).with_values(&fit.values);
        let standard = |along: usize| (demands[along] - breaks.log_factors[along]) / breaks.scatter[along];
        let along = usize::from(standard(1) > standard(0));
        points.push([(demands[along] - breaks.log_factors[along]).exp(), broke as f64 / (held + broke) as f64]);
        if !scatters.iter().any(|(own, _)| *own == along) {
            scatters.push((along, breaks.scatter[along]));
        }
    }
    let ends = points.iter().map(|[demand, _]| *demand);
    let [low, high] = [ends.clone().fold(1.0, f64::min), ends.fold(1.0, f64::max)];
    let of_scatter = |(along, scatter): (usize, f64)| {
        let at = |place: usize| {
            let demand = 0.9 * low + (1.1 * high - 0.9 * low) * place as f64 / POINTS as f64;
            [demand, uncertainty::normal::cumulative(demand.ln() / scatter)]
        };
        let name = format!("probability, breaking along {}", ["MD", "TD"][along]);
        Curve { name, points: (0..=POINTS).map(at).collect(), look: Look::Line }
    };
    let mut curves: Vec<Curve> = scatters.into_iter().map(of_scatter).collect();
    let is_empty = points.is_empty();
    curves.push(Curve { name: "share that broke".into(), points, look: Look::Points });
    let axes = ["demand over the median break strain", "share"];
    (!is_empty).then(|| Plot::new("Films that broke", axes, curves))
}

/// Pairs of unknowns, a plot a pair: samples of the posterior.
pub(super) fn pairs(found: &Posterior) -> Vec<Plot> {
    /// Most unknowns whose pairs are drawn.
    const MOST: usize = 4;
    /// Most points of a pair.
    const POINTS: usize = 400;
    let plan = &*found.plan;
    let shown: Vec<usize> = (0..plan.unknowns.len().min(MOST)).collect();
    let samples: Vec<Vec<f64>> = found.unknowns().map(|x| plan.values(x)).collect();
    let step = samples.len().div_ceil(POINTS).max(1);
    let mut plots = Vec::new();
    for (place, one) in shown.iter().enumerate() {
        for other in &shown[place + 1..] {
            let [a, b] = [*one, *other].map(|index| plan.unknowns[index].name.as_str());
            let points = samples.iter().step_by(step).map(|values| [values[*one], values[*other]]).collect();
            let curve = Curve { name: "posterior".into(), points, look: Look::Points };
            let title = format!("Posterior of {a} and {b}");
            plots.push(Plot::new(title, [a, b], vec![curve]));
        }
    }
    plots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_that_fits_six_times_worse_is_named() {
        let found = |errors: &[f64]| -> Vec<String> {
            let row = |(place, error)| {
                object(json!({ "test": format!("t{place}"), "signal": "force", "relative_error": error }))
            };
            let rows: Vec<Row> = errors.iter().enumerate().map(row).collect();
            misfits(&rows).iter().map(Warning::to_string).collect()
        };
        assert_eq!(found(&[0.03, 0.18, 0.02]), ["t1: its force is off by 18 %, 7.2 times as much as the others"]);
        for alike in [&[0.03, 0.06, 0.02][..], &[0.001, 0.01, 0.001], &[0.03, 0.18], &[0.2]] {
            assert!(found(alike).is_empty(), "{alike:?}");
        }
    }
}
