//! Points in the space of what varies, with what came of each, as the page's script draws them: pairs of what varies coloured by
//! an outcome, parallel coordinates, and the front of two outcomes.

use serde_json::{Value, json};

use super::super::drawn::DIGITS;
use super::super::html::{data, escape};
use base::number::rounded;

/// Most points that are drawn.
const MOST_POINTS: usize = 1500;

/// One coordinate of the points.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    /// Words and unit.
    pub(super) words: String,
    /// The words that the numbers stand for, where it has words for values.
    pub(super) names: Vec<String>,
    /// Whether it came of the others.
    pub(super) is_outcome: bool,
}

/// Points, in the order in which they became known.
#[derive(Clone, Debug)]
pub(super) struct Points {
    pub(super) axes: Vec<Axis>,
    pub(super) rows: Vec<Vec<Option<f64>>>,
    /// How many there are, of which these are the first.
    pub(super) all: usize,
    /// Place of the best one.
    pub(super) best: Option<usize>,
    /// What a point is, in the plural.
    pub(super) of: &'static str,
    /// The two outcomes whose front is shown first, by their places among the outcomes.
    pub(super) front: [usize; 2],
}

impl Axis {
    pub(super) fn input(words: impl Into<String>) -> Axis {
        Axis { words: words.into(), names: vec![], is_outcome: false }
    }

    pub(super) fn outcome(words: impl Into<String>) -> Axis {
        Axis { words: words.into(), names: vec![], is_outcome: true }
    }
}

impl Points {
    /// The figures of the points (HTML); empty of fewer than two points.
    pub(super) fn figures(&self, title: &str) -> String {
        let outcomes = self.axes.iter().filter(|axis| axis.is_outcome).count();
        let inputs = self.axes.len() - outcomes;
        if self.rows.len() < 2 || inputs == 0 || outcomes == 0 {
            return String::new();
        }
        let figure = |kind: &str, heading: &str, words: &str| {
            let (heading, words) = (escape(&format!("{title}: {heading}")), escape(words));
            format!(
                "<figure data-draw=\"{kind}\">\n<h3>{heading}</h3>\n<figcaption class=\"unseen\">{words}</figcaption>\n\
                 </figure>\n"
            )
        };
        let of = self.of;
        let pairs = format!("{of} over every two of what varies, coloured by what came of them");
        let lines = format!("a line for each of the {of} through its values on every axis");
        let front = format!("{of} over two of their outcomes; of those on the front none is smaller in size in both");
        let figures = [
            figure("pairs", if inputs > 1 { "pairs" } else { "what varies" }, &pairs),
            figure("lines", "parallel coordinates", &lines),
            if outcomes > 1 { figure("front", "two outcomes, and their front", &front) } else { String::new() },
        ];
        format!(
            "<div class=\"scatter\" data-key=\"{}\">\n{}{}</div>\n",
            escape(title),
            data(&self.content()),
            figures.concat()
        )
    }

    fn content(&self) -> Value {
        let axis = |axis: &Axis| json!({ "words": axis.words, "names": axis.names, "outcome": axis.is_outcome });
        let shown = self.shown();
        let number = |value: &Option<f64>| match value {
            Some(value) if value.is_finite() => rounded(*value, DIGITS).into(),
            _ => Value::Null,
        };
        let row = |place: &usize| Value::Array(self.rows[*place].iter().map(number).collect());
        json!({
            "of": self.of,
            "axes": self.axes.iter().map(axis).collect::<Vec<_>>(),
            "rows": shown.iter().map(row).collect::<Vec<_>>(),
            "front": self.front,
            "best": self.best.and_then(|best| shown.iter().position(|place| *place == best)),
            "all": self.all,
        })
    }

    /// Places of the points that are drawn: of many evenly spread ones, the best and the last.
    fn shown(&self) -> Vec<usize> {
        let every = self.rows.len().div_ceil(MOST_POINTS).max(1);
        let last = self.rows.len() - 1;
        (0..self.rows.len()).filter(|place| place % every == 0 || *place == last || Some(*place) == self.best).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::html::block;

    fn points(count: usize) -> Points {
        let axes = vec![Axis::input("k1"), Axis::input("<ke>"), Axis::outcome("error")];
        let row = |place: usize| vec![Some(place as f64), Some(1.0 / 3.0), (place > 0).then_some(f64::NAN)];
        Points { axes, rows: (0..count).map(row).collect(), all: count, best: Some(1), of: "trials", front: [0, 1] }
    }

    #[test]
    fn points_are_data_for_the_script() {
        let html = points(3).figures("1008 & 1009");
        let block = block(&html).expect("a block");
        let content: Value = serde_json::from_str(block).expect("JSON");
        assert_eq!(content["rows"][0], json!([0.0, 0.333333, null]), "what has no value is a gap");
        assert_eq!((&content["best"], &content["axes"][1]["words"]), (&json!(1), &json!("<ke>")));
        assert!(html.contains("1008 &amp; 1009: pairs") && !html.contains("data-draw=\"front\""), "{html}");
        assert_eq!(points(1).figures("1008"), "");
    }

    #[test]
    fn of_many_points_some_are_drawn_and_the_best_and_the_last_among_them() {
        let content = points(4000).content();
        let rows = content["rows"].as_array().expect("rows");
        assert!(rows.len() <= MOST_POINTS + 2, "{}", rows.len());
        let best = content["best"].as_u64().expect("the best") as usize;
        assert_eq!((&rows[best][0], &rows[rows.len() - 1][0]), (&json!(1.0), &json!(3999.0)));
        assert_eq!(content["all"], 4000);
    }
}
