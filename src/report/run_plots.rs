//! The plots of one run.

use super::panes::{self, Pane, PaneCurve, Shown};
use lab::signal::column::Column;
use lab::signal::{Channel, Recording, Series};
use plot::{Curve, Plot, TIME, Window};
use study::post::{ReferenceComparison, Results};

/// Signals over time and against each other.
pub(super) fn signals(results: &Results) -> Vec<Plot> {
    let on_page = panes::panes().filter(|pane| matches!(pane.shown, Shown::Page | Shown::PageAndTab));
    on_page.filter_map(|pane| plot(&pane, &results.signals, results.comparison.as_ref())).collect()
}

/// The plot of a pane; none where the run has none of its channels.
fn plot(pane: &Pane, signals: &Recording, comparison: Option<&ReferenceComparison>) -> Option<Plot> {
    let title = pane.title(signals)?;
    let own = pane.curves(signals);
    let y = pane.columns[0].0.axis;
    if let Some(x) = pane.over {
        let curves: Vec<Curve> = own.into_iter().filter_map(|curve| path(signals, x, curve)).collect();
        return (!curves.is_empty()).then(|| Plot::new(title, [x.axis, y], curves));
    }
    if own.is_empty() {
        return None;
    }
    let simulated = own.into_iter().map(|PaneCurve { column, label, values, .. }| {
        over_time(&label, &Series::new(signals.time.as_slice(), values), column.factor)
    });
    let measured = pane.measured.iter().filter_map(|measured| {
        let comparison = comparison?;
        let label = format!("{}{}", measured.label, comparison.label());
        Some(over_time(&label, (measured.series)(comparison)?, measured.column.factor).dashed())
    });
    let curves = simulated.chain(measured).collect();
    // Of a column alone beside what was measured of it, errors are taken.
    let is_compared = pane.columns.len() == pane.measured.len();
    let window = |comparison: &ReferenceComparison| Window {
        label: "error window".into(),
        range: comparison.window.map(|time| time * 1e3),
    };
    let window = comparison.filter(|_| is_compared).map(window);
    Some(Plot { window, ..Plot::new(title, [TIME, y], curves) })
}

/// Share of the largest energy below which a term is named and not drawn; one that is zero throughout does not exist.
pub(super) const NEGLIGIBLE: f64 = 1e-3;

/// The energy audit, and the terms too small to be drawn.
pub(super) fn energies(energies: &Recording) -> (Plot, Vec<String>) {
    let magnitude = |channel: &Channel| channel.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let largest = energies.channels.iter().map(magnitude).fold(0.0, f64::max);
    let there = energies.channels.iter().filter(|channel| magnitude(channel) > 0.0);
    let (small, drawn): (Vec<&Channel>, Vec<&Channel>) =
        there.partition(|channel| magnitude(channel) < NEGLIGIBLE * largest);
    let words = |channel: &Channel| channel.name.trim_end_matches("_J").replace('_', " ");
    let curve = |channel: &Channel| {
        let series = Series::new(energies.time.as_slice(), channel.values.as_slice());
        let curve = over_time(&words(channel), &series, 1.0);
        if channel.name.starts_with("sum") { curve.dashed() } else { curve }
    };
    let plot = Plot::new("Energy audit", [TIME, "energy (J)"], drawn.into_iter().map(curve).collect());
    (plot, small.into_iter().map(words).collect())
}

/// A channel over another of the same impactor, that of the column `x`.
fn path(signals: &Recording, x: Column, curve: PaneCurve<'_>) -> Option<Curve> {
    let PaneCurve { column: y, prefix, label, values } = curve;
    let along = signals.channel(&format!("{prefix}{}", x.name))?;
    let points = along.iter().zip(values).map(|(a, b)| [a * x.factor, b * y.factor]);
    Some(Curve::line(label, points))
}

fn over_time(name: &str, series: &Series, factor: f64) -> Curve {
    Curve::line(name, series.samples().map(|[t, v]| [t * 1e3, v * factor]))
}
