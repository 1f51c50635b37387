//! The results of a sweep: one table with a row for each run, the statistics of its figures, and their trends over an input.

use std::collections::{BTreeMap, HashMap};

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::json;

use super::{Done, Sweep, warnings};
use crate::evaluate::{Evaluation, EvaluationError, Evaluations, Figure, is_cost};
use crate::post::{VERDICT, badness, is_of_script, is_result};
use crate::script::{Row, RunFindings, object};
use base::finding::Finding;
use base::table::{Column, Values};
use scene::model::Input;
use uncertainty::effects::main_effects;
use uncertainty::statistics::{Bootstrap, Estimate, Interval, deviation, mean, quantiles, wilson};

/// Columns of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Number of the run, its inputs, its status, its figures, codes of its findings, why it failed, its evaluation.
    pub columns: Vec<Column>,
    /// Number of columns of inputs, after that of the number.
    pub inputs: usize,
    /// Number of columns of figures, after that of the status.
    pub figures: usize,
}

/// A run that is done, as it stands in the table.
const FINISHED: &str = "finished";
const FAILED: &str = "failed";

/// A column without rows for figures of the kind of `figure`.
fn column_of(name: &str, figure: &Figure) -> Column {
    let values = match figure {
        Figure::Number(_) => Values::Numbers(vec![]),
        Figure::Flag(_) => Values::Flags(vec![]),
        Figure::Text(_) => Values::Texts(vec![]),
    };
    Column { name: name.to_owned(), values }
}

/// Appends `figure` as row `row`, a gap where it is not of the kind of `values`.
fn push(values: &mut Values, row: usize, figure: &Figure) {
    values.resize(row);
    match (values, figure) {
        (Values::Numbers(values), Figure::Number(number)) => values.push(Some(*number)),
        (Values::Flags(values), Figure::Flag(flag)) => values.push(Some(*flag)),
        (Values::Texts(values), Figure::Text(text)) => values.push(Some(text.clone())),
        (values, _) => values.resize(row + 1),
    }
}

/// Rows that are added one by one.
#[derive(Default)]
struct Figures {
    columns: Vec<Column>,
    places: HashMap<String, usize>,
    rows: usize,
}

impl Figures {
    fn add(&mut self, evaluation: &Evaluation) {
        for (name, figure) in &evaluation.figures {
            let next = self.columns.len();
            let place = *self.places.entry(name.clone()).or_insert(next);
            if place == next {
                self.columns.push(column_of(name, figure));
            }
            push(&mut self.columns[place].values, self.rows, figure);
        }
        self.rows += 1;
    }
}

impl Table {
    /// The table of the runs of `sweep` of which `done` knows the outcome; others have no row.
    ///
    /// # Errors
    /// A record cannot be read.
    pub fn from_evaluations(sweep: &Sweep, done: &Done, evaluations: &Evaluations) -> Result<Table, EvaluationError> {
        let mut figures = Figures::default();
        let (mut places, mut status, mut findings, mut failures, mut keys) = (vec![], vec![], vec![], vec![], vec![]);
        for place in 0..sweep.len() {
            let key = done.keys.get(&place).copied();
            let evaluation = match (key, done.refused.get(&place)) {
                (Some(keys), _) => Some(evaluations.known_record(keys)?),
                (None, Some(cause)) => Some(Evaluation::failed(cause.clone())),
                (None, None) => None,
            };
            let Some(evaluation) = evaluation else { continue };
            figures.add(&evaluation);
            places.push(place);
            let outcome = if evaluation.failure.is_some() { FAILED } else { FINISHED };
            status.push(Some(outcome.to_owned()));
            findings.push(Some(evaluation.findings.join(" ")));
            failures.push(evaluation.failure);
            keys.push(key.map(|keys| keys.figures.to_string()));
        }
        let text = |name: &str, values| Column { name: name.into(), values: Values::Texts(values) };
        let numbers = places.iter().map(|place| Some((place + 1) as f64)).collect();
        let mut columns = vec![Column { name: "run".into(), values: Values::Numbers(numbers) }];
        columns.extend(inputs(sweep, &places));
        let inputs = columns.len() - 1;
        columns.push(text("status", status));
        let count = figures.columns.len();
        figures.columns.iter_mut().for_each(|column| column.values.resize(places.len()));
        columns.extend(figures.columns);
        columns.extend([text("findings", findings), text("failure", failures), text("evaluation", keys)]);
        Ok(Table { columns, inputs, figures: count })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The column of this name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// The columns of inputs.
    pub fn inputs(&self) -> &[Column] {
        self.columns.get(1..=self.inputs).unwrap_or_default()
    }

    /// The columns of figures.
    pub fn figures(&self) -> &[Column] {
        let first = self.inputs + 2;
        self.columns.get(first..first + self.figures).unwrap_or_default()
    }

    /// Number of the run in a row, from one.
    pub fn number(&self, row: usize) -> usize {
        match self.columns.first().map(|column| &column.values) {
            Some(Values::Numbers(values)) => values[row].unwrap_or_default() as usize,
            _ => 0,
        }
    }

    /// Why the run in a row failed, if it did.
    pub fn failure(&self, row: usize) -> Option<&str> {
        match &self.column("failure")?.values {
            Values::Texts(values) => values[row].as_deref(),
            _ => None,
        }
    }
}

fn inputs(sweep: &Sweep, places: &[usize]) -> Vec<Column> {
    let rows: Vec<Vec<Input>> = places.iter().map(|place| sweep.inputs(*place).collect()).collect();
    let factors = sweep.variation().factors.iter().enumerate();
    let column = |(index, factor): (usize, &scene::model::Factor)| {
        let values: Vec<&Input> = rows.iter().map(|row| &row[index]).collect();
        let number = |input: &&Input| match input {
            Input::Number(number) => Some(*number),
            Input::Text(_) => None,
        };
        let numbers: Option<Vec<f64>> = values.iter().map(number).collect();
        let values = match numbers {
            Some(numbers) => Values::Numbers(numbers.into_iter().map(Some).collect()),
            None => Values::Texts(values.into_iter().map(|input| Some(input.to_string())).collect()),
        };
        Column { name: factor.column(), values }
    };
    factors.map(column).collect()
}

/// The results of a sweep.
#[derive(Clone, Debug, Default)]
pub struct SweepResults {
    /// Inputs and outputs.
    pub table: Table,
    /// Runs that were evaluated before, and now.
    pub reused: usize,
    /// Runs that failed.
    pub failed: usize,
    /// Runs without an outcome yet.
    pub missing: usize,
    /// Time that the engine took for the runs that were computed, s.
    pub engine_s: f64,
    /// Figures that vary, in the order of the table.
    pub statistics: Vec<(String, Quantiles)>,
    /// Share of the runs whose film ruptured, and its interval of 95 %.
    pub rupture: Option<(f64, [f64; 2])>,
    /// The verdicts on film, and how many runs have each.
    pub verdicts: Vec<(String, usize)>,
    /// Main effects on the figures that vary.
    pub effects: Vec<Effects>,
    /// Implausible variations.
    pub findings: Vec<Finding>,
}

impl SweepResults {
    /// The results of the runs of `sweep` of which `done` knows the outcome.
    ///
    /// # Errors
    /// A record cannot be read.
    pub fn from_evaluations(
        sweep: &Sweep,
        done: &Done,
        evaluations: &Evaluations,
    ) -> Result<SweepResults, EvaluationError> {
        let table = Table::from_evaluations(sweep, done, evaluations)?;
        let failed = (0..table.rows()).filter(|row| table.failure(*row).is_some()).count();
        let figures: Vec<&Column> = table.figures().iter().filter(|column| !is_cost(&column.name)).collect();
        let known = figures.iter().filter_map(|column| Some((*column, of_column(column)?)));
        let known: Vec<(&Column, Quantiles)> = known.collect();
        let rupture = table.column("ruptured").and_then(probability);
        let independent = sweep.variation().is_independent();
        let of = |column: &Column| effects(&table, column, independent);
        let of_rupture =
            rupture.filter(|(share, _)| *share > 0.0 && *share < 1.0).and_then(|_| of(table.column("ruptured")?));
        let varying: Vec<&Column> = known.iter().filter(|(_, of)| of.varies()).map(|(column, _)| *column).collect();
        let effects = varying.par_iter().filter_map(|column| of(column)).collect::<Vec<_>>();
        let effects = effects.into_iter().chain(of_rupture).collect();
        Ok(SweepResults {
            reused: done.cache_hits,
            failed,
            missing: sweep.len() - done.len(),
            engine_s: done.engine_s,
            statistics: known.iter().map(|(column, of)| (column.name.clone(), *of)).collect(),
            rupture: rupture.map(|(share, interval)| (share, interval.ends())),
            verdicts: verdicts(&table),
            effects,
            findings: warnings(&sweep.base, &sweep.variation).iter().map(Finding::new).collect(),
            table,
        })
    }

    /// How often the runs had findings.
    pub fn run_findings(&self) -> RunFindings {
        let mut found = RunFindings::default();
        let Some(Values::Texts(codes)) = self.table.column("findings").map(|column| &column.values) else {
            return found;
        };
        let outcomes = codes.iter().enumerate().filter(|(row, _)| self.table.failure(*row).is_none());
        outcomes.for_each(|(_, codes)| found.count(codes.as_deref().unwrap_or_default().split_whitespace()));
        found
    }

    /// The content of `summary.json`; `seconds` is the wall time of this process.
    pub fn summary(&self, sweep: &Sweep, seconds: f64) -> Row {
        let statistics = self.statistics.iter().map(|(name, quantiles)| (name.clone(), json!(quantiles)));
        let (probability, interval) = self.rupture.unzip();
        object(json!({
            "scenario": sweep.model().name, "title": sweep.model().title, "droptower": env!("CARGO_PKG_VERSION"),
            "runs": self.table.rows(), "reused": self.reused, "failed": self.failed, "missing": self.missing,
            "seconds": seconds, "engine_s": self.engine_s, "statistics": statistics.collect::<Row>(),
            "rupture_probability": probability, "interval": interval, "effects": self.effects, "findings": self.findings,
        }))
    }

    /// The figures that are shown first, at most so many: the one by which runs are ranked, those by which they are
    /// judged, and those that a script measures, as far as they vary.
    pub fn shown_figures<'a>(&'a self, ranked: &'a str, most: usize) -> Vec<&'a str> {
        let varying = || self.statistics.iter().filter(|(_, of)| of.varies()).map(|(name, _)| name.as_str());
        let is_first = |name: &&str| *name == ranked;
        let is_own = |name: &&str| is_of_script(name) && !is_first(name);
        let is_key = |name: &&str| is_result(name) && !is_first(name);
        let ordered = varying().filter(is_first).chain(varying().filter(is_key)).chain(varying().filter(is_own));
        ordered.take(most).collect()
    }

    /// The runs that are worst by a figure ([`badness`]), from zero, the worst first; failed runs come before all, then those whose
    /// film ruptured; of each kind those without the figure come last.
    pub fn worst(&self, figure: &str, count: usize) -> Vec<usize> {
        let values = self.table.column(figure).map(|column| column.values.numbers()).unwrap_or_default();
        let ruptured = match self.table.column("ruptured").map(|column| &column.values) {
            Some(Values::Flags(flags)) => flags.as_slice(),
            _ => &[],
        };
        let kind = |row: usize| (self.table.failure(row).is_some(), ruptured.get(row).copied().flatten() == Some(true));
        let of =
            |row: usize| values.get(row).copied().flatten().map_or(f64::NEG_INFINITY, |value| badness(figure, value));
        let mut rows: Vec<usize> = (0..self.table.rows()).collect();
        rows.sort_by(|a, b| kind(*b).cmp(&kind(*a)).then(of(*b).total_cmp(&of(*a))).then(a.cmp(b)));
        rows.into_iter().take(count).map(|row| self.table.number(row) - 1).collect()
    }
}

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

impl Quantiles {
    /// Whether the figure differs between runs by more than its rounding.
    fn varies(&self) -> bool {
        self.deviation.is_some_and(|deviation| deviation > 1e-9 * self.mean.abs())
    }
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

/// The verdicts on film, and how many runs have each.
fn verdicts(table: &Table) -> Vec<(String, usize)> {
    let mut counts = BTreeMap::new();
    if let Some(Values::Texts(verdicts)) = table.column(VERDICT).map(|column| &column.values) {
        verdicts.iter().flatten().for_each(|verdict| *counts.entry(verdict.clone()).or_default() += 1);
    }
    counts.into_iter().collect()
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
        interval: share.interval.map(Interval::ends),
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

/// Least number of different inputs of a parabola.
const LEAST_PARABOLA: usize = 6;

/// The polynomial of second degree, or of first, that fits points with the least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trend {
    /// Where the polynomial is centred, and by what its argument is divided.
    centre: f64,
    scale: f64,
    /// Constant, linear and quadratic part.
    coefficients: [f64; 3],
}

impl Trend {
    /// The trend of `points`; none of less than three, or of points at one place.
    pub fn of_points(points: &[[f64; 2]]) -> Option<Trend> {
        let points: Vec<[f64; 2]> =
            points.iter().copied().filter(|point| point.iter().all(|v| v.is_finite())).collect();
        let mut places: Vec<f64> = points.iter().map(|point| point[0]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let (first, last) = (*places.first()?, *places.last()?);
        if points.len() < 3 || last <= first {
            return None;
        }
        let (centre, scale) = (0.5 * (first + last), 0.5 * (last - first));
        let terms = if places.len() < LEAST_PARABOLA { 2 } else { 3 };
        let (mut normal, mut right) = (DMatrix::<f64>::zeros(terms, terms), DVector::<f64>::zeros(terms));
        for [x, y] in points {
            let u = (x - centre) / scale;
            let powers = DVector::from_column_slice(&[1.0, u, u * u][..terms]);
            normal += &powers * powers.transpose();
            right += powers * y;
        }
        let mut coefficients = [0.0; 3];
        coefficients[..terms].copy_from_slice(normal.cholesky()?.solve(&right).as_slice());
        Some(Trend { centre, scale, coefficients })
    }

    /// Its value at a place.
    pub fn at(&self, x: f64) -> f64 {
        let u = (x - self.centre) / self.scale;
        let [constant, linear, quadratic] = self.coefficients;
        constant + u * (linear + u * quadratic)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn results(figure: &str, values: [Option<f64>; 5], failed: usize) -> SweepResults {
        let column = |name: &str, values| Column { name: name.into(), values };
        let failure = (0..5).map(|row| (row == failed).then(|| "lost".to_owned())).collect();
        let columns = vec![
            column("run", Values::Numbers((1..=5).map(|run| Some(f64::from(run))).collect())),
            column("status", Values::Texts(vec![None; 5])),
            column(figure, Values::Numbers(values.to_vec())),
            column("failure", Values::Texts(failure)),
        ];
        SweepResults { table: Table { columns, inputs: 0, figures: 1 }, failed: 1, ..SweepResults::default() }
    }

    #[test]
    fn ruptured_runs_are_worse_than_any_that_held() {
        let mut found = results("peak_N", [Some(3.0), Some(1.0), None, Some(0.5), Some(2.0)], 4);
        let flags = Values::Flags(vec![Some(false), Some(true), Some(true), Some(false), None]);
        found.table.columns.push(Column { name: "ruptured".into(), values: flags });
        assert_eq!(found.worst("peak_N", 5), [4, 1, 2, 0, 3]);
    }

    #[test]
    fn the_worst_runs_are_those_with_the_largest_values() {
        let found = results("depth_m", [Some(-3.0), Some(1.0), None, Some(0.5), Some(2.0)], 3);
        assert_eq!(found.worst("depth_m", 5), [3, 4, 1, 0, 2]);
        let negative =
            |figure| results(figure, [Some(-1.0), Some(-3.0), Some(-2.0), Some(-4.0), None], 4).worst(figure, 3);
        assert_eq!(negative("own_margin"), [4, 0, 2]);
        assert_eq!(negative("peak_displacement_m"), [4, 3, 1], "the deepest");
    }

    #[test]
    fn a_parabola_is_its_own_trend() {
        let points: Vec<[f64; 2]> =
            (0..9).map(|i| f64::from(i) * 1e-6).map(|x| [x, 2.0 - 3e5 * x + 4e11 * x * x]).collect();
        let trend = Trend::of_points(&points).unwrap();
        assert!(points.iter().all(|[x, y]| (trend.at(*x) - y).abs() < 1e-9), "{trend:?}");
    }

    #[test]
    fn few_places_have_a_line_and_one_has_none() {
        let trend = Trend::of_points(&[[1.0, 1.0], [1.0, 3.0], [3.0, 4.0], [3.0, 6.0]]).unwrap();
        assert!((trend.at(2.0) - 3.5).abs() < 1e-12 && (trend.at(3.0) - 5.0).abs() < 1e-12);
        assert_eq!(Trend::of_points(&[[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]), None);
        assert_eq!(Trend::of_points(&[[1.0, 1.0], [2.0, f64::NAN]]), None);
    }
}
