//! A recording whose rest, release and impact are known: what of it the model is fitted to.

use super::Known;
use super::model::{COUNT, Model, Sample, Unknowns, of};
use super::release::Release;
use crate::Error;
use crate::experiment::Warning;
use crate::signal::Series;

/// Fewest equal samples of a laser in a row that are not a moving impactor: out of range a laser holds its last value, or
/// writes the end of its range, or zero.
const HELD: usize = 20;
/// Share of the peak's rise up to which the force is fitted: there a bent power of the travel describes film.
const ONSET: f64 = 0.2;
/// Share of the force to which the model describes it: one standard deviation. Assumed.
const ONSET_ERROR: f64 = 0.01;
/// Share from which on contact is guessed.
const EARLY: f64 = 0.08;
/// Samples of the onset beyond that.
const BEYOND: f64 = 3.0;
/// Length of the means by which the onset's end is found, s.
const SMOOTHED: f64 = 1e-3;
/// Time after the first peak of the filtered reading until which the peak itself is sought, s.
const SHORT_PEAK: f64 = 2e-3;
/// Longest rest that counts, s: a zero that drifts is nearly constant over it.
const LONGEST_REST: f64 = 2.0;
/// Lengths of means of the reading: where it changes slowly and where release and onset are, s.
const COARSE: f64 = 1e-3;
const FINE: f64 = 5e-5;
/// Times about the release, and before contact, over which the reading counts finely, s.
const ABOUT_RELEASE: f64 = 0.015;
const BEFORE_CONTACT: f64 = 0.02;
/// Least noise, m/s²: below it the model's own errors count; and of the laser, m.
const LEAST_NOISE: f64 = 0.01;
const LEAST_LASER_NOISE: f64 = 2e-5;

/// A recording on equal steps, with its landmarks.
#[derive(Clone, Debug)]
pub(super) struct Recorded {
    pub reading: Series,
    pub release: Release,
    /// Standard deviation of a sample, m/s².
    pub noise: f64,
    /// End of the onset of the force, s.
    pub onset_end: f64,
    /// Guess of the contact, s.
    contact: f64,
    /// The reading before contact, and its rise from there to the first peak, m/s².
    base: f64,
    rise: f64,
    /// The samples of a laser until then.
    laser: Vec<[f64; 2]>,
    laser_noise: f64,
    /// Number of samples of the laser that it held.
    held: usize,
}

impl Recorded {
    /// The landmarks of an evenly sampled `reading` (m/s²) under `gravity` (m/s²), beside the recorded `laser` (m).
    pub(super) fn find(reading: &Series, laser: Option<&Series>, gravity: f64) -> Result<Recorded, Error> {
        let release = Release::find(reading, gravity)?;
        let Onset { contact, end: onset_end, base, rise } = Onset::of(reading, &release);
        let (laser, held) = laser.map_or_else(Default::default, |laser| moving(laser, [release.flank[0], onset_end]));
        let laser_noise = third_differences(&laser).max(LEAST_LASER_NOISE);
        let noise = release.noise.max(LEAST_NOISE);
        Ok(Recorded {
            reading: reading.clone(),
            release,
            noise,
            onset_end,
            contact,
            base,
            rise,
            laser,
            laser_noise,
            held,
        })
    }

    pub(super) fn has_laser(&self) -> bool {
        !self.laser.is_empty()
    }

    pub(super) fn laser_rows(&self) -> usize {
        self.laser.len()
    }

    pub(super) fn without_laser(self) -> Recorded {
        Recorded { laser: vec![], held: 0, ..self }
    }

    /// The report of samples that the laser held.
    pub(super) fn held_laser(&self) -> Option<Warning> {
        (self.held > 0).then_some(Warning::LaserOutOfRange { samples: self.held, run: HELD })
    }

    /// First time that counts, s.
    pub(super) fn start(&self) -> f64 {
        let first = self.reading.time().first().copied().unwrap_or(0.0);
        first.max(self.release.rest_end - LONGEST_REST)
    }

    /// Time between two samples, s.
    pub(super) fn step(&self) -> f64 {
        match self.reading.time() {
            [first, .., last] => (last - first) / (self.reading.len() - 1) as f64,
            _ => f64::NAN,
        }
    }

    /// The reading without offset and drift from the end of the rest on, m/s².
    pub(super) fn levelled(&self, u: &Unknowns) -> Series {
        let moving = self.reading.window([self.release.rest_end, f64::INFINITY]);
        let level = |[t, r]: [f64; 2]| r - u[of::OFFSET] - u[of::DRIFT] * (t - self.start());
        moving.with_values(moving.samples().map(level).collect())
    }

    /// The model of this recording.
    pub(super) fn model<'a>(&self, known: &'a Known, gravity: f64) -> Model<'a> {
        let fall = self.contact - self.release.flank[0];
        let speed = known.height.map_or(gravity * fall, |[height, _]| (2.0 * gravity * height).sqrt());
        Model {
            samples: self.samples(),
            laser: self.laser.clone(),
            laser_deviation: self.laser_noise,
            known,
            gravity,
            speed,
            reach: speed * (self.onset_end - self.contact),
            force: ONSET * self.rise,
            step: self.step(),
            smear: self.step(),
        }
    }

    /// Means of the reading from the rest to the end of the onset.
    fn samples(&self) -> Vec<Sample> {
        let until = self.reading.window([self.start(), self.onset_end]);
        let (time, values, step) = (until.time(), until.values(), self.step());
        let count = |length: f64| ((length / step).round() as usize).max(1);
        let from = self.contact - BEFORE_CONTACT;
        let mut samples = Vec::new();
        let mut first = 0;
        while first < time.len() {
            let is_fine = (time[first] - self.release.flank[0]).abs() < ABOUT_RELEASE || time[first] > from;
            let last = (first + count(if is_fine { FINE } else { COARSE })).min(time.len());
            let mean = |of: &[f64]| of[first..last].iter().sum::<f64>() / (last - first) as f64;
            let (time, reading) = (mean(time), mean(values));
            let force = if time > self.contact { (reading - self.base).abs() } else { 0.0 };
            let deviation = (self.noise / ((last - first) as f64).sqrt()).hypot(ONSET_ERROR * force);
            samples.push(Sample { time, reading, deviation });
            first = last;
        }
        samples
    }

    /// The unknowns to search from.
    pub(super) fn first_guess(&self, known: &Known, gravity: f64) -> Unknowns {
        let duration = 0.5 * (self.release.flank[1] - self.release.flank[0]);
        let fall = self.contact - self.release.flank[0] - duration / 3.0;
        let free = 0.5 * gravity * fall * fall;
        // Of a known height, the friction that makes it last so long.
        let height = known.height.map_or(free * (1.0 - Known::FRICTION[0]), |[height, _]| height);
        let friction = known.friction.filter(|[_, error]| *error < 0.1).map_or(1.0 - height / free, |[given, _]| given);
        let friction = friction.clamp(-0.02, 0.6);
        let lasts = (2.0 * height / (gravity * (1.0 - friction))).sqrt() + duration / 3.0;
        let mut guess = [0.0; COUNT];
        guess[of::OFFSET] = self.release.offset;
        guess[of::INVERSE] = 0.5;
        guess[of::RELEASE] = self.contact - lasts;
        guess[of::DURATION] = duration;
        guess[of::FRICTION] = friction;
        guess[of::CONTACT] = self.contact;
        guess[of::LEVEL] = (ONSET * self.rise).ln();
        guess
    }
}

/// The rise of the reading to its first peak.
#[derive(Clone, Copy, Debug)]
struct Onset {
    /// Estimated contact, s.
    contact: f64,
    /// When the reading has risen by a share of it, s.
    end: f64,
    /// The reading before contact, and its rise to the peak, m/s².
    base: f64,
    rise: f64,
}

impl Onset {
    /// By means of [`SMOOTHED`]: the longer ones in which landmarks are found lower short peaks. A force that grows as
    /// tⁿ with n of 1.7 tells the contact from the times of two shares.
    fn of(reading: &Series, release: &Release) -> Onset {
        let until = reading.window([release.flank[1], release.peak + SHORT_PEAK]);
        let (time, values) = (until.time(), until.values());
        let step = time.windows(2).next().map_or(0.0, |pair| pair[1] - pair[0]);
        let count = ((SMOOTHED / step) as usize).clamp(1, values.len().max(1));
        let means: Vec<f64> = values.windows(count).map(|window| window.iter().sum::<f64>() / count as f64).collect();
        let top = (0..means.len()).max_by(|a, b| means[*a].total_cmp(&means[*b])).unwrap_or(0);
        // The later part of the fall, which the coupling has let recover, but not its end.
        let fall = &means[top / 2..(4 * top / 5).max(top / 2)];
        let base = fall.iter().sum::<f64>() / fall.len().max(1) as f64;
        let rise = means.get(top).map_or(0.0, |top| top - base);
        let reaches = |share: f64| {
            let below = means[..top].iter().rposition(|mean| *mean < base + share * rise).unwrap_or(0);
            time.get(below + count / 2).copied().unwrap_or(release.peak)
        };
        let [early, late] = [EARLY, ONSET].map(reaches);
        let duration = (late - early).max(step) / (1.0 - (EARLY / ONSET).powf(1.0 / 1.7));
        Onset { contact: (late - duration).max(release.flank[1]), end: late + BEYOND * step, base, rise }
    }
}

/// The samples between two times (s) that show a moving impactor, and the number of those that the laser held.
fn moving(laser: &Series, [from, to]: [f64; 2]) -> (Vec<[f64; 2]>, usize) {
    let mut samples = laser.samples();
    let (mut moving, mut held) = (vec![], 0);
    for run in laser.values().chunk_by(|a, b| a == b) {
        let of_run = samples.by_ref().take(run.len());
        if run.len() >= HELD {
            held += of_run.count();
        } else {
            moving.extend(of_run.filter(|[t, z]| z.is_finite() && *t > from && *t < to));
        }
    }
    (moving, held)
}

/// Noise of a smooth signal: the root mean square of its third differences over √20.
fn third_differences(samples: &[[f64; 2]]) -> f64 {
    let third = |s: &[[f64; 2]]| s[3][1] - 3.0 * s[2][1] + 3.0 * s[1][1] - s[0][1];
    let squares = samples.windows(4).map(|window| third(window).powi(2)).sum::<f64>();
    (squares / 20.0 / samples.len().saturating_sub(3).max(1) as f64).sqrt()
}
