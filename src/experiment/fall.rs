//! The fall before a simulated impact, in closed form.

use thiserror::Error;

use crate::number::significant;
use crate::signal::Series;

/// The fall before a simulated impact: rest, the release by the magnet, then a constant net acceleration.
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
    /// Time over which the magnet's force falls to zero as a parabola with its vertex at the end, s. In the
    /// paper the reading falls over 32 ms.
    pub release_duration: f64,
}

/// Why there is no such fall.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FallError {
    /// A quantity of the fall is not positive.
    #[error("{what} is {value}, but must be positive")]
    NotPositive {
        /// Quantity of the fall, as the message names it.
        what: &'static str,
        /// Its value in the SI unit.
        value: f64,
    },
    /// The speed is above that of a free fall over the height.
    #[error(
        "a fall over {} m does not reach {} m/s: {needed:.2} m/s² would be needed, more than gravity",
        significant(*height, 6), significant(*speed, 6)
    )]
    TooFast {
        /// Height of the fall, m.
        height: f64,
        /// Speed at first contact, m/s.
        speed: f64,
        /// Net acceleration that reaches the speed over the height, m/s².
        needed: f64,
    },
    /// The simulated signals end too early.
    #[error("the simulated impact has no {channel} at {} s after contact", significant(*time, 9))]
    NoImpact {
        /// The simulated signal, acceleration or displacement.
        channel: &'static str,
        /// Time after first contact at which it has no value, s.
        time: f64,
    },
}

/// The true motion of fall and simulated impact; times count from the release.
pub(super) struct Motion<'a> {
    fall: &'a Fall,
    /// Time from the magnet's last force to contact, s.
    free: f64,
    /// Net acceleration of the fall, m/s², positive.
    net: f64,
    acceleration: &'a Series,
    displacement: &'a Series,
    /// Last simulated time after contact, s.
    pub(super) last: f64,
}

impl Motion<'_> {
    pub(super) fn new<'a>(
        fall: &'a Fall,
        acceleration: &'a Series,
        displacement: &'a Series,
    ) -> Result<Motion<'a>, FallError> {
        let (free, net) = fall.solve()?;
        let ends = [acceleration, displacement].map(|series| series.time().last().copied().unwrap_or(f64::NAN));
        let last = ends[0].min(ends[1]);
        for (series, channel) in [(acceleration, "acceleration"), (displacement, "displacement")] {
            if series.at(0.0).is_none() || last.is_nan() || last <= 0.0 {
                return Err(FallError::NoImpact { channel, time: 0.0 });
            }
        }
        Ok(Motion { fall, free, net, acceleration, displacement, last })
    }

    /// From the release to contact, s.
    pub(super) fn fall_time(&self) -> f64 {
        self.fall.release_duration + self.free
    }

    /// Coordinate acceleration, m/s².
    pub(super) fn acceleration(&self, t: f64) -> Option<f64> {
        let since_contact = t - self.fall_time();
        if since_contact >= 0.0 {
            return self.acceleration.at(since_contact.min(self.last));
        }
        let s = (t / self.fall.release_duration).clamp(0.0, 1.0);
        Some(-self.net * (2.0 * s - s * s))
    }

    /// Height of the impactor's lowest point over the film's upper face, m.
    pub(super) fn place(&self, t: f64) -> Option<f64> {
        let since_contact = t - self.fall_time();
        if since_contact >= 0.0 {
            return self.displacement.at(since_contact.min(self.last));
        }
        let Fall { height, release_duration, .. } = *self.fall;
        let s = (t / release_duration).clamp(0.0, 1.0);
        let free = (t - release_duration).max(0.0);
        let let_go = release_duration * release_duration * (s * s * s / 3.0 - s * s * s * s / 12.0);
        Some(height - self.net * (let_go + 2.0 / 3.0 * release_duration * free + 0.5 * free * free))
    }
}

impl Fall {
    /// Time from the magnet's last force to contact (s) and net acceleration (m/s²).
    ///
    /// With T the duration of the release, t the rest and A the acceleration: H = A(T²/4 + ⅔Tt + ½t²), v = A(⅔T + t).
    fn solve(&self) -> Result<(f64, f64), FallError> {
        let Fall { height, speed, gravity, release_duration } = *self;
        let given = [
            ("the height", height),
            ("the speed", speed),
            ("gravity", gravity),
            ("the duration of the release", release_duration),
        ];
        for (what, value) in given {
            if value.is_nan() || value <= 0.0 || value.is_infinite() {
                return Err(FallError::NotPositive { what, value });
            }
        }
        let half = 1.0 / 3.0 * speed * release_duration - 0.5 * height;
        let constant = 0.25 * speed * release_duration * release_duration - 2.0 / 3.0 * height * release_duration;
        let free = (-half + (half * half - 0.5 * speed * constant).sqrt()) / (0.5 * speed);
        let needed = speed / (2.0 / 3.0 * release_duration + free);
        if free > 0.0 && needed <= gravity {
            return Ok((free, needed));
        }
        // Without a solution not even the whole height at once would do.
        let needed = if free > 0.0 { needed } else { 0.5 * speed * speed / height };
        Err(FallError::TooFast { height, speed, needed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::integrate;

    const FALL: Fall = Fall { height: 1.0, speed: 4.16, gravity: 9.81, release_duration: 0.032 };

    fn impact() -> Series {
        Series::new(vec![0.0, 0.1], vec![0.0, -0.1])
    }

    /// Equation 48 against the integral of the acceleration that it belongs to.
    #[test]
    fn the_fall_covers_its_height_and_reaches_its_speed() {
        let impact = impact();
        let motion = Motion::new(&FALL, &impact, &impact).unwrap();
        let steps = 20_000;
        let time: Vec<f64> = (0..=steps).map(|i| motion.fall_time() * f64::from(i) / f64::from(steps)).collect();
        let before = |t: &f64| motion.acceleration(t.min(motion.fall_time() - 1e-12)).unwrap();
        let acceleration = Series::new(time.as_slice(), time.iter().map(before).collect::<Vec<_>>());
        let end = |series: &Series| series.values().last().copied().unwrap();
        assert!((end(&integrate::once(&acceleration, 0.0)) + FALL.speed).abs() < 1e-6);
        let place = integrate::twice(&acceleration, 0.0, FALL.height);
        assert!(end(&place).abs() < 1e-6);
        let gap = place.samples().map(|[t, z]| (motion.place(t).unwrap() - z).abs()).fold(0.0, f64::max);
        assert!(gap < 1e-6, "{gap}");
    }

    #[test]
    fn impossible_falls_are_refused() {
        let impact = impact();
        let made = |fall: Fall| Motion::new(&fall, &impact, &impact).map(|_| ());
        assert!(matches!(made(Fall { speed: 4.6, ..FALL }), Err(FallError::TooFast { .. })));
        assert!(matches!(made(Fall { height: 0.01, ..FALL }), Err(FallError::TooFast { .. })));
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = made(Fall { height: wrong, ..FALL });
            assert!(matches!(refused, Err(FallError::NotPositive { what: "the height", .. })), "{refused:?}");
        }
        let late = impact.window([0.05, 0.1]);
        let missing = Motion::new(&FALL, &late, &impact).map(|_| ());
        assert_eq!(missing, Err(FallError::NoImpact { channel: "acceleration", time: 0.0 }));
    }
}
