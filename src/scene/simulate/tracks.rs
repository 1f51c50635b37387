//! Quantities recorded at every step of a run and interpolated at its samples.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::grid::Grid;
use lab::signal::column::Column;
use lab::signal::{Channel, Recording};
use membrane::engine::{BodyTrack, Track};

/// Impactors, jaws and strains at the samples of a run. Each loading makes its signals of them.
#[derive(Serialize, Deserialize)]
pub(super) struct Tracks {
    /// Between two samples, s.
    pub(super) sample: f64,
    /// Number of samples.
    pub(super) samples: usize,
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
    /// Between two samples, s.
    sample: f64,
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
    /// Tracks with `sample` (s) between samples of an impactor that moves down at `speed` (m/s) in free fall under
    /// `gravity` (m/s²), along z alone or not.
    pub(super) fn new(sample: f64, [speed, gravity]: [f64; 2], is_spatial: bool) -> BodyTracks {
        let mut at_half_steps = Grid::new(-0.5 * sample, 0.5 * sample);
        // Free fall before first contact, so that the first sample is a mean like every other.
        at_half_steps.push(-sample, [gravity * sample - speed, 0.0, 0.0]);
        at_half_steps.push(0.0, [-speed, 0.0, 0.0]);
        BodyTracks {
            sample,
            at_steps: Grid::new(0.0, sample),
            at_half_steps,
            is_spatial,
            lateral: Grid::new(0.0, sample),
            lateral_half: Grid::new(-0.5 * sample, 0.5 * sample),
            first_contact: None,
            has_met: false,
        }
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
                self.lateral_half.push(-self.sample, lateral);
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
        (half[2 * k + 2][impulse] - half[2 * k][impulse]) / self.sample
    }

    /// Whether it touched the film, and whether other bodies.
    pub(super) fn touched(&self) -> [bool; 2] {
        [self.first_contact.is_some(), self.has_met]
    }
}

impl Tracks {
    /// Tracks of a run of `duration` (s) with `sample` (s) between samples.
    pub(super) fn new(duration: f64, sample: f64, bodies: Vec<BodyTracks>, bars: Option<BodyTracks>) -> Tracks {
        Tracks {
            sample,
            samples: (duration / sample * (1.0 + 1e-12)).floor() as usize + 1,
            bodies,
            jaws: Grid::new(0.0, sample),
            middle: 0.0,
            strains: Grid::new(0.0, sample),
            bars,
            sampled: BTreeMap::new(),
        }
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
        let new = || Grid::new(0.0, self.sample);
        self.sampled.entry(column.name.to_owned()).or_insert_with(new).push(time, [value]);
    }

    /// The values sampled for `column`; none where the run does not have it.
    pub(super) fn sampled(&self, column: &Column) -> &[f64] {
        self.sampled.get(column.name).map_or(&[], |grid| grid.rows.as_flattened())
    }

    /// Whether `time` (s) has reached the next sample of the strains.
    pub(super) fn is_due(&self, time: f64) -> bool {
        self.strains.rows.len() < self.samples && self.strains.is_due(time)
    }

    /// Whether every sample has been recorded, with the half steps on both of its sides.
    pub(super) fn are_complete(&self) -> bool {
        let last = -0.5 * self.sample + (2 * self.samples) as f64 * (0.5 * self.sample);
        self.jaws.rows.len() >= self.samples && last <= self.middle
    }

    /// Samples at which everything is known of the impactors and the strains.
    pub(super) fn whole(&self) -> usize {
        let of_bodies = self.bodies.iter().chain(&self.bars).map(BodyTracks::whole).min().unwrap_or(0);
        self.samples.min(of_bodies).min(self.strains.rows.len())
    }

    /// Channels of one row a sample.
    pub(super) fn table<const K: usize>(&self, names: &[&str; K], rows: &[[f64; K]]) -> Recording {
        Recording {
            time: (0..rows.len()).map(|k| k as f64 * self.sample).collect(),
            channels: (0..K)
                .map(|c| Channel { name: names[c].to_string(), values: rows.iter().map(|r| r[c]).collect() })
                .collect(),
        }
    }
}
