//! Statistics of the table of a sweep: quantiles, probability of rupture, main effects.

use uncertainty::effects::main_effects;
use uncertainty::statistics::{Bootstrap, Estimate, Interval, deviation, mean, quantiles, wilson};

use serde::Serialize;

use super::table::Table;
use base::table::{Column, Values};

/// Confidence of intervals.
const CONFIDENCE: f64 = 0.95;

/// Resamples of the intervals of main effects.
const RESAMPLES: usize = 200;

/// Statistics of a figure over the runs that have it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quantiles {
    /// Mean.
    pub mean: f64,
    /// Standard deviation (n − 1); none of a single run.
    pub deviation: Option<f64>,
    /// Quantile of 5 %.
    pub p05: f64,
    /// Median.
    pub p50: f64,
    /// Quantile of 95 %.
    pub p95: f64,
    /// Runs that have the figure.
    pub count: usize,
}

/// Main effects on a figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effects {
    /// The figure.
    pub figure: String,
    /// Of each input.
    pub effects: Vec<Effect>,
    /// Interval of 95 % of the share that inputs have only together, where it is not zero.
    pub together: Option<[f64; 2]>,
    /// Runs that have the figure.
    pub count: usize,
}

/// Share of the variance of a figure that an input has alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// The input.
    pub input: String,
    /// Its share.
    pub share: f64,
    /// Interval of 95 %.
    pub interval: Option<[f64; 2]>,
}

/// Mean, deviation and quantiles of a column; none of one without numbers.
pub(super) fn of_column(column: &Column) -> Option<Quantiles> {
    let Values::Numbers(values) = &column.values else { return None };
    let values: Vec<f64> = values.iter().flatten().copied().filter(|value| value.is_finite()).collect();
    let at = quantiles(&values, &[0.05, 0.5, 0.95])?;
    let [p05, p50, p95] = at[..] else { return None };
    Some(Quantiles { mean: mean(&values)?, deviation: deviation(&values), p05, p50, p95, count: values.len() })
}

/// Probability of what a column of Booleans states, and its interval (Wilson 1927).
pub(super) fn probability(column: &Column) -> Option<(f64, Interval)> {
    let Values::Flags(values) = &column.values else { return None };
    let known: Vec<bool> = values.iter().flatten().copied().collect();
    let count = known.iter().filter(|flag| **flag).count();
    let trials = known.len();
    (trials > 0).then(|| (count as f64 / trials as f64, wilson(count as u64, trials as u64, CONFIDENCE)))
}

/// The share of the variance of a figure that each input has alone; none where they are not known. Inputs that are not
/// `independent` may vary together.
pub(super) fn effects(table: &Table, figure: &Column, independent: bool) -> Option<Effects> {
    let inputs: Vec<Vec<f64>> = table.inputs().iter().map(coordinates).collect();
    let points: Vec<Vec<f64>> = (0..table.rows()).map(|row| inputs.iter().map(|input| input[row]).collect()).collect();
    let bootstrap = Bootstrap { resamples: RESAMPLES, confidence: CONFIDENCE, seed: 0 };
    let outputs = match &figure.values {
        Values::Flags(flags) => flags.iter().map(|flag| flag.map(|own| f64::from(u8::from(own)))).collect(),
        values => values.numbers(),
    };
    let found = main_effects(&points, &outputs, independent, &bootstrap).ok()?;
    let effect = |(input, share): (&Column, Estimate)| Effect {
        input: input.name.clone(),
        share: share.value,
        interval: share.interval.map(|interval| [interval.low, interval.high]),
    };
    let effects = table.inputs().iter().zip(found.shares).map(effect).collect();
    let together = found.sum.map(|sum| [1.0 - sum.high, 1.0 - sum.low]).filter(|[low, _]| *low > 1e-9);
    let count = outputs.iter().flatten().filter(|own| own.is_finite()).count();
    Some(Effects { figure: figure.name.clone(), effects, together, count })
}

/// An input as numbers: words by the order in which they appear.
fn coordinates(input: &Column) -> Vec<f64> {
    match &input.values {
        Values::Texts(texts) => {
            let mut words: Vec<&Option<String>> = vec![];
            let place = |text| {
                let found = words.iter().position(|word| *word == text);
                found.unwrap_or_else(|| {
                    words.push(text);
                    words.len() - 1
                }) as f64
            };
            texts.iter().map(place).collect()
        }
        values => values.numbers().into_iter().map(Option::unwrap_or_default).collect(),
    }
}
