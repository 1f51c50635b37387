//! Signals over time in a recording: in the units of its charts, simulated over measured.

use viz::{Chart, Places, SignalTrack, Stroke};

use lab::signal::column::{self, Column};
use lab::signal::{Recording, Series};
use study::post::ReferenceComparison;

/// The channels of one chart.
struct Pane {
    title: &'static str,
    channels: &'static [Shown],
    /// The measured signals, each with the beginning of its label.
    measured: &'static [(Shown, MeasuredSeries)],
}

/// Which series of a recording.
type MeasuredSeries = fn(&ReferenceComparison) -> Option<&Series>;

/// How a channel is shown.
struct Shown {
    /// Its name in `signals.csv`.
    channel: &'static str,
    /// Its name below the entity `signals`, with the unit that it is shown in.
    entity: &'static str,
    label: &'static str,
    /// From SI to the unit.
    factor: f64,
}

/// A channel that is the only simulated one of its chart.
const SIMULATED: &str = "simulated";

/// The unfiltered channel behind its filtered one.
const RAW: &str = "simulated, raw";

/// A column in the unit of its values.
const fn shown(column: Column, label: &'static str) -> Shown {
    Shown { channel: column.name, entity: column.name, label, factor: 1.0 }
}

/// A column in the unit of its axis.
const fn as_plotted(column: Column, entity: &'static str, label: &'static str) -> Shown {
    Shown { channel: column.name, entity, label, factor: column.factor }
}

/// Charts beside the film; a run has those for which it has channels.
const FIRST: [Pane; 7] = [
    Pane {
        title: "Acceleration, m/s²",
        channels: &[shown(column::ACCELERATION_FILTERED, "simulated, filtered"), shown(column::ACCELERATION, RAW)],
        measured: &[(shown(column::ACCELERATION_FILTERED, ""), |c| c.acceleration.as_ref())],
    },
    Pane {
        title: "Displacement, mm",
        channels: &[
            as_plotted(column::DISPLACEMENT, "displacement_mm", SIMULATED),
            as_plotted(column::DEPTH, "depth_mm", SIMULATED),
            as_plotted(column::DEFLECTION, "deflection_mm", SIMULATED),
        ],
        measured: &[(as_plotted(column::DISPLACEMENT, "displacement_mm", ""), |c| c.displacement.as_ref())],
    },
    Pane {
        title: "Energy of the impactor, J",
        channels: &[
            shown(column::KINETIC_ENERGY, "kinetic"),
            shown(column::POTENTIAL_ENERGY, "potential"),
            shown(column::ABSORBED_ENERGY, "absorbed by the film"),
            shown(column::TOTAL_ENERGY, "total"),
        ],
        measured: &[
            (shown(column::ABSORBED_ENERGY, "absorbed by the film, "), |c| c.absorbed_energy.as_ref()),
            (shown(column::TOTAL_ENERGY, "total, "), |c| c.total_energy.as_ref()),
        ],
    },
    Pane { title: "Force, N", channels: &[shown(column::FORCE, SIMULATED)], measured: &[] },
    Pane { title: "Stress, MPa", channels: &[as_plotted(column::STRESS, "stress_MPa", SIMULATED)], measured: &[] },
    Pane { title: "Strain, %", channels: &[as_plotted(column::STRAIN, "strain_percent", SIMULATED)], measured: &[] },
    Pane {
        title: "Pressure, kPa",
        channels: &[as_plotted(column::PRESSURE, "pressure_kPa", SIMULATED)],
        measured: &[],
    },
];

/// Charts in tabs.
const MORE: [Pane; 9] = [
    Pane { title: "Contact force, N", channels: &[shown(column::CONTACT_FORCE, SIMULATED)], measured: &[] },
    Pane {
        title: "Force of the impactors on each other, N",
        channels: &[shown(column::COLLISION_FORCE, SIMULATED)],
        measured: &[],
    },
    Pane { title: "Velocity, m/s", channels: &[shown(column::VELOCITY, SIMULATED)], measured: &[] },
    Pane {
        title: "Displacement across, mm",
        channels: &[
            as_plotted(column::DISPLACEMENT_X, "displacement_x_mm", "along x"),
            as_plotted(column::DISPLACEMENT_Y, "displacement_y_mm", "along y"),
        ],
        measured: &[],
    },
    Pane {
        title: "Size of the acceleration, m/s²",
        channels: &[shown(column::ACCELERATION_RESULTANT, SIMULATED)],
        measured: &[],
    },
    Pane {
        title: "Largest strain, %",
        channels: &[
            as_plotted(column::MAX_STRAIN_MD, "max_strain_md_percent", "MD"),
            as_plotted(column::MAX_STRAIN_TD, "max_strain_td_percent", "TD"),
        ],
        measured: &[],
    },
    Pane {
        title: "Force on the frame, N",
        channels: &[
            shown(column::FRAME_FORCE_X, "along x"),
            shown(column::FRAME_FORCE_Y, "along y"),
            shown(column::FRAME_FORCE, "downwards, on the bars"),
        ],
        measured: &[],
    },
    Pane {
        title: "Slip in the clamp, mm",
        channels: &[as_plotted(column::CLAMP_SLIP, "clamp_slip_mm", SIMULATED)],
        measured: &[],
    },
    Pane {
        title: "Length of the tears, mm",
        channels: &[as_plotted(column::TORN_LENGTH, "torn_length_mm", SIMULATED)],
        measured: &[],
    },
];

/// The reference of a run up to an end time.
#[derive(Clone, Copy)]
struct MeasuredChannel<'a> {
    comparison: &'a ReferenceComparison,
    /// s.
    end: f64,
}

impl MeasuredChannel<'_> {
    /// The measured signals of a chart: a single one in grey, several in the colours of the simulated ones.
    fn tracks(self, pane: &Pane, own: &[SignalTrack]) -> impl Iterator<Item = SignalTrack> {
        let MeasuredChannel { comparison, end } = self;
        let word = comparison.label();
        pane.measured.iter().filter_map(move |(shown, series)| {
            let series = series(comparison)?.window([0.0, end]);
            let label = format!("{}{word}", shown.label);
            let path = format!("measured/{}", shown.entity);
            let its_own = own.iter().find(|track| track.path.ends_with(&format!("/{}", shown.entity)));
            let stroke = match its_own.filter(|_| pane.measured.len() > 1) {
                Some(track) => track.stroke.target_of(),
                None => Stroke::target(),
            };
            let drawn = track(path, shown, [series.time(), series.values()], stroke);
            Some(SignalTrack { label, ..drawn })
        })
    }
}

/// Charts and their signals.
#[derive(Default)]
pub(super) struct Signals {
    pub(super) tracks: Vec<SignalTrack>,
    pub(super) charts: Vec<Chart>,
    pub(super) more_charts: Vec<Chart>,
}

/// All signals of a run up to now, and beneath them the reference up to the time `end`, s.
pub(super) fn of(
    signals: &Recording,
    energies: &Recording,
    comparison: Option<&ReferenceComparison>,
    end: f64,
) -> Signals {
    let measured = comparison.map(|comparison| MeasuredChannel { comparison, end });
    let mut tracks = vec![];
    let mut charts = |panes: &[Pane]| -> Vec<Chart> {
        panes.iter().filter_map(|pane| pane.chart(signals, measured, &mut tracks)).collect()
    };
    let (charts, mut more_charts) = (charts(&FIRST), charts(&MORE));
    more_charts.extend(audit(energies, &mut tracks));
    Signals { tracks, charts, more_charts }
}

impl Pane {
    /// The chart of those channels that the run has; `None` without any.
    fn chart(
        &self,
        signals: &Recording,
        measured: Option<MeasuredChannel<'_>>,
        all: &mut Vec<SignalTrack>,
    ) -> Option<Chart> {
        let own = self.channels.iter().flat_map(|shown| {
            signals.channels.iter().filter_map(move |channel| {
                let (prefix, _) = column::find(&channel.name).filter(|(_, column)| column.name == shown.channel)?;
                Some((shown, prefix, &channel.values))
            })
        });
        let own = own.enumerate().map(|(index, (shown, prefix, values))| {
            let stroke = if shown.label == RAW { Stroke::nth(4).faint() } else { Stroke::nth(index) };
            let path = format!("signals/{prefix}{}", shown.entity);
            let drawn = track(path, shown, [&signals.time, values], stroke);
            // Of several impactors, each under its name.
            let label = match prefix.strip_suffix('_') {
                Some(name) if shown.label == SIMULATED => name.to_owned(),
                Some(name) => format!("{name}: {}", shown.label),
                None => drawn.label,
            };
            SignalTrack { label, ..drawn }
        });
        let own: Vec<SignalTrack> = own.collect();
        let measured =
            measured.filter(|_| !own.is_empty()).into_iter().flat_map(|measured| measured.tracks(self, &own));
        let mut tracks: Vec<SignalTrack> = measured.collect();
        tracks.extend(own);
        chart(self.title, tracks, all)
    }
}

/// Every term of the energy audit that is not zero throughout; all terms of a single sample.
fn audit(energies: &Recording, all: &mut Vec<SignalTrack>) -> Option<Chart> {
    let is_there = |values: &[f64]| values.len() < 2 || values.iter().any(|value| *value != 0.0);
    let terms = energies.channels.iter().filter(|channel| is_there(&channel.values));
    let tracks = terms.enumerate().map(|(index, channel)| {
        let words = channel.name.trim_end_matches("_J").replace('_', " ");
        let places = Places::Times(energies.time.clone());
        let values = channel.values.iter().map(|value| *value as f32).collect();
        SignalTrack {
            path: format!("energies/{}", channel.name),
            label: words,
            places,
            values,
            stroke: Stroke::nth(index),
        }
    });
    chart("Energy audit, J", tracks.collect(), all)
}

fn track(path: String, shown: &Shown, [time, values]: [&[f64]; 2], stroke: Stroke) -> SignalTrack {
    SignalTrack {
        path,
        label: shown.label.to_owned(),
        places: Places::Times(time.to_vec()),
        values: values.iter().map(|value| (value * shown.factor) as f32).collect(),
        stroke,
    }
}

fn chart(title: &str, tracks: Vec<SignalTrack>, all: &mut Vec<SignalTrack>) -> Option<Chart> {
    let signals: Vec<String> = tracks.iter().map(|track| track.path.clone()).collect();
    all.extend(tracks);
    (!signals.is_empty()).then(|| Chart { title: title.to_owned(), signals })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::{Annotations, Channel};

    fn recording(names: &[&str]) -> Recording {
        let channel = |name: &&str| Channel { name: (*name).to_owned(), values: vec![0.0, 0.5] };
        Recording { time: vec![0.0, 0.1], channels: names.iter().map(channel).collect() }
    }

    #[test]
    fn charts_show_the_channels_that_a_run_has_in_their_units() {
        let signals = recording(&["displacement_m", "force_N", "velocity_m_s"]);
        let Signals { tracks, charts, more_charts } = of(&signals, &recording(&["hourglass_J"]), None, 1.0);
        let shown = charts.iter().chain(&more_charts).map(|c| (c.title.as_str(), c.signals.join(" ")));
        let expected = [
            ("Displacement, mm", "signals/displacement_mm"),
            ("Force, N", "signals/force_N"),
            ("Velocity, m/s", "signals/velocity_m_s"),
            ("Energy audit, J", "energies/hourglass_J"),
        ];
        let expected = expected.map(|(title, paths)| (title, paths.to_owned()));
        assert_eq!(shown.collect::<Vec<_>>(), expected);
        assert_eq!(tracks[0].values, [0.0, 500.0]);
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
            reduction_warnings: vec![],
        };
        let Signals { tracks, charts, .. } =
            of(&recording(&["displacement_m"]), &recording(&[]), Some(&comparison), 0.1);
        assert_eq!(charts[0].signals, ["measured/displacement_mm", "signals/displacement_mm"]);
        assert_eq!(
            (tracks[0].label.as_str(), tracks[0].values.as_slice()),
            ("measured (virtual)", &[-100.0, -200.0][..])
        );
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
            reduction_warnings: vec![],
        };
        let names = ["displacement_m", "kinetic_energy_J", "absorbed_energy_J", "total_energy_J"];
        let tracks = of(&recording(&names), &recording(&[]), Some(&comparison), 0.1).tracks;
        let stroke = |path: &str| tracks.iter().find(|track| track.path == path).map(|track| track.stroke);
        let [absorbed, total] = ["absorbed_energy_J", "total_energy_J"].map(|name| stroke(&format!("measured/{name}")));
        assert_ne!(absorbed, total);
        assert_eq!(total, stroke("signals/total_energy_J").map(Stroke::target_of));
        assert_eq!(stroke("measured/displacement_mm"), Some(Stroke::target()));
    }
}
