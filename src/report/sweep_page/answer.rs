//! What a sweep answers, in one sentence and one picture.

use super::super::drawn;
use super::super::ranges::{Line, Look, ranges};
use super::SweepPage;
use super::columns::{Columns, Shown, lower};
use super::effects;
use base::written::{Reading, capital, digits};
use plot::{Curve, Plot, Window};
use study::sweep::{Quantiles, SweepResults};

/// Least and most bars of a histogram.
const BARS: [usize; 2] = [5, 24];

/// How the figure by which runs are ranked scatters, what matters most for it, and whether the film holds.
pub(super) fn sentence(page: &SweepPage, columns: &Columns) -> String {
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
    match effects::sorted(page, columns, figure).into_iter().find(|effect| effect.is_distinct) {
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
    Some(match share {
        0.0 => format!("The film holds in every run: it ruptures with a probability below {high} %."),
        1.0 => format!("The film ruptures in every run: with a probability above {low} %."),
        _ => format!("The film ruptures in {share_shown} % of the runs (probability {low} to {high} %)."),
    })
}

fn quantiles<'a>(results: &'a SweepResults, figure: &Shown) -> Option<&'a Quantiles> {
    results.statistics.iter().find(|(name, _)| *name == figure.key).map(|(_, of)| of)
}

/// Histograms of the figures that are shown first, and the probability of rupture where it is neither 0 nor 1 (HTML).
pub(super) fn picture(page: &SweepPage, columns: &Columns) -> String {
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
    ranges("", Look::Bars, &Vec::from_iter(line))
}

/// How many runs have which value.
fn histogram(figure: &Shown, of: &Quantiles) -> Option<Plot> {
    let values: Vec<f64> = figure.numbers().into_iter().flatten().filter(|value| value.is_finite()).collect();
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high <= low {
        return None;
    }
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
