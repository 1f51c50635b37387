//! The runs of a sweep so far: what varies in them, and the figures that came of it.

use std::collections::BTreeMap;

use base::units::Dimension;
use base::written::Reading;
use scene::model::{Factor, Input};
use scene::scenario::grammar;
use study::evaluate::Evaluation;
use study::post::{badness, is_of_script, is_result};
use study::sweep::Sweep;

use super::points::{Axis, Points};

/// Most figures that are shown.
const MOST_FIGURES: usize = 4;

/// Most runs whose figures are stored.
const MOST_RUNS: usize = 20_000;

/// The runs of a sweep that are done.
#[derive(Clone, Debug)]
pub(super) struct SweepRuns {
    factors: Vec<(String, Option<Dimension>)>,
    /// The figure by which runs are ranked.
    ranked: String,
    rows: BTreeMap<usize, Row>,
    /// Runs that have figures, those that are not among the rows included.
    finished: usize,
    /// Place and value of the run that is worst by that figure.
    worst: Option<(usize, f64)>,
}

/// Inputs of a run, and its figures.
type Row = (Vec<Input>, Vec<(String, f64)>);

impl SweepRuns {
    pub(super) fn new(sweep: &Sweep, ranked: &str) -> SweepRuns {
        let title = |factor: &Factor| grammar::title(&factor.path).unwrap_or_else(|| factor.path.clone());
        let factors = &sweep.variation().factors;
        let is_twice = |title: &String| factors.iter().filter(|other| self::title_is(other, title)).count() > 1;
        let words = |factor: &Factor| Some(title(factor)).filter(|title| !is_twice(title));
        let factors =
            factors.iter().map(|factor| (words(factor).unwrap_or_else(|| factor.path.clone()), factor.dimension));
        SweepRuns {
            factors: factors.collect(),
            ranked: ranked.to_owned(),
            rows: BTreeMap::new(),
            finished: 0,
            worst: None,
        }
    }

    /// Takes note of a run; a failed one has no figures.
    pub(super) fn add(&mut self, place: usize, inputs: Vec<Input>, evaluation: &Evaluation) {
        if evaluation.failure.is_some() {
            return;
        }
        self.finished += 1;
        if let Some(value) =
            evaluation.figures.iter().find(|(name, _)| *name == self.ranked).and_then(|(_, figure)| figure.number())
            && self.worst.is_none_or(|(_, worst)| badness(&self.ranked, value) > badness(&self.ranked, worst))
        {
            self.worst = Some((place, value));
        }
        if self.rows.len() >= MOST_RUNS {
            return;
        }
        let is_shown = |name: &str| name == self.ranked || is_result(name) || is_of_script(name);
        let figures = evaluation.figures.iter().filter(|(name, _)| is_shown(name));
        let figures = figures.filter_map(|(name, figure)| Some((name.clone(), figure.number()?))).collect();
        self.rows.insert(place, (inputs, figures));
    }

    /// The figures that vary, the one by which runs are ranked first.
    fn figures(&self) -> Vec<String> {
        let mut ranges: Vec<(&String, [f64; 2])> = vec![];
        for (name, value) in self.rows.values().flat_map(|(_, figures)| figures) {
            match ranges.iter_mut().find(|(known, _)| *known == name) {
                Some((_, [low, high])) => (*low, *high) = (low.min(*value), high.max(*value)),
                None => ranges.push((name, [*value; 2])),
            }
        }
        ranges.retain(|(_, [low, high])| high - low > 1e-9 * high.abs().max(low.abs()));
        ranges.sort_by_key(|(name, _)| **name != self.ranked);
        ranges.into_iter().take(MOST_FIGURES).map(|(name, _)| name.clone()).collect()
    }

    /// The run that is worst by the figure by which runs are ranked: number, words, and the value as it is read.
    pub(super) fn worst(&self) -> Option<(usize, String, String)> {
        let (place, value) = self.worst?;
        let (words, reading) = Reading::of_name(&self.ranked, value);
        Some((place + 1, words, reading.text(value)))
    }

    /// The runs in the space of what varies.
    pub(super) fn points(&self) -> Points {
        let figures = self.figures();
        let mut axes = vec![];
        let mut columns: Vec<Vec<Option<f64>>> = vec![];
        for (at, (words, dimension)) in self.factors.iter().enumerate() {
            let inputs = self.rows.values().map(|(inputs, _)| inputs.get(at));
            let (axis, column) = input(words, *dimension, inputs.collect());
            axes.push(axis);
            columns.push(column);
        }
        for name in &figures {
            let of = |(_, figures): &Row| figures.iter().find(|(own, _)| own == name).map(|(_, value)| *value);
            let column: Vec<Option<f64>> = self.rows.values().map(of).collect();
            let (words, reading) = Reading::of_name(name, size(&column));
            axes.push(Axis::outcome(reading.heading(&words)));
            columns.push(column.into_iter().map(|value| value.map(|value| reading.value(value))).collect());
        }
        let rows = (0..self.rows.len()).map(|row| columns.iter().map(|column| column[row]).collect());
        Points { axes, rows: rows.collect(), all: self.finished, best: None, of: "runs", front: [0, 1] }
    }
}

fn title_is(factor: &Factor, title: &String) -> bool {
    grammar::title(&factor.path).as_ref() == Some(title)
}

fn size(column: &[Option<f64>]) -> f64 {
    column.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// The axis of a key that varies, and its values: numbers in the unit in which they are read, words as their places.
fn input(words: &str, dimension: Option<Dimension>, inputs: Vec<Option<&Input>>) -> (Axis, Vec<Option<f64>>) {
    let number = |input: &Option<&Input>| match input {
        Some(Input::Number(number)) => Some(*number),
        _ => None,
    };
    let numbers: Vec<Option<f64>> = inputs.iter().map(number).collect();
    if numbers.iter().all(Option::is_some) {
        let reading = Reading::of_unit(dimension.map_or("1", |dimension| dimension.unit), size(&numbers));
        let values = numbers.into_iter().map(|value| value.map(|value| reading.value(value)));
        return (Axis::input(reading.heading(words)), values.collect());
    }
    let mut names: Vec<String> = vec![];
    let values = inputs.iter().map(|input| {
        let name = input.map(ToString::to_string)?;
        let known = names.iter().position(|other| *other == name);
        Some(known.unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        }) as f64)
    });
    let values = values.collect();
    (Axis { names, ..Axis::input(words) }, values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::evaluate::Figure;

    #[test]
    fn runs_are_points_in_the_units_in_which_they_are_read() {
        let metre = Some(base::units::Length::DIMENSION);
        let mut runs = SweepRuns {
            factors: vec![("Thickness".into(), metre), ("Film".into(), None)],
            ranked: "peak_force_N".into(),
            rows: BTreeMap::new(),
            finished: 0,
            worst: None,
        };
        let evaluation = |force: f64, failure: Option<&str>| Evaluation {
            figures: vec![
                ("peak_displacement_m".into(), Figure::Number(-0.1 * force)),
                ("peak_force_N".into(), Figure::Number(force)),
                ("elements".into(), Figure::Number(4.0)),
            ],
            failure: failure.map(str::to_owned),
            ..Evaluation::failed(String::new())
        };
        let inputs = |thickness, film: &str| vec![Input::Number(thickness), Input::Text(film.into())];
        runs.add(7, inputs(12e-6, "a.toml"), &evaluation(1.0, None));
        runs.add(3, inputs(10e-6, "b.toml"), &evaluation(2.0, None));
        runs.add(5, inputs(11e-6, "b.toml"), &evaluation(9.0, Some("the film tore")));
        let points = runs.points();
        let words: Vec<&str> = points.axes.iter().map(|axis| axis.words.as_str()).collect();
        assert_eq!(words[..3], ["Thickness (µm)", "Film", "peak force (N)"]);
        assert_eq!(points.axes[1].names, ["b.toml", "a.toml"]);
        let rounded = |row: &Vec<Option<f64>>| row.iter().map(|value| value.unwrap().round()).collect::<Vec<_>>();
        assert_eq!(rounded(&points.rows[0])[..3], [10.0, 0.0, 2.0]);
        assert_eq!(rounded(&points.rows[1])[..3], [12.0, 1.0, 1.0]);
        assert_eq!(runs.worst(), Some((4, "peak force".into(), "2 N".into())));
        assert_eq!(points.all, 2);
        // The deepest run, although its displacement is the smallest number.
        let mut deep =
            SweepRuns { ranked: "peak_displacement_m".into(), rows: BTreeMap::new(), worst: None, ..runs.clone() };
        deep.add(7, inputs(12e-6, "a.toml"), &evaluation(1.0, None));
        deep.add(3, inputs(10e-6, "b.toml"), &evaluation(2.0, None));
        assert_eq!(deep.worst(), Some((4, "peak displacement".into(), "\u{2212}200 mm".into())));
        // Runs that are drawn no more still count.
        for place in 10..MOST_RUNS + 10 {
            runs.rows.insert(place, (inputs(12e-6, "a.toml"), vec![]));
        }
        runs.add(MOST_RUNS + 20, inputs(12e-6, "a.toml"), &evaluation(3.0, None));
        assert_eq!(runs.worst(), Some((MOST_RUNS + 21, "peak force".into(), "3 N".into())));
        assert_eq!((runs.finished, runs.rows.contains_key(&(MOST_RUNS + 20))), (3, false));
    }
}
