//! The recording of a comparison: all runs on one timeline.

use std::path::Path;

use viz::{Chart, Places, Scene, SignalTrack, Stroke};

use serde_json::Value;

use super::{RecordingError, Text, diagram, text};
use crate::compare_page;
use plot::Plot;
use study::post::RunComparison;
use study::script::Row;

/// Writes the recording of a comparison to `path`: plots over time as signals, others as diagrams.
///
/// # Errors
/// The file cannot be written.
pub fn write_comparison(path: &Path, comparison: &RunComparison) -> Result<(), RecordingError> {
    Ok(viz::write(path, scene(comparison))?)
}

fn scene(comparison: &RunComparison) -> Scene {
    let (over_time, others): (Vec<Plot>, Vec<Plot>) = compare_page::plots(comparison);
    let ends = over_time.iter().flat_map(|plot| &plot.curves).filter_map(|curve| curve.points.last());
    Scene {
        name: comparison.title(),
        duration: ends.map(|[time, _]| time * 1e-3).fold(0.0, f64::max),
        documents: vec![text(comparison).document()],
        signals: over_time.iter().enumerate().flat_map(tracks).collect(),
        charts: over_time.iter().enumerate().map(chart).collect(),
        diagrams: diagram::diagrams("plots", &others).collect(),
        ..Scene::default()
    }
}

/// The tables that the terminal prints.
fn text(comparison: &RunComparison) -> Text {
    let notes =
        comparison.findings.iter().map(|found| format!("- {} \\[{}\\]\n", text::escaped(&found.message), found.code));
    let row = |head: &str, cells: Vec<String>| -> Row {
        let heads = std::iter::once(head).chain(comparison.runs.iter().map(|run| run.name.as_str()));
        heads.map(str::to_owned).zip(cells.into_iter().map(Value::from)).collect()
    };
    let table = |title: &str, head: &str, rows: Vec<Vec<String>>| {
        text::table(title, &rows.into_iter().map(|cells| row(head, cells)).collect::<Vec<_>>())
    };
    let parts = [
        notes.collect(),
        table("Figures", "figure", compare_page::figures(comparison.key_figures())),
        table("Scenarios", "key", compare_page::keys(comparison)),
        table("Errors of signals", "signal", compare_page::errors(comparison)),
    ];
    Text { title: "Comparison".to_owned(), markdown: parts.join("\n") }
}

/// Entity of the curve of a run. Names of columns and runs may hold any characters, so entities are numbered.
fn entity(plot: usize, run: usize) -> String {
    format!("signals/{plot}/{run}")
}

fn chart((number, plot): (usize, &Plot)) -> Chart {
    let signals = (0..plot.curves.len()).map(|run| entity(number, run)).collect();
    Chart { title: plot.y.label.clone(), signals }
}

fn tracks<'a>((number, plot): (usize, &'a Plot)) -> impl Iterator<Item = SignalTrack> + use<'a> {
    plot.curves.iter().enumerate().map(move |(run, curve)| SignalTrack {
        path: entity(number, run),
        label: curve.name.clone(),
        places: Places::Times(curve.points.iter().map(|[time, _]| time * 1e-3).collect()),
        values: curve.points.iter().map(|[_, value]| *value as f32).collect(),
        stroke: Stroke::nth(run),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::{Channel, Recording};
    use study::store::StoredRun;

    #[test]
    fn every_run_has_a_curve_in_every_chart() {
        let run = |place: &str, last: f64| {
            let channel = |name: &str, values: [f64; 2]| Channel { name: name.into(), values: values.to_vec() };
            let channels = vec![channel("strain", [0.0, 0.5]), channel("stress_Pa", [0.0, last])];
            let signals = Recording { time: vec![0.0, 0.25], channels };
            StoredRun { place: place.into(), signals, ..StoredRun::default() }
        };
        let scene = scene(&RunComparison::from_runs(&[run("/r/a", 2e6), run("/r/b", 4e6)], &[]));
        let charts: Vec<_> = scene.charts.iter().map(|chart| (chart.title.as_str(), chart.signals.len())).collect();
        assert_eq!(charts, [("strain (%)", 2), ("stress (MPa)", 2)]);
        let of_b = scene.signals.iter().find(|track| track.path == scene.charts[1].signals[1]).expect("a signal");
        assert_eq!((of_b.label.as_str(), of_b.values.as_slice()), ("b", [0.0, 4.0].as_slice()));
        assert_eq!(of_b.places, Places::Times(vec![0.0, 0.25]));
        assert_eq!((scene.diagrams.len(), scene.duration), (1, 0.25));
        assert!(scene.documents[0].text.contains("| strain | - | 0 % |"), "{}", scene.documents[0].text);
    }
}
