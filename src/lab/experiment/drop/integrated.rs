//! The third stage: motion and energies from contact on.

use super::corrected::{Corrected, Restoration};
use super::error::DropError;
use super::motion;
use super::tower::{Reduction, Tower};
use crate::experiment::Warning;
use crate::experiment::absorption::{AbsorptionError, energy_absorption};
use crate::experiment::contact::{Contact, SpeedSource};
use crate::signal::column::Column;
use crate::signal::filter::{self, Standard};
use crate::signal::{Recording, Series, column};

/// Share by which a speed may exceed that of the ideal fall; a laser determines it to half of that.
const FASTER: f64 = 0.01;

/// Motion and energies of a corrected acceleration after contact.
pub(super) struct Integrated {
    corrected: Corrected,
    /// Speed of the ideal fall, m/s.
    pub ideal_speed: f64,
    /// Signals from contact on.
    pub signals: Recording,
    /// D of equation 26.
    pub energy_absorption: Result<f64, AbsorptionError>,
    /// Largest deviation of the total energy from its first value, over that.
    pub total_energy_drift: f64,
    /// The report of a speed above that of the free fall.
    faster: Option<Warning>,
}

impl Integrated {
    /// Integrates a corrected acceleration from its contact on.
    pub(super) fn new(corrected: Corrected, tower: &Tower, reduction: &Reduction) -> Result<Integrated, DropError> {
        let Corrected { acceleration, contact, .. } = &corrected;
        let filtered = match reduction.class {
            Some(class) => filter::channel(acceleration, class, Standard::Iso6487)?,
            None => acceleration.clone(),
        };
        let signals = motion::signals(acceleration, &filtered, contact, tower.body)?;
        let faster = faster_than_fall(-contact.velocity, tower)?;
        let channel = |column: Column| signals.channel(column.name).unwrap_or_default();
        Ok(Integrated {
            ideal_speed: tower.ideal_speed(),
            energy_absorption: energy_absorption(tower.body, channel(column::VELOCITY), channel(column::DISPLACEMENT)),
            total_energy_drift: motion::drift(channel(column::TOTAL_ENERGY)),
            faster,
            signals,
            corrected,
        })
    }

    /// First contact.
    pub(super) fn contact(&self) -> &Contact {
        &self.corrected.contact
    }

    /// The corrected acceleration from the end of the rest on, m/s².
    pub(super) fn acceleration(&self) -> &Series {
        &self.corrected.acceleration
    }

    /// The correction of the acceleration.
    pub(super) fn restoration(&self) -> Restoration {
        self.corrected.restoration
    }

    /// Time constant of the coupling that was undone, s.
    pub(super) fn time_constant(&self) -> Option<f64> {
        match self.corrected.restoration {
            Restoration::Coupling(coupling) => Some(coupling.time_constant()),
            Restoration::Ramp(_) => None,
        }
    }

    /// Reading of the sensor at rest, m/s².
    pub(super) fn offset(&self) -> f64 {
        self.corrected.offset
    }

    /// Whether its fall closes with an offset alone that the rest does not show.
    pub(super) fn is_doubtful(&self) -> bool {
        matches!(self.corrected.warning, Some(Warning::ZeroOffsetDoubtful { .. }))
    }

    /// Reports of the correction and the motion; that there is no energy absorption only if `with_absorption`.
    pub(super) fn warnings(&self, with_absorption: bool) -> Vec<Warning> {
        let absorption = self.energy_absorption.err().filter(|_| with_absorption);
        let without_laser = without_laser(self.contact().speed_from);
        let missing = absorption.map(|reason| Warning::NoEnergyAbsorption { reason });
        let warnings = [self.faster.clone(), without_laser, missing, self.corrected.warning.clone()];
        warnings.into_iter().flatten().collect()
    }
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
