//! A run in an open viewer while it computes: a thread of its own sends the snapshots, so that a slow viewer does not
//! delay the run.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::time::Duration;
use std::{io, thread};

use thiserror::Error;

use crate::recording::{self, documents};
use crate::scene::{Scene, SignalTrack};
use crate::stage::{Address, Stage};
use crate::{Quantity, VizError, signals, text};
use lab::signal::{Channel, Recording};
use report::geometry::{SceneFace, is_finite};
use report::{RunPage, escaped};
use scene::model::Model;
use scene::simulate::{FilmState, Snapshot, SnapshotEvent};
use study::post::ReferenceComparison;

/// Longest wait for a viewer to answer.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);
/// Longest waits at the end.
const WAITS: Waits = Waits { send: Duration::from_secs(8), join: Duration::from_secs(10) };

/// Most snapshots in the queue to the viewer; further ones are left out.
const QUEUE: usize = 64;

/// Upper end of an extended colour range over the largest strain so far.
const MARGIN: f32 = 1.25;

/// Why a viewer does not show a run or a part of it.
#[derive(Debug, Error)]
pub enum LiveError {
    /// No viewer answers.
    #[error("no viewer answers at {address}: {source}")]
    NoAnswer {
        /// Its address.
        address: String,
        /// Why.
        source: io::Error,
    },
    /// The viewer did not receive all snapshots.
    #[error("the viewer at {address} was too slow: {lost} snapshots were left out")]
    Slow {
        /// Its address.
        address: String,
        /// Number of snapshots that were left out.
        lost: usize,
    },
    /// The viewer stopped responding.
    #[error("the viewer at {address} stopped responding")]
    NotResponding {
        /// Its address.
        address: String,
    },
    /// The data cannot be sent.
    #[error(transparent)]
    Recording(#[from] VizError),
}

/// A run that a viewer shows.
pub struct Live<'a> {
    address: Address,
    model: &'a Model,
    comparison: Option<&'a ReferenceComparison>,
    scenario: &'a str,
    viewer: Option<Viewer>,
    /// Samples of the signals and of the energies sent so far.
    sent: [usize; 2],
    /// Entities of the signals that the viewer has.
    shown: Vec<String>,
    /// Colour ranges of the viewer.
    ranges: Vec<[f32; 2]>,
    lost: usize,
    waits: Waits,
}

/// Longest waits at the end.
#[derive(Clone, Copy)]
struct Waits {
    /// Of the sending thread for what it has sent.
    send: Duration,
    /// Of the run for the sending thread.
    join: Duration,
}

/// The thread that sends to the viewer.
struct Viewer {
    snapshots: SyncSender<State>,
    /// A channel of its own, so that a full queue of snapshots does not block the end.
    end: Sender<Scene>,
    done: Receiver<Result<(), VizError>>,
}

/// A snapshot and the samples since the one before.
struct State {
    snapshot: Snapshot,
    samples: Vec<SignalTrack>,
    ranges: Option<Vec<[f32; 2]>>,
}

impl<'a> Live<'a> {
    /// Connects to the viewer at `address` for a run of `model`, resolved as `scenario`.
    ///
    /// # Errors
    /// No viewer answers.
    pub fn connect(
        address: &Address,
        model: &'a Model,
        comparison: Option<&'a ReferenceComparison>,
        scenario: &'a str,
    ) -> Result<Live<'a>, LiveError> {
        let no_answer = |source| LiveError::NoAnswer { address: address.to_string(), source };
        address.answers(CONNECT_TIMEOUT).map_err(no_answer)?;
        let address = address.clone();
        Ok(Live {
            address,
            model,
            comparison,
            scenario,
            viewer: None,
            sent: [0; 2],
            shown: vec![],
            ranges: vec![],
            lost: 0,
            waits: WAITS,
        })
    }

    /// Shows a snapshot of finite positions, unless the queue to the viewer is full.
    pub fn show(&mut self, event: &SnapshotEvent<'_>) {
        if !is_finite(event.snapshot) {
            return;
        }
        if self.viewer.is_none() {
            self.viewer = Some(Viewer::start(self.address.clone(), self.begin(event), self.waits.send));
        }
        let Some(viewer) = &self.viewer else { return };
        let ranges = self.wider(event);
        // `finish` reports a viewer that has ended.
        if viewer.snapshots.try_send(self.state(event, ranges.clone())).is_err() {
            self.lost += 1;
            return;
        }
        self.sent = samples(event);
        self.ranges = ranges.unwrap_or_else(|| std::mem::take(&mut self.ranges));
    }

    /// Sends the results, if there are any, and waits a limited time for the viewer to receive them.
    ///
    /// # Errors
    /// The viewer was too slow, stopped responding or refused the data.
    pub fn finish(mut self, run: Option<&RunPage>) -> Result<(), LiveError> {
        let Some(Viewer { snapshots, end, done }) = self.viewer.take() else { return Ok(()) };
        let address = self.address.to_string();
        if let Some(run) = run {
            // Where the thread has ended, `done` has the reason.
            let _ = end.send(self.rest(run));
        }
        drop((snapshots, end));
        match done.recv_timeout(self.waits.join) {
            Ok(Err(VizError::Flush(_))) => Err(LiveError::NotResponding { address }),
            Ok(Err(error)) => Err(error.into()),
            Ok(Ok(())) if self.lost == 0 => Ok(()),
            Ok(Ok(())) => Err(LiveError::Slow { address, lost: self.lost }),
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                Err(LiveError::NotResponding { address })
            }
        }
    }

    /// The scene before its first snapshot.
    fn begin(&mut self, event: &SnapshotEvent<'_>) -> Scene {
        let Live { model, comparison, scenario, .. } = *self;
        let charts = signals::charted(event.signals, event.energies, comparison, model.run_time());
        let begun = format!("# {}\n\n{}\n", escaped(&model.title), escaped(&model.subject()));
        let quantities: Vec<Quantity> = recording::quantities(&[event.snapshot]).into_iter().map(with_margin).collect();
        let faces: Vec<SceneFace> = event.films.iter().map(SceneFace::from).collect();
        self.sent = samples(event);
        self.shown = charts.tracks().map(|track| track.path.clone()).collect();
        self.ranges = quantities.iter().map(|quantity| quantity.range).collect();
        Scene {
            name: model.name.clone(),
            duration: model.run_time(),
            is_live: true,
            extent: recording::extent(&faces, &[event.snapshot]),
            documents: vec![text::document(recording::SUMMARY, begun), recording::scenario(scenario)],
            quantities,
            faces,
            bodies: recording::bodies(model, event.impactors, Some(event.snapshot)),
            charts,
            ..Scene::default()
        }
    }

    fn state(&self, event: &SnapshotEvent<'_>, ranges: Option<Vec<[f32; 2]>>) -> State {
        let [signals, energies] = self.sent;
        let (signals, energies) = (since(event.signals, signals), since(event.energies, energies));
        let Snapshot { time, films, impactors } = event.snapshot;
        // What a viewer shows: no velocities and stresses.
        let films = films.iter().map(FilmState::without_detail).collect();
        State {
            snapshot: Snapshot { time: *time, films, impactors: impactors.clone() },
            samples: signals::charted(&signals, &energies, None, f64::INFINITY).tracks().cloned().collect(),
            ranges,
        }
    }

    /// The extended colour ranges, where the snapshot exceeds the present ones.
    fn wider(&self, event: &SnapshotEvent<'_>) -> Option<Vec<[f32; 2]>> {
        let now = recording::quantities(&[event.snapshot]);
        let wider = now.iter().zip(&self.ranges).map(|(quantity, range)| match quantity.range {
            [_, high] if high > range[1] => [range[0], MARGIN * high],
            _ => *range,
        });
        let wider: Vec<[f32; 2]> = wider.collect();
        (wider != self.ranges).then_some(wider)
    }

    /// The part that the viewer does not have yet: samples since the last snapshot it received, channels computed at
    /// the end, the output of the post script, and the log.
    fn rest(&self, run: &RunPage) -> Scene {
        let results = run.results;
        let mut charts =
            signals::charted(&results.signals, &run.outcome.energies, self.comparison, self.model.run_time());
        let tracks = charts.beside.iter_mut().chain(&mut charts.tabs).flat_map(|chart| &mut chart.tracks);
        tracks.for_each(|track| self.leave_unsent(track));
        Scene {
            documents: documents(run),
            charts,
            diagrams: results.script_output.plots.clone(),
            events: text::listed(run),
            ..Scene::default()
        }
    }

    /// Takes the samples that the viewer has out of a track.
    fn leave_unsent(&self, track: &mut SignalTrack) {
        if !self.shown.contains(&track.path) {
            return;
        }
        let [signals, energies] = self.sent;
        let sent = match track.path.split('/').next() {
            Some("signals") => signals,
            Some("energies") => energies,
            // The reference was sent at the beginning.
            _ => track.values.len(),
        };
        track.times.drain(..sent.min(track.times.len()));
        track.values.drain(..sent.min(track.values.len()));
    }
}

impl Viewer {
    fn start(address: Address, scene: Scene, wait: Duration) -> Viewer {
        let (snapshots, states) = sync_channel(QUEUE);
        let (end, ended) = channel();
        let (result, done) = channel();
        thread::spawn(move || {
            // `finish` may have stopped waiting.
            let _ = result.send(send(&address, scene, &states, &ended, wait));
        });
        Viewer { snapshots, end, done }
    }
}

/// Sends all snapshots until there are no more, then the results, if there are any, and waits so long for them to arrive.
fn send(
    address: &Address,
    scene: Scene,
    states: &Receiver<State>,
    end: &Receiver<Scene>,
    wait: Duration,
) -> Result<(), VizError> {
    let mut stage = Stage::live(address, scene)?;
    for State { snapshot, samples, ranges } in states {
        stage.set_ranges(snapshot.time, &ranges.unwrap_or_default())?;
        (0..snapshot.films.len()).try_for_each(|face| stage.film(face, &snapshot))?;
        stage.bodies(&snapshot)?;
        samples.iter().try_for_each(|track| stage.samples(&track.path, &track.times, &track.values))?;
    }
    end.recv().map_or(Ok(()), |rest| stage.complete(rest))?;
    stage.finish(wait)
}

/// Samples of the signals and of the energies so far.
fn samples(event: &SnapshotEvent<'_>) -> [usize; 2] {
    [event.signals.time.len(), event.energies.time.len()]
}

fn with_margin(quantity: Quantity) -> Quantity {
    Quantity { range: quantity.range.map(|end| MARGIN * end), ..quantity }
}

/// The samples from one on.
fn since(recording: &Recording, first: usize) -> Recording {
    let rest = |values: &[f64]| values.get(first..).unwrap_or_default().to_vec();
    let channel = |channel: &Channel| Channel { name: channel.name.clone(), values: rest(&channel.values) };
    Recording { time: rest(&recording.time), channels: recording.channels.iter().map(channel).collect() }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;
    use std::path::Path;

    use super::*;
    use scene::scenario::Document;
    use scene::simulate::Film;

    fn model() -> Model {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/drop/1008.toml");
        Document::read(&path).and_then(|document| scene::model::check(&document)).expect("a model")
    }

    fn film() -> Film {
        Film { nodes: 3, tris: vec![[0, 1, 2]], ..Film::default() }
    }

    /// The triangle, stretched.
    fn stretched(strain: f32) -> Snapshot {
        let state = FilmState {
            positions: vec![[0.0; 3]; 3],
            strains: vec![[strain; 3]],
            failed: vec![false],
            ..FilmState::default()
        };
        Snapshot { time: f64::from(strain), films: vec![state], impactors: vec![] }
    }

    fn forces(samples: usize) -> Recording {
        let values: Vec<f64> = (0..samples).map(|sample| sample as f64).collect();
        let channels = vec![Channel { name: "force_N".to_owned(), values: values.clone() }];
        Recording { time: values, channels }
    }

    /// A viewer with a queue of one snapshot, and what is sent to it.
    fn viewer() -> (Viewer, Receiver<State>, Receiver<Scene>) {
        let ((snapshots, states), (end, ends), (_, done)) = (sync_channel(1), channel(), channel());
        (Viewer { snapshots, end, done }, states, ends)
    }

    #[test]
    fn samples_that_a_slow_viewer_missed_come_with_the_next_snapshot() {
        let (model, films, energies) = (model(), [film()], Recording::default());
        let (viewer, states, _ends) = viewer();
        let address = Address::DEFAULT.parse().expect("an address");
        let mut live = Live {
            address,
            model: &model,
            comparison: None,
            scenario: "",
            viewer: Some(viewer),
            sent: [0; 2],
            shown: vec!["signals/force_N".to_owned()],
            ranges: vec![[0.0, 1.0]; 4],
            lost: 0,
            waits: WAITS,
        };
        let mut show = |strain, samples| {
            let (snapshot, signals) = (stretched(strain), forces(samples));
            let event = SnapshotEvent {
                films: &films,
                impactors: &[],
                snapshot: &snapshot,
                signals: &signals,
                energies: &energies,
            };
            live.show(&event);
        };
        let samples = |state: &State| state.samples.iter().map(|track| track.values.len()).collect::<Vec<_>>();
        show(0.001, 2);
        show(0.2, 5);
        let taken = states.try_recv().expect("the first state");
        assert!(taken.ranges.is_none() && samples(&taken) == [2], "{:?}", taken.ranges);
        show(0.2, 6);
        let taken = states.try_recv().expect("the third state");
        assert_eq!(taken.ranges.map(|ranges| ranges[0]), Some([0.0, 25.0]));
        assert_eq!(taken.samples.iter().map(|track| track.values.len()).collect::<Vec<_>>(), [4]);
        show(0.2, 7);
        assert_eq!(live.lost, 1);

        let mut whole = signals::charted(&forces(9), &energies, None, f64::INFINITY).beside.remove(0).tracks.remove(0);
        let mut made = SignalTrack { path: "signals/filtered".to_owned(), ..whole.clone() };
        live.leave_unsent(&mut whole);
        live.leave_unsent(&mut made);
        assert_eq!(whole.values, [7.0, 8.0], "those after the last state that got through");
        assert_eq!(made.values.len(), 9, "channels that are made in the end come whole");
    }

    /// A viewer that lets the run connect and never answers.
    #[test]
    fn a_silent_viewer_is_waited_for_so_long_and_told() {
        let door = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = format!("rerun+http://{}/proxy", door.local_addr().expect("an address"));
        let (model, films, snapshot, signals) = (model(), [film()], stretched(0.1), forces(2));
        let address = address.parse().expect("an address");
        let mut live = Live::connect(&address, &model, None, "").expect("an open door");
        live.waits = Waits { send: Duration::from_millis(200), join: Duration::from_millis(400) };
        let energies = Recording::default();
        live.show(&SnapshotEvent {
            films: &films,
            impactors: &[],
            snapshot: &snapshot,
            signals: &signals,
            energies: &energies,
        });
        assert!(matches!(live.finish(None), Err(LiveError::NotResponding { .. })));
    }

    #[test]
    fn the_end_is_received_though_the_queue_is_full() {
        let (viewer, states, ends) = viewer();
        let state = || {
            let snapshot = Snapshot { time: 0.0, films: vec![], impactors: vec![] };
            State { snapshot, samples: vec![], ranges: None }
        };
        viewer.snapshots.try_send(state()).expect("room for one");
        assert!(viewer.snapshots.try_send(state()).is_err(), "and no more");
        viewer.end.send(Scene { name: "end".to_owned(), ..Scene::default() }).expect("room for the end");
        drop(viewer);
        assert_eq!((states.iter().count(), ends.recv().expect("the end").name.as_str()), (1, "end"));
    }
}
