//! The page of a sweep: how its figures scatter, what matters for them, the worst runs, and tables of all.

use std::collections::HashMap;

use serde_json::{Map, Value};

use crate::drawn::{self, Line, RangeLook, ranges};
use crate::figure;
use crate::html::{self, Cell, escape, folded};
use base::number::ends;
use base::shell::quoted;
use base::table::{Column, Values};
use base::units::Dimension;
use base::written::{Reading, capital, digits};
use plot::{Curve, Look, Plot, Window};
use scene::model::Factor;
use scene::scenario::grammar;
use study::post::{self, Verdict};
use study::sweep::{Quantiles, Sweep, SweepResults, Table, Trend};

/// The content of the page of a sweep.
#[derive(Clone, Copy)]
pub struct SweepPage<'a> {
    /// The sweep.
    pub sweep: &'a Sweep,
    /// Its results.
    pub results: &'a SweepResults,
    /// The content of `summary.json`.
    pub summary: &'a Map<String, Value>,
    /// The command that repeats it.
    pub command: &'a str,
    /// The command that runs the scenario as it is written.
    pub single: &'a str,
    /// The figure that is shown first.
    pub figure: &'a str,
}

/// The sentence of the page.
pub fn sweep_answer(page: &SweepPage) -> String {
    sentence(page, &Columns::of_page(page))
}

/// `report.html` of a sweep.
pub fn sweep_page(page: &SweepPage) -> String {
    let SweepPage { sweep, results, summary, command, .. } = *page;
    let title = format!("{}: {} runs", sweep.model().title, results.table.rows());
    let columns = Columns::of_page(page);
    let facts = summary.iter().filter(|(_, value)| value.is_number());
    let parts = [
        html::findings(Vec::new(), &results.findings),
        picture(page, &columns),
        html::section("What matters", &tornadoes(page, &columns)),
        html::section("Trends", &drawn::small(&scatters(page, &columns))),
        html::section("Worst runs", &worst_runs(page, &columns)),
        html::section("Failed runs", &failures(results)),
        html::section("What varies", &inputs(sweep, &columns)),
        html::section("Figures", &folded("median, range and deviation of every figure", &statistics(results))),
        html::section("Runs", &folded(&format!("{} runs", results.table.rows()), &all_runs(page, &columns))),
        html::section("Run it again", &[html::verbatim(command), figure::table(facts)].concat()),
    ];
    html::finished(&title, &sentence(page, &columns), &parts)
}

/// The keys that vary and the values that they have.
fn inputs(sweep: &Sweep, columns: &Columns) -> String {
    let row = |(factor, column): (&scene::model::Factor, &Shown)| {
        vec![Cell::text(&column.words).titled(&column.key), Cell::text(factor.shown_values())]
    };
    let rows: Vec<Vec<Cell>> = sweep.variation().factors.iter().zip(&columns.inputs).map(row).collect();
    let method = html::note(&sweep.variation().description());
    [html::sorted_table(&["input", "values"].map(Cell::text), &rows), method].concat()
}

/// Least and most bars of a histogram.
const BARS: [usize; 2] = [5, 24];

/// How the figure by which runs are ranked scatters, what matters most for it, and whether the film holds.
pub(crate) fn sentence(page: &SweepPage, columns: &Columns) -> String {
    let results = page.results;
    let scatter = columns.figures.first().and_then(|figure| {
        let of = quantiles(results, figure)?;
        let runs = results.table.rows();
        let part = if of.count < runs { format!(" (of {} of {runs} runs)", of.count) } else { String::new() };
        Some(format!("{}{part} {}{}", capital(&figure.words), range(&figure.reading, of), cause(page, columns, figure)))
    });
    let count = results.table.rows();
    let none = match count {
        0 => "No run has an outcome.".into(),
        _ => format!("No figure varies over {count} runs."),
    };
    let failed = (results.failed > 0).then(|| format!("{} of {count} runs failed.", results.failed));
    let sentences = [Some(scatter.unwrap_or(none)), held(results), failed];
    sentences.into_iter().flatten().collect::<Vec<_>>().join(" ")
}

/// The median and the range of nine in ten runs.
fn range(reading: &Reading, of: &Quantiles) -> String {
    let [low, high] = [of.p05, of.p95].map(|value| reading.digits(value));
    format!("{}, in 9 of 10 runs {}", reading.text(of.p50), reading.with_unit(&format!("{low} to {high}")))
}

/// The input with the largest effect on a figure.
fn cause(page: &SweepPage, columns: &Columns, figure: &Shown) -> String {
    match sorted(page, columns, figure).into_iter().find(|effect| effect.is_distinct) {
        Some(largest) => {
            let share = digits(100.0 * largest.share);
            format!("; what matters most is {} ({share} % of its variance).", lower(&largest.input.words))
        }
        None => ".".into(),
    }
}

/// Whether the film held.
fn held(results: &SweepResults) -> Option<String> {
    let (share, [low, high]) = results.rupture?;
    let [share_shown, low, high] = [share, low, high].map(|share| digits(100.0 * share));
    let of =
        |verdict: Verdict| results.verdicts.iter().find(|(own, _)| own == verdict.name()).map_or(0, |(_, runs)| *runs);
    let count: usize = results.verdicts.iter().map(|(_, runs)| runs).sum();
    let doubts = [
        (Verdict::TooCoarse, "have elements that are too coarse to tell whether it holds"),
        (Verdict::Descending, "end before the lowest point"),
    ];
    let doubts = doubts.iter().filter(|(verdict, _)| of(*verdict) > 0);
    let doubts: Vec<String> = doubts.map(|(verdict, why)| format!("{} {why}", of(*verdict))).collect();
    if !doubts.is_empty() {
        let broke = if share > 0.0 {
            format!("The film ruptures in {share_shown} % of the runs")
        } else {
            "No film broke".into()
        };
        return Some(format!("{broke}, but of {count} runs {}.", doubts.join(" and ")));
    }
    Some(match share {
        0.0 if of(Verdict::CannotBreak) == count && count > 0 => format!("{}.", Verdict::CannotBreak.sentence()),
        0.0 => format!("The film holds in every run: it ruptures with a probability below {high} %."),
        1.0 => format!("The film ruptures in every run: with a probability above {low} %."),
        _ => format!("The film ruptures in {share_shown} % of the runs (probability {low} to {high} %)."),
    })
}

fn quantiles<'a>(results: &'a SweepResults, figure: &Shown) -> Option<&'a Quantiles> {
    results.statistics.iter().find(|(name, _)| *name == figure.key).map(|(_, of)| of)
}

/// Histograms of the figures that are shown first, and the probability of rupture where it is neither 0 nor 1 (HTML).
fn picture(page: &SweepPage, columns: &Columns) -> String {
    let plots = columns.figures.iter().filter_map(|figure| histogram(figure, quantiles(page.results, figure)?));
    [drawn::small_figures(plots.map(|plot| drawn::filled(&plot))), rupture(page.results)].concat()
}

/// The probability of rupture with its interval.
fn rupture(results: &SweepResults) -> String {
    let line = results.rupture.filter(|(share, _)| *share > 0.0 && *share < 1.0).map(|(share, interval)| {
        let [low, high] = interval.map(|end| digits(100.0 * end));
        let text = format!("{} % of the runs ({low} to {high})", digits(100.0 * share));
        Line {
            words: "Film ruptures".into(),
            title: "ruptured".into(),
            value: Some(share),
            interval: Some(interval),
            text,
            ..Line::default()
        }
    });
    ranges("", RangeLook::Bars, &Vec::from_iter(line))
}

/// How many runs have which value.
fn histogram(figure: &Shown, of: &Quantiles) -> Option<Plot> {
    let values: Vec<f64> = figure.numbers().into_iter().flatten().filter(|value| value.is_finite()).collect();
    let [low, high] = ends(values.iter().copied()).filter(|[low, high]| low < high)?;
    let count = ((values.len() as f64).sqrt().ceil() as usize).clamp(BARS[0], BARS[1]);
    let width = (high - low) / count as f64;
    let mut bars = vec![0_usize; count];
    for value in values {
        bars[(((value - low) / width) as usize).min(count - 1)] += 1;
    }
    let shown = |bar: usize| figure.reading.value(low + width * bar as f64);
    let tops = bars.iter().enumerate().flat_map(|(bar, runs)| [shown(bar), shown(bar + 1)].map(|x| [x, *runs as f64]));
    let points = std::iter::once([shown(0), 0.0]).chain(tops).chain([[shown(count), 0.0]]);
    let window =
        Window { label: "9 of 10 runs".into(), range: [of.p05, of.p95].map(|value| figure.reading.value(value)) };
    let curves = vec![Curve::line("runs", points)];
    let plot = Plot::new(capital(&figure.words), [&figure.heading(), "runs"], curves);
    Some(Plot { window: Some(window), ..plot })
}

/// Most plots of figures over inputs.
const MOST_PLOTS: usize = 9;

/// Most points of a plot.
const MOST_POINTS: usize = 1000;

/// Points of the curve of a trend.
const TREND_POINTS: usize = 40;

/// The effect of an input on a figure.
struct Shared<'a> {
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
fn sorted<'a>(page: &SweepPage, columns: &'a Columns, figure: &Shown) -> Vec<Shared<'a>> {
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
fn tornadoes(page: &SweepPage, columns: &Columns) -> String {
    let of = |figure: &Shown| page.results.effects.iter().find(|effects| effects.figure == figure.key);
    let tornado = |figure: &Shown| {
        let count = of(figure).map_or(0, |effects| effects.count);
        let lines: Vec<Line> = sorted(page, columns, figure).iter().map(|effect| line(effect, figure, count)).collect();
        let together = of(figure).and_then(|effects| effects.together).map_or_else(String::new, |[low, high]| {
            let [low, high] = [low, high].map(|share| digits(rounded(share)));
            html::note(&format!("Inputs that act together have {low} to {high} %."))
        });
        ranges(&capital(&figure.words), RangeLook::Bars, &lines) + together.as_str()
    };
    let rupture = page.results.table.column("ruptured").map(Shown::of_figure);
    let all: String =
        columns.figures.iter().chain(rupture.as_ref().filter(|own| of(own).is_some())).map(tornado).collect();
    if all.is_empty() {
        return html::note("Not known: too few runs, or figures that do not vary.");
    }
    let note = "Share of the variance of a figure that an input has alone, with its interval of 95 %; and by how much the \
                figure changes from the value that 5 % of the runs are below to that which 95 % are below. The intervals \
                contain what the runs do not tell of any input.";
    html::blocks(&all, note)
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
pub(crate) fn scatters(page: &SweepPage, columns: &Columns) -> Vec<Plot> {
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
    let trend = Trend::of_points(&points).zip(ends(points.iter().map(|point| point[0]))).map(|(trend, [low, high])| {
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

/// Most runs of a table on the page; the file has all of them.
const MOST_ROWS: usize = 200;

/// How many of the worst runs are shown.
const WORST: usize = 3;

/// The worst runs, each with the command that repeats it.
fn worst_runs(page: &SweepPage, columns: &Columns) -> String {
    let SweepPage { sweep, results, single, .. } = *page;
    let item = |place: usize| {
        let row = (0..results.table.rows()).find(|row| results.table.number(*row) == place + 1)?;
        let outcome = match results.table.failure(row) {
            Some(cause) => format!("failed: {cause}"),
            None => columns.figures.iter().map(|figure| said(figure, row)).collect::<Vec<_>>().join(", "),
        };
        let inputs = columns.inputs.iter().map(|input| lower(&said(input, row))).collect::<Vec<_>>().join(", ");
        let command = html::verbatim(&format!("{single} {}", changes(sweep, place)));
        Some(format!(
            "<li><p><b>run {}</b>: {}; with {}</p>\n{command}</li>\n",
            place + 1,
            escape(&outcome),
            escape(&inputs)
        ))
    };
    let items: String = results.worst(page.figure, WORST).into_iter().filter_map(item).collect();
    if items.is_empty() {
        return items;
    }
    let note = format!(
        "Worst by {}, the largest first; --keep worst:{WORST} in the command of the sweep writes their folders too.",
        page.figure
    );
    format!("<ol class=\"worst\">\n{items}</ol>\n{}", html::note(&note))
}

/// The words of a column and its value in a row.
fn said(column: &Shown, row: usize) -> String {
    format!("{} {}", column.words, column.text(row))
}

/// The runs without a result.
pub(crate) fn failures(results: &SweepResults) -> String {
    let rows = (0..results.table.rows()).filter_map(|row| {
        let cause = results.table.failure(row)?;
        let number = results.table.number(row);
        Some(vec![Cell::number(number as f64, number.to_string()), Cell::text(cause)])
    });
    html::sorted_table(&["run", "cause"].map(Cell::text), &rows.take(MOST_ROWS).collect::<Vec<_>>())
}

/// Median, range and deviation of every figure, each in its unit.
fn statistics(results: &SweepResults) -> String {
    let row = |(name, of): &(String, study::sweep::Quantiles)| {
        let (words, reading) = post::reading(name, of.p50.abs().max(of.p95.abs()).max(of.p05.abs()));
        let cell = |value: f64| Cell::number(value, reading.text(value));
        let deviation = of.deviation.map_or_else(Cell::default, cell);
        vec![Cell::text(words).titled(name), cell(of.p50), cell(of.p05), cell(of.p95), cell(of.mean), deviation]
    };
    let head = ["figure", "median", "5 % are below", "95 % are below", "mean", "standard deviation"].map(Cell::text);
    html::sorted_table(&head, &results.statistics.iter().map(row).collect::<Vec<_>>())
}

/// The first runs with inputs, the figures that are shown first, and the changes of the scenario that repeat each.
fn all_runs(page: &SweepPage, columns: &Columns) -> String {
    let SweepPage { sweep, results, .. } = *page;
    let shown = || columns.inputs.iter().chain(&columns.figures);
    let names = shown().map(|column| Cell::text(column.heading()).titled(&column.key));
    let head: Vec<Cell> = std::iter::once(Cell::text("run")).chain(names).chain([Cell::text("repeated by")]).collect();
    let numbers: Vec<Vec<Option<f64>>> = shown().map(Shown::numbers).collect();
    let row = |row: usize| {
        let number = results.table.number(row);
        let cells = shown().zip(&numbers).map(|(column, numbers)| match numbers[row] {
            Some(value) => Cell::reading(Some(value), &column.reading),
            None => Cell::text(column.text(row)),
        });
        let changes = html::verbatim(&changes(sweep, number - 1));
        let command = Cell::html(format!("<details><summary>changes</summary>{changes}</details>"));
        std::iter::once(Cell::number(number as f64, number.to_string())).chain(cells).chain([command]).collect()
    };
    let count = results.table.rows();
    let rest = match count > MOST_ROWS {
        true => html::note(&format!("{MOST_ROWS} of {count}; table.csv has all, with every figure.")),
        false => html::note("table.csv has every figure."),
    };
    let rows: Vec<Vec<Cell>> = (0..count.min(MOST_ROWS)).map(row).collect();
    [html::sorted_table(&head, &rows), rest].concat()
}

/// The changes of the scenario that give the run at `place`, as options.
fn changes(sweep: &Sweep, place: usize) -> String {
    let options = sweep.changes(place).into_iter().map(|change| format!("--set {}", quoted(&change)));
    options.collect::<Vec<_>>().join(" ")
}

/// Most figures that are shown with plots.
const MOST_FIGURES: usize = 4;

/// A column as it is shown.
pub(crate) struct Shown<'a> {
    /// Its values.
    pub column: &'a Column,
    /// What it is.
    pub words: String,
    /// Its key or name in full, shown on hover.
    pub key: String,
    /// How its values are read.
    pub reading: Reading,
}

/// Inputs, and the figures that are shown first.
pub(crate) struct Columns<'a> {
    /// In the order of the keys that vary.
    pub inputs: Vec<Shown<'a>>,
    /// The one by which runs are ranked comes first.
    pub figures: Vec<Shown<'a>>,
}

impl<'a> Columns<'a> {
    fn of_page(page: &SweepPage<'a>) -> Columns<'a> {
        let table = &page.results.table;
        let figures = page.results.shown_figures(page.figure, MOST_FIGURES);
        Columns {
            inputs: input_columns(table, &page.sweep.variation().factors),
            figures: figures.into_iter().filter_map(|name| table.column(name)).map(Shown::of_figure).collect(),
        }
    }
}

fn input_columns<'a>(table: &'a Table, factors: &[Factor]) -> Vec<Shown<'a>> {
    let titles: Vec<String> =
        factors.iter().map(|factor| grammar::title(&factor.path).unwrap_or_else(|| factor.path.clone())).collect();
    let mut counts: HashMap<&String, usize> = HashMap::new();
    titles.iter().for_each(|title| *counts.entry(title).or_default() += 1);
    let shown = |((column, factor), title): ((&'a Column, &Factor), &String)| {
        // Of two keys with one title, as the frictions of two impactors, the paths tell which is which.
        let words = if counts[title] > 1 { factor.path.clone() } else { title.clone() };
        let reading =
            Reading::of_unit(factor.dimension.map_or("1", |dimension: Dimension| dimension.unit), size(column));
        Shown { column, words, key: factor.path.clone(), reading }
    };
    table.inputs().iter().zip(factors).zip(&titles).map(shown).collect()
}

/// The largest size of the numbers of a column.
fn size(column: &Column) -> f64 {
    match &column.values {
        Values::Numbers(values) => values.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs())),
        _ => 0.0,
    }
}

impl<'a> Shown<'a> {
    /// A figure, by its name.
    fn of_figure(column: &'a Column) -> Shown<'a> {
        let (words, reading) = post::reading(&column.name, size(column));
        Shown { column, words, key: column.name.clone(), reading }
    }

    /// Words and unit, as the head of a column or of an axis.
    pub(crate) fn heading(&self) -> String {
        self.reading.heading(&self.words)
    }

    /// The number of each row, SI; none of a word or a gap.
    pub(crate) fn numbers(&self) -> Vec<Option<f64>> {
        match &self.column.values {
            Values::Texts(texts) => vec![None; texts.len()],
            values => values.numbers(),
        }
    }

    /// The value in a row with its unit; empty of a gap.
    pub(crate) fn text(&self, row: usize) -> String {
        match &self.column.values {
            Values::Texts(texts) => texts.get(row).cloned().flatten().unwrap_or_default(),
            values => {
                values.numbers().get(row).copied().flatten().map_or_else(String::new, |value| self.reading.text(value))
            }
        }
    }
}

/// `words` within a sentence: a capital that begins a word is none there.
pub(crate) fn lower(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next();
    // Abbreviations keep theirs.
    let is_word = letters.clone().next().is_some_and(char::is_lowercase);
    match first {
        Some(first) if is_word => first.to_lowercase().chain(letters).collect(),
        _ => words.to_owned(),
    }
}
