//! Virtual sensors: what an accelerometer and a laser would have read in a simulated drop.
//!
//! The recordings that come out are virtual. The paper prints no recording, and of its sensors neither time constant nor noise:
//! the values of [`Accelerometer`] and [`Laser`] are assumed.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use thiserror::Error;

use super::coupling::high_pass;
use crate::signal::csv::clean_time;
use crate::signal::{Channel, Recording, Series};
use crate::units::STANDARD_GRAVITY;

/// The fall before a simulated impact: rest, the magnet letting go, then a constant net acceleration.
///
/// The net acceleration is what covers the height and reaches the speed; the guide's friction has the rest of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fall {
    /// m.
    pub height: f64,
    /// Speed at first contact, m/s, positive.
    pub speed: f64,
    /// m/s².
    pub gravity: f64,
    /// Time over which the magnet's force falls to zero as a parabola with its vertex at the end, s. The paper sees
    /// the reading fall over 32 ms.
    pub letting_go: f64,
}

/// Why there is no such fall or recording.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SensorError {
    #[error("{what} is {value}, but must be {must_be}")]
    Value { what: &'static str, value: f64, must_be: &'static str },
    #[error("a fall over {height} m does not reach {speed} m/s: {needed:.2} m/s² would be needed, more than gravity")]
    TooFast { height: f64, speed: f64, needed: f64 },
    #[error("the simulated impact has no {channel} at {time} s after contact")]
    NoImpact { channel: &'static str, time: f64 },
}

/// Piezoelectric accelerometer, AC-coupled, digitised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerometer {
    /// Of the first-order high pass, s. Assumed: the paper's reading is back at zero before contact, and after 0.15 s
    /// only 4 % (1 m) or 2 % (1.5 m) of a step are left of it then; a shorter one would lose more of the blow.
    pub time_constant: f64,
    /// Standard deviation of the white noise, m/s². Assumed: a little over half a step, so that the steps average out.
    pub noise: f64,
    /// Reading at rest, m/s². Assumed.
    pub offset: f64,
    /// Largest magnitude that is read, m/s². Assumed: 50 g.
    pub range: f64,
    /// Of the converter over the whole range, both signs. Assumed.
    pub bits: u32,
}

impl Default for Accelerometer {
    fn default() -> Accelerometer {
        Accelerometer { time_constant: 0.15, noise: 0.15, offset: 0.2, range: 50.0 * STANDARD_GRAVITY, bits: 12 }
    }
}

/// Laser triangulation of the impactor's lowest point over the film's upper face; it sees nothing outside its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laser {
    /// Lowest and highest place that it sees, m. The paper's sensor has a range of 50 mm; where it lies is assumed.
    pub range: [f64; 2],
    /// Standard deviation of the white noise, m. Assumed.
    pub noise: f64,
    /// Of the converter over the range. Assumed.
    pub bits: u32,
}

impl Default for Laser {
    fn default() -> Laser {
        Laser { range: [-0.035, 0.015], noise: 5e-5, bits: 12 }
    }
}

/// The sensors on the tower and their recorder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    pub accelerometer: Accelerometer,
    /// None where it failed.
    pub laser: Option<Laser>,
    /// 1/s.
    pub sample_rate: f64,
    /// Shortest and longest rest on the recording, s; the seed chooses between them, so that nobody knows the time of release.
    pub rest: [f64; 2],
}

impl Default for Sensors {
    fn default() -> Sensors {
        let (accelerometer, laser) = (Accelerometer::default(), Some(Laser::default()));
        Sensors { accelerometer, laser, sample_rate: 10e3, rest: [0.1, 0.2] }
    }
}

/// A virtual recording and the truth that it hides.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualDrop {
    /// `time_s`, `accelerometer_m_s2` and, with a laser, `laser_m` (`NaN` out of range).
    pub recording: Recording,
    /// First contact on the recording's clock, s.
    pub contact_time: f64,
}

/// Steps of the true motion per sample of the recording.
const OVERSAMPLING: usize = 10;

/// What the `sensors` read in a drop whose impact was simulated: `acceleration` (m/s², coordinate acceleration, upward) and
/// `displacement` (m) from contact on. The same `seed` gives the same recording, bit for bit.
pub fn virtual_drop(
    acceleration: &Series,
    displacement: &Series,
    fall: &Fall,
    sensors: &Sensors,
    seed: u64,
) -> Result<VirtualDrop, SensorError> {
    sensors.check()?;
    let motion = Motion::new(fall, acceleration, displacement)?;
    let release = release_time(sensors.rest, seed);
    let contact_time = release + motion.fall_time();
    let step = 1.0 / sensors.sample_rate;
    let end = contact_time + motion.last;
    let count = (end / step).floor() as usize;
    let time: Vec<f64> = (0..=count).map(|i| clean_time(i as f64 * step)).collect();

    let fine = (0..=count * OVERSAMPLING).map(|j| j as f64 * step / OVERSAMPLING as f64);
    let fine: Vec<f64> = fine.collect();
    let proper = fine.iter().map(|t| Some(motion.acceleration(t - release)? + fall.gravity));
    let proper = proper.collect::<Option<Vec<f64>>>();
    let proper = proper.ok_or(SensorError::NoImpact { channel: "acceleration", time: motion.last })?;
    let coupled = high_pass(&Series::new(fine, proper), sensors.accelerometer.time_constant);
    let sampled = coupled.values().iter().step_by(OVERSAMPLING).copied();
    let mut channels = vec![Channel {
        name: "accelerometer_m_s2".into(),
        values: sensors.accelerometer.read(sampled, &mut noise(seed, 1)),
    }];
    if let Some(laser) = &sensors.laser {
        let places = time.iter().map(|t| motion.place(t - release)).collect::<Option<Vec<f64>>>();
        let places = places.ok_or(SensorError::NoImpact { channel: "displacement", time: motion.last })?;
        channels.push(Channel { name: "laser_m".into(), values: laser.read(&places, &mut noise(seed, 2)) });
    }
    Ok(VirtualDrop { recording: Recording { time, channels }, contact_time })
}

/// One source of noise; the others do not change where one is left out.
fn noise(seed: u64, source: u64) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(source);
    generator
}

fn release_time([shortest, longest]: [f64; 2], seed: u64) -> f64 {
    let share: f64 = StandardUniform.sample(&mut noise(seed, 0));
    shortest + share * (longest - shortest)
}

impl Sensors {
    fn check(&self) -> Result<(), SensorError> {
        let Sensors { accelerometer, laser, sample_rate, rest } = self;
        let Accelerometer { time_constant, noise, offset, range, bits } = accelerometer;
        let positive =
            [("the time constant", *time_constant), ("the range", *range), ("the sample rate", *sample_rate)];
        let mut ranges = vec![(rest[0] >= 0.0 && rest[1] >= rest[0], "the rest", rest[1], "a range of times")];
        ranges.extend(positive.map(|(what, value)| (value > 0.0 && value.is_finite(), what, value, "positive")));
        ranges.push((*noise >= 0.0, "the noise", *noise, "zero or more"));
        ranges.push((offset.is_finite(), "the offset", *offset, "finite"));
        ranges.push(((1..=32).contains(bits), "the number of bits", f64::from(*bits), "1 to 32"));
        if let Some(Laser { range, noise, bits }) = laser {
            ranges.push((range[1] > range[0], "the laser's upper limit", range[1], "above its lower one"));
            ranges.push((*noise >= 0.0, "the laser's noise", *noise, "zero or more"));
            ranges.push(((1..=32).contains(bits), "the laser's number of bits", f64::from(*bits), "1 to 32"));
        }
        let wrong = ranges.into_iter().find(|(holds, ..)| !holds);
        wrong.map_or(Ok(()), |(_, what, value, must_be)| Err(SensorError::Value { what, value, must_be }))
    }
}

impl Accelerometer {
    /// Offset, noise, limits and steps; rounded to 0.1 mm/s², far below a step.
    fn read(&self, coupled: impl Iterator<Item = f64>, generator: &mut ChaCha8Rng) -> Vec<f64> {
        let step = 2.0 * self.range / f64::from(self.bits).exp2();
        let read = |r: f64| {
            let scatter: f64 = StandardNormal.sample(generator);
            let held = (r + self.offset + self.noise * scatter).clamp(-self.range, self.range);
            rounded((held / step).round() * step, 1e4)
        };
        coupled.map(read).collect()
    }
}

impl Laser {
    /// Noise, limits and steps; rounded to a micrometre.
    fn read(&self, places: &[f64], generator: &mut ChaCha8Rng) -> Vec<f64> {
        let [lowest, highest] = self.range;
        let step = (highest - lowest) / f64::from(self.bits).exp2();
        let read = |place: &f64| {
            let scatter: f64 = StandardNormal.sample(generator);
            let seen = place + self.noise * scatter;
            let within = (lowest..=highest).contains(&seen);
            if within { rounded(lowest + ((seen - lowest) / step).round() * step, 1e6) } else { f64::NAN }
        };
        places.iter().map(read).collect()
    }
}

fn rounded(value: f64, per_unit: f64) -> f64 {
    // Adding zero makes −0 a 0.
    (value * per_unit).round() / per_unit + 0.0
}

/// The true motion; times count from the release.
struct Motion<'a> {
    fall: &'a Fall,
    /// Time from the magnet's last force to contact, s.
    free: f64,
    /// Net acceleration of the fall, m/s², positive.
    net: f64,
    acceleration: &'a Series,
    displacement: &'a Series,
    /// Last simulated time after contact, s.
    last: f64,
}

impl Motion<'_> {
    fn new<'a>(fall: &'a Fall, acceleration: &'a Series, displacement: &'a Series) -> Result<Motion<'a>, SensorError> {
        let (free, net) = fall.solve()?;
        let ends = [acceleration, displacement].map(|series| series.time().last().copied().unwrap_or(f64::NAN));
        let last = ends[0].min(ends[1]);
        for (series, channel) in [(acceleration, "acceleration"), (displacement, "displacement")] {
            if series.at(0.0).is_none() || last.is_nan() || last <= 0.0 {
                return Err(SensorError::NoImpact { channel, time: 0.0 });
            }
        }
        Ok(Motion { fall, free, net, acceleration, displacement, last })
    }

    fn fall_time(&self) -> f64 {
        self.fall.letting_go + self.free
    }

    fn acceleration(&self, t: f64) -> Option<f64> {
        let since_contact = t - self.fall_time();
        if since_contact >= 0.0 {
            return self.acceleration.at(since_contact.min(self.last));
        }
        let s = (t / self.fall.letting_go).clamp(0.0, 1.0);
        Some(-self.net * (2.0 * s - s * s))
    }

    /// Height of the impactor's lowest point over the film's upper face, m.
    fn place(&self, t: f64) -> Option<f64> {
        let since_contact = t - self.fall_time();
        if since_contact >= 0.0 {
            return self.displacement.at(since_contact.min(self.last));
        }
        let Fall { height, letting_go, .. } = *self.fall;
        let s = (t / letting_go).clamp(0.0, 1.0);
        let free = (t - letting_go).max(0.0);
        let let_go = letting_go * letting_go * (s * s * s / 3.0 - s * s * s * s / 12.0);
        Some(height - self.net * (let_go + 2.0 / 3.0 * letting_go * free + 0.5 * free * free))
    }
}

impl Fall {
    /// Time from the magnet's last force to contact (s) and net acceleration (m/s²).
    ///
    /// With T the time of letting go, t the rest and A the acceleration: H = A(T²/4 + ⅔Tt + ½t²), v = A(⅔T + t).
    fn solve(&self) -> Result<(f64, f64), SensorError> {
        let Fall { height, speed, gravity, letting_go } = *self;
        for (what, value) in [("the height", height), ("the speed", speed), ("gravity", gravity)] {
            if value.is_nan() || value <= 0.0 {
                return Err(SensorError::Value { what, value, must_be: "positive" });
            }
        }
        if letting_go.is_nan() || letting_go <= 0.0 {
            return Err(SensorError::Value { what: "the time of letting go", value: letting_go, must_be: "positive" });
        }
        let half = 1.0 / 3.0 * speed * letting_go - 0.5 * height;
        let constant = 0.25 * speed * letting_go * letting_go - 2.0 / 3.0 * height * letting_go;
        let free = (-half + (half * half - 0.5 * speed * constant).sqrt()) / (0.5 * speed);
        let needed = speed / (2.0 / 3.0 * letting_go + free);
        if free > 0.0 && needed <= gravity {
            return Ok((free, needed));
        }
        // Without a solution not even the whole height at once would do.
        let needed = if free > 0.0 { needed } else { 0.5 * speed * speed / height };
        Err(SensorError::TooFast { height, speed, needed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::coupling::restored;
    use crate::signal::integrate;

    const FALL: Fall = Fall { height: 1.0, speed: 4.16, gravity: 9.81, letting_go: 0.032 };

    /// A spring under gravity: a = −g + ω²(…), for 100 ms; places from the integrals.
    fn impact() -> [Series; 2] {
        let time: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 1e-4).collect();
        let acceleration =
            Series::new(time.as_slice(), time.iter().map(|t| -9.81 + 170.0 * (25.0 * t).sin()).collect::<Vec<_>>());
        let displacement = integrate::twice(&acceleration, -FALL.speed, 0.0);
        [acceleration, displacement]
    }

    fn ideal() -> Sensors {
        let accelerometer = Accelerometer { noise: 0.0, offset: 0.0, bits: 32, ..Accelerometer::default() };
        let laser = Laser { range: [-10.0, 10.0], noise: 0.0, bits: 32 };
        Sensors { accelerometer, laser: Some(laser), ..Sensors::default() }
    }

    #[test]
    fn without_noise_the_truth_can_be_had_back() {
        let [acceleration, displacement] = impact();
        let drop = virtual_drop(&acceleration, &displacement, &FALL, &ideal(), 8).unwrap();
        let reading = drop.recording.series("accelerometer_m_s2").unwrap();
        let back = restored(&reading, 0.15);
        let place = integrate::twice(&back, 0.0, FALL.height);
        let velocity = integrate::once(&back, 0.0).at(drop.contact_time).unwrap();
        assert!((velocity + FALL.speed).abs() < 1e-3, "{velocity}");
        let laser = drop.recording.channel("laser_m").unwrap();
        let gap = place.values().iter().zip(laser).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gap < 2e-4, "{gap}");
        assert!(place.at(drop.contact_time).unwrap().abs() < 1e-4);
    }

    #[test]
    fn the_same_seed_gives_the_same_bits_and_another_does_not() {
        let [acceleration, displacement] = impact();
        let record =
            |sensors: &Sensors, seed| virtual_drop(&acceleration, &displacement, &FALL, sensors, seed).unwrap();
        let sensors = Sensors::default();
        let with_laser = record(&sensors, 8);
        let failed = record(&Sensors { laser: None, ..sensors }, 8);
        assert_eq!(with_laser.recording.channels[0], failed.recording.channels[0]);
        assert_eq!(failed.recording.channels.len(), 1);
        assert_ne!(record(&sensors, 9).contact_time, with_laser.contact_time);
        assert_eq!(record(&sensors, 8).contact_time, with_laser.contact_time);
    }

    #[test]
    fn readings_have_steps_limits_and_noise() {
        let [acceleration, displacement] = impact();
        let drop = virtual_drop(&acceleration, &displacement, &FALL, &Sensors::default(), 8).unwrap();
        let step = 100.0 * STANDARD_GRAVITY / 4096.0;
        let reading = drop.recording.series("accelerometer_m_s2").unwrap();
        assert!(reading.values().iter().all(|r| ((r / step).round() * step - r).abs() < 1e-4));
        let rest = reading.window([0.0, 0.1]);
        let mean = rest.values().iter().sum::<f64>() / rest.len() as f64;
        let scatter = rest.values().iter().map(|r| (r - mean).powi(2)).sum::<f64>() / rest.len() as f64;
        let expected = 0.15_f64.powi(2) + step * step / 12.0;
        assert!((mean - 0.2).abs() < 4.0 * (expected / rest.len() as f64).sqrt(), "{mean}");
        assert!((scatter / expected - 1.0).abs() < 0.2, "{scatter} for {expected}");
        let laser = drop.recording.series("laser_m").unwrap();
        let seen: Vec<f64> = laser.values().iter().copied().filter(|place| place.is_finite()).collect();
        assert!(seen.len() > 100 && seen.iter().all(|place| (-0.035..=0.015).contains(place)));
    }

    #[test]
    fn falls_that_cannot_be_are_refused() {
        let [acceleration, displacement] = impact();
        let record = |fall: Fall| virtual_drop(&acceleration, &displacement, &fall, &Sensors::default(), 8).map(|_| ());
        assert!(matches!(record(Fall { speed: 4.6, ..FALL }), Err(SensorError::TooFast { .. })));
        assert!(matches!(record(Fall { height: 0.0, ..FALL }), Err(SensorError::Value { what: "the height", .. })));
        assert!(matches!(record(Fall { height: 0.01, ..FALL }), Err(SensorError::TooFast { .. })));
        let early = acceleration.window([0.01, 0.1]);
        let missing = virtual_drop(&early, &displacement, &FALL, &Sensors::default(), 8).map(|_| ());
        assert_eq!(missing, Err(SensorError::NoImpact { channel: "acceleration", time: 0.0 }));
    }
}
