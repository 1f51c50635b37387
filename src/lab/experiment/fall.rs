//! The fall before a simulated impact, in closed form.

use crate::error::{Error, refusal};
use crate::signal::Series;
use base::number::significant;

/// The fall before a simulated impact: rest, the release by the magnet, then gravity less the guide's friction
/// (methods.md, equations 48 and 49).
///
/// The friction is what covers the height and reaches the speed.
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
    /// Share of the guide's friction at contact that is proportional to the speed, 0 to 1; the rest is constant.
    pub speed_share: f64,
}

/// The true motion of fall and simulated impact; times count from the release.
pub(super) struct Motion<'a> {
    fall: &'a Fall,
    /// Time from the magnet's last force to contact, s.
    free: f64,
    /// Acceleration of the fall without the friction that is proportional to the speed, m/s², positive.
    net: f64,
    /// Friction proportional to the speed, over mass and speed, 1/s.
    per_speed: f64,
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
    ) -> Result<Motion<'a>, Error> {
        let Solved { free, net, per_speed } = fall.solve()?;
        let ends = [acceleration, displacement].map(|series| series.time().last().copied().unwrap_or(f64::NAN));
        let last = ends[0].min(ends[1]);
        for (series, channel) in [(acceleration, "acceleration"), (displacement, "displacement")] {
            if series.value_at(0.0).is_none() || last.is_nan() || last <= 0.0 {
                return Err(no_impact(channel, 0.0));
            }
        }
        Ok(Motion { fall, free, net, per_speed, acceleration, displacement, last })
    }

    /// From the release to contact, s.
    pub(super) fn fall_time(&self) -> f64 {
        self.fall.release_duration + self.free
    }

    /// Coordinate acceleration, m/s².
    pub(super) fn acceleration(&self, t: f64) -> Option<f64> {
        let since_contact = t - self.fall_time();
        if since_contact >= 0.0 {
            return self.acceleration.value_at(since_contact.min(self.last));
        }
        let s = (t / self.fall.release_duration).clamp(0.0, 1.0);
        let [_, speed] = self.fall.fallen(t.max(0.0), self.net, self.per_speed);
        Some(-(self.net * (2.0 * s - s * s) - self.per_speed * speed))
    }

    /// Height of the impactor's lowest point over the film's upper face, m.
    pub(super) fn place(&self, t: f64) -> Option<f64> {
        let since_contact = t - self.fall_time();
        if since_contact >= 0.0 {
            return self.displacement.value_at(since_contact.min(self.last));
        }
        let [fallen, _] = self.fall.fallen(t.max(0.0), self.net, self.per_speed);
        Some(self.fall.height - fallen)
    }
}

/// The refusal of a simulated channel that has no value at a time (s) after contact.
pub(super) fn no_impact(channel: &str, time: f64) -> Error {
    refusal!("the simulated impact has no {channel} at {} s after contact", significant(time, 9))
}

/// The unknowns of a fall.
struct Solved {
    /// Time from the magnet's last force to contact, s.
    free: f64,
    /// Acceleration of the fall without the friction that is proportional to the speed, m/s², positive.
    net: f64,
    /// Friction proportional to the speed, over mass and speed, 1/s.
    per_speed: f64,
}

impl Fall {
    fn solve(&self) -> Result<Solved, Error> {
        let (free, net) = self.with_constant_friction()?;
        let share = self.speed_share;
        if !(0.0..=1.0).contains(&share) {
            return Err(refusal!(
                "the share of the friction that is proportional to the speed is {share}, but must be 0 to 1"
            ));
        }
        let constant = Solved { free, net, per_speed: 0.0 };
        // Friction at contact, over the mass, between none and gravity: more of it covers more height before the speed.
        let [mut low, mut high] = [0.0, self.gravity];
        if share == 0.0 || self.of_friction(low).is_none_or(|least| self.end(&least) > self.height) {
            return Ok(constant);
        }
        while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
            let middle = 0.5 * (low + high);
            let is_enough = self.of_friction(middle).is_none_or(|fall| self.end(&fall) > self.height);
            if is_enough { high = middle } else { low = middle }
        }
        Ok(self.of_friction(low).unwrap_or(constant))
    }

    /// The fall that reaches the speed with `friction` over mass (m/s²) at contact; none where it does not.
    fn of_friction(&self, friction: f64) -> Option<Solved> {
        let per_speed = self.speed_share * friction / self.speed;
        let net = self.gravity - (1.0 - self.speed_share) * friction;
        let [_, released] = self.fallen(self.release_duration, net, per_speed);
        let (missing, at_contact) = (self.speed - released, self.gravity - friction);
        let free = missing / at_contact * log_share(per_speed * missing / at_contact);
        (missing > 0.0 && at_contact > 0.0).then_some(Solved { free, net, per_speed })
    }

    /// Height that `solved` covers, m.
    fn end(&self, solved: &Solved) -> f64 {
        self.fallen(self.release_duration + solved.free, solved.net, solved.per_speed)[0]
    }

    /// Height fallen (m) and speed (m/s) at `t` (s) from the release on, with the acceleration `net` (m/s²) of gravity
    /// less the constant friction and the friction `per_speed` (1/s): equation 49, which is 48 without the latter.
    fn fallen(&self, t: f64, net: f64, per_speed: f64) -> [f64; 2] {
        let full = self.release_duration;
        let (released, free) = (t.min(full), (t - full).max(0.0));
        let phi = |n: i32, t: f64| t.powi(n) * exponential_share(n, -per_speed * t);
        let rate = [2.0 / full, -2.0 / (full * full)].map(|factor| net * factor);
        let speed = rate[0] * phi(2, released) + rate[1] * phi(3, released);
        let fallen = rate[0] * phi(3, released) + rate[1] * phi(4, released);
        [fallen + speed * phi(1, free) + net * phi(2, free), speed * phi(0, free) + net * phi(1, free)]
    }

    /// Time from the magnet's last force to contact (s) and net acceleration (m/s²) where the friction is constant.
    ///
    /// With T the duration of the release, t the rest and A the acceleration: H = A(T²/4 + ⅔Tt + ½t²), v = A(⅔T + t).
    fn with_constant_friction(&self) -> Result<(f64, f64), Error> {
        let Fall { height, speed, gravity, release_duration, .. } = *self;
        let given = [
            ("the height", height),
            ("the speed", speed),
            ("gravity", gravity),
            ("the duration of the release", release_duration),
        ];
        for (what, value) in given {
            if value.is_nan() || value <= 0.0 || value.is_infinite() {
                return Err(refusal!("{what} is {value}, but must be positive"));
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
        let [height, speed] = [height, speed].map(|value| significant(value, 6));
        Err(refusal!(
            "a fall over {height} m does not reach {speed} m/s: {needed:.2} m/s² would be needed, more than gravity"
        ))
    }
}

/// φ_n(x) = Σ_i xⁱ/(i + n)!: φ_0 is the exponential, and tⁿ φ_n(−kt) its n-fold integral.
fn exponential_share(n: i32, x: f64) -> f64 {
    let first = (1..=n).fold(1.0, |product, i| product / f64::from(i));
    let (mut term, mut sum, mut i) = (first, first, f64::from(n));
    while term.abs() > f64::EPSILON * 1e-3 * sum.abs() {
        i += 1.0;
        term *= x / i;
        sum += term;
    }
    sum
}

/// ln(1 + x)/x.
fn log_share(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.ln_1p() / x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::integrate;

    const FALL: Fall = Fall { height: 1.0, speed: 4.16, gravity: 9.81, release_duration: 0.032, speed_share: 0.0 };

    fn impact() -> Series {
        Series::new(vec![0.0, 0.1], vec![0.0, -0.1])
    }

    /// Equations 48 and 49 against the integral of the acceleration that they belong to.
    #[test]
    fn the_fall_covers_its_height_and_reaches_its_speed() {
        for speed_share in [0.0, 0.1, 0.5, 1.0] {
            covers_and_reaches(&Fall { speed_share, ..FALL });
        }
    }

    fn covers_and_reaches(fall: &Fall) {
        let impact = impact();
        let motion = Motion::new(fall, &impact, &impact).unwrap();
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
        let friction = |t: f64| FALL.gravity + motion.acceleration(t).unwrap();
        let [released, contact] = [FALL.release_duration, motion.fall_time() - 1e-9].map(friction);
        let speed = motion.fall.fallen(FALL.release_duration, motion.net, motion.per_speed)[1];
        let expected = contact * (1.0 - fall.speed_share * (1.0 - speed / FALL.speed));
        assert!((released - expected).abs() < 1e-6, "{released} for {expected}");
    }

    #[test]
    fn shares_of_exponential_and_logarithm_are_theirs() {
        for x in [-3.0_f64, -1e-9, 0.5] {
            assert!((exponential_share(0, x) / x.exp() - 1.0).abs() < 1e-14);
            assert!((exponential_share(1, x) / (x.exp_m1() / x) - 1.0).abs() < 1e-14);
        }
        assert_eq!([0, 1, 2, 3].map(|n| exponential_share(n, 0.0)), [1.0, 1.0, 0.5, 1.0 / 6.0]);
    }
}
