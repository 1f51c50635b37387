//! Runs and studies as Rerun recordings: film, impactor, signals and what happened; searches closing in on their target.

mod body;
mod comparison;
mod diagram;
mod events;
mod film;
mod live;
mod findings;
mod signals;
mod study;
mod text;

use std::path::Path;

use droptower_viz::{Document, Scene, VizError};
use thiserror::Error;

use super::{RunPage, figure, subject};
pub use comparison::write_comparison;
pub use droptower_viz::Address;
pub use live::{Live, LiveError};
pub use study::{Approach, Iteration, StudyRecording, write_study};
pub use text::Text;

/// Why a recording was not written.
#[derive(Debug, Error)]
pub enum RecordingError {
    #[error("recording: {0}")]
    Viz(#[from] VizError),
}

/// Writes the recording of a run to `path`.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, run: &RunPage) -> Result<(), RecordingError> {
    Ok(droptower_viz::write(path, &scene(run))?)
}

fn scene(run: &RunPage) -> Scene {
    let RunPage { model, outcome, results, .. } = run;
    let signals = signals::of(&results.signals, &outcome.energies, results.comparison.as_ref(), model.run_time());
    Scene {
        name: model.name.clone(),
        is_live: false,
        duration: model.run_time(),
        documents: documents(run),
        quantities: film::quantities(&outcome.frames),
        films: (0..outcome.films.len()).map(|face| film::track(outcome, face)).collect(),
        body: outcome.impactor.as_ref().map(|impactor| body::track(impactor, &outcome.frames)),
        signals: signals.tracks,
        charts: signals.charts,
        more_charts: signals.more_charts,
        diagrams: diagram::diagrams("plots", &results.findings.plots).collect(),
        events: events::of(run),
    }
}

/// Title of the text that a run opens with.
const SUMMARY: &str = "Summary";

fn scenario(text: &str) -> Text {
    Text::verbatim("Scenario", text)
}

/// Summary, what the post script left in tables, and the scenario.
fn documents(run: &RunPage) -> Vec<Document> {
    let RunPage { model, results, .. } = run;
    let warnings: String =
        results.measures.warnings().iter().map(|line| format!("- {}\n", text::escaped(line))).collect();
    let figures = figure::markdown(&results.summary(model));
    let summary =
        format!("# {}\n\n{}\n\n{warnings}\n{figures}", text::escaped(&model.title), text::escaped(&subject(model)));
    let summary = Text { title: SUMMARY.to_owned(), markdown: summary };
    let texts = std::iter::once(summary).chain(Text::tables(&results.findings)).chain([scenario(run.scenario)]);
    texts.map(|text| text.document()).collect()
}
