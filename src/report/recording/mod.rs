//! The run as a Rerun recording: film, impactor, signals and what happened, on one timeline.

mod body;
mod events;
mod film;

use std::path::Path;

use droptower_viz::{Plot, Scene, SignalTrack, VizError};
use thiserror::Error;

use crate::mesh::MeshError;
use crate::model::Model;
use crate::signal::Recording;
use crate::simulate::Outcome;

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
        summary: format!("{summary_text}\n\nColour: the larger fibre strain, 0 (dark) to {highest:.3} (bright).\n"),
        films: faces.map(|face| film::track(outcome, face, highest)).collect(),
        body: impactor.map(|impactor| body::track(impactor, outcome)).transpose()?,
        signals: tracks("signals", signals).chain(tracks("energies", &outcome.energies)).collect(),
        plots: plots(signals, &outcome.energies),
        events: events::of(outcome, signals),
    })
}

fn tracks<'a>(folder: &'a str, recording: &'a Recording) -> impl Iterator<Item = SignalTrack> + 'a {
    recording.channels.iter().map(move |channel| SignalTrack {
        path: format!("{folder}/{}", channel.name),
        label: channel.name.clone(),
        times: recording.time.clone(),
        values: channel.values.clone(),
    })
}

fn plots(signals: &Recording, energies: &Recording) -> Vec<Plot> {
    let shown = |channels: &[&str]| -> Vec<String> {
        let present = channels.iter().filter(|name| signals.channel(name).is_some());
        present.map(|name| format!("signals/{name}")).collect()
    };
    let mut plots: Vec<Plot> = PLOTS
        .iter()
        .map(|(title, channels)| Plot { title: (*title).to_owned(), signals: shown(channels) })
        .filter(|plot| !plot.signals.is_empty())
        .collect();
    if !energies.channels.is_empty() {
        plots.push(Plot {
            title: "Energies, J".to_owned(),
            signals: tracks("energies", energies).map(|track| track.path).collect(),
        });
    }
    plots
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
        let plots = plots(&signals, &recording(&["hourglass"]));
        let shown = plots.iter().map(|p| (p.title.as_str(), p.signals.join(" ")));
        let expected = [
            ("Displacement, m", "signals/displacement_m"),
            ("Force, N", "signals/force_N"),
            ("Energies, J", "energies/hourglass"),
        ];
        let expected = expected.map(|(title, paths)| (title, paths.to_owned()));
        assert_eq!(shown.collect::<Vec<_>>(), expected);
    }
}
