//! Drops on films of made-up laws, as sensors of many kinds record them, with the truth beside each.
//!
//! Nothing here is shared with the engine or with the reduction of recordings: the motion is integrated from the forces
//! (Runge and Kutta's method of fourth order, ten steps a sample), the coupling of the accelerometer is a state of the
//! same equations. Film loads as `k dⁿ / (1 + (d/s)²)`, which softens, and unloads more steeply from a travel that
//! remains; neither is the law that the reduction fits. After contact the motion may instead be given ([`Given`]), as
//! another simulation has it.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

/// m/s².
pub const GRAVITY: f64 = 9.81;
/// Standard deviation of the height that the reducer is told, m.
pub const HEIGHT_ERROR: f64 = 2e-3;
/// Standard deviation of the zero of the laser, m.
const LASER_ZERO: f64 = 1e-4;
/// Standard deviation of a sample of the laser, m; its range, m; its step, m.
const LASER_NOISE: f64 = 5e-5;
const LASER_RANGE: [f64; 2] = [-0.035, 0.015];
const LASER_STEP: f64 = 1e-5;
/// Step of the accelerometer's converter, m/s²: 16 bits over ±400 g.
const STEP: f64 = 800.0 * GRAVITY / 65536.0;
/// Steps of the motion for each sample.
const OVERSAMPLING: u32 = 10;
/// Longest recording, s.
const LONGEST: f64 = 3.0;

/// Tower, film and sensors of a drop.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Height of fall over the film, m.
    pub height: f64,
    /// Time over which the holding force ends, s, and whether it does so as a line or as a cosine.
    pub release: f64,
    pub is_linear: bool,
    /// Friction of the guide over the weight.
    pub friction: f64,
    /// Exponent of the film's force, travel that it is to reach (m), travel at which it has softened by half (m).
    pub exponent: f64,
    pub travel: f64,
    pub softens: f64,
    /// Exponent of unloading, and share of the travel that remains.
    pub steeper: f64,
    pub remains: f64,
    /// Inverse time constant of the accelerometer, 1/s; zero is DC-coupled.
    pub coupling: f64,
    /// Samples a second.
    pub rate: f64,
    /// Standard deviation of a sample, m/s²; reading at rest, m/s², and its drift, m/s³.
    pub noise: f64,
    pub offset: f64,
    pub drift: f64,
    /// Time before the release, s.
    pub rest: f64,
    pub has_laser: bool,
    seed: u64,
}

/// What happened.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Time of first contact, s.
    pub contact: f64,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Largest travel, m, negative.
    pub travel: f64,
    /// Share of the energy that the film absorbed: 1 − ΔE_u/ΔE_l of the impactor's kinetic and potential energy before and
    /// after the lowest point (Polymers 2021, 13, 1537, equation 11).
    pub absorption: f64,
}

/// A motion after contact that was found elsewhere.
#[derive(Clone, Debug)]
pub struct Given {
    /// Impact speed, m/s.
    pub speed: f64,
    /// Time between values, s.
    pub step: f64,
    /// Acceleration of the impactor, m/s², positive upward, from contact on.
    pub acceleration: Vec<f64>,
}

impl Given {
    /// At a time after contact, linear between values.
    fn at(&self, t: f64) -> f64 {
        let place = (t / self.step).clamp(0.0, (self.acceleration.len() - 1) as f64);
        let (index, share) = (place as usize, place.fract());
        let next = (index + 1).min(self.acceleration.len() - 1);
        self.acceleration[index] + share * (self.acceleration[next] - self.acceleration[index])
    }
}

/// A recording, and what happened.
#[derive(Clone, Debug)]
pub struct Recording {
    pub truth: Truth,
    /// The height as it was measured, m.
    pub height: f64,
    /// s.
    pub time: Vec<f64>,
    /// m/s².
    pub accelerometer: Vec<f64>,
    /// m; `NaN` out of range.
    pub laser: Option<Vec<f64>>,
}

impl Setup {
    /// One of the ranges of laboratories: heights 0.3 to 1.5 m, releases of 0 to 5 ms, friction 0 or 2 %, film from stiff to
    /// slack, coupling of 0.3 and 1 s or none, 5 to 20 kHz, noise 0.02 to 0.25 g.
    pub fn of(seed: u64) -> Setup {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut share = || -> f64 { StandardUniform.sample(&mut random) };
        let log = |x: f64, from: f64, to: f64| from * (to / from).powf(x);
        let one_of = |x: f64, of: &[f64]| of[((x * of.len() as f64) as usize).min(of.len() - 1)];
        Setup {
            height: 0.3 + 1.2 * share(),
            release: 0.005 * share(),
            is_linear: share() < 0.5,
            friction: one_of(share(), &[0.0, 0.02]),
            exponent: 1.0 + 2.0 * share(),
            travel: log(share(), 0.015, 0.2),
            softens: 0.3 + 2.0 * share(),
            steeper: 1.2 + 2.0 * share(),
            remains: 0.4 * share(),
            coupling: one_of(share(), &[0.0, 1.0, 1.0 / 0.3]),
            rate: one_of(share(), &[5e3, 10e3, 20e3]),
            noise: GRAVITY * log(share(), 0.02, 0.25),
            offset: 0.1 * GRAVITY * (share() - 0.5),
            drift: 0.04 * (share() - 0.5),
            rest: 0.1 + 0.3 * share(),
            has_laser: share() < 0.4,
            seed,
        }
    }

    /// The drop, recorded.
    pub fn record(&self) -> Recording {
        self.recorded(Contact::Film(Film::of(self)))
    }

    /// A drop from the height that leads to the given speed, and goes on as given.
    pub fn record_given(&self, given: &Given) -> Recording {
        let met = Contact::Given { given, since: None };
        let (mut state, mut t, step) = (State { place: 0.0, velocity: 0.0, held: 0.0 }, 0.0, 1e-5);
        while -state.velocity < given.speed {
            (state, t) = (self.advanced(t, step, &state, &met), t + step);
        }
        // What the last step fell too far.
        let height = -state.place - (-state.velocity - given.speed) * given.speed / GRAVITY;
        Setup { height, ..self.clone() }.recorded(met)
    }

    fn recorded(&self, mut met: Contact<'_>) -> Recording {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed ^ 0x5eed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let step = 1.0 / self.rate;
        // The release falls between two samples.
        let release = self.rest + normal().abs().fract() * step;
        let zero = LASER_ZERO * normal();
        let height = self.height + HEIGHT_ERROR * normal();
        let (mut state, mut t) = (State { place: self.height, velocity: 0.0, held: 0.0 }, 0.0);
        let (mut time, mut accelerometer, mut laser) = (vec![], vec![], vec![]);
        let mut contact = None;
        let mut energies = Energies::default();
        let (mut travel, mut end) = (0.0_f64, LONGEST);
        let fine = step / f64::from(OVERSAMPLING);
        for i in 0_u32.. {
            if t > end {
                break;
            }
            if i % OVERSAMPLING == 0 {
                let read = self.acceleration(t - release, &state, &met) - self.coupling * state.held;
                let read = read + self.offset + self.drift * t + self.noise * normal();
                let seen = state.place + zero + LASER_NOISE * normal();
                time.push(t);
                accelerometer.push((read / STEP).round() * STEP);
                let is_seen = (LASER_RANGE[0]..=LASER_RANGE[1]).contains(&seen);
                laser.push(if is_seen { (seen / LASER_STEP).round() * LASER_STEP } else { f64::NAN });
            }
            let next = self.advanced(t - release, fine, &state, &met);
            if contact.is_none() && next.place <= 0.0 {
                let share = state.place / (state.place - next.place);
                let speed = state.velocity + share * (next.velocity - state.velocity);
                contact = Some([t + share * fine, -speed]);
                if let Contact::Given { given, since } = &mut met {
                    *since = Some(t + share * fine - release);
                    end = t + (given.acceleration.len() - 1) as f64 * given.step;
                }
                energies = Energies::at([-speed, 0.0]);
            }
            if let Some([since, _]) = contact {
                energies.add([next.velocity, next.place], next.place < travel);
                travel = travel.min(next.place);
                if let Contact::Film(film) = &mut met {
                    film.pressed(-next.place);
                }
                if end == LONGEST && state.velocity < 0.0 && next.velocity >= 0.0 {
                    end = t + 2.0 * (t - since) + 0.05;
                }
            }
            (state, t) = (next, f64::from(i + 1) * fine);
        }
        let [contact, speed] = contact.expect("film is met");
        let truth = Truth { contact, speed, travel, absorption: energies.absorption() };
        Recording { truth, height, time, accelerometer, laser: self.has_laser.then_some(laser) }
    }

    /// Acceleration (upward) at a time after the release, without what the holding force balances.
    fn acceleration(&self, t: f64, state: &State, met: &Contact<'_>) -> f64 {
        if t < 0.0 {
            return 0.0;
        }
        let force = match met {
            Contact::Film(film) => film.force(-state.place, state.velocity),
            Contact::Given { given, since: Some(since) } => return given.at(t - since),
            Contact::Given { since: None, .. } => 0.0,
        };
        let s = (t / self.release.max(1e-9)).min(1.0);
        let hold = if self.is_linear { 1.0 - s } else { 0.5 * (1.0 + (std::f64::consts::PI * s).cos()) };
        let driving = force - GRAVITY * (1.0 - hold);
        let friction = self.friction * GRAVITY;
        match state.velocity {
            0.0 if driving.abs() <= friction => 0.0,
            0.0 => driving - friction * driving.signum(),
            velocity => driving - friction * velocity.signum(),
        }
    }

    fn advanced(&self, t: f64, h: f64, state: &State, met: &Contact<'_>) -> State {
        let slope = |t: f64, s: &State| {
            let a = self.acceleration(t, s, met);
            State { place: s.velocity, velocity: a, held: a - self.coupling * s.held }
        };
        let k1 = slope(t, state);
        let k2 = slope(t + 0.5 * h, &state.plus(&k1, 0.5 * h));
        let k3 = slope(t + 0.5 * h, &state.plus(&k2, 0.5 * h));
        let k4 = slope(t + h, &state.plus(&k3, h));
        state.plus(&k1, h / 6.0).plus(&k2, h / 3.0).plus(&k3, h / 3.0).plus(&k4, h / 6.0)
    }
}

/// Place over the film (m), velocity (m/s, up), and what the coupling holds back, ∫(a − held/τ) dt (m/s).
#[derive(Clone, Copy)]
struct State {
    place: f64,
    velocity: f64,
    held: f64,
}

impl State {
    fn plus(self, slope: &State, h: f64) -> State {
        State {
            place: self.place + h * slope.place,
            velocity: self.velocity + h * slope.velocity,
            held: self.held + h * slope.held,
        }
    }
}

/// What the impactor meets.
enum Contact<'a> {
    Film(Film),
    /// Since when after the release, s.
    Given {
        given: &'a Given,
        since: Option<f64>,
    },
}

/// Film, its force over the mass.
struct Film {
    stiffness: f64,
    exponent: f64,
    softens: f64,
    steeper: f64,
    remains: f64,
    /// Largest travel until now, m, and force there, m/s².
    most: [f64; 2],
}

impl Film {
    /// The stiffness is that which takes up the fall over the travel.
    fn of(setup: &Setup) -> Film {
        let Setup { exponent, travel, softens, steeper, remains, .. } = *setup;
        let mut film = Film { stiffness: 1.0, exponent, softens: softens * travel, steeper, remains, most: [0.0; 2] };
        let steps = 2000;
        let work: f64 = (0..steps).map(|i| film.loaded((f64::from(i) + 0.5) / f64::from(steps) * travel)).sum();
        film.stiffness =
            GRAVITY * (setup.height + travel) * (1.0 - setup.friction) / (work * travel / f64::from(steps));
        film
    }

    fn loaded(&self, travel: f64) -> f64 {
        let softened = 1.0 + (travel / self.softens).powi(2);
        if travel > 0.0 { self.stiffness * travel.powf(self.exponent) / softened } else { 0.0 }
    }

    fn force(&self, travel: f64, velocity: f64) -> f64 {
        let [most, force] = self.most;
        if velocity <= 0.0 && travel >= most {
            return self.loaded(travel);
        }
        let remains = self.remains * most;
        if travel <= remains { 0.0 } else { force * ((travel - remains) / (most - remains)).powf(self.steeper) }
    }

    fn pressed(&mut self, travel: f64) {
        if travel > self.most[0] {
            self.most = [travel, self.loaded(travel)];
        }
    }
}

/// Least and largest energy over the mass before and after the lowest point, m²/s².
#[derive(Clone, Copy, Default)]
struct Energies {
    before: [f64; 2],
    after: [f64; 2],
}

impl Energies {
    fn of([velocity, place]: [f64; 2]) -> f64 {
        0.5 * velocity * velocity + GRAVITY * place
    }

    fn at(motion: [f64; 2]) -> Energies {
        Energies { before: [Energies::of(motion); 2], after: [Energies::of(motion); 2] }
    }

    fn add(&mut self, motion: [f64; 2], is_deepest: bool) {
        let energy = Energies::of(motion);
        let widened = |[least, most]: [f64; 2]| [energy.min(least), energy.max(most)];
        if is_deepest {
            (self.before, self.after) = (widened(self.before), [energy; 2]);
        } else {
            self.after = widened(self.after);
        }
    }

    fn absorption(&self) -> f64 {
        let span = |[least, most]: [f64; 2]| most - least;
        1.0 - span(self.after) / span(self.before)
    }
}
