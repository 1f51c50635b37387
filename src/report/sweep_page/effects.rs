//! What matters: main effects sorted by size, and the figures over the inputs that have them.

use super::super::ranges::{Line, Look as RangeLook, ranges};
use super::SweepPage;
use super::columns::{Columns, Shown, lower};
use base::written::{capital, digits};
use plot::{Curve, Look, Plot};
use study::sweep::Trend;

/// Most plots of figures over inputs.
const MOST_PLOTS: usize = 9;

/// Most points of a plot.
const MOST_POINTS: usize = 1000;

/// Points of the curve of a trend.
const TREND_POINTS: usize = 40;

/// The effect of an input on a figure.
pub(super) struct Shared<'a> {
    pub input: &'a Shown<'a>,
    /// Of the variance.
    pub share: f64,
    pub interval: Option<[f64; 2]>,
    /// Whether it can be told from zero.
    pub is_distinct: bool,
    /// By how much the figure changes, SI, as the input goes from its quantile of 5 % to that of 95 %; none of a word.
    pub change: Option<f64>,
}

/// The effects of all inputs on a figure, the largest first; those that cannot be told from zero come last.
pub(super) fn sorted<'a>(page: &SweepPage, columns: &'a Columns, figure: &Shown) -> Vec<Shared<'a>> {
    let Some(effects) = page.results.effects.iter().find(|effects| effects.figure == figure.key) else { return vec![] };
    let shared = |input: &'a Shown<'a>| {
        let effect = effects.effects.iter().find(|effect| effect.input == input.column.name)?;
        // A share has no meaning below zero: the estimate is then as good as zero.
        let is_distinct = effect.share > 0.0 && effect.interval.is_none_or(|[low, _]| low > 0.0);
        Some(Shared {
            input,
            share: effect.share,
            interval: effect.interval,
            is_distinct,
            change: change(input, figure),
        })
    };
    let mut all: Vec<Shared> = columns.inputs.iter().filter_map(shared).collect();
    all.sort_by(|a, b| b.is_distinct.cmp(&a.is_distinct).then(b.share.total_cmp(&a.share)));
    all
}

/// Pairs of input and figure, SI.
fn points(input: &Shown, figure: &Shown) -> Vec<[f64; 2]> {
    input.numbers().into_iter().zip(figure.numbers()).filter_map(|(x, y)| Some([x?, y?])).collect()
}

fn change(input: &Shown, figure: &Shown) -> Option<f64> {
    let points = points(input, figure);
    let trend = Trend::of_points(&points)?;
    let mut places: Vec<f64> = points.iter().map(|point| point[0]).collect();
    places.sort_by(f64::total_cmp);
    let at = |share: f64| places[((places.len() - 1) as f64 * share).round() as usize];
    Some(trend.at(at(0.95)) - trend.at(at(0.05)))
}

/// A tornado of each figure that is shown first (HTML).
pub(super) fn tornadoes(page: &SweepPage, columns: &Columns) -> String {
    let of = |figure: &Shown| page.results.effects.iter().find(|effects| effects.figure == figure.key);
    let tornado = |figure: &Shown| {
        let count = of(figure).map_or(0, |effects| effects.count);
        let lines: Vec<Line> = sorted(page, columns, figure).iter().map(|effect| line(effect, figure, count)).collect();
        let together = of(figure).and_then(|effects| effects.together).map_or_else(String::new, |[low, high]| {
            let [low, high] = [low, high].map(|share| digits(rounded(share)));
            format!("<p class=\"note\">Inputs that act together have {low} to {high} %.</p>\n")
        });
        ranges(&capital(&figure.words), RangeLook::Bars, &lines) + together.as_str()
    };
    let rupture = page.results.table.column("ruptured").map(Shown::of_figure);
    let all: String =
        columns.figures.iter().chain(rupture.as_ref().filter(|own| of(own).is_some())).map(tornado).collect();
    if all.is_empty() {
        return "<p class=\"note\">Not known: too few runs, or figures that do not vary.</p>\n".into();
    }
    let note = "Share of the variance of a figure that an input has alone, with its interval of 95 %; and by how much the \
                figure changes from the value that 5 % of the runs are below to that which 95 % are below. The intervals \
                contain what the runs do not tell of any input.";
    format!("<div class=\"blocks\">\n{all}</div>\n<p class=\"note\">{note}</p>\n")
}

fn line(effect: &Shared, figure: &Shown, count: usize) -> Line {
    let words = effect.input.words.clone();
    let title = effect.input.key.clone();
    if !effect.is_distinct {
        let text = format!("not distinguishable from 0 with {count} runs");
        return Line { words, title, text, ..Line::default() };
    }
    let share = effect.share.min(1.0);
    let interval = effect.interval.map(|[low, high]| [low.max(0.0), high.min(1.0)]);
    let range = interval.map(|[low, high]| format!(" ({} to {})", digits(rounded(low)), digits(rounded(high))));
    let change = effect.change.map(|change| format!(", {}", signed(figure, change)));
    let text = format!("{} %{}{}", digits(rounded(share)), range.unwrap_or_default(), change.unwrap_or_default());
    // Of all figures on the axis of the whole.
    Line { words, title, value: Some(share), interval, text, ..Line::default() }
}

/// A share in whole percent: no more is known of it.
fn rounded(share: f64) -> f64 {
    (100.0 * share).round()
}

/// A change with its sign and unit.
fn signed(figure: &Shown, change: f64) -> String {
    let text = figure.reading.text(change);
    if change > 0.0 { format!("+{text}") } else { text }
}

/// Figures over the inputs that matter for them, with the trend.
pub(super) fn scatters(page: &SweepPage, columns: &Columns) -> Vec<Plot> {
    let of_figure = |figure| {
        let distinct = sorted(page, columns, figure).into_iter().filter(|effect| effect.is_distinct);
        distinct.filter_map(|effect| Some((effect.share, scatter(effect.input, figure)?))).collect::<Vec<_>>()
    };
    let mut all: Vec<(usize, f64, Plot)> = vec![];
    for (place, figure) in columns.figures.iter().enumerate() {
        all.extend(of_figure(figure).into_iter().map(|(share, plot)| (place, share, plot)));
    }
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(MOST_PLOTS);
    // Those of one figure stay together, in the order of the figures.
    all.sort_by_key(|(place, ..)| *place);
    all.into_iter().map(|(_, _, plot)| plot).collect()
}

/// A figure over an input that is a number.
fn scatter(input: &Shown, figure: &Shown) -> Option<Plot> {
    let points = points(input, figure);
    let shown = |[x, y]: [f64; 2]| [input.reading.value(x), figure.reading.value(y)];
    let trend = Trend::of_points(&points).map(|trend| {
        let low = points.iter().map(|point| point[0]).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|point| point[0]).fold(f64::NEG_INFINITY, f64::max);
        let at = |step: usize| low + (high - low) * step as f64 / TREND_POINTS as f64;
        Curve::line("trend", (0..=TREND_POINTS).map(|step| shown([at(step), trend.at(at(step))])))
    });
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let points: Vec<[f64; 2]> = points.into_iter().step_by(every).map(shown).collect();
    let runs = Curve { name: "runs".into(), points, look: Look::Points };
    let title = format!("{} over {}", capital(&figure.words), lower(&input.words));
    let curves = std::iter::once(runs).chain(trend).collect::<Vec<_>>();
    (!curves[0].points.is_empty()).then(|| Plot::new(title, [&input.heading(), &figure.heading()], curves))
}
