//! Quantities recorded at every step of a run and interpolated at its samples.

use serde::{Deserialize, Serialize};

use super::grid::Grid;
use crate::engine::Track;
use crate::signal::{Channel, Recording};

/// Impactor, jaws and strains at the samples of a run. Each loading makes its signals of them.
#[derive(Serialize, Deserialize)]
pub(super) struct Tracks {
    /// Between two samples, s.
    pub(super) sample: f64,
    /// Number of samples.
    pub(super) samples: usize,
    /// Height of the impactor (m), its work on the film (J), force on the jaws (N).
    pub(super) at_steps: Grid<3>,
    /// Velocity of the impactor (m/s) and the impulse of the film on it so far (N s), twice a sample.
    pub(super) at_half_steps: Grid<2>,
    /// Whether the impactor does not move along z alone.
    pub(super) are_spatial: bool,
    /// Position of the impactor along x and y, m; only where it does not move along z alone.
    pub(super) lateral: Grid<2>,
    /// Its velocity along x and y (m/s) and the kinetic energy of its motion besides that along z (J), twice a sample.
    pub(super) lateral_half: Grid<3>,
    /// Largest MD and TD strain.
    pub(super) strains: Grid<2>,
    /// Force of the film on the frame along x and y, N; only where a frame holds sides.
    pub(super) frame: Grid<2>,
    /// Pressure of the air between two faces over that of the surroundings, Pa; only where it is computed.
    pub(super) air: Grid<1>,
    /// Least distance of two faces (m) and nodes in touch with another face; only where faces meet.
    pub(super) films: Grid<2>,
    /// Largest rise of a node, m; only under pressure.
    pub(super) rise: Grid<1>,
    /// Height of the impactor at its first impulse, m.
    pub(super) first_contact: Option<f64>,
}

impl Tracks {
    /// Tracks of a run of `duration` (s) with `sample` (s) between samples; an impactor moves down at `speed` (m/s) in
    /// free fall under `gravity` (m/s²).
    pub(super) fn new(duration: f64, sample: f64, speed: f64, gravity: f64) -> Tracks {
        let mut at_half_steps = Grid::new(-0.5 * sample, 0.5 * sample);
        // Free fall before first contact, so that the first sample is a mean like every other.
        at_half_steps.push(-sample, [gravity * sample - speed, 0.0]);
        at_half_steps.push(0.0, [-speed, 0.0]);
        Tracks {
            sample,
            samples: (duration / sample * (1.0 + 1e-12)).floor() as usize + 1,
            at_steps: Grid::new(0.0, sample),
            at_half_steps,
            are_spatial: false,
            lateral: Grid::new(0.0, sample),
            lateral_half: Grid::new(-0.5 * sample, 0.5 * sample),
            strains: Grid::new(0.0, sample),
            frame: Grid::new(0.0, sample),
            air: Grid::new(0.0, sample),
            films: Grid::new(0.0, sample),
            rise: Grid::new(0.0, sample),
            first_contact: None,
        }
    }

    /// The same of an impactor that does not move along z alone.
    pub(super) fn of_spatial_motion(self) -> Tracks {
        Tracks { are_spatial: true, ..self }
    }

    /// Records one step.
    pub(super) fn follow(&mut self, track: &Track) {
        let [x, y, z] = track.centre;
        let [along_x, along_y, velocity] = track.velocity;
        if track.impulse != 0.0 {
            self.first_contact.get_or_insert(z);
        }
        let middle = track.time + 0.5 * track.dt;
        self.at_steps.push(track.time, [z, track.work, track.jaw_force]);
        self.at_half_steps.push(middle, [velocity, track.impulse]);
        if self.are_spatial {
            let lateral = [along_x, along_y, track.lateral_energy];
            if self.lateral_half.rows.is_empty() {
                self.lateral_half.push(-self.sample, lateral);
            }
            self.lateral.push(track.time, [x, y]);
            self.lateral_half.push(middle, lateral);
        }
    }

    /// Whether `time` (s) has reached the next sample of the strains.
    pub(super) fn is_due(&self, time: f64) -> bool {
        self.strains.rows.len() < self.samples && self.strains.is_due(time)
    }

    /// Whether every sample has been recorded.
    pub(super) fn are_complete(&self) -> bool {
        self.at_steps.rows.len() >= self.samples && self.at_half_steps.rows.len() > 2 * self.samples
    }

    /// Samples whose half steps on both sides are known.
    pub(super) fn whole(&self) -> usize {
        let halves = self.at_half_steps.rows.len().saturating_sub(1) / 2;
        self.samples.min(self.at_steps.rows.len()).min(halves)
    }

    /// Impulse of the film on the impactor around sample `k`, over the time between samples, N.
    pub(super) fn contact_force(&self, k: usize) -> f64 {
        let half = &self.at_half_steps.rows;
        (half[2 * k + 2][1] - half[2 * k][1]) / self.sample
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
