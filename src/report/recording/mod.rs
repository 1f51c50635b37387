//! Runs and studies as Rerun recordings: film, impactor, signals and what happened; searches closing in on their target.

mod body;
mod diagram;
mod events;
mod film;
mod findings;
mod study;
mod text;

use std::path::Path;

use droptower_viz::{Chart, Document, Places, Scene, SignalTrack, Stroke, VizError};
use thiserror::Error;

use crate::mesh::MeshError;
use crate::model::Model;
use crate::signal::Recording;
use crate::simulate::Outcome;
pub use study::{Approach, Iteration, StudyRecording, write_study};
pub use text::Text;

/// Why a recording was not written.
#[derive(Debug, Error)]
pub enum RecordingError {
    #[error("recording: {0}")]
    Viz(#[from] VizError),
    #[error("recording: {0}")]
    Impactor(#[from] MeshError),
}

/// Diagrams and the channels of `signals.csv` that they show where a run has them.
const PLOTS: [(&str, &[&str]); 7] = [
    ("Acceleration, m/s²", &["acceleration_m_s2", "acceleration_filtered_m_s2"]),
    ("Displacement, m", &["displacement_m", "depth_m", "deflection_m"]),
    ("Force, N", &["contact_force_N", "force_N"]),
    ("Pull on the frame, N", &["frame_force_x_N", "frame_force_y_N"]),
    ("Stress, Pa", &["stress_Pa"]),
    ("Pressure, Pa", &["pressure_Pa"]),
    ("Strain", &["strain", "max_strain_md", "max_strain_td"]),
];

/// Writes the run to `path`; `signals` are the channels of `signals.csv`, `summary_text` is Markdown.
pub fn write(
    path: &Path,
    model: &Model,
    outcome: &Outcome,
    signals: &Recording,
    summary_text: &str,
) -> Result<(), RecordingError> {
    let scene = scene(model, outcome, signals, summary_text)?;
    Ok(droptower_viz::write(path, &scene)?)
}

fn scene(model: &Model, outcome: &Outcome, signals: &Recording, summary_text: &str) -> Result<Scene, MeshError> {
    let highest = film::highest_strain(outcome);
    let faces = 0..outcome.films.len();
    let impactor = model.impactor.as_ref();
    Ok(Scene {
        name: model.name.clone(),
        documents: vec![Document {
            path: "texts/summary".to_owned(),
            title: "Summary".to_owned(),
            text: format!("{summary_text}\n\nColour: the larger fibre strain, 0 (dark) to {highest:.3} (bright).\n"),
        }],
        films: faces.map(|face| film::track(outcome, face, highest)).collect(),
        body: impactor.map(|impactor| body::track(impactor, outcome)).transpose()?,
        signals: tracks("signals", signals).chain(tracks("energies", &outcome.energies)).collect(),
        charts: charts(signals, &outcome.energies),
        diagrams: vec![],
        events: events::of(outcome, signals),
    })
}

fn tracks<'a>(folder: &'a str, recording: &'a Recording) -> impl Iterator<Item = SignalTrack> + 'a {
    recording.channels.iter().enumerate().map(move |(index, channel)| SignalTrack {
        path: format!("{folder}/{}", channel.name),
        label: channel.name.clone(),
        places: Places::Times(recording.time.clone()),
        values: channel.values.iter().map(|value| *value as f32).collect(),
        stroke: Stroke::nth(index),
    })
}

fn charts(signals: &Recording, energies: &Recording) -> Vec<Chart> {
    let shown = |channels: &[&str]| -> Vec<String> {
        let present = channels.iter().filter(|name| signals.channel(name).is_some());
        present.map(|name| format!("signals/{name}")).collect()
    };
    let mut charts: Vec<Chart> = PLOTS
        .iter()
        .map(|(title, channels)| Chart { title: (*title).to_owned(), signals: shown(channels) })
        .filter(|chart| !chart.signals.is_empty())
        .collect();
    if !energies.channels.is_empty() {
        charts.push(Chart {
            title: "Energies, J".to_owned(),
            signals: tracks("energies", energies).map(|track| track.path).collect(),
        });
    }
    charts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Channel;

    fn recording(names: &[&str]) -> Recording {
        let channel = |name: &&str| Channel { name: (*name).to_owned(), values: vec![0.0, 1.0] };
        Recording { time: vec![0.0, 0.1], channels: names.iter().map(channel).collect() }
    }

    #[test]
    fn diagrams_show_the_channels_that_a_run_has() {
        let signals = recording(&["displacement_m", "force_N", "velocity_m_s"]);
        let charts = charts(&signals, &recording(&["hourglass"]));
        let shown = charts.iter().map(|p| (p.title.as_str(), p.signals.join(" ")));
        let expected = [
            ("Displacement, m", "signals/displacement_m"),
            ("Force, N", "signals/force_N"),
            ("Energies, J", "energies/hourglass"),
        ];
        let expected = expected.map(|(title, paths)| (title, paths.to_owned()));
        assert_eq!(shown.collect::<Vec<_>>(), expected);
    }
}
