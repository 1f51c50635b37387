//! The inputs and outputs of a sweep as one table: a row for each run, by number.

use std::collections::HashMap;

use super::{Done, Sweep};
use crate::evaluate::{Evaluation, EvaluationError, Evaluations, Figure};
use base::table::{Column, Values};
use scene::model::Input;

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
