//! From the readings of the sensors to contact, speed, travel and energies.

use super::clipping::Clipping;
use super::error::DropError;
use super::laser::Cleaned;
use super::result::{Drop, Intervals};
use super::time_constant::{Choice, Coupling, Disagreement, Known};
use super::tower::{Correction, Height, KnownContact, Reduction, Tower};
use super::{friction, motion, plausibility, time_constant};
use crate::experiment::Warning;
use crate::experiment::absorption::{Body, energy_absorption, film_absorption};
use crate::experiment::contact::{self, Contact, ContactError, SpeedSource};
use crate::experiment::coupling;
use crate::experiment::ramp::GravityRamp;
use crate::experiment::release::Release;
use crate::signal::column::Column;
use crate::signal::filter::{self, ChannelFilter, Standard};
use crate::signal::resample::{self, ResampleError};
use crate::signal::{Series, column, gap, integrate};
use membrane::engine::GuideFriction;

/// Reduces the `acceleration` that was read (m/s², upward) and, where there is one, the `laser`'s distance from the
/// film's upper face (m, upward; `NaN` out of range). Both have one clock and start with the impactor at rest.
pub fn reduce(
    acceleration: &Series,
    laser: Option<&Series>,
    tower: &Tower,
    reduction: &Reduction,
) -> Result<Drop, DropError> {
    check(tower, reduction)?;
    let reading = even(acceleration)?;
    if let (Some(class), Some(step)) = (reduction.class, resample::common_step(reading.time())) {
        ChannelFilter::new(class, step, Standard::Iso6487)?;
    }
    let release = Release::find(&reading, tower.body.gravity)?;
    let rest_end = release.rest_end;
    let cleaned = laser.map(Cleaned::of);
    let laser = cleaned.as_ref().map(|cleaned| &cleaned.series);
    let fall = Fall { zeroed: zeroed(&reading, &release), release, laser, tower, reduction };
    let mut drop = match reduction.correction {
        Correction::Coupling { time_constant } => fall.by_coupling(time_constant),
        Correction::Ramp => fall.by_ramp(),
    }?;
    // A laser that is not used needs no report.
    let cleaned = cleaned.filter(|_| drop.contact.speed_from == SpeedSource::Laser);
    drop.warnings.extend(cleaned.as_ref().and_then(Cleaned::warning));
    let clipping = Clipping::of(&reading, drop.contact.time);
    drop = drop.withholding(clipping);
    let implausible = plausibility::warnings(&drop, &reading, rest_end);
    drop.warnings.extend(implausible);
    Ok(drop)
}

/// Share by which the covered height may differ from the stated one; an error of 1 % in the time constant makes 1 %.
const OTHER_HEIGHT: f64 = 0.05;
/// The same of the impact speed.
const OTHER_SPEED: f64 = 0.05;
/// Halvings of an interval of time constants at which the fall does not close.
const HALVINGS: u32 = 10;
/// Share by which a speed may exceed that of the ideal fall; a laser determines it to half of that.
const FASTER: f64 = 0.01;

/// A recording whose rest and release are known.
struct Fall<'a> {
    /// The reading from the end of the rest on, without the sensor's offset.
    zeroed: Series,
    release: Release,
    laser: Option<&'a Series>,
    tower: &'a Tower,
    reduction: &'a Reduction,
}

impl Fall<'_> {
    fn by_coupling(&self, time_constant: Option<f64>) -> Result<Drop, DropError> {
        let choice = match time_constant {
            Some(given) => time_constant::given(given),
            None => self.time_constant()?,
        };
        let (mut drop, restored) = self.coupled(choice.best)?;
        let ends = choice.ends.map(|ends| self.closing(choice.best, ends, drop.is_doubtful()));
        let ends = ends.into_iter().flatten().flatten();
        let (others, ends): (Vec<Drop>, Vec<Series>) = ends.unzip();
        drop.intervals = drop.intervals(&others);
        let falls = [vec![restored], ends].concat();
        let friction = friction::fit(&falls, self.undisturbed(), self.tower.body);
        let disagreement = choice.disagreement.into_iter().map(|of| self.disagreement(of, friction.as_ref(), &drop));
        let disagreement: Vec<Warning> = disagreement.collect();
        drop.guide_friction = friction.filter(|friction| friction.constant >= 0.0 && friction.per_speed >= 0.0);
        let of_film = drop.guide_friction.as_ref().and_then(|friction| drop.film_absorption(self.tower.body, friction));
        drop.film_absorption = of_film;
        drop.warnings.extend(disagreement);
        if time_constant.is_some() && drop.contact.speed_from == SpeedSource::Laser {
            drop.warnings.extend(self.other_height(&falls[0], drop.contact.time));
        }
        Ok(drop)
    }

    /// The time constant of the recording: by laser and height, or by the fall alone.
    fn time_constant(&self) -> Result<Choice, DropError> {
        let fall = coupling::time_constant(&self.zeroed, self.undisturbed());
        match self.laser.filter(|_| self.reduction.contact.is_none()) {
            Some(laser) => {
                let height = match self.tower.height {
                    Height::Known(height) => Some(height),
                    Height::OfSpeed(_) => None,
                };
                let known = Known { reading: &self.zeroed, zero: self.release.zero, height, fall };
                time_constant::by_laser(&known, |restored| self.by_laser(restored, laser))
            }
            None => {
                let gravity = self.tower.body.gravity;
                let of_speed = coupling::inverse_with_friction_of_speed(&self.zeroed, self.undisturbed(), gravity);
                Ok(time_constant::by_fall(&fall?, of_speed))
            }
        }
    }

    /// Contact by the laser, of a restored acceleration.
    fn by_laser(&self, restored: &Series, laser: &Series) -> Result<Contact, ContactError> {
        contact::by_laser(|_| restored.clone(), laser, self.start(), self.ideal_contact())
    }

    /// The drop with this coupling, and the acceleration restored with it.
    fn coupled(&self, coupling: Coupling) -> Result<(Drop, Series), DropError> {
        let restored = |offset: f64| {
            time_constant::restored(&self.zeroed, Coupling { offset: coupling.offset + offset, ..coupling })
        };
        let (restored, contact, offset, warning) = match (self.reduction.contact, self.laser) {
            (Some(known), _) => {
                let restored = restored(0.0);
                let warning = other_speed(&restored, known);
                (restored, self.known(known)?, 0.0, warning)
            }
            (None, Some(laser)) => {
                let restored = restored(0.0);
                let contact = self.by_laser(&restored, laser)?;
                (restored, contact, 0.0, None)
            }
            (None, None) => {
                let closed = contact::by_fall(restored, self.tower.known(), self.release.zero)?;
                let warning = closed.doubtful.then(|| self.doubtful_offset(closed.offset));
                (restored(closed.offset), closed.contact, closed.offset, warning)
            }
        };
        let mut drop = Drop::of(&restored, contact, self.tower, self.reduction)?;
        drop.warnings.extend(warning);
        let offset = self.release.offset + coupling.offset + offset;
        Ok((Drop { time_constant: Some(coupling.time_constant()), offset, ..drop }, restored))
    }

    /// The drops at the ends of an interval about `best`, which is as wide as it is where the fall closes without a
    /// doubt that `best` does not leave.
    fn closing(&self, best: Coupling, ends: [Coupling; 2], is_doubtful: bool) -> [Option<(Drop, Series)>; 2] {
        let closed = |coupling| self.coupled(coupling).ok().filter(|(drop, _)| is_doubtful || !drop.is_doubtful());
        ends.map(|end| {
            closed(end).or_else(|| {
                let between = |share: f64| Coupling {
                    inverse: best.inverse + share * (end.inverse - best.inverse),
                    offset: best.offset + share * (end.offset - best.offset),
                };
                let (mut inside, mut outside, mut found) = (0.0, 1.0, None);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (inside + outside);
                    match closed(between(middle)) {
                        Some(drop) => (inside, found) = (middle, Some(drop)),
                        None => outside = middle,
                    }
                }
                found
            })
        })
    }

    /// The report of sources that disagree, with the `friction` of the fall.
    fn disagreement(&self, disagreement: Disagreement, friction: Option<&GuideFriction>, drop: &Drop) -> Warning {
        match disagreement {
            Disagreement::Height { covered } => {
                Warning::DropHeightDiffers { covered, height: self.tower.height.metres() }
            }
            Disagreement::LaserSpeed { reached, laser } => Warning::LaserSpeedDiffers { reached, laser },
            Disagreement::Friction { constant } => {
                let friction = friction.map(|friction| [0.0, drop.contact.velocity].map(|v| friction.force_at(v)));
                Warning::GuideFrictionChanges {
                    time_constant: drop.time_constant.unwrap_or(f64::NAN),
                    constant,
                    friction: friction.unwrap_or([f64::NAN; 2]),
                }
            }
        }
    }

    /// The contact that is known, which ends the fall.
    fn known(&self, KnownContact { time, speed }: KnownContact) -> Result<Contact, DropError> {
        let (release, impact) = (self.start(), self.release.blow);
        if time <= release || time > impact {
            return Err(DropError::ContactOutsideFall { contact: time, release, impact });
        }
        let speed_from = SpeedSource::Stated;
        let (laser_residual, speed_error) = (None, None);
        Ok(Contact { time, velocity: -speed, iterations: 0, laser_residual, speed_error, speed_from })
    }

    /// An offset that closes the fall without a laser but lies beyond the scatter of the rest.
    fn doubtful_offset(&self, offset: f64) -> Warning {
        Warning::ZeroOffsetDoubtful { offset, error: self.release.zero.error(), known: self.tower.known() }
    }

    /// A restored acceleration that, integrated from rest, covers another height than the stated one.
    fn other_height(&self, restored: &Series, contact: f64) -> Option<Warning> {
        let height = self.tower.height.metres();
        let covered = -integrate::twice(restored, 0.0, 0.0).at(contact)?;
        let differs = (covered / height - 1.0).abs() > OTHER_HEIGHT;
        differs.then_some(Warning::DropHeightDiffers { covered, height })
    }

    fn by_ramp(&self) -> Result<Drop, DropError> {
        let ramp = GravityRamp::fit(&self.zeroed, self.release.flank)?;
        let ramped = |contact: f64| ramped(&self.zeroed, &ramp, contact);
        let contact = match (self.reduction.contact, self.laser) {
            (Some(known), _) => self.known(known)?,
            (None, Some(laser)) => contact::by_laser(ramped, laser, self.start(), self.ideal_contact())?,
            (None, None) => return Err(DropError::LaserNeeded),
        };
        let drop = Drop::of(&ramped(contact.time), contact, self.tower, self.reduction)?;
        Ok(Drop { ramp: Some(ramp), offset: self.release.offset, ..drop })
    }

    /// When the impactor begins to fall, s.
    fn start(&self) -> f64 {
        self.release.flank[0]
    }

    /// Contact of the ideal fall, s.
    fn ideal_contact(&self) -> f64 {
        self.start() + (2.0 * self.tower.height.metres() / self.tower.body.gravity).sqrt()
    }

    /// The part from which the time constant is fitted, s: after the release, before the earliest possible contact.
    fn undisturbed(&self) -> [f64; 2] {
        let [top, bottom] = self.release.flank;
        [2.0 * bottom - top, self.ideal_contact().min(self.release.blow - 0.02)]
    }
}

fn check(tower: &Tower, reduction: &Reduction) -> Result<(), DropError> {
    let mut values =
        vec![("mass", tower.body.mass), ("gravity", tower.body.gravity), ("height", tower.height.metres())];
    if let Correction::Coupling { time_constant: Some(given) } = reduction.correction {
        values.push(("time constant", given));
    }
    if let Some(KnownContact { speed, .. }) = reduction.contact {
        values.push(("impact speed", speed));
    }
    let wrong = values.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0 || value.is_infinite());
    wrong.map_or(Ok(()), |(what, value)| Err(DropError::NotPositive { what, value }))
}

/// The reading on equal steps.
fn even(acceleration: &Series) -> Result<Series, DropError> {
    if let Some(gap) = gap::first(acceleration) {
        return Err(DropError::NotMeasured(gap));
    }
    let count = acceleration.len();
    if count < 2 {
        return Err(ResampleError::TooShort { count }.into());
    }
    if resample::common_step(acceleration.time()).is_some() {
        return Ok(acceleration.clone());
    }
    Ok(resample::uniform(acceleration, median_step(acceleration.time()))?)
}

/// s; a few times that are written twice or left out do not change it.
fn median_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The reading from the end of the rest on, without the sensor's offset.
fn zeroed(reading: &Series, release: &Release) -> Series {
    let moving = reading.window([release.rest_end, f64::INFINITY]);
    moving.with_values(moving.values().iter().map(|r| r - release.offset).collect())
}

fn ramped(zeroed: &Series, ramp: &GravityRamp, contact: f64) -> Series {
    zeroed.with_values(zeroed.samples().map(|[t, r]| r + ramp.mirrored(t, contact)).collect())
}

impl Drop {
    /// Motion and energies of a corrected acceleration (m/s²) after `contact`.
    fn of(corrected: &Series, contact: Contact, tower: &Tower, reduction: &Reduction) -> Result<Drop, DropError> {
        let filtered = match reduction.class {
            Some(class) => filter::channel(corrected, class, Standard::Iso6487)?,
            None => corrected.clone(),
        };
        let signals = motion::signals(corrected, &filtered, &contact, tower.body)?;
        let mut warnings = Vec::new();
        warnings.extend(faster_than_fall(-contact.velocity, tower)?);
        warnings.extend(without_laser(contact.speed_from));
        let channel = |name| signals.channel(name).unwrap_or_default();
        let [velocity, displacement] = [column::VELOCITY, column::DISPLACEMENT].map(|column| channel(column.name));
        let absorption = energy_absorption(tower.body, velocity, displacement);
        let missing = |reason| warnings.push(Warning::NoEnergyAbsorption { reason });
        let energy_absorption = absorption.map_err(missing).ok();
        let total_energy_drift = motion::drift(channel(column::TOTAL_ENERGY.name));
        Ok(Drop {
            contact,
            ideal_speed: tower.ideal_speed(),
            time_constant: None,
            intervals: None,
            guide_friction: None,
            ramp: None,
            offset: 0.0,
            energy_absorption,
            film_absorption: None,
            total_energy_drift,
            signals,
            clipped_from: None,
            warnings,
        })
    }

    /// Whether its fall closes with an offset alone that the rest does not show.
    fn is_doubtful(&self) -> bool {
        self.warnings.iter().any(|warning| matches!(warning, Warning::ZeroOffsetDoubtful { .. }))
    }

    /// The intervals about this drop that the others span; none without others.
    fn intervals(&self, others: &[Drop]) -> Option<Intervals> {
        let drops = || std::iter::once(self).chain(others);
        let span = |of: &dyn Fn(&Drop) -> Option<f64>| {
            let values = drops().map(of).collect::<Option<Vec<f64>>>()?;
            Some([f64::INFINITY, f64::NEG_INFINITY].map(|start: f64| match start > 0.0 {
                true => values.iter().copied().fold(start, f64::min),
                false => values.iter().copied().fold(start, f64::max),
            }))
        };
        let deepest = |drop: &Drop| Some(drop.signals.series(column::DISPLACEMENT.name)?.smallest()?[1]);
        (!others.is_empty()).then_some(())?;
        let speed = -self.contact.velocity;
        let [low, high] = span(&|drop| Some(-drop.contact.velocity))?;
        let scatter = time_constant::INTERVAL * self.contact.speed_error.unwrap_or(0.0);
        let widened = |end: f64, sign: f64| speed + sign * (end - speed).hypot(scatter);
        Some(Intervals {
            time_constant: span(&|drop| drop.time_constant)?,
            impact_speed: [widened(low, -1.0), widened(high, 1.0)],
            displacement: span(&deepest)?,
            energy_absorption: span(&|drop| drop.energy_absorption),
        })
    }

    /// Energy absorption of the film on a guide with `friction`.
    fn film_absorption(&self, body: Body, friction: &GuideFriction) -> Option<f64> {
        let channel = |column: Column| self.signals.channel(column.name);
        film_absorption(body, friction, channel(column::VELOCITY)?, channel(column::DISPLACEMENT)?).ok()
    }

    /// The drop without the energy absorption where the accelerometer was at the end of its range in the impact.
    fn withholding(mut self, clipping: Option<Clipping>) -> Drop {
        let Some(Clipping { level, start, duration }) = clipping else {
            return self;
        };
        self.clipped_from = Some(start - self.contact.time);
        (self.energy_absorption, self.film_absorption) = (None, None);
        self.intervals = self.intervals.map(|intervals| Intervals { energy_absorption: None, ..intervals });
        self.warnings.retain(|warning| !matches!(warning, Warning::NoEnergyAbsorption { .. }));
        let extreme = |name: &str, of: fn(&Series) -> Option<[f64; 2]>| of(&self.signals.series(name)?).map(|[_, v]| v);
        self.warnings.push(Warning::Saturated {
            reading: level,
            start,
            duration,
            peak: extreme(column::ACCELERATION_FILTERED.name, Series::largest).unwrap_or(f64::NAN),
            deepest: extreme(column::DISPLACEMENT.name, Series::smallest).unwrap_or(f64::NAN),
        });
        self
    }
}

/// An impact speed that is known and that the `restored` acceleration, integrated from rest, does not reach.
fn other_speed(restored: &Series, KnownContact { time, speed }: KnownContact) -> Option<Warning> {
    let reached = -integrate::once(restored, 0.0).at(time)?;
    let differs = (reached / speed - 1.0).abs() > OTHER_SPEED;
    differs.then_some(Warning::ImpactSpeedDiffers { reached, speed })
}

/// Friction only lowers the speed: one above that of the free fall is reported, or refused where no error of
/// measurement explains it.
fn faster_than_fall(speed: f64, tower: &Tower) -> Result<Option<Warning>, DropError> {
    let (ideal, height) = (tower.ideal_speed(), tower.height.metres());
    let excess = speed / ideal - 1.0;
    if excess > FASTER {
        return Err(DropError::FasterThanFall { speed, ideal, height });
    }
    // Beyond rounding: a speed that is known stands for both.
    Ok((excess > 1e-9).then_some(Warning::FasterThanFreeFall { excess, height }))
}

/// The report that there was no laser.
fn without_laser(speed_from: SpeedSource) -> Option<Warning> {
    match speed_from {
        SpeedSource::Laser => None,
        SpeedSource::Fall => Some(Warning::NoLaser),
        SpeedSource::Given => Some(Warning::NoLaserNoHeight),
        SpeedSource::Stated => Some(Warning::ContactStated),
    }
}
