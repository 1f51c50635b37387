//! The results of a sweep: its table and what follows from it.

use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::statistics::{self, Effects, Quantiles};
use super::table::Table;
use super::{Done, Sweep, warnings};
use crate::evaluate::{EvaluationError, Evaluations, is_cost};
use crate::post::{badness, is_of_script, is_result};
use crate::script::RunFindings;
use base::finding::Finding;
use base::table::{Column, Values};

/// The results of a sweep.
#[derive(Clone, Debug)]
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
        let statistics = figures.iter().filter_map(|column| {
            let name = column.name.clone();
            statistics::of_column(column).map(|quantiles| (name, quantiles))
        });
        let rupture = table.column("ruptured").and_then(statistics::probability);
        let varies = |column: &&&Column| {
            let quantiles = statistics::of_column(column);
            quantiles.is_some_and(|of| of.deviation.is_some_and(|deviation| deviation > 1e-9 * of.mean.abs()))
        };
        let independent = sweep.variation().is_independent();
        let of = |column: &Column| statistics::effects(&table, column, independent);
        let of_rupture =
            rupture.filter(|(share, _)| *share > 0.0 && *share < 1.0).and_then(|_| of(table.column("ruptured")?));
        let varying: Vec<&Column> = figures.iter().filter(varies).copied().collect();
        let effects = varying.par_iter().filter_map(|column| of(column)).collect::<Vec<_>>();
        let effects = effects.into_iter().chain(of_rupture).collect();
        Ok(SweepResults {
            reused: done.cache_hits,
            failed,
            missing: sweep.len() - done.len(),
            engine_s: done.engine_s,
            statistics: statistics.collect(),
            rupture: rupture.map(|(share, interval)| (share, [interval.low, interval.high])),
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
    pub fn summary(&self, sweep: &Sweep, seconds: f64) -> Map<String, Value> {
        let statistics = self.statistics.iter().map(|(name, quantiles)| (name.clone(), json!(quantiles)));
        let (probability, interval) = self.rupture.unzip();
        let entries = [
            ("scenario", json!(sweep.model().name)),
            ("title", json!(sweep.model().title)),
            ("droptower", json!(env!("CARGO_PKG_VERSION"))),
            ("runs", json!(self.table.rows())),
            ("reused", json!(self.reused)),
            ("failed", json!(self.failed)),
            ("missing", json!(self.missing)),
            ("seconds", json!(seconds)),
            ("engine_s", json!(self.engine_s)),
            ("statistics", Value::Object(statistics.collect())),
            ("rupture_probability", json!(probability)),
            ("interval", json!(interval)),
            ("effects", json!(self.effects)),
            ("findings", json!(self.findings)),
        ];
        entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }

    /// The figures that are shown first, at most so many: the one by which runs are ranked, those by which they are
    /// judged, and those that a script measures, as far as they vary.
    pub fn shown_figures<'a>(&'a self, ranked: &'a str, most: usize) -> Vec<&'a str> {
        let varies = |of: &Quantiles| of.deviation.is_some_and(|deviation| deviation > 1e-9 * of.mean.abs());
        let varying = || self.statistics.iter().filter(|(_, of)| varies(of)).map(|(name, _)| name.as_str());
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
        let table = Table { columns, inputs: 0, figures: 1 };
        SweepResults {
            table,
            reused: 0,
            failed: 1,
            missing: 0,
            engine_s: 0.0,
            statistics: vec![],
            rupture: None,
            effects: vec![],
            findings: vec![],
        }
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
}
