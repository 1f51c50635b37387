//! Quantities recorded at every step of a run and interpolated at its samples; channels of
//! film and frame, a row each.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::frame::{Crest, HeldSides};
use super::mount::Grid;
use lab::signal::column::{self, Column};
use lab::signal::{Channel, Recording};
use membrane::engine::{BodyTrack, FilmContactState, Springs, SpringsState, Torn, Track, View};

/// The samples of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Sampling {
    /// Time between two, s.
    pub(super) interval: f64,
    /// Their number.
    pub(super) count: usize,
}

impl Sampling {
    /// Samples of a run of `duration` (s), `interval` (s) apart.
    pub(super) fn new(duration: f64, interval: f64) -> Sampling {
        Sampling { interval, count: (duration / interval * (1.0 + 1e-12)).floor() as usize + 1 }
    }

    fn at_samples<const K: usize>(self) -> Grid<K> {
        Grid::new(0.0, self.interval, self.count)
    }

    /// Twice a sample, from the half before the first to that after the last.
    fn at_halves<const K: usize>(self) -> Grid<K> {
        Grid::new(-0.5 * self.interval, 0.5 * self.interval, 2 * self.count + 1)
    }
}

/// Impactors, jaws and strains at the samples of a run. Each loading makes its signals of them.
#[derive(Serialize, Deserialize)]
pub(super) struct Tracks {
    /// When they are recorded.
    pub(super) sampling: Sampling,
    /// The impactors.
    pub(super) bodies: Vec<BodyTracks>,
    /// Force on the jaws, N.
    pub(super) jaws: Grid<1>,
    /// The middle of the last step, s.
    middle: f64,
    /// Largest MD and TD strain.
    pub(super) strains: Grid<2>,
    /// The frame's bars; only where there are any.
    pub(super) bars: Option<BodyTracks>,
    /// Samples of the columns that the run has, by their names.
    sampled: BTreeMap<String, Grid<1>>,
}

/// An impactor at the samples of a run.
#[derive(Serialize, Deserialize)]
pub(super) struct BodyTracks {
    sampling: Sampling,
    /// Height (m), work on the film (J).
    pub(super) at_steps: Grid<2>,
    /// Velocity (m/s), while it is held that with which it is released, and the impulses of the film and of other
    /// impactors on it so far (N s), twice a sample.
    pub(super) at_half_steps: Grid<3>,
    /// Whether it does not move along z alone.
    pub(super) is_spatial: bool,
    /// Position along x and y, m; only where it does not move along z alone.
    pub(super) lateral: Grid<2>,
    /// Velocity along x and y (m/s) and the kinetic energy of its motion besides that along z (J), twice a sample.
    pub(super) lateral_half: Grid<3>,
    /// Its height at the first impulse of the film, m.
    pub(super) first_contact: Option<f64>,
    /// Whether another impactor or the frame's bars have pushed it.
    has_met: bool,
}

impl BodyTracks {
    /// Tracks of an impactor that moves down at `speed` (m/s) in free fall under `gravity` (m/s²), along z alone or not.
    pub(super) fn new(sampling: Sampling, [speed, gravity]: [f64; 2], is_spatial: bool) -> BodyTracks {
        let (mut at_half_steps, interval) = (sampling.at_halves(), sampling.interval);
        // Free fall before first contact, so that the first sample is a mean like every other.
        at_half_steps.push(-interval, [gravity * interval - speed, 0.0, 0.0]);
        at_half_steps.push(0.0, [-speed, 0.0, 0.0]);
        BodyTracks {
            sampling,
            at_steps: sampling.at_samples(),
            at_half_steps,
            is_spatial,
            lateral: sampling.at_samples(),
            lateral_half: sampling.at_halves(),
            first_contact: None,
            has_met: false,
        }
    }

    fn is_like(&self, other: &BodyTracks) -> bool {
        self.sampling == other.sampling
            && self.is_spatial == other.is_spatial
            && self.at_steps.is_like(&other.at_steps)
            && self.at_half_steps.is_like(&other.at_half_steps)
            && self.lateral.is_like(&other.lateral)
            && self.lateral_half.is_like(&other.lateral_half)
    }

    /// Records a step at the time of the full step and in the middle of the step after it, s.
    fn follow(&mut self, body: &BodyTrack, [time, middle]: [f64; 2]) {
        let [x, y, z] = body.centre;
        let [along_x, along_y, velocity] = body.velocity;
        if body.impulse != 0.0 {
            self.first_contact.get_or_insert(z);
        }
        self.at_steps.push(time, [z, body.work]);
        self.at_half_steps.push(middle, [velocity, body.impulse, body.collision]);
        self.has_met |= body.collision != 0.0;
        if self.is_spatial {
            let lateral = [along_x, along_y, body.lateral_energy];
            if self.lateral_half.rows.is_empty() {
                self.lateral_half.push(-self.sampling.interval, lateral);
            }
            self.lateral.push(time, [x, y]);
            self.lateral_half.push(middle, lateral);
        }
    }

    /// Samples whose half steps on both sides are known.
    fn whole(&self) -> usize {
        let halves = self.at_half_steps.rows.len().saturating_sub(1) / 2;
        self.at_steps.rows.len().min(halves)
    }

    /// Impulse of the film on the impactor around sample `k`, over the time between samples, N.
    pub(super) fn contact_force(&self, k: usize) -> f64 {
        self.mean_force(k, 1)
    }

    /// Impulse of the other impactors on it around sample `k`, over the time between samples, N.
    pub(super) fn collision_force(&self, k: usize) -> f64 {
        self.mean_force(k, 2)
    }

    fn mean_force(&self, k: usize, impulse: usize) -> f64 {
        let half = &self.at_half_steps.rows;
        (half[2 * k + 2][impulse] - half[2 * k][impulse]) / self.sampling.interval
    }

    /// Whether it touched the film, and whether other bodies.
    pub(super) fn touched(&self) -> [bool; 2] {
        [self.first_contact.is_some(), self.has_met]
    }
}

impl Tracks {
    /// Tracks of a run with these impactors and the frame's bars.
    pub(super) fn new(sampling: Sampling, bodies: Vec<BodyTracks>, bars: Option<BodyTracks>) -> Tracks {
        Tracks {
            sampling,
            bodies,
            jaws: sampling.at_samples(),
            middle: 0.0,
            strains: sampling.at_samples(),
            bars,
            sampled: BTreeMap::new(),
        }
    }

    /// Whether it has the same samples and impactors as the other, whatever is recorded: of another scene, it could be of
    /// any length.
    pub(super) fn is_like(&self, other: &Tracks) -> bool {
        let bodies = |tracks: &Tracks| tracks.bodies.len();
        let pairs = self.bodies.iter().chain(&self.bars).zip(other.bodies.iter().chain(&other.bars));
        let new = other.sampling.at_samples();
        self.sampling == other.sampling
            && bodies(self) == bodies(other)
            && self.bars.is_some() == other.bars.is_some()
            && pairs.into_iter().all(|(one, other)| one.is_like(other))
            && self.jaws.is_like(&other.jaws)
            && self.strains.is_like(&other.strains)
            && self.sampled.values().all(|grid| grid.is_like(&new))
    }

    /// Records one step.
    pub(super) fn follow(&mut self, track: &Track<'_>) {
        self.middle = track.time + 0.5 * track.dt;
        self.jaws.push(track.time, [track.jaw_force]);
        for (tracks, body) in self.bodies.iter_mut().zip(track.bodies) {
            tracks.follow(body, [track.time, self.middle]);
        }
        if let (Some(tracks), Some(bars)) = (&mut self.bars, &track.frame) {
            tracks.follow(bars, [track.time, self.middle]);
        }
    }

    /// Adds the value that is sampled for `column` at `time` (s).
    pub(super) fn sample(&mut self, column: &Column, time: f64, value: f64) {
        let new = || self.sampling.at_samples();
        self.sampled.entry(column.name.to_owned()).or_insert_with(new).push(time, [value]);
    }

    /// The values sampled for `column`; none where the run does not have it.
    pub(super) fn sampled(&self, column: &Column) -> &[f64] {
        self.sampled.get(column.name).map_or(&[], |grid| grid.rows.as_flattened())
    }

    /// Whether `time` (s) has reached the next sample of the strains.
    pub(super) fn is_due(&self, time: f64) -> bool {
        self.strains.rows.len() < self.sampling.count && self.strains.is_due(time)
    }

    /// Whether every sample has been recorded, with the half steps on both of its sides.
    pub(super) fn are_complete(&self) -> bool {
        let Sampling { interval, count } = self.sampling;
        let last = -0.5 * interval + (2 * count) as f64 * (0.5 * interval);
        self.jaws.rows.len() >= count && last <= self.middle
    }

    /// Samples at which everything is known of the impactors and the strains.
    pub(super) fn whole(&self) -> usize {
        let of_bodies = self.bodies.iter().chain(&self.bars).map(BodyTracks::whole).min().unwrap_or(0);
        self.sampling.count.min(of_bodies).min(self.strains.rows.len())
    }

    /// Channels of one row a sample.
    pub(super) fn table<const K: usize>(&self, names: &[&str; K], rows: &[[f64; K]]) -> Recording {
        Recording {
            time: (0..rows.len()).map(|k| k as f64 * self.sampling.interval).collect(),
            channels: (0..K)
                .map(|c| Channel { name: names[c].to_string(), values: rows.iter().map(|r| r[c]).collect() })
                .collect(),
        }
    }
}

/// Rise of the film from its initial heights.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Rise {
    /// Heights of all nodes at the start, m.
    before: Vec<f64>,
}

impl Rise {
    /// Largest rise of a node, m.
    pub(super) fn largest(&mut self, view: &View<'_>) -> f64 {
        let heights = || view.nodes.position.iter().map(|x| x[2]);
        if self.before.is_empty() {
            self.before = heights().collect();
        }
        heights().zip(&self.before).map(|(now, before)| now - before).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Largest change of the rise over the last tenth of the samples, relative to the last rise; none without samples.
pub(super) fn settling(tracks: &Tracks) -> Option<f64> {
    let rises = tracks.sampled(&column::DEFLECTION);
    let last = rises.last()?;
    let held = &rises[rises.len() - rises.len().div_ceil(10)..];
    let change = held.iter().map(|rise| (rise - last).abs()).fold(0.0, f64::max);
    Some(change / last.abs())
}

/// The state of a run at a sample, with what takes time to compute or is also checked against a bound.
pub(super) struct Sample<'a> {
    /// State of the engine.
    pub(super) view: &'a View<'a>,
    /// Sides held by the frame.
    pub(super) held: &'a HeldSides,
    /// The held edge on the crest of the frame's bars.
    pub(super) crest: &'a Crest,
    /// Largest rise of a node of inflated film, m.
    pub(super) rise: Option<f64>,
    /// Largest slip in the frame's clamp (m), and the share of it that holds film no longer.
    pub(super) clamp: Option<[f64; 2]>,
    /// State of the springs on which film hangs.
    pub(super) springs: Option<SpringsState>,
    /// Contact between faces.
    pub(super) films: Option<FilmContactState>,
    /// Tears.
    pub(super) torn: Option<Torn>,
}

/// A channel that is sampled.
struct Sampled {
    column: Column,
    /// Its value in a sample; none of a run that does not have the channel.
    value: fn(&Sample<'_>) -> Option<f64>,
    /// Its value in the column at sample `k`, from what was sampled and interpolated to the time of `k`.
    finish: fn(&Tracks, usize, f64) -> f64,
}

/// The sampled channels, in the order of `signals.csv`.
const SAMPLED: &[Sampled] = &[
    sampled(column::FRAME_FORCE_X, |s| s.held.force(s.view, 0)),
    sampled(column::FRAME_FORCE_Y, |s| s.held.force(s.view, 1)),
    Sampled {
        finish: on_bars,
        ..sampled(column::FRAME_FORCE, |s| {
            s.crest.force(s.view.nodes).or_else(|| s.view.springs().map(Springs::vertical_force))
        })
    },
    sampled(column::CLAMP_SLIP, |s| s.clamp.map(|[slip, _]| slip)),
    sampled(column::SPRING_ELONGATION, |s| Some(s.springs?.elongation)),
    sampled(column::SPRING_FORCE, |s| Some(s.springs?.force)),
    sampled(column::AIR_PRESSURE, |s| s.view.cushion_pressure()),
    sampled(column::FILM_DISTANCE, |s| Some(s.films?.distance)),
    Sampled {
        finish: |_, _, nodes| nodes.round(),
        ..sampled(column::FILM_CONTACT_NODES, |s| Some(s.films?.nodes as f64))
    },
    sampled(column::TORN_LENGTH, |s| Some(s.torn?.length)),
    sampled(column::TORN_AREA, |s| Some(s.torn?.area)),
    sampled(column::FRACTURE_ENERGY, |s| Some(s.torn?.energy)),
    sampled(column::DEFLECTION, |s| s.rise),
    sampled(column::PRESSURE, |s| Some(s.view.inflated()?[0])),
    sampled(column::VOLUME, |s| Some(s.view.inflated()?[1])),
];

/// A channel whose values are as they were sampled.
const fn sampled(column: Column, value: fn(&Sample<'_>) -> Option<f64>) -> Sampled {
    Sampled { column, value, finish: |_, _, value| value }
}

/// Vertical force on the frame at sample `k`, N: that of springs or of the edge on the `crest` of bars, and what film and
/// impactors push these by.
fn on_bars(tracks: &Tracks, k: usize, crest: f64) -> f64 {
    tracks.bars.as_ref().map_or(crest, |bars| crest - bars.contact_force(k) - bars.collision_force(k))
}

/// Adds the values of a sample to `tracks`.
pub(super) fn take(sample: &Sample<'_>, tracks: &mut Tracks) {
    for Sampled { column, value, .. } in SAMPLED {
        if let Some(value) = value(sample) {
            tracks.sample(column, sample.view.time, value);
        }
    }
}

/// Adds the sampled channels to the `signals` of a loading, but for those that it has placed itself.
pub(super) fn add(tracks: &Tracks, signals: &mut Recording) {
    for Sampled { column, finish, .. } in SAMPLED {
        let values = tracks.sampled(column);
        if !values.is_empty() && signals.channel(column.name).is_none() {
            let values = values.iter().take(signals.time.len()).enumerate();
            let values = values.map(|(k, value)| finish(tracks, k, *value)).collect();
            signals.channels.push(Channel { name: column.name.into(), values });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settling_is_the_change_in_the_last_tenth() {
        let mut tracks = Tracks::new(Sampling::new(1.0, 0.05), vec![], None);
        assert_eq!(settling(&tracks), None);
        for k in 0..=20 {
            let time = 0.05 * f64::from(k);
            let rise = if k < 19 { 5.0 * time } else { 5.0 - 0.01 * f64::from(20 - k) };
            tracks.sample(&column::DEFLECTION, time, rise);
        }
        assert!(settling(&tracks).is_some_and(|change| (change - 0.1).abs() < 1e-12), "{:?}", settling(&tracks));
    }

    #[test]
    fn sampled_channels_follow_those_that_a_loading_placed_itself() {
        let mut tracks = Tracks::new(Sampling::new(1.0, 0.5), vec![], None);
        for time in [0.0, 0.5, 1.0] {
            tracks.sample(&column::PRESSURE, time, 1.0);
            tracks.sample(&column::FILM_CONTACT_NODES, time, 2.6);
        }
        let mut signals = tracks.table(&[column::PRESSURE.name], &[[5.0], [6.0]]);
        add(&tracks, &mut signals);
        let expected = [("pressure_Pa", vec![5.0, 6.0]), ("film_contact_nodes", vec![3.0, 3.0])];
        let expected = expected.map(|(name, values)| Channel { name: name.into(), values });
        assert_eq!(signals.channels, expected);
    }
}
