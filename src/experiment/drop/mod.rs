//! A drop test, from what the sensors read to contact, speed, travel and energies.

mod channels;
mod figures;
mod laser;
mod motion;
mod plausibility;
#[cfg(test)]
mod tests;

use thiserror::Error;

pub use channels::{ChannelNames, DropChannels, DropChannelsError};
pub use figures::Figures;

use super::absorption::{AbsorptionError, Body, energy_absorption};
use super::contact::{self, Contact, ContactError, Known, SpeedSource};
use super::coupling::{self, CouplingError};
use super::ramp::{GravityRamp, RampError};
use super::release::{Release, ReleaseError};
use crate::signal::filter::{self, ChannelFilter, FilterError, Standard};
use crate::signal::gap::{self, Gap};
use crate::signal::resample::{self, ResampleError};
use crate::signal::{Recording, Series, integrate};

/// What is known of a drop before its recording is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tower {
    pub body: Body,
    /// Height of fall, m.
    pub height: Height,
}

/// Where the fall begins above the film's upper face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// As set on the tower, m.
    Known(f64),
    /// That of the ideal fall to the impact speed that is known in its place, m.
    OfSpeed(f64),
}

impl Height {
    fn metres(self) -> f64 {
        match self {
            Height::Known(height) | Height::OfSpeed(height) => height,
        }
    }
}

impl Tower {
    /// Speed of the ideal fall √(2gH), m/s.
    fn ideal_speed(&self) -> f64 {
        (2.0 * self.body.gravity * self.height.metres()).sqrt()
    }

    /// What closes a fall that no laser saw.
    fn known(&self) -> Known {
        match self.height {
            Height::Known(height) => Known::Height(height),
            Height::OfSpeed(_) => Known::Speed(self.ideal_speed()),
        }
    }
}

/// How what the accelerometer does not show is put back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Correction {
    /// The exact inverse of AC coupling with the time constant in s, or with the one that the fall tells.
    Coupling { time_constant: Option<f64> },
    /// The release, mirrored and added after contact.
    Ramp,
}

/// How a recording is reduced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduction {
    pub correction: Correction,
    /// Channel frequency class of the filtered acceleration; none leaves it as corrected.
    pub class: Option<f64>,
}

impl Default for Reduction {
    /// Coupling with the fall's own time constant, CFC 1000.
    fn default() -> Reduction {
        Reduction { correction: Correction::Coupling { time_constant: None }, class: Some(1000.0) }
    }
}

/// A reduced drop.
#[derive(Clone, Debug, PartialEq)]
pub struct Drop {
    pub contact: Contact,
    /// Speed of the ideal fall √(2gH), m/s.
    pub ideal_speed: f64,
    /// Of the correction by coupling, s.
    pub time_constant: Option<f64>,
    /// Of the correction by the gravity ramp.
    pub ramp: Option<GravityRamp>,
    /// What the sensor reads at rest, m/s².
    pub offset: f64,
    /// Time from contact on (s): `displacement_m`, `velocity_m_s`, `acceleration_m_s2`, `acceleration_filtered_m_s2`,
    /// `kinetic_energy_J`, `potential_energy_J`, `absorbed_energy_J`, `total_energy_J`.
    pub signals: Recording,
    /// D of the paper's equation 11; none where the recording ends before the impactor turns round.
    pub energy_absorption: Option<f64>,
    /// Largest deviation of the total energy (equation 10) from its first value, over that.
    pub total_energy_drift: f64,
    /// What a reader of the figures should know.
    pub notes: Vec<String>,
}

/// Why a recording cannot be reduced.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DropError {
    #[error("the {what} is {value}, but must be positive")]
    NotPositive { what: &'static str, value: f64 },
    #[error("acceleration: {0}")]
    NotMeasured(Gap),
    #[error("acceleration: {0}")]
    Filter(#[from] FilterError),
    #[error("acceleration: {0}")]
    Resample(#[from] ResampleError),
    #[error(transparent)]
    Release(#[from] ReleaseError),
    #[error(transparent)]
    Ramp(#[from] RampError),
    #[error("acceleration: {0}; give the time constant (a DC-coupled sensor has an endless one, such as 1000 s)")]
    Coupling(#[from] CouplingError),
    #[error(transparent)]
    Contact(#[from] ContactError),
    #[error(
        "the impact speed of {speed:.3} m/s is above the {ideal:.3} m/s of an ideal fall over {height} m; is the height right?"
    )]
    FasterThanFall { speed: f64, ideal: f64, height: f64 },
    #[error("without a laser the gravity ramp tells no speed: use the correction by coupling")]
    LaserNeeded,
    #[error("acceleration: the recording ends with first contact at {contact:.4} s")]
    EndsAtContact { contact: f64 },
}

/// Reduces the `acceleration` that was read (m/s², upward) and, where there is one, the `laser`'s distance from the film's upper
/// face (m, upward; `NaN` out of range). Both have one clock and start with the impactor at rest.
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
    let seen = laser.map(laser::seen);
    let laser = seen.as_ref().map(|seen| &seen.series);
    let fall = Fall { zeroed: zeroed(&reading, &release), release, laser, tower, reduction };
    let mut drop = match reduction.correction {
        Correction::Coupling { time_constant } => fall.by_coupling(time_constant),
        Correction::Ramp => fall.by_ramp(),
    }?;
    drop.notes.extend(seen.as_ref().and_then(laser::Seen::note));
    let doubts = plausibility::doubts(&drop, &reading, rest_end);
    drop.notes.extend(doubts);
    Ok(drop)
}

/// A fall that covers a height which differs by a larger share is another one: a time constant that is 1 % off makes 1 %.
const OTHER_HEIGHT: f64 = 0.05;
/// Speeds above that of the ideal fall by a larger share are refused; a laser tells them to half of it.
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
        let time_constant = match time_constant {
            Some(given) => given,
            None => coupling::time_constant(&self.zeroed, self.undisturbed())?,
        };
        let restored = |offset: f64| restored(&self.zeroed, offset, time_constant);
        let Some(laser) = self.laser else {
            let closed = contact::by_fall(restored, self.tower.known(), self.release.zero)?;
            let mut drop = Drop::of(&restored(closed.offset), closed.contact, self.tower, self.reduction)?;
            drop.notes.extend(closed.doubtful.then(|| self.doubt(closed.offset)));
            return Ok(Drop {
                time_constant: Some(time_constant),
                offset: self.release.offset + closed.offset,
                ..drop
            });
        };
        let restored = restored(0.0);
        let contact = contact::by_laser(|_| restored.clone(), laser, self.start(), self.ideal_contact())?;
        let mut drop = Drop::of(&restored, contact, self.tower, self.reduction)?;
        drop.notes.extend(self.other_height(&restored, contact.time));
        Ok(Drop { time_constant: Some(time_constant), offset: self.release.offset, ..drop })
    }

    /// What an offset that only just closes the fall without a laser makes one ask.
    fn doubt(&self, offset: f64) -> String {
        let (error, what) = (self.release.zero.error(), self.tower.known().what());
        format!(
            "closing the fall moves the sensor's zero by {offset:.3} m/s², though the rest tells it to {error:.4} m/s²: is the {what} right?"
        )
    }

    /// Said where the restored acceleration, integrated from rest, covers another height than the one that is known.
    fn other_height(&self, restored: &Series, contact: f64) -> Option<String> {
        let height = self.tower.height.metres();
        let covered = -integrate::twice(restored, 0.0, 0.0).at(contact)?;
        let differs = (covered / height - 1.0).abs() > OTHER_HEIGHT;
        differs.then(|| {
            format!("integrated from rest the fall covers {covered:.2} m up to contact, not {height} m: is the height right?")
        })
    }

    fn by_ramp(&self) -> Result<Drop, DropError> {
        let laser = self.laser.ok_or(DropError::LaserNeeded)?;
        let ramp = GravityRamp::fit(&self.zeroed, self.release.flank)?;
        let ramped = |contact: f64| ramped(&self.zeroed, &ramp, contact);
        let contact = contact::by_laser(ramped, laser, self.start(), self.ideal_contact())?;
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

    /// The part that tells the time constant, s: after the magnet let go, before the earliest possible contact.
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

/// s; few times that are written twice or left out do not move it.
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

fn restored(zeroed: &Series, offset: f64, time_constant: f64) -> Series {
    let reading = zeroed.with_values(zeroed.values().iter().map(|r| r - offset).collect());
    coupling::restored(&reading, time_constant)
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
        let mut notes = Vec::new();
        notes.extend(faster_than_fall(-contact.velocity, tower)?);
        notes.extend(without_laser(contact.speed_from).map(String::from));
        let channel = |name| signals.channel(name).unwrap_or_default();
        let absorption = energy_absorption(tower.body, channel("velocity_m_s"), channel("displacement_m"));
        let energy_absorption = absorption.map_err(|reason| notes.push(without_absorption(reason))).ok();
        let total_energy_drift = motion::drift(channel("total_energy_J"));
        Ok(Drop {
            contact,
            ideal_speed: tower.ideal_speed(),
            time_constant: None,
            ramp: None,
            offset: 0.0,
            energy_absorption,
            total_energy_drift,
            signals,
            notes,
        })
    }
}

/// Friction only takes speed: one above that of the ideal fall is noted, or refused where no error of measurement explains it.
fn faster_than_fall(speed: f64, tower: &Tower) -> Result<Option<String>, DropError> {
    let (ideal, height) = (tower.ideal_speed(), tower.height.metres());
    let above = speed / ideal - 1.0;
    if above > FASTER {
        return Err(DropError::FasterThanFall { speed, ideal, height });
    }
    // Beyond rounding: a speed that is known stands for both.
    Ok((above > 1e-9).then(|| {
        format!(
            "the impact speed is {:.2} % above that of an ideal fall over {height} m: is the height right?",
            100.0 * above
        )
    }))
}

/// What stands in for a laser.
fn without_laser(speed_from: SpeedSource) -> Option<&'static str> {
    match speed_from {
        SpeedSource::Laser => None,
        SpeedSource::Fall => {
            Some("no laser: contact and speed from the fall over the known height and the onset of the force")
        }
        SpeedSource::Given => {
            Some("no laser and no height: contact from the fall to the known speed and the onset of the force")
        }
    }
}

fn without_absorption(reason: AbsorptionError) -> String {
    match reason {
        AbsorptionError::NoUnloading => {
            "no energy absorption: the recording ends before the impactor turns round".into()
        }
        other => format!("no energy absorption: {other}"),
    }
}
