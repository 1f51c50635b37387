//! The model of a whole recording: rest, release, fall and onset of the force, as an accelerometer and a laser read them
//! (methods.md, equations 40 to 46).

use super::Known;
use crate::experiment::coupling;

/// Number of unknowns.
pub(super) const COUNT: usize = 13;

/// The unknowns of a recording, by the names of [`of`].
pub(super) type Unknowns = [f64; COUNT];

/// Places of the unknowns.
pub(super) mod of {
    /// Reading at rest, m/s², and its change with time, m/s³.
    pub const OFFSET: usize = 0;
    pub const DRIFT: usize = 1;
    /// Inverse time constant of the coupling, 1/s: zero is a sensor that holds a constant.
    pub const INVERSE: usize = 2;
    /// Begin of the release and its duration, s.
    pub const RELEASE: usize = 3;
    pub const DURATION: usize = 4;
    /// Friction of the guide at the speed of an ideal fall, over the weight; share of it that is proportional to the
    /// speed; share of it that goes on after contact.
    pub const FRICTION: usize = 5;
    pub const OF_SPEED: usize = 6;
    pub const GOES_ON: usize = 7;
    /// First contact, s. It is an unknown rather than the height: along a height that is known, friction moves it with the
    /// square, too, so that draws from a normal density would scatter it more than the onset allows.
    pub const CONTACT: usize = 8;
    /// Force over the mass at the end of the onset, ln (m/s²); its exponent, and its bend.
    pub const LEVEL: usize = 9;
    pub const EXPONENT: usize = 10;
    pub const BEND: usize = 11;
    /// Zero of the laser, m.
    pub const LASER: usize = 12;
}

/// Standard deviations that are assumed where nothing is given (methods.md, table of section 12).
const DRIFT: f64 = 0.05;
const DURATION: f64 = 0.03;
const OF_SPEED: f64 = 0.1;
const GOES_ON: f64 = 0.2;
const EXPONENT: [f64; 2] = [1.7, 1.0];
const BEND: f64 = 0.5;
const LEVEL: f64 = 3.0;
/// Of the laser's zero, m.
const LASER: f64 = 1e-4;
/// Degrees of freedom of Student's distributions of the friction that is not given, and of its part that goes on.
const FREEDOM: f64 = 1.0;
/// Place of the friction among the rows of what is known beforehand.
const FRICTION_ROW: usize = 2;
/// Residual beyond which a reading counts less than its square (Huber 1964): a knock is no noise.
const OUTLIER: f64 = 5.0;

/// Mean of some samples of the accelerometer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// s.
    pub time: f64,
    /// m/s².
    pub reading: f64,
    /// Standard deviation, m/s².
    pub deviation: f64,
}

/// A recording until the end of the onset, with what is known of its tower.
#[derive(Clone)]
pub(super) struct Model<'a> {
    pub samples: Vec<Sample>,
    /// Time (s) and place over the film (m).
    pub laser: Vec<[f64; 2]>,
    /// Standard deviation of the laser, m.
    pub laser_deviation: f64,
    pub known: &'a Known,
    /// m/s².
    pub gravity: f64,
    /// Speed of the ideal fall, to which friction refers, m/s.
    pub speed: f64,
    /// Travel at the end of the onset, m.
    pub reach: f64,
    /// Expected force at the end of the onset over the mass, m/s².
    pub force: f64,
    /// Time between two samples, s.
    pub step: f64,
    /// Time over which the step of the acceleration at contact is smeared, s: that of a sample in the end.
    pub smear: f64,
}

/// The fall from the release on (equations 48 and 49).
struct Fall {
    /// Acceleration without the friction of the speed, m/s²; that friction over mass and speed, 1/s.
    net: f64,
    per_speed: f64,
    /// Duration of the release, s.
    duration: f64,
}

impl Fall {
    /// Acceleration (downward), speed and height fallen at the time `t` (s) from the release on. Within the release the
    /// friction of the speed is left out of the speed, where it is some 0.1 mm/s.
    fn at(&self, t: f64) -> [f64; 3] {
        let Fall { net, per_speed, duration } = *self;
        let s = (t / duration).clamp(0.0, 1.0);
        let speed = net * duration * (s * s - s.powi(3) / 3.0);
        let fallen = net * duration * duration * (s.powi(3) / 3.0 - s.powi(4) / 12.0);
        if t < duration {
            return [net * (2.0 * s - s * s) - per_speed * speed, speed, fallen];
        }
        let (free, start) = (t - duration, net - per_speed * speed);
        let [once, twice] = integrals(per_speed * free);
        let v = speed + start * free * once;
        [net - per_speed * v, v, fallen + speed * free + start * free * free * twice]
    }
}

/// (1 − e⁻ˣ)/x and (x − 1 + e⁻ˣ)/x², the integrals of a decay.
fn integrals(x: f64) -> [f64; 2] {
    match x.abs() < 1e-2 {
        true => [1.0 - x / 2.0 + x * x / 6.0 - x.powi(3) / 24.0, 0.5 - x / 6.0 + x * x / 24.0 - x.powi(3) / 120.0],
        false => [-(-x).exp_m1() / x, (x + (-x).exp_m1()) / (x * x)],
    }
}

impl Model<'_> {
    fn fall(&self, u: &Unknowns) -> Fall {
        let [friction, share] = [u[of::FRICTION], u[of::OF_SPEED]];
        Fall {
            net: self.gravity * (1.0 - friction * (1.0 - share)),
            per_speed: friction * share * self.gravity / self.speed,
            duration: u[of::DURATION],
        }
    }

    /// Time of first contact on the recording's clock (s) and speed (m/s, downward).
    pub(super) fn contact(&self, u: &Unknowns) -> [f64; 2] {
        let [_, speed, _] = self.fall(u).at(u[of::CONTACT] - u[of::RELEASE]);
        [u[of::CONTACT], speed]
    }

    /// Height of fall, m.
    pub(super) fn height(&self, u: &Unknowns) -> f64 {
        self.fall(u).at(u[of::CONTACT] - u[of::RELEASE])[2]
    }

    /// The largest residual of height, speed and time of contact as they are known, in standard deviations.
    pub(super) fn pull(&self, u: &Unknowns) -> f64 {
        let Known { height, speed, contact_time, .. } = self.known;
        let [contact, reached] = self.contact(u);
        let pairs = [(height, self.height(u)), (speed, reached), (contact_time, contact)];
        let pull = |(known, value): (&Option<[f64; 2]>, f64)| known.map_or(0.0, |[mean, error]| (value - mean) / error);
        pairs.into_iter().map(pull).fold(0.0, |most, pull| most.max(pull.abs()))
    }

    /// Sum of squares without what is assumed of the friction.
    pub(super) fn evidence(&self, u: &Unknowns) -> f64 {
        let beforehand = self.beforehand(u, self.contact(u));
        self.residuals(u).iter().map(|r| r * r).sum::<f64>() - beforehand[FRICTION_ROW].powi(2)
    }

    /// First time at which a mean of the reading over `length` (s), between two times, is off the model by more than `most` (m/s²), by
    /// more than a `share` of itself, and by more than noise makes.
    pub(super) fn leaves(
        &self,
        u: &Unknowns,
        [from, to]: [f64; 2],
        length: f64,
        [most, share]: [f64; 2],
    ) -> Option<f64> {
        /// Standard deviations of a mean that noise does not reach.
        const NOISE: f64 = 6.0;
        let rows = self.residuals(u);
        let inside: Vec<(&Sample, f64)> =
            self.samples.iter().zip(rows).filter(|(own, _)| (from..to).contains(&own.time)).collect();
        let bin = |own: &Sample| ((own.time - from) / length).floor();
        inside.chunk_by(|a, b| bin(a.0) == bin(b.0)).find_map(|bin| {
            let mean = |value: &dyn Fn(&(&Sample, f64)) -> f64| bin.iter().map(value).sum::<f64>() / bin.len() as f64;
            let off = mean(&|(own, row)| own.deviation * straight(*row)).abs();
            let noise = mean(&|(own, _)| own.deviation) / (bin.len() as f64).sqrt();
            let start = bin[0].0.time;
            let is_off = off > most && off > share * mean(&|(own, _)| own.reading).abs() && off > NOISE * noise;
            (is_off && start + length < to).then_some(start)
        })
    }

    /// Root mean square distance of motion and laser, m.
    pub(super) fn laser_residual(&self, u: &Unknowns) -> f64 {
        let rows = self.residuals(u);
        let of_laser = &rows[self.samples.len()..self.samples.len() + self.laser.len()];
        self.laser_deviation * (of_laser.iter().map(|r| r * r).sum::<f64>() / of_laser.len() as f64).sqrt()
    }

    /// Residuals over their standard deviations: samples, laser, then what is known or assumed beforehand. Half of their
    /// sum of squares is the negative logarithm of the posterior density.
    pub(super) fn residuals(&self, u: &Unknowns) -> Vec<f64> {
        let fall = self.fall(u);
        let [contact, speed] = self.contact(u);
        let after = self.gravity * (1.0 - u[of::GOES_ON] * u[of::FRICTION]);
        let level = u[of::LEVEL].exp();
        // Acceleration downward at a travel.
        let pressed = |travel: f64| {
            let share = travel.max(0.0) / self.reach;
            after - level * share.powf(u[of::EXPONENT]) * (-u[of::BEND] * share).exp()
        };
        let mut rows = Vec::with_capacity(self.samples.len() + self.laser.len() + 12);
        let mut state = [contact, 0.0, speed];
        let mut places = vec![[contact, 0.0]];
        let mut before: Option<[f64; 2]> = None;
        let mut coupled = 0.0;
        for Sample { time, reading, deviation } in &self.samples {
            if *time > contact {
                state = runge_kutta(state, *time, pressed);
                places.push([*time, -state[1]]);
            }
            // Friction that ends is a step at contact, which a sample sees as its mean, so that it moves smoothly.
            let after = ((time - contact) / self.smear + 0.5).clamp(0.0, 1.0);
            let down = (1.0 - after) * fall.at((time - u[of::RELEASE]).min(contact - u[of::RELEASE]))[0]
                + after * pressed(state[1]);
            coupled = match before {
                None => -down,
                Some([t, last]) => {
                    let (decay, gain) = coupling::shares(time - t, u[of::INVERSE]);
                    decay * coupled + gain * (-down - last)
                }
            };
            before = Some([*time, -down]);
            let read = coupled + u[of::OFFSET] + u[of::DRIFT] * (time - self.start());
            rows.push(robust((reading - read) / deviation));
        }
        let height = self.height(u);
        let place = |time: f64| match time <= contact {
            true => Some(height - fall.at(time - u[of::RELEASE])[2]),
            false => {
                let next = places.partition_point(|[t, _]| *t < time);
                let ([t0, z0], [t1, z1]) = (places.get(next.checked_sub(1)?)?, places.get(next)?);
                Some(z0 + (z1 - z0) * (time - t0) / (t1 - t0))
            }
        };
        rows.extend(
            self.laser
                .iter()
                .map(|[time, z]| place(*time).map_or(0.0, |place| (z - place - u[of::LASER]) / self.laser_deviation)),
        );
        rows.extend(self.beforehand(u, [contact, speed]));
        rows
    }

    /// What is known or assumed, as residuals.
    fn beforehand(&self, u: &Unknowns, [contact, speed]: [f64; 2]) -> Vec<f64> {
        let Known { height, speed: known_speed, contact_time, friction, .. } = self.known;
        let by = |[mean, deviation]: &[f64; 2], value: f64| (value - mean) / deviation;
        // Student's distribution: what the reading shows clearly is believed.
        let student = |d: f64| ((FREEDOM + 1.0) * (d * d / FREEDOM).ln_1p()).sqrt() * d.signum();
        let friction = match friction {
            Some(given) => by(given, u[of::FRICTION]),
            None => student(by(&Known::FRICTION, u[of::FRICTION])),
        };
        let mut rows = vec![
            u[of::DRIFT] / DRIFT,
            u[of::DURATION] / DURATION,
            friction,
            u[of::OF_SPEED] / OF_SPEED,
            student((u[of::GOES_ON] - 1.0) / GOES_ON),
            by(&EXPONENT, u[of::EXPONENT]),
            u[of::BEND] / BEND,
            (u[of::LEVEL] - self.force.ln()) / LEVEL,
            u[of::LASER] / LASER,
        ];
        rows.extend(height.map(|height| by(&height, self.height(u))));
        rows.extend(known_speed.map(|known| by(&known, speed)));
        rows.extend(contact_time.map(|known| by(&known, contact)));
        rows
    }

    fn start(&self) -> f64 {
        self.samples.first().map_or(0.0, |sample| sample.time)
    }

    /// Least and largest values of the unknowns. A little negative friction stands for a gravity or a sensitivity that is
    /// off; a release ends no sooner than two samples after its begin, so that it moves smoothly between samples.
    pub(super) fn bounds(&self) -> [[f64; 2]; COUNT] {
        let mut bounds = [[f64::NEG_INFINITY, f64::INFINITY]; COUNT];
        bounds[of::INVERSE] = self.known.inverse.map_or([0.0, 100.0], |given| [given; 2]);
        bounds[of::DURATION] = [2.0 * self.step, 0.1];
        bounds[of::FRICTION] = [-0.03, 0.9];
        bounds[of::OF_SPEED] = [0.0, 1.0];
        bounds[of::GOES_ON] = [0.0, 2.0];
        bounds[of::EXPONENT] = [0.3, 6.0];
        bounds[of::CONTACT] = [self.start(), self.samples.last().map_or(f64::INFINITY, |sample| sample.time)];
        bounds
    }
}

/// Travel and speed at the time `until` (s) under an acceleration (downward) that depends on the travel.
fn runge_kutta([t, d, v]: [f64; 3], until: f64, acceleration: impl Fn(f64) -> f64) -> [f64; 3] {
    let h = until - t;
    let a = acceleration(d);
    let (v2, a2) = (v + 0.5 * h * a, acceleration(d + 0.5 * h * v));
    let (v3, a3) = (v + 0.5 * h * a2, acceleration(d + 0.5 * h * v2));
    let (v4, a4) = (v + h * a3, acceleration(d + h * v3));
    [until, d + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4), v + h / 6.0 * (a + 2.0 * a2 + 2.0 * a3 + a4)]
}

/// The residual that [`robust`] has made another of.
fn straight(r: f64) -> f64 {
    if r.abs() > OUTLIER { 0.5 * (r * r / OUTLIER + OUTLIER) * r.signum() } else { r }
}

/// A residual whose square is Huber's loss.
fn robust(r: f64) -> f64 {
    match r.abs() > OUTLIER {
        true => (OUTLIER * (2.0 * r.abs() - OUTLIER)).sqrt() * r.signum(),
        false => r,
    }
}
