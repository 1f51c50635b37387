//! Rerun recordings of runs: film, impactors, signals, events.

mod body;
mod diagram;
mod events;
mod film;
mod points;
mod live;
mod signals;
mod text;

use std::path::Path;

use std::time::Duration;

use thiserror::Error;
use viz::{Document, Scene, Stage, VizError};

use super::film::is_finite;
use super::{RunPage, figure};
use base::number::significant;
pub use live::{Live, LiveError};
use scene::simulate::Snapshot;
use text::Text;
pub use viz::Address;

/// Why a recording was not written.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// The scene is inconsistent, or the file or the viewer cannot be written to.
    #[error("recording: {0}")]
    Viz(#[from] VizError),
}

/// Longest time that a file may take to be written.
const WRITE_TIMEOUT: Duration = Duration::from_secs(600);

/// Writes the recording of a run to `path`, snapshot by snapshot.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, run: &RunPage) -> Result<(), RecordingError> {
    let outcome = run.outcome;
    let snapshots = drawn(&outcome.snapshots);
    let mut stage = Stage::file(path, scene(run, &snapshots))?;
    // One face after the other: consecutive snapshots of one entity compress better.
    for (face, film) in outcome.films.iter().enumerate() {
        for snapshot in &snapshots {
            stage.film(face, &film::state(film, snapshot, face))?;
        }
    }
    Ok(stage.finish(WRITE_TIMEOUT)?)
}

/// The scene without the snapshots of the films, which are logged one by one.
fn scene(run: &RunPage, snapshots: &[&Snapshot]) -> Scene {
    let RunPage { model, outcome, results, .. } = run;
    let signals = signals::charted(&results.signals, &outcome.energies, results.comparison.as_ref(), model.run_time());
    Scene {
        name: model.name.clone(),
        is_live: false,
        extent: film::extent(&outcome.films, &ends(snapshots, run.failure.is_some())),
        duration: model.run_time(),
        documents: documents(run),
        quantities: film::quantities(snapshots),
        films: film::tracks(&outcome.films),
        bodies: body::tracks(model, &outcome.impactors, snapshots),
        points: points::tracks(results.field.as_deref()),
        signals: signals.tracks,
        charts: signals.charts,
        more_charts: signals.more_charts,
        diagrams: diagram::diagrams("plots", &results.script_output.plots).collect(),
        events: events::listed(run),
    }
}

/// The snapshots that can be drawn: those of finite positions.
fn drawn(snapshots: &[Snapshot]) -> Vec<&Snapshot> {
    snapshots.iter().filter(|snapshot| is_finite(snapshot)).collect()
}

/// The snapshots that have to be in view: the first and, unless the run failed, the last.
fn ends<'a>(snapshots: &[&'a Snapshot], failed: bool) -> Vec<&'a Snapshot> {
    let last = snapshots.last().filter(|_| !failed);
    snapshots.first().into_iter().chain(last).copied().collect()
}

/// Title of the text that a run opens with.
const SUMMARY: &str = "Summary";

fn scenario(text: &str) -> Text {
    Text::verbatim("Scenario", text)
}

/// Summary, tables and files of the post script, and the scenario.
fn documents(run: &RunPage) -> Vec<Document> {
    let RunPage { model, results, .. } = run;
    let findings = results.measures.findings().iter();
    let warnings: String =
        findings.map(|found| format!("- {} \\[{}\\]\n", text::escaped(&found.message), found.code)).collect();
    let figures = figure::markdown(&results.summary(model));
    let field = results.field.as_deref().map_or(String::new(), |field| {
        let largest = significant(points::range(field) * 1e3, 3);
        format!(
            "Points are those of the field, moved as measured; their colours are errors from 0 to {largest} mm.\n\n"
        )
    });
    let summary = format!(
        "# {}\n\n{}\n\n{field}{warnings}\n{figures}",
        text::escaped(&model.title),
        text::escaped(&model.subject())
    );
    let summary = Text { title: SUMMARY.to_owned(), markdown: summary };
    let texts = std::iter::once(summary)
        .chain(Text::tables(&results.script_output))
        .chain(Text::files(&results.script_output))
        .chain([scenario(run.scenario)]);
    texts.map(|text| text.document()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::simulate::FilmState;

    #[test]
    fn snapshots_with_infinite_positions_are_not_drawn() {
        let snapshot = |place: f32| {
            let state = FilmState { positions: vec![[place; 3]], ..FilmState::default() };
            Snapshot { time: 0.0, films: vec![state], impactors: vec![] }
        };
        let snapshots = [0.0, 1.0, 1e9, f32::NAN].map(snapshot);
        let drawn = drawn(&snapshots);
        let at = |snapshots: Vec<&Snapshot>| {
            snapshots.iter().map(|snapshot| snapshot.films[0].positions[0][0]).collect::<Vec<_>>()
        };
        assert_eq!(at(drawn.clone()), [0.0, 1.0, 1e9]);
        assert_eq!((at(ends(&drawn, false)), at(ends(&drawn, true))), (vec![0.0, 1e9], vec![0.0]));
    }
}
