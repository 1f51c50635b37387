//! Signals over time in a recording: in the units of its charts, simulated over measured.

use crate::quantity::Stroke;
use crate::scene::{Chart, Charts, SignalTrack};
use lab::signal::Recording;
use lab::signal::column::{self, Column};
use report::panes::{self, Pane, PaneCurve, Shown};
use study::post::ReferenceComparison;

/// The reference of a run, and the time up to which it is shown, s.
type Measured<'a> = (&'a ReferenceComparison, f64);

/// The measured signals of a chart: a single one in grey, several in the colours of the simulated ones.
fn measured_tracks((comparison, end): Measured<'_>, pane: &Pane, own: &[SignalTrack]) -> Vec<SignalTrack> {
    let of = |measured: &panes::Measured| {
        let series = (measured.series)(comparison)?.window([0.0, end]);
        let label = format!("{}{}", measured.label, comparison.label());
        let entity = entity(&measured.column);
        let its_own = own.iter().find(|track| track.path.ends_with(&format!("/{entity}")));
        let stroke = match its_own.filter(|_| pane.measured.len() > 1) {
            Some(track) => track.stroke.target_of(),
            None => Stroke::target(),
        };
        let values = [series.time(), series.values()];
        Some(track(format!("measured/{entity}"), label, values, measured.column.factor, stroke))
    };
    pane.measured.iter().filter_map(of).collect()
}

/// All signals of a run up to now, and beneath them the reference up to the time `end`, s.
pub(crate) fn charted(
    signals: &Recording,
    energies: &Recording,
    comparison: Option<&ReferenceComparison>,
    end: f64,
) -> Charts {
    let measured = comparison.map(|comparison| (comparison, end));
    let mut out = Charts::default();
    for pane in panes::panes() {
        let charts = match pane.shown {
            Shown::Page => continue,
            Shown::Beside => &mut out.beside,
            Shown::Tab | Shown::PageAndTab => &mut out.tabs,
        };
        charts.extend(chart_of(&pane, signals, measured));
    }
    out.tabs.extend(audit(energies));
    out
}

/// The chart of a pane; `None` where the run has none of its channels.
fn chart_of(pane: &Pane, signals: &Recording, measured: Option<Measured<'_>>) -> Option<Chart> {
    let title = format!("{}, {}", pane.title(signals)?, pane.columns[0].0.axis_unit);
    let own = pane.curves(signals).into_iter().enumerate().map(|(index, curve)| {
        let PaneCurve { column, prefix, label, values } = curve;
        // The unfiltered channel lies behind its filtered one.
        let stroke = if column == column::ACCELERATION { Stroke::nth(4).faint() } else { Stroke::nth(index) };
        let path = format!("signals/{prefix}{}", entity(&column));
        track(path, label, [&signals.time, values], column.factor, stroke)
    });
    let own: Vec<SignalTrack> = own.collect();
    let measured = measured.filter(|_| !own.is_empty());
    let mut tracks = measured.map(|measured| measured_tracks(measured, pane, &own)).unwrap_or_default();
    tracks.extend(own);
    chart(&title, tracks)
}

/// The name of a column below the entity `signals`, with the unit that it is shown in.
fn entity(column: &Column) -> String {
    match column.axis_unit {
        _ if column.factor == 1.0 => column.name.to_owned(),
        "%" => format!("{}_percent", column.short),
        unit => format!("{}_{unit}", column.short),
    }
}

/// Every term of the energy audit that is not zero throughout; all terms of a single sample.
fn audit(energies: &Recording) -> Option<Chart> {
    let is_there = |values: &[f64]| values.len() < 2 || values.iter().any(|value| *value != 0.0);
    let terms = energies.channels.iter().filter(|channel| is_there(&channel.values));
    let tracks = terms.enumerate().map(|(index, channel)| {
        let words = channel.name.trim_end_matches("_J").replace('_', " ");
        let values = channel.values.iter().map(|value| *value as f32).collect();
        SignalTrack {
            path: format!("energies/{}", channel.name),
            label: words,
            times: energies.time.clone(),
            values,
            stroke: Stroke::nth(index),
        }
    });
    chart("Energy audit, J", tracks.collect())
}

fn track(path: String, label: String, [time, values]: [&[f64]; 2], factor: f64, stroke: Stroke) -> SignalTrack {
    SignalTrack {
        path,
        label,
        times: time.to_vec(),
        values: values.iter().map(|value| (value * factor) as f32).collect(),
        stroke,
    }
}

fn chart(title: &str, tracks: Vec<SignalTrack>) -> Option<Chart> {
    (!tracks.is_empty()).then(|| Chart { title: title.to_owned(), tracks })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::{Annotations, Channel, Series};

    fn recording(names: &[&str]) -> Recording {
        let channel = |name: &&str| Channel { name: (*name).to_owned(), values: vec![0.0, 0.5] };
        Recording { time: vec![0.0, 0.1], channels: names.iter().map(channel).collect() }
    }

    #[test]
    fn charts_show_the_channels_that_a_run_has_in_their_units() {
        let signals = recording(&["displacement_m", "force_N", "velocity_m_s"]);
        let charts = charted(&signals, &recording(&["hourglass_J"]), None, 1.0);
        let paths = |chart: &Chart| chart.tracks.iter().map(|track| track.path.clone()).collect::<Vec<_>>().join(" ");
        let shown = charts.beside.iter().chain(&charts.tabs).map(|chart| (chart.title.as_str(), paths(chart)));
        let expected = [
            ("Displacement, mm", "signals/displacement_mm"),
            ("Force, N", "signals/force_N"),
            ("Velocity, m/s", "signals/velocity_m_s"),
            ("Energy audit, J", "energies/hourglass_J"),
        ];
        let expected = expected.map(|(title, paths)| (title, paths.to_owned()));
        assert_eq!(shown.collect::<Vec<_>>(), expected);
        assert_eq!(charts.beside[0].tracks[0].values, [0.0, 500.0]);
    }

    #[test]
    fn a_measurement_is_drawn_beneath_the_simulation_and_marked_if_virtual() {
        let series = Series::new(vec![-0.1, 0.0, 0.1, 0.2], vec![1.0, -0.1, -0.2, -0.3]);
        let comparison = ReferenceComparison {
            acceleration: None,
            displacement: Some(series),
            absorbed_energy: None,
            total_energy: None,
            window: [0.0, 0.1],
            energy_absorption: None,
            drop: None,
            annotations: Annotations::new(vec!["VIRTUAL drop test".to_owned()]),
            contact: [[0.0; 2]; 2],
            reduction_warnings: vec![],
            run_speed: 0.0,
            field: None,
        };
        let charts = charted(&recording(&["displacement_m"]), &recording(&[]), Some(&comparison), 0.1);
        let tracks = &charts.beside[0].tracks;
        let paths: Vec<&str> = tracks.iter().map(|track| track.path.as_str()).collect();
        assert_eq!(paths, ["measured/displacement_mm", "signals/displacement_mm"]);
        assert_eq!((tracks[0].label.as_str(), &tracks[0].values[..]), ("measured (virtual)", &[-100.0, -200.0][..]));
    }

    #[test]
    fn two_measured_signals_have_two_colours() {
        let series = || Some(Series::new(vec![0.0, 0.1], vec![0.0, 1.0]));
        let comparison = ReferenceComparison {
            acceleration: None,
            displacement: series(),
            absorbed_energy: series(),
            total_energy: series(),
            window: [0.0, 0.1],
            energy_absorption: None,
            drop: None,
            annotations: Annotations::default(),
            contact: [[0.0; 2]; 2],
            reduction_warnings: vec![],
            run_speed: 0.0,
            field: None,
        };
        let names = ["displacement_m", "kinetic_energy_J", "absorbed_energy_J", "total_energy_J"];
        let charts = charted(&recording(&names), &recording(&[]), Some(&comparison), 0.1);
        let stroke = |path: &str| charts.tracks().find(|track| track.path == path).map(|track| track.stroke);
        let [absorbed, total] = ["absorbed_energy_J", "total_energy_J"].map(|name| stroke(&format!("measured/{name}")));
        assert_ne!(absorbed, total);
        assert_eq!(total, stroke("signals/total_energy_J").map(Stroke::target_of));
        assert_eq!(stroke("measured/displacement_mm"), Some(Stroke::target()));
    }
}
