//! Virtual sensors: what an accelerometer and a laser would have read in a simulated drop.
//!
//! The recordings that come out are virtual. The paper prints no recording, and of its sensors neither time constant
//! nor noise: the values of [`Accelerometer`] and [`Laser`] are assumed.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

use super::coupling::high_pass;
use super::fall::{Fall, Motion, no_impact};
use crate::error::{Error, refusal};
use crate::signal::{Channel, Recording, Series};
use base::number::{clean_time, significant};
use base::units::STANDARD_GRAVITY;

/// Channel of the accelerometer.
pub const ACCELEROMETER: &str = "accelerometer_m_s2";
/// Channel of the laser.
pub const LASER: &str = "laser_m";

/// Piezoelectric accelerometer, AC-coupled, digitised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerometer {
    /// Of the first-order high pass, s. Assumed: the paper's reading is back at zero before contact, and after 0.15 s
    /// only 4 % (1 m) or 2 % (1.5 m) of a step are left of it then; with a shorter one more of the impact would be
    /// lost.
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

/// Laser triangulation of the impactor's lowest point over the film's upper face; `NaN` outside its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laser {
    /// Lowest and highest place that it measures, m. The paper's sensor has a range of 50 mm; its place is assumed.
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
    /// On the impactor.
    pub accelerometer: Accelerometer,
    /// None where it failed.
    pub laser: Option<Laser>,
    /// 1/s.
    pub sample_rate: f64,
    /// Shortest and longest rest on the recording, s; the seed chooses between them, so that the time of release is
    /// unknown.
    pub rest: [f64; 2],
}

impl Default for Sensors {
    fn default() -> Sensors {
        let (accelerometer, laser) = (Accelerometer::default(), Some(Laser::default()));
        Sensors { accelerometer, laser, sample_rate: 10e3, rest: [0.1, 0.2] }
    }
}

/// A virtual recording and its true contact time.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualDrop {
    /// `time_s`, `accelerometer_m_s2` and, with a laser, `laser_m` (`NaN` out of range).
    pub recording: Recording,
    /// First contact on the recording's clock, s.
    pub contact_time: f64,
}

/// Steps of the true motion per sample of the recording.
const OVERSAMPLING: usize = 10;
/// Most samples of a recording; more are a mistake.
pub const MOST_SAMPLES: usize = 1_000_000;

/// Readings of the `sensors` in a drop whose impact was simulated: `acceleration` (m/s², coordinate acceleration, upward)
/// and `displacement` (m) from contact on. The same `seed` gives the same recording, bit for bit.
pub fn virtual_drop(
    acceleration: &Series,
    displacement: &Series,
    fall: &Fall,
    sensors: &Sensors,
    seed: u64,
) -> Result<VirtualDrop, Error> {
    sensors.check()?;
    let motion = Motion::new(fall, acceleration, displacement)?;
    let release = release_time(sensors.rest, seed);
    let contact_time = release + motion.fall_time();
    let step = 1.0 / sensors.sample_rate;
    let count = samples(contact_time + motion.last, sensors.sample_rate)?;
    let time: Vec<f64> = (0..=count).map(|i| clean_time(i as f64 * step)).collect();

    let fine = (0..=count * OVERSAMPLING).map(|j| j as f64 * step / OVERSAMPLING as f64);
    let fine: Vec<f64> = fine.collect();
    let proper = fine.iter().map(|t| Some(motion.acceleration(t - release)? + fall.gravity));
    let proper = proper.collect::<Option<Vec<f64>>>();
    let proper = proper.ok_or_else(|| no_impact("acceleration", motion.last))?;
    let coupled = high_pass(&Series::new(fine, proper), sensors.accelerometer.time_constant);
    let sampled = coupled.values().iter().step_by(OVERSAMPLING).copied();
    let mut channels =
        vec![Channel { name: ACCELEROMETER.into(), values: sensors.accelerometer.read(sampled, &mut noise(seed, 1)) }];
    if let Some(laser) = &sensors.laser {
        let places = time.iter().map(|t| motion.place(t - release)).collect::<Option<Vec<f64>>>();
        let places = places.ok_or_else(|| no_impact("displacement", motion.last))?;
        channels.push(Channel { name: LASER.into(), values: laser.read(&places, &mut noise(seed, 2)) });
    }
    Ok(VirtualDrop { recording: Recording { time, channels }, contact_time })
}

/// Steps that a recording of `length` (s) takes.
fn samples(length: f64, rate: f64) -> Result<usize, Error> {
    let count = (length / (1.0 / rate)).floor();
    if count < MOST_SAMPLES as f64 {
        return Ok(count as usize);
    }
    let [length, rate] = [length, rate].map(|value| significant(value, 6));
    Err(refusal!("{length} s at {rate} samples a second are more than {MOST_SAMPLES} samples"))
}

/// One source of noise, independent of whether the others are used.
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
    fn check(&self) -> Result<(), Error> {
        let Sensors { accelerometer, laser, sample_rate, rest } = self;
        let Accelerometer { time_constant, noise, offset, range, bits } = accelerometer;
        let positive =
            [("the time constant", *time_constant), ("the range", *range), ("the sample rate", *sample_rate)];
        let is_range = rest[0] >= 0.0 && rest[1] >= rest[0] && rest[1].is_finite();
        let mut ranges = vec![(is_range, "the rest", rest[1], "a range of times")];
        ranges.extend(positive.map(|(what, value)| (value > 0.0 && value.is_finite(), what, value, "positive")));
        ranges.push((*noise >= 0.0 && noise.is_finite(), "the noise", *noise, "zero or more"));
        ranges.push((offset.is_finite(), "the offset", *offset, "finite"));
        ranges.push(((1..=32).contains(bits), "the number of bits", f64::from(*bits), "1 to 32"));
        if let Some(Laser { range, noise, bits }) = laser {
            ranges.push((range[1] > range[0], "the laser's upper limit", range[1], "above its lower one"));
            ranges.push((*noise >= 0.0 && noise.is_finite(), "the laser's noise", *noise, "zero or more"));
            ranges.push(((1..=32).contains(bits), "the laser's number of bits", f64::from(*bits), "1 to 32"));
        }
        let wrong = ranges.into_iter().find(|(holds, ..)| !holds);
        let refused =
            |(_, what, value, must_be): (bool, &str, f64, &str)| refusal!("{what} is {value}, but must be {must_be}");
        wrong.map_or(Ok(()), |wrong| Err(refused(wrong)))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::coupling::restored;
    use crate::signal::integrate;

    const FALL: Fall = Fall { height: 1.0, speed: 4.16, gravity: 9.81, release_duration: 0.032, speed_share: 0.0 };

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
    fn without_noise_the_motion_is_recovered() {
        let [acceleration, displacement] = impact();
        let drop = virtual_drop(&acceleration, &displacement, &FALL, &ideal(), 8).unwrap();
        let reading = drop.recording.series(ACCELEROMETER).unwrap();
        let back = restored(&reading, 1.0 / 0.15);
        let place = integrate::twice(&back, 0.0, FALL.height);
        let velocity = integrate::once(&back, 0.0).value_at(drop.contact_time).unwrap();
        assert!((velocity + FALL.speed).abs() < 1e-3, "{velocity}");
        let laser = drop.recording.channel(LASER).unwrap();
        let gap = place.values().iter().zip(laser).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gap < 2e-4, "{gap}");
        assert!(place.value_at(drop.contact_time).unwrap().abs() < 1e-4);
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
        let reading = drop.recording.series(ACCELEROMETER).unwrap();
        assert!(reading.values().iter().all(|r| ((r / step).round() * step - r).abs() < 1e-4));
        let rest = reading.window([0.0, 0.1]);
        let mean = rest.values().iter().sum::<f64>() / rest.len() as f64;
        let scatter = rest.values().iter().map(|r| (r - mean).powi(2)).sum::<f64>() / rest.len() as f64;
        let expected = 0.15_f64.powi(2) + step * step / 12.0;
        assert!((mean - 0.2).abs() < 4.0 * (expected / rest.len() as f64).sqrt(), "{mean}");
        assert!((scatter / expected - 1.0).abs() < 0.2, "{scatter} for {expected}");
        let laser = drop.recording.series(LASER).unwrap();
        let seen: Vec<f64> = laser.values().iter().copied().filter(|place| place.is_finite()).collect();
        assert!(seen.len() > 100 && seen.iter().all(|place| (-0.035..=0.015).contains(place)));
    }
}
