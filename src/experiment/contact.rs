//! When the impactor meets the film, and how fast: the search that starts from the ideal fall
//! (Polymers 2021, 13, 1537, section 3.2).

use serde::Serialize;
use thiserror::Error;

use super::fit::{Moments, least_squares};
use crate::signal::{Series, integrate};

/// Where contact time and impact speed were taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SpeedSource {
    /// The doubly integrated acceleration matched to the laser.
    Laser,
    /// The acceleration integrated from rest over the known height.
    Fall,
    /// It was known: the acceleration integrated from rest reaches it at contact.
    Given,
}

/// First contact of impactor and film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// s, on the recording's clock.
    pub time: f64,
    /// m/s, negative: downward.
    pub velocity: f64,
    /// Rounds until the contact time settled.
    pub iterations: u32,
    /// Root mean square distance of matched motion and laser, m.
    pub laser_residual: Option<f64>,
    pub speed_from: SpeedSource,
}

/// Why no contact could be found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ContactError {
    #[error(
        "laser: fewer than {FEWEST} samples within any {LASER_LENGTH} s between the release at {release:.4} s and the end at {end:.4} s"
    )]
    LaserWithoutSamples { release: f64, end: f64 },
    #[error("laser: it rises while the impactor falls; its values must count upward from the film's upper face")]
    LaserReversed,
    #[error("laser: the motion matched to it does not pass the film's upper face near {near:.4} s")]
    NoCrossing { near: f64 },
    #[error("acceleration: integrated from rest it does not fall through {height} m; check the height")]
    HeightNotCovered { height: f64 },
    #[error("acceleration: integrated from rest it does not reach {speed} m/s; check the speed")]
    SpeedNotReached { speed: f64 },
    #[error(
        "acceleration: no onset of the force is seen near {near:.4} s, where the fall {}; check the {}",
        known.reached(), known.name()
    )]
    NoOnset { near: f64, known: FallCondition },
    #[error(
        "acceleration: a fall that {} would need the sensor's zero {offset:.3} m/s² off its mean at rest, which is known to {error:.4} m/s²; check the {}",
        known.reached(), known.name()
    )]
    NotClosed { known: FallCondition, offset: f64, error: f64 },
    #[error("the contact time did not settle within {MOST_ROUNDS} rounds")]
    NotSettled,
}

/// Fewest values of the laser that a motion is matched to.
const FEWEST: usize = 10;
const MOST_ROUNDS: u32 = 50;
/// The contact time has settled when it moves by less, s.
const SETTLED: f64 = 1e-6;
/// Stretch around the presumed contact in which the laser counts, s: the first pass through its range, not the rebound.
const LASER_SPAN: [f64; 2] = [-0.02, 0.06];
const LASER_LENGTH: f64 = 0.08;

/// Matches the motion to the `laser` (m, upward from the film's upper face; `NaN` where it saw nothing).
///
/// `acceleration` gives the corrected acceleration (m/s²) for a presumed contact time (s). In each round its double
/// integral, plus place and speed at the presumed contact, is brought to the laser by linear least squares; contact is where the
/// matched motion passes zero. The first presumption is where the laser first measured after the `release` (s), or, where nothing
/// comes of that since it saw the whole fall, `ideal` (s), the ideal fall's contact time.
pub fn by_laser(
    acceleration: impl Fn(f64) -> Series,
    laser: &Series,
    release: f64,
    ideal: f64,
) -> Result<Contact, ContactError> {
    let search = |from: f64| settled(&acceleration, laser, first_pass(laser, release, from)?);
    search(release).or_else(|_| search(ideal.max(release)))
}

/// Contact after the rounds from the `presumed` time (s) on.
fn settled(acceleration: impl Fn(f64) -> Series, laser: &Series, mut presumed: f64) -> Result<Contact, ContactError> {
    for round in 1..=MOST_ROUNDS {
        let pass = pass(laser, presumed);
        if pass.len() < FEWEST {
            return Err(ContactError::NoCrossing { near: presumed });
        }
        let matched = Matched::find(&acceleration(presumed), &pass, presumed)?;
        let (time, velocity) = matched.crossing(presumed)?;
        if (time - presumed).abs() < SETTLED {
            let laser_residual = Some(matched.residual);
            return Ok(Contact { time, velocity, iterations: round, laser_residual, speed_from: SpeedSource::Laser });
        }
        presumed = time;
    }
    Err(ContactError::NotSettled)
}

/// What the laser measured around the presumed contact.
fn pass(laser: &Series, presumed: f64) -> Vec<[f64; 2]> {
    let near = laser.window(LASER_SPAN.map(|span| presumed + span));
    near.samples().filter(|[_, place]| place.is_finite()).collect()
}

/// Where the laser is first looked at, s: around the time `from`, or where it next measured.
fn first_pass(laser: &Series, release: f64, from: f64) -> Result<f64, ContactError> {
    let end = laser.time().last().copied().unwrap_or(release);
    let measured = laser.samples().filter(|[t, place]| *t > from && place.is_finite()).map(|[t, _]| t);
    let found = std::iter::once(from).chain(measured).find(|place| pass(laser, *place).len() >= FEWEST);
    found.ok_or(ContactError::LaserWithoutSamples { release, end })
}

/// A motion that agrees with the laser.
struct Matched {
    velocity: Series,
    place: Series,
    residual: f64,
}

impl Matched {
    fn find(acceleration: &Series, pass: &[[f64; 2]], presumed: f64) -> Result<Matched, ContactError> {
        let span = LASER_SPAN.map(|span| presumed + span);
        let velocity = integrate::once(&acceleration.window(span), 0.0);
        let place = integrate::once(&velocity, 0.0);
        let origin = place.time().first().copied().unwrap_or(presumed);
        let length = span[1] - span[0];
        let rows = pass.iter().filter_map(|[t, laser]| Some(([1.0, (t - origin) / length], laser - place.at(*t)?)));
        let fitted = least_squares(rows.clone()).ok_or(ContactError::NoCrossing { near: presumed })?;
        let ([at_origin, rise], left) = fitted;
        let speed = rise / length;
        let residual = (left / rows.count() as f64).sqrt();
        let velocity = integrate::once(&acceleration.window(span), speed);
        let place = integrate::once(&velocity, at_origin);
        Ok(Matched { velocity, place, residual })
    }

    /// Time and velocity of the first way down through zero.
    fn crossing(&self, presumed: f64) -> Result<(f64, f64), ContactError> {
        let missing = || ContactError::NoCrossing { near: presumed };
        let time = crossing(&self.place, 0.0).ok_or_else(|| match self.velocity.values().first() {
            Some(velocity) if *velocity > 0.0 => ContactError::LaserReversed,
            _ => missing(),
        })?;
        Ok((time, self.velocity.at(time).ok_or_else(missing)?))
    }
}

/// When a signal is first at or below `level`, having been above it.
fn crossing(signal: &Series, level: f64) -> Option<f64> {
    let (time, z) = (signal.time(), signal.values());
    let k = (1..signal.len()).find(|k| z[k - 1] > level && z[*k] <= level)?;
    Some(time[k - 1] + (time[k] - time[k - 1]) * (z[k - 1] - level) / (z[k - 1] - z[k]))
}

/// How far the onset of the force may lie from where the integrated fall has come to what is known of it, s.
const ONSET_SEARCH: f64 = 0.003;
/// Last part of the fall, over which the rate at the known height or speed is taken, s.
const RATE_OVER: f64 = 0.01;
/// Stretch around it that is described by fall and onset, s.
const ONSET_SPAN: [f64; 2] = [-0.05, 0.006];

/// What is known of a fall that no laser saw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FallCondition {
    /// Height that it covers, m.
    Height(f64),
    /// Speed that it reaches, m/s.
    Speed(f64),
}

impl FallCondition {
    /// The integral of an acceleration that reaches [`FallCondition::level`] at contact.
    fn integral(self, acceleration: &Series) -> Series {
        match self {
            FallCondition::Height(_) => integrate::twice(acceleration, 0.0, 0.0),
            FallCondition::Speed(_) => integrate::once(acceleration, 0.0),
        }
    }

    fn level(self) -> f64 {
        match self {
            FallCondition::Height(value) | FallCondition::Speed(value) => -value,
        }
    }

    fn speed_from(self) -> SpeedSource {
        match self {
            FallCondition::Height(_) => SpeedSource::Fall,
            FallCondition::Speed(_) => SpeedSource::Given,
        }
    }

    /// What the fall has come to.
    fn reached(self) -> String {
        match self {
            FallCondition::Height(height) => format!("covers {height} m"),
            FallCondition::Speed(speed) => format!("reaches {speed:.3} m/s"),
        }
    }

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        match self {
            FallCondition::Height(_) => "height",
            FallCondition::Speed(_) => "speed",
        }
    }

    fn unreached(self) -> ContactError {
        match self {
            FallCondition::Height(height) => ContactError::HeightNotCovered { height },
            FallCondition::Speed(speed) => ContactError::SpeedNotReached { speed },
        }
    }
}

/// The zero of the sensor, from the rest before the release.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZeroOffset {
    /// Samples that it is the mean of.
    pub samples: usize,
    /// Standard deviation of one sample, m/s².
    pub deviation: f64,
}

impl ZeroOffset {
    /// Standard error of the mean, m/s².
    pub fn error(&self) -> f64 {
        self.deviation / (self.samples.max(1) as f64).sqrt()
    }
}

/// A fall that was closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedFall {
    pub contact: Contact,
    /// Offset beyond the mean of the rest that closes the fall, m/s².
    pub offset: f64,
    /// The offset is larger than the rest lets expect.
    pub doubtful: bool,
}

/// Closing offsets beyond so many standard errors, and beyond so large a share of what is known, are doubtful or refused.
const DOUBTFUL: [f64; 2] = [5.0, 0.0025];
const REFUSED: [f64; 2] = [10.0, 0.01];

/// A fall without laser: from rest to what is `known` of it, with the sensor's offset as the unknown that closes it.
///
/// `acceleration` gives the corrected acceleration (m/s²) from rest on, where the offset is larger by its argument (m/s²) than the
/// mean of the rest, which is the sensor's `zero`. In each round the onset of the force is looked for near the time at which the
/// fall with the offset of the rest has come to what is known, and the offset becomes the one with which it comes there exactly
/// then. A fall that no onset ends, or that only an offset far beyond the scatter of the rest would close, is another one than
/// what is `known` of it.
pub fn by_fall(
    acceleration: impl Fn(f64) -> Series,
    known: FallCondition,
    zero: ZeroOffset,
) -> Result<ClosedFall, ContactError> {
    let integral = |offset: f64| known.integral(&acceleration(offset));
    let reached_at = |offset: f64, time: f64| integral(offset).at(time).ok_or(known.unreached());
    let fallen = crossing(&integral(0.0), known.level()).ok_or(known.unreached())?;
    let rate = (reached_at(0.0, fallen)? - reached_at(0.0, fallen - RATE_OVER)?) / RATE_OVER;
    // What is reached depends on the offset in proportion.
    let sway = reached_at(1.0, fallen)? - reached_at(0.0, fallen)?;
    // Noise moves the mean of the rest, and integrated the fall as much again; both in proportion to the noise, whose square
    // the sum over the onset is measured in.
    let trust = 0.5 * zero.samples as f64 * (rate / sway).powi(2);
    let (mut offset, mut presumed) = (0.0, fallen);
    for round in 1..=MOST_ROUNDS {
        let corrected = acceleration(offset);
        let time = onset(&corrected, presumed, |time| trust * (time - fallen).powi(2));
        let time = time.ok_or(ContactError::NoOnset { near: presumed, known })?;
        let (without, with) = (reached_at(0.0, time)?, reached_at(1.0, time)?);
        offset = (known.level() - without) / (with - without);
        if (time - presumed).abs() <= 1.01 * step(&corrected) {
            let beyond = |[errors, share]: [f64; 2]| {
                offset.abs() > errors * zero.error() && (offset * sway / known.level()).abs() > share
            };
            if beyond(REFUSED) {
                return Err(ContactError::NotClosed { known, offset, error: zero.error() });
            }
            let velocity = integrate::once(&acceleration(offset), 0.0).at(time).ok_or(known.unreached())?;
            let speed_from = known.speed_from();
            let contact = Contact { time, velocity, iterations: round, laser_residual: None, speed_from };
            return Ok(ClosedFall { contact, offset, doubtful: beyond(DOUBTFUL) });
        }
        presumed = time;
    }
    Err(ContactError::NotSettled)
}

/// Mean sample interval, s: the onset is known no better.
fn step(series: &Series) -> f64 {
    match series.time() {
        [first, .., last] => (last - first) / (series.len() - 1) as f64,
        _ => 0.0,
    }
}

/// An onset takes at least so many variances from the sum of squares that a straight line leaves: by chance hardly ever.
const SEEN: f64 = 60.0;

/// Where a constant before and a cubic after describe the acceleration around `near` (s) best, in the sum of squares together with
/// the `penalty` (m²/s⁴) of a time; none where a straight line does as well, where the acceleration does not rise to the end, and
/// where the best time is the first or last that is looked at.
///
/// The two need not meet: the guide's friction ends with the fall. Between two samples all times are alike; the middle is given.
fn onset(acceleration: &Series, near: f64, penalty: impl Fn(f64) -> f64) -> Option<f64> {
    let around = acceleration.window(ONSET_SPAN.map(|span| near + span));
    let time = around.time();
    let first = time.partition_point(|t| *t < near - ONSET_SEARCH).max(1);
    let last = time.partition_point(|t| *t <= near + ONSET_SEARCH);
    if time.len() < last + 4 {
        return None;
    }
    let split = Split::new(&around, near, first..last);
    let best = split.pieces.iter().min_by(|a, b| {
        let sum = |piece: &Piece| piece.left + penalty(time[piece.from]);
        sum(a).total_cmp(&sum(b))
    })?;
    let variance = best.left / (time.len() - 5) as f64;
    let is_seen = split.line - best.left > SEEN * variance;
    let is_inside = best.from > first && best.from + 1 < last;
    (is_seen && is_inside && best.rise > 0.0).then(|| 0.5 * (time[best.from - 1] + time[best.from]))
}

/// All ways to part a signal into a constant and a cubic.
struct Split {
    pieces: Vec<Piece>,
    /// Sum of squares that a straight line leaves of the whole.
    line: f64,
}

/// One of them.
struct Piece {
    /// First sample of the cubic.
    from: usize,
    /// Sum of squares that both leave.
    left: f64,
    /// From the constant to the end of the cubic.
    rise: f64,
}

impl Split {
    /// Sums run along the signal once, so that time grows with its samples alone.
    fn new(signal: &Series, near: f64, places: std::ops::Range<usize>) -> Split {
        let mean = signal.values().iter().sum::<f64>() / signal.len().max(1) as f64;
        let row = |[t, a]: [f64; 2]| ((t - near) / ONSET_SEARCH, a - mean);
        let rows: Vec<(f64, f64)> = signal.samples().map(row).collect();
        let cubic = |u: f64| [1.0, u, u * u, u * u * u];
        let mut after = Moments::default();
        let mut tails: Vec<_> = rows
            .iter()
            .enumerate()
            .rev()
            .filter_map(|(k, (u, a))| {
                after.add(cubic(*u), *a);
                places.contains(&k).then(|| after.solve())
            })
            .collect();
        let (mut before, mut line) = (Moments::default(), Moments::default());
        let mut pieces = Vec::new();
        for (k, (u, a)) in rows.iter().enumerate() {
            if places.contains(&k)
                && let (Some(([constant], head)), Some((tail, rest))) = (before.solve(), tails.pop().flatten())
            {
                let end = rows.last().map_or([0.0; 4], |(u, _)| cubic(*u));
                let rise = tail.iter().zip(end).map(|(c, x)| c * x).sum::<f64>() - constant;
                pieces.push(Piece { from: k, left: head + rest, rise });
            }
            before.add([1.0], *a);
            line.add([1.0, *u], *a);
        }
        Split { pieces, line: line.solve().map_or(0.0, |(_, left)| left) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 1e-4;
    const CONTACT: f64 = 0.48317;
    const NET: f64 = 8.6;
    const ZERO: ZeroOffset = ZeroOffset { samples: 1, deviation: 0.05 };

    /// Falls with NET from t = 0; from CONTACT on −9.8 + 400 u + 3000 u² m/s².
    fn acceleration(t: f64) -> f64 {
        let u = t - CONTACT;
        if u < 0.0 { -NET } else { -9.8 + 400.0 * u + 3000.0 * u * u }
    }

    fn place(t: f64) -> f64 {
        let u = t - CONTACT;
        if u < 0.0 {
            return 0.5 * NET * (CONTACT * CONTACT - t * t);
        }
        -NET * CONTACT * u - 4.9 * u * u + 400.0 / 6.0 * u.powi(3) + 250.0 * u.powi(4)
    }

    fn sampled(f: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..5500).map(|i| f64::from(i) * STEP).collect();
        let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
        Series::new(time, values)
    }

    fn laser(t: f64) -> f64 {
        let place = place(t);
        if (-0.035..0.015).contains(&place) { place } else { f64::NAN }
    }

    #[test]
    fn a_clean_laser_gives_contact_and_speed() {
        let acceleration = sampled(acceleration);
        for ideal in [0.2, 0.4515, 0.48, 0.5] {
            let contact = by_laser(|_| acceleration.clone(), &sampled(laser), 0.0, ideal).unwrap();
            assert!((contact.time - CONTACT).abs() < 2e-6, "{contact:?}");
            assert!((contact.velocity + NET * CONTACT).abs() < 1e-3, "{contact:?}");
            assert!(contact.laser_residual.unwrap() < 1e-6, "{contact:?}");
        }
    }

    #[test]
    fn lasers_without_usable_samples_are_refused() {
        let acceleration = sampled(acceleration);
        let found = |laser: Series| by_laser(|_| acceleration.clone(), &laser, 0.0, 0.45).unwrap_err();
        assert!(matches!(found(sampled(|_| f64::NAN)), ContactError::LaserWithoutSamples { .. }));
        assert_eq!(found(sampled(|t| -laser(t))), ContactError::LaserReversed);
        assert!(matches!(found(sampled(|t| laser(t) + 0.7)), ContactError::NoCrossing { .. }));
    }

    #[test]
    fn a_fall_of_which_height_or_speed_is_known_gives_them_too() {
        let known = [FallCondition::Height(0.5 * NET * CONTACT * CONTACT), FallCondition::Speed(NET * CONTACT)];
        for (known, wrong) in known.into_iter().flat_map(|known| [0.0, 0.02, -0.03].map(|wrong| (known, wrong))) {
            let fall = |offset: f64| sampled(|t| acceleration(t) + wrong - offset);
            let ClosedFall { contact, offset, .. } = by_fall(fall, known, ZERO).unwrap();
            assert!((contact.time - CONTACT).abs() < STEP, "{contact:?}");
            assert!((contact.velocity / (-NET * CONTACT) - 1.0).abs() < 5e-4, "{contact:?}");
            assert!((offset - wrong).abs() < 5e-3, "{offset}");
        }
    }

    #[test]
    fn a_height_or_speed_that_the_fall_does_not_reach_is_refused() {
        let fall = |known| by_fall(|offset| sampled(|t| acceleration(t) - offset), known, ZERO);
        assert_eq!(fall(FallCondition::Height(9.0)), Err(ContactError::HeightNotCovered { height: 9.0 }));
        assert_eq!(fall(FallCondition::Speed(9.0)), Err(ContactError::SpeedNotReached { speed: 9.0 }));
    }

    /// The guide goes on rubbing less and less, without an impact; and one whose force falls off.
    #[test]
    fn what_does_not_rise_at_once_is_no_onset() {
        let known = FallCondition::Height(1.0);
        for end in [0.0, -40.0] {
            let after = |t: f64| if t < CONTACT { 0.0 } else { end * (t - CONTACT) };
            let found = by_fall(|offset| sampled(|t| 0.5 * t - NET + after(t) - offset), known, ZERO);
            assert!(matches!(found, Err(ContactError::NoOnset { .. })), "{end}: {found:?}");
        }
    }

    /// So slow that a wrong height leaves the onset within the search: only the offset shows it.
    #[test]
    fn an_offset_that_the_rest_contradicts_closes_no_fall() {
        let time = 0.15;
        let height = 0.5 * NET * time * time;
        let zero = ZeroOffset { samples: 100, deviation: 0.1 };
        let close = |share: f64| {
            let fall = |offset: f64| sampled(|t| acceleration(t + CONTACT - time) - offset);
            by_fall(fall, FallCondition::Height(share * height), zero)
        };
        assert!(!close(1.0).unwrap().doubtful);
        assert!(close(1.007).unwrap().doubtful);
        for share in [0.98, 1.02] {
            assert!(matches!(close(share), Err(ContactError::NotClosed { .. })), "{share}: {:?}", close(share));
        }
    }
}
