//! The first stage: a levelled reading whose rest and release are known, and how it is corrected.

use super::corrected::{Corrected, Restoration};
use super::error::DropError;
use super::evaluated::Evaluated;
use super::friction;
use super::integrated::Integrated;
use super::time_constant::{self, Choice, Coupling, Disagreement, Known};
use super::tower::{Height, KnownContact, Reduction, Tower};
use crate::experiment::Warning;
use crate::experiment::contact::{self, Contact, ContactError, SpeedSource};
use crate::experiment::coupling;
use crate::experiment::ramp::GravityRamp;
use crate::experiment::release::Release;
use crate::signal::{Series, integrate};
use membrane::engine::GuideFriction;

/// Share by which the covered height may differ from the stated one; an error of 1 % in the time constant makes 1 %.
const OTHER_HEIGHT: f64 = 0.05;
/// Share by which the reached impact speed may differ from the stated one.
const OTHER_SPEED: f64 = 0.05;
/// Halvings of an interval of time constants at which the fall does not close.
const HALVINGS: u32 = 10;

/// A levelled reading whose rest and release are known.
pub(super) struct Levelled<'a> {
    /// The reading from the end of the rest on, without the sensor's offset.
    reading: Series,
    release: Release,
    laser: Option<&'a Series>,
    tower: &'a Tower,
    reduction: &'a Reduction,
}

impl<'a> Levelled<'a> {
    /// Levels an evenly sampled `reading` (m/s²) by its rest, beside the cleaned `laser` (m).
    pub(super) fn find(
        reading: &Series,
        laser: Option<&'a Series>,
        tower: &'a Tower,
        reduction: &'a Reduction,
    ) -> Result<Levelled<'a>, DropError> {
        let release = Release::find(reading, tower.body.gravity)?;
        let moving = reading.window([release.rest_end, f64::INFINITY]);
        let reading = moving.with_values(moving.values().iter().map(|r| r - release.offset).collect());
        Ok(Levelled { reading, release, laser, tower, reduction })
    }

    /// Rest and release.
    pub(super) fn release(&self) -> Release {
        self.release
    }

    /// The drop by the inverse of AC coupling, with the time constant in s or the one that the recording determines.
    pub(super) fn by_coupling(&self, time_constant: Option<f64>) -> Result<Evaluated, DropError> {
        let choice = match time_constant {
            Some(given) => time_constant::given(given),
            None => self.time_constant()?,
        };
        let best = self.coupled(choice.best)?;
        let ends = choice.ends.map(|ends| self.closing(choice.best, ends, best.is_doubtful()));
        let ends: Vec<Integrated> = ends.into_iter().flatten().flatten().collect();
        let falls: Vec<&Series> = std::iter::once(&best).chain(&ends).map(Integrated::acceleration).collect();
        let friction = friction::fit(&falls, self.undisturbed(), self.tower.body);
        let disagreement = choice.disagreement.into_iter().map(|of| self.disagreement(of, friction.as_ref(), &best));
        let mut warnings: Vec<Warning> = disagreement.collect();
        if time_constant.is_some() && best.contact().speed_from == SpeedSource::Laser {
            warnings.extend(self.other_height(&best));
        }
        Ok(Evaluated::new(best, &ends, friction, self.tower.body, warnings))
    }

    /// The drop by the mirrored release.
    pub(super) fn by_ramp(&self) -> Result<Evaluated, DropError> {
        let ramp = GravityRamp::fit(&self.reading, self.release.flank)?;
        let ramped = |contact: f64| {
            let mirrored = self.reading.samples().map(|[t, r]| r + ramp.mirrored(t, contact));
            self.reading.with_values(mirrored.collect())
        };
        let contact = match (self.reduction.contact, self.laser) {
            (Some(known), _) => self.known(known)?,
            (None, Some(laser)) => contact::by_laser(ramped, laser, self.start(), self.ideal_contact())?,
            (None, None) => return Err(DropError::LaserNeeded),
        };
        let corrected = Corrected {
            acceleration: ramped(contact.time),
            contact,
            restoration: Restoration::Ramp(ramp),
            offset: self.release.offset,
            warning: None,
        };
        Ok(Evaluated::without_intervals(Integrated::new(corrected, self.tower, self.reduction)?))
    }

    /// The time constant of the recording: by laser and height, or by the fall alone.
    fn time_constant(&self) -> Result<Choice, DropError> {
        let fall = coupling::time_constant(&self.reading, self.undisturbed());
        match self.laser.filter(|_| self.reduction.contact.is_none()) {
            Some(laser) => {
                let height = match self.tower.height {
                    Height::Known(height) => Some(height),
                    Height::OfSpeed(_) => None,
                };
                let known = Known { reading: &self.reading, zero: self.release.zero, height, fall };
                time_constant::by_laser(&known, |restored| self.by_laser(restored, laser))
            }
            None => {
                let gravity = self.tower.body.gravity;
                let of_speed = coupling::inverse_with_friction_of_speed(&self.reading, self.undisturbed(), gravity);
                Ok(time_constant::by_fall(&fall?, of_speed))
            }
        }
    }

    /// Contact by the laser, of a restored acceleration.
    fn by_laser(&self, restored: &Series, laser: &Series) -> Result<Contact, ContactError> {
        contact::by_laser(|_| restored.clone(), laser, self.start(), self.ideal_contact())
    }

    /// The motion with this coupling.
    fn coupled(&self, coupling: Coupling) -> Result<Integrated, DropError> {
        Integrated::new(self.restored(coupling)?, self.tower, self.reduction)
    }

    /// The acceleration with this coupling undone, and its contact.
    fn restored(&self, coupling: Coupling) -> Result<Corrected, DropError> {
        let restored = |offset: f64| {
            time_constant::restored(&self.reading, Coupling { offset: coupling.offset + offset, ..coupling })
        };
        let (acceleration, contact, offset, warning) = match (self.reduction.contact, self.laser) {
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
        let offset = self.release.offset + coupling.offset + offset;
        Ok(Corrected { acceleration, contact, restoration: Restoration::Coupling(coupling), offset, warning })
    }

    /// The motions at the ends of an interval about `best`, which is as wide as it is where the fall closes without a
    /// doubt that `best` does not leave.
    fn closing(&self, best: Coupling, ends: [Coupling; 2], is_doubtful: bool) -> [Option<Integrated>; 2] {
        let closed = |coupling| self.coupled(coupling).ok().filter(|motion| is_doubtful || !motion.is_doubtful());
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
                        Some(motion) => (inside, found) = (middle, Some(motion)),
                        None => outside = middle,
                    }
                }
                found
            })
        })
    }

    /// The report of sources that disagree, with the `friction` of the fall.
    fn disagreement(
        &self,
        disagreement: Disagreement,
        friction: Option<&GuideFriction>,
        motion: &Integrated,
    ) -> Warning {
        match disagreement {
            Disagreement::Height { covered } => {
                Warning::DropHeightDiffers { covered, height: self.tower.height.metres() }
            }
            Disagreement::LaserSpeed { reached, laser } => Warning::LaserSpeedDiffers { reached, laser },
            Disagreement::Friction { constant } => {
                let velocity = motion.contact().velocity;
                let friction = friction.map(|friction| [0.0, velocity].map(|v| friction.force_at(v)));
                Warning::GuideFrictionChanges {
                    time_constant: motion.time_constant().unwrap_or(f64::NAN),
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
    fn other_height(&self, motion: &Integrated) -> Option<Warning> {
        let height = self.tower.height.metres();
        let covered = -integrate::twice(motion.acceleration(), 0.0, 0.0).value_at(motion.contact().time)?;
        let differs = (covered / height - 1.0).abs() > OTHER_HEIGHT;
        differs.then_some(Warning::DropHeightDiffers { covered, height })
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

/// An impact speed that is known and that the `restored` acceleration, integrated from rest, does not reach.
fn other_speed(restored: &Series, KnownContact { time, speed }: KnownContact) -> Option<Warning> {
    let reached = -integrate::once(restored, 0.0).value_at(time)?;
    let differs = (reached / speed - 1.0).abs() > OTHER_SPEED;
    differs.then_some(Warning::ImpactSpeedDiffers { reached, speed })
}
