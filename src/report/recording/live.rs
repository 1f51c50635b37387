//! A run in a running viewer while it goes: what a watched run shows is handed to a thread of its own, which a slow viewer
//! may hold up and the run not.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, channel, sync_channel};
use std::thread;
use std::time::Duration;

use droptower_viz::{Address, Document, Event, FilmFrame, Pose, Quantity, Scene, SignalTrack, Stage, VizError};
use thiserror::Error;

use super::{RecordingError, body, documents, events, film, signals, text};
use crate::model::Model;
use crate::post::Comparison;
use crate::report::{RunPage, subject};
use crate::signal::{Channel, Recording};
use crate::simulate::Glimpse;

/// Longest wait for a viewer to answer, and for it to take what is left at the end.
const PATIENCE: Duration = Duration::from_secs(2);
const LAST_PATIENCE: Duration = Duration::from_secs(10);

/// States that may wait for the viewer before the next one is left out.
const WAITING: usize = 64;

/// What colours reach beyond the largest strain so far when they have to be spread anew.
const SPREAD: f32 = 1.25;

/// Why a viewer does not show a run, or not all of it.
#[derive(Debug, Error)]
pub enum LiveError {
    #[error("no viewer answers at {address}: {source}")]
    NoAnswer { address: String, source: io::Error },
    #[error("the viewer at {address} fell behind: {lost} states were left out")]
    Slow { address: String, lost: usize },
    #[error("the viewer at {address} does not take the rest of the run")]
    Stuck { address: String },
    #[error(transparent)]
    Recording(#[from] RecordingError),
}

/// A run that a viewer shows.
pub struct Live<'a> {
    address: Address,
    model: &'a Model,
    comparison: Option<&'a Comparison>,
    scenario: &'a str,
    viewer: Option<Viewer>,
    /// Samples of the signals and of the energies that were handed over.
    sent: [usize; 2],
    /// Upper ends of the colours.
    ranges: Vec<[f32; 2]>,
    lost: usize,
}

/// The thread that talks to the viewer.
struct Viewer {
    news: SyncSender<News>,
    done: Receiver<Result<(), VizError>>,
}

/// What is new in a run.
enum News {
    State { films: Vec<FilmFrame>, pose: Option<Pose>, samples: Vec<SignalTrack>, ranges: Option<Vec<[f32; 2]>> },
    End { documents: Vec<Document>, events: Vec<Event> },
}

impl<'a> Live<'a> {
    /// A viewer that answers at `address`, for a run of `model` from the text `scenario`.
    ///
    /// # Errors
    /// No viewer answers.
    pub fn connect(
        address: &Address,
        model: &'a Model,
        comparison: Option<&'a Comparison>,
        scenario: &'a str,
    ) -> Result<Live<'a>, LiveError> {
        let no_answer = |source| LiveError::NoAnswer { address: address.to_string(), source };
        address.answers(PATIENCE).map_err(no_answer)?;
        let address = address.clone();
        Ok(Live { address, model, comparison, scenario, viewer: None, sent: [0; 2], ranges: vec![], lost: 0 })
    }

    /// Shows a state, unless the viewer has fallen behind.
    ///
    /// # Errors
    /// The impactor cannot be drawn.
    pub fn show(&mut self, glimpse: &Glimpse<'_>) -> Result<(), LiveError> {
        if self.viewer.is_none() {
            let scene = self.scene(glimpse);
            self.ranges = scene.quantities.iter().map(|quantity| quantity.range).collect();
            self.sent = [glimpse.signals.time.len(), glimpse.energies.time.len()];
            self.viewer = Some(Viewer::start(self.address.clone(), scene));
            return Ok(());
        }
        let state = self.state(glimpse);
        let Some(viewer) = &self.viewer else { return Ok(()) };
        match viewer.news.try_send(state) {
            Ok(()) => self.sent = [glimpse.signals.time.len(), glimpse.energies.time.len()],
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => self.lost += 1,
        }
        Ok(())
    }

    /// Hands over what was measured in the end, if anything was, and waits for the viewer to take it, but not for long.
    ///
    /// # Errors
    /// The viewer fell behind, got stuck or refused.
    pub fn finish(self, run: Option<&RunPage>) -> Result<(), LiveError> {
        let Some(Viewer { news, done }) = self.viewer else { return Ok(()) };
        let address = self.address.to_string();
        if let Some(run) = run {
            // A full queue is told below.
            let _ = news.try_send(News::End { documents: documents(run), events: events::of(run) });
        }
        drop(news);
        match done.recv_timeout(LAST_PATIENCE) {
            Ok(Err(error)) => Err(RecordingError::from(error).into()),
            Ok(Ok(())) if self.lost == 0 => Ok(()),
            Ok(Ok(())) => Err(LiveError::Slow { address, lost: self.lost }),
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => Err(LiveError::Stuck { address }),
        }
    }

    /// The scene with the first state.
    fn scene(&self, glimpse: &Glimpse<'_>) -> Scene {
        let Live { model, comparison, scenario, .. } = self;
        let signals = signals::of(glimpse.signals, glimpse.energies, *comparison, model.run_time());
        let begun = format!("# {}\n\n{}\n", text::escaped(&model.title), text::escaped(&subject(model)));
        let texts = [super::Text { title: super::SUMMARY.to_owned(), markdown: begun }, super::scenario(scenario)];
        let films = glimpse.films.iter().enumerate().map(|(face, film)| droptower_viz::FilmTrack {
            frames: vec![film::state(film, glimpse.frame, face)],
            ..film::alone(film, face)
        });
        let quantities = film::quantities(std::slice::from_ref(glimpse.frame));
        Scene {
            name: model.name.clone(),
            duration: model.run_time(),
            is_live: true,
            documents: texts.iter().map(super::Text::document).collect(),
            quantities: quantities.into_iter().map(spread).collect(),
            films: films.collect(),
            body: glimpse.impactor.map(|impactor| body::track(impactor, std::slice::from_ref(glimpse.frame))),
            signals: signals.tracks,
            charts: signals.charts,
            more_charts: signals.more_charts,
            ..Scene::default()
        }
    }

    fn state(&mut self, glimpse: &Glimpse<'_>) -> News {
        let films = glimpse.films.iter().enumerate();
        let [signals, energies] = self.sent;
        let (signals, energies) = (since(glimpse.signals, signals), since(glimpse.energies, energies));
        News::State {
            films: films.map(|(face, film)| film::state(film, glimpse.frame, face)).collect(),
            pose: body::pose(glimpse.frame),
            samples: signals::of(&signals, &energies, None, f64::INFINITY).tracks,
            ranges: self.wider(glimpse),
        }
    }

    /// The ranges of the colours, where the state goes beyond them.
    fn wider(&mut self, glimpse: &Glimpse<'_>) -> Option<Vec<[f32; 2]>> {
        let now = film::quantities(std::slice::from_ref(glimpse.frame));
        let is_beyond = |(quantity, range): (&Quantity, &[f32; 2])| quantity.range[1] > range[1];
        if !now.iter().zip(&self.ranges).any(is_beyond) {
            return None;
        }
        for (quantity, range) in now.iter().zip(&mut self.ranges) {
            if quantity.range[1] > range[1] {
                range[1] = SPREAD * quantity.range[1];
            }
        }
        Some(self.ranges.clone())
    }
}

impl Viewer {
    fn start(address: Address, scene: Scene) -> Viewer {
        let (news, heard) = sync_channel(WAITING);
        let (told, done) = channel();
        thread::spawn(move || {
            // Whoever waited for it may have given up.
            let _ = told.send(tell(&address, &scene, &heard));
        });
        Viewer { news, done }
    }
}

/// Tells the viewer all news until there are no more.
fn tell(address: &Address, scene: &Scene, news: &Receiver<News>) -> Result<(), VizError> {
    let mut stage = Stage::live(address, scene)?;
    for news in news {
        match news {
            News::State { films, pose, samples, ranges } => {
                stage.spread(&ranges.unwrap_or_default())?;
                films.iter().enumerate().try_for_each(|(face, frame)| stage.film(face, frame))?;
                pose.iter().try_for_each(|pose| stage.pose(pose))?;
                samples.iter().try_for_each(|track| stage.samples(&track.path, &track.places, &track.values))?;
            }
            News::End { documents, events } => {
                documents.iter().try_for_each(|document| stage.document(document))?;
                events.iter().try_for_each(|event| stage.event(event))?;
            }
        }
    }
    stage.finish(LAST_PATIENCE)
}

fn spread(quantity: Quantity) -> Quantity {
    Quantity { range: quantity.range.map(|end| SPREAD * end), ..quantity }
}

/// The samples from one on.
fn since(recording: &Recording, first: usize) -> Recording {
    let rest = |values: &[f64]| values.get(first..).unwrap_or_default().to_vec();
    let channel = |channel: &Channel| Channel { name: channel.name.clone(), values: rest(&channel.values) };
    Recording { time: rest(&recording.time), channels: recording.channels.iter().map(channel).collect() }
}
