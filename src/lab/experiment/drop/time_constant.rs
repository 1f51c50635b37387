//! The time constant of the accelerometer's coupling, and how well it is known (theory.md, section 12).

use super::error::DropError;
use crate::experiment::contact::{Contact, ContactError, ZeroOffset};
use crate::experiment::coupling::{self, CouplingError, FallFit};
use crate::signal::{Series, integrate};

/// Share to which a stated height of fall is taken as known: one standard deviation. Assumed.
const HEIGHT_KNOWN: f64 = 0.005;
/// Standard deviations by which laser and height, or laser and fall, may differ.
const AGREE: f64 = 3.0;
/// Share by which the impact speeds of laser and fall may differ in any case, and the heights.
const SPEEDS_AGREE: f64 = 0.005;
const HEIGHTS_AGREE: f64 = 0.01;
/// Share by which the time constants of fall and laser differ where the guide's friction changes.
const CONSTANTS_DIFFER: f64 = 0.01;
/// Standard deviations of an interval of 95 %.
pub(super) const INTERVAL: f64 = 2.0;
/// Smallest inverse of a time constant, 1/s: no fall distinguishes one of 1000 s from an endless one.
pub(super) const LEAST_INVERSE: f64 = 1e-3;
/// An inverse time constant (1/s) to start with where the fall gives none.
const START: f64 = 1.0;
/// Most steps of the search, and the share by which the last one changes the inverse.
const MOST_STEPS: u32 = 30;
const CONVERGED: f64 = 1e-7;
/// Steps of the differences from which derivatives follow: of the inverse time constant (1/s), of the zero (m/s²).
const DIFFERENCE: [f64; 2] = [1e-2, 1e-2];

/// A time constant with the zero of the sensor that belongs to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coupling {
    /// Inverse of the time constant, 1/s.
    pub inverse: f64,
    /// Zero beyond the mean of the rest, m/s².
    pub offset: f64,
}

impl Coupling {
    /// s.
    pub(super) fn time_constant(self) -> f64 {
        1.0 / self.inverse
    }
}

/// The time constant of a recording.
pub(super) struct Choice {
    pub best: Coupling,
    /// Ends of its interval of 95 %; none where it was given.
    pub ends: Option<[Coupling; 2]>,
    /// Where laser, height and fall disagree.
    pub disagreement: Vec<Disagreement>,
}

/// Two sources that do not agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Disagreement {
    /// The fall to the laser's speed covers another height, m.
    Height { covered: f64 },
    /// The fall over the height reaches another speed than the laser's, m/s.
    LaserSpeed { reached: f64, laser: f64 },
    /// With constant friction the fall has another time constant, s.
    Friction { constant: f64 },
}

/// Knowledge of a fall beside the laser.
pub(super) struct Known<'a> {
    /// The reading from the end of the rest on, without the sensor's zero, m/s².
    pub reading: &'a Series,
    /// Zero of the sensor.
    pub zero: ZeroOffset,
    /// Height of the fall, m, where it is known.
    pub height: Option<f64>,
    /// The time constant with which the fall has a constant acceleration.
    pub fall: Result<FallFit, CouplingError>,
}

/// The reading (m/s²) with the coupling undone.
pub(super) fn restored(reading: &Series, coupling: Coupling) -> Series {
    let zeroed = reading.with_values(reading.values().iter().map(|r| r - coupling.offset).collect());
    coupling::restored(&zeroed, coupling.time_constant())
}

/// The time constant with which the acceleration, integrated from rest, reaches the laser's speed and covers the height
/// (equations 50 and 51). `contact` finds contact in a restored acceleration.
pub(super) fn by_laser(
    known: &Known<'_>,
    contact: impl Fn(&Series) -> Result<Contact, ContactError>,
) -> Result<Choice, DropError> {
    let both = known.search(&contact, known.height)?;
    let agree = both.excess <= AGREE * AGREE;
    let alone = if agree { both } else { known.search(&contact, None)? };
    let mut disagreement = Vec::new();
    if let Some(height) = known.height.filter(|_| !agree) {
        if let Some((fall, at)) = known.fall.as_ref().ok().zip(known.of_fall(&contact)) {
            let is_covered = (at.covered / height - 1.0).abs() < HEIGHTS_AGREE;
            if is_covered && !at.reaches_laser() {
                let (reached, laser) = (at.speed, at.laser);
                disagreement.push(Disagreement::LaserSpeed { reached, laser });
                return Ok(Choice { disagreement, ..of_fit(fall) });
            }
        }
        disagreement.push(Disagreement::Height { covered: known.state(alone.best, alone.time)?[1] });
    }
    if let Ok(fall) = &known.fall {
        let (inverse, own) = (alone.best.inverse, 1.0 / fall.time_constant);
        let differs = (own - inverse).abs() > AGREE * fall.error.hypot(alone.error);
        let much = (inverse / own - 1.0).abs() > CONSTANTS_DIFFER;
        disagreement.extend((differs && much).then_some(Disagreement::Friction { constant: fall.time_constant }));
    }
    let end = |sign: f64| {
        let inverse = (alone.best.inverse + sign * INTERVAL * alone.error).max(LEAST_INVERSE);
        Coupling { inverse, offset: alone.best.offset + alone.zero_per_inverse * (inverse - alone.best.inverse) }
    };
    Ok(Choice { best: alone.best, ends: Some([end(-1.0), end(1.0)]), disagreement })
}

/// The time constant of the fall alone: friction may be constant, or all of it proportional to the speed, in which case
/// the fall has the inverse time constant `of_speed` (1/s).
pub(super) fn by_fall(fall: &FallFit, of_speed: Option<f64>) -> Choice {
    let choice = of_fit(fall);
    let Some(of_speed) = of_speed else { return choice };
    let widened = |[low, high]: [Coupling; 2]| {
        let end = |inverse: f64| Coupling { inverse: inverse.max(LEAST_INVERSE), offset: 0.0 };
        let error = INTERVAL * fall.error;
        [end(low.inverse.min(of_speed - error)), end(high.inverse.max(of_speed + error))]
    };
    Choice { ends: choice.ends.map(widened), ..choice }
}

/// A time constant that was given (s).
pub(super) fn given(time_constant: f64) -> Choice {
    Choice { best: Coupling { inverse: 1.0 / time_constant, offset: 0.0 }, ends: None, disagreement: Vec::new() }
}

fn of_fit(fall: &FallFit) -> Choice {
    let inverse = 1.0 / fall.time_constant;
    let end =
        |sign: f64| Coupling { inverse: (inverse + sign * INTERVAL * fall.error).max(LEAST_INVERSE), offset: 0.0 };
    Choice { best: Coupling { inverse, offset: 0.0 }, ends: Some([end(-1.0), end(1.0)]), disagreement: Vec::new() }
}

/// The least sum of squares.
#[derive(Clone, Copy)]
struct Estimate {
    best: Coupling,
    /// Standard error of the inverse time constant, 1/s.
    error: f64,
    /// Change of the zero that goes with one of the inverse time constant, m/s.
    zero_per_inverse: f64,
    /// The sum of squares that is left.
    excess: f64,
    /// Contact, s.
    time: f64,
}

/// The fall with its own time constant, beside the laser.
struct OfFall {
    /// Speed of the integrated acceleration at contact, and of the laser, m/s, positive.
    speed: f64,
    laser: f64,
    /// Standard deviation of their difference, m/s.
    deviation: f64,
    /// Height by integration, m.
    covered: f64,
}

impl OfFall {
    fn reaches_laser(&self) -> bool {
        (self.speed - self.laser).abs() < (AGREE * self.deviation).max(SPEEDS_AGREE * self.laser)
    }
}

impl Known<'_> {
    /// Speed (m/s, downward) and covered height (m) at `time` (s), by integration from rest.
    fn state(&self, coupling: Coupling, time: f64) -> Result<[f64; 2], ContactError> {
        let missing = ContactError::NoCrossing { near: time };
        let after = self.reading.time().partition_point(|t| *t <= time).min(self.reading.len().saturating_sub(1));
        let end = self.reading.time().get(after).ok_or(missing)?;
        let velocity = integrate::once(&restored(&self.reading.window([f64::NEG_INFINITY, *end]), coupling), 0.0);
        let place = integrate::once(&velocity, 0.0);
        Ok([-velocity.value_at(time).ok_or(missing)?, -place.value_at(time).ok_or(missing)?])
    }

    /// Change of that state with the inverse time constant and with the zero.
    fn change(&self, coupling: Coupling, time: f64) -> Result<[[f64; 2]; 2], ContactError> {
        let here = self.state(coupling, time)?;
        let [inverse, zero] = DIFFERENCE;
        let by_inverse = self.state(Coupling { inverse: coupling.inverse + inverse, ..coupling }, time)?;
        let by_zero = self.state(Coupling { offset: coupling.offset + zero, ..coupling }, time)?;
        Ok([0, 1].map(|of| [(by_inverse[of] - here[of]) / inverse, (by_zero[of] - here[of]) / zero]))
    }

    /// Standard deviations of speed (m/s) and height (m) by the noise of the reading.
    fn noise(&self, coupling: Coupling, time: f64) -> [f64; 2] {
        let first = self.reading.time().first().copied().unwrap_or(time);
        let (t, x) = (time - first, coupling.inverse);
        let step = t / self.reading.window([first, time]).len().max(1) as f64;
        // Variance of equation 50 for white noise of r: the speed weighs a reading at the time s by 1 + x (t − s), the
        // height by the integral of that.
        let speed = t + x * t * t + x * x * t.powi(3) / 3.0;
        let height = t.powi(3) / 3.0 + x * t.powi(4) / 4.0 + x * x * t.powi(5) / 20.0;
        [speed, height].map(|square| self.zero.deviation * (step * square).sqrt())
    }

    /// Minimises equation 51.
    fn search(
        &self,
        contact: &impl Fn(&Series) -> Result<Contact, ContactError>,
        height: Option<f64>,
    ) -> Result<Estimate, DropError> {
        let inverse = self.fall.as_ref().map_or(START, |fall| 1.0 / fall.time_constant);
        let mut now = Coupling { inverse, offset: 0.0 };
        for _ in 0..MOST_STEPS {
            let at = contact(&restored(self.reading, now))?;
            let step = self.step(now, &at, height)?;
            let moved = (step.best.inverse - now.inverse).abs();
            if moved <= CONVERGED * now.inverse {
                return Ok(step);
            }
            if step.best.inverse < LEAST_INVERSE {
                let [from, to] = [self.reading.time()[0], at.time];
                return Err(CouplingError::NoRecovery { from, to }.into());
            }
            now = step.best;
        }
        Err(ContactError::NotSettled.into())
    }

    /// One step of Gauss and Newton towards the speed and height at contact.
    fn step(&self, now: Coupling, at: &Contact, height: Option<f64>) -> Result<Estimate, ContactError> {
        let [speed, covered] = self.state(now, at.time)?;
        let [by_speed, by_height] = self.change(now, at.time)?;
        let noise = self.noise(now, at.time);
        let deviation = noise[0].hypot(at.speed_error.unwrap_or(0.0));
        let mut rows = vec![
            (by_speed.map(|by| by / deviation), (-at.velocity - speed) / deviation),
            ([0.0, 1.0 / self.zero.error()], -now.offset / self.zero.error()),
        ];
        if let Some(height) = height {
            let deviation = noise[1].hypot(HEIGHT_KNOWN * height);
            rows.push((by_height.map(|by| by / deviation), (height - covered) / deviation));
        }
        let (mut normal, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
        for (by, residual) in &rows {
            for i in 0..2 {
                right[i] += by[i] * residual;
                for j in 0..2 {
                    normal[i][j] += by[i] * by[j];
                }
            }
        }
        // Two unknowns: the normal equations are solved by hand, and their inverse is the covariance.
        let [[a, b], [_, c]] = normal;
        let determinant = a * c - b * b;
        let [inverse, zero] =
            [(c * right[0] - b * right[1]) / determinant, (a * right[1] - b * right[0]) / determinant];
        let left = |(by, residual): &([f64; 2], f64)| (residual - by[0] * inverse - by[1] * zero).powi(2);
        Ok(Estimate {
            best: Coupling { inverse: now.inverse + inverse, offset: now.offset + zero },
            error: (c / determinant).sqrt(),
            zero_per_inverse: -b / c,
            excess: rows.iter().map(left).sum(),
            time: at.time,
        })
    }

    /// The fall with its own time constant.
    fn of_fall(&self, contact: &impl Fn(&Series) -> Result<Contact, ContactError>) -> Option<OfFall> {
        let fall = self.fall.as_ref().ok()?;
        let own = Coupling { inverse: 1.0 / fall.time_constant, offset: 0.0 };
        let at = contact(&restored(self.reading, own)).ok()?;
        let [speed, covered] = self.state(own, at.time).ok()?;
        let [[by_inverse, by_zero], _] = self.change(own, at.time).ok()?;
        let noise = self.noise(own, at.time)[0].hypot(at.speed_error.unwrap_or(0.0));
        let deviation = noise.hypot((by_inverse * fall.error).hypot(by_zero * self.zero.error()));
        Some(OfFall { speed, laser: -at.velocity, deviation, covered })
    }
}
