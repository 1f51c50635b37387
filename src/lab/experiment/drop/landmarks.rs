//! Times of events in a recording of a drop.

use super::error::DropError;
use super::reduce::even;
use super::result::Drop;
use crate::experiment::contact::ContactError;
use crate::experiment::coupling::CouplingError;
use crate::experiment::release::{Release, ReleaseError};
use crate::signal::{Series, column};

/// Times of a drop on the recording's clock, s, as far as they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Landmarks {
    /// When the reading begins to fall.
    pub release: Option<f64>,
    /// When the impactor is released at the latest; of a recording that is not reduced.
    pub release_end: Option<f64>,
    /// First contact.
    pub contact: Option<f64>,
    /// Latest time of a contact that was not found.
    pub latest_contact: Option<f64>,
    /// Time near which a contact was sought and not found.
    pub sought_contact: Option<f64>,
    /// When the reading has risen by one gravity in the impact; of a recording that is not reduced.
    pub impact: Option<f64>,
    /// Largest travel; none where the impactor still descends at the end.
    pub lowest_point: Option<f64>,
    /// Largest upward velocity after the lowest point.
    pub rebound: Option<f64>,
}

impl Landmarks {
    /// The landmarks of a reduced drop.
    pub fn of_drop(drop: &Drop) -> Landmarks {
        let clock = |[time, _]: [f64; 2]| drop.contact.time + time;
        let rebound = drop.rebound();
        Landmarks {
            release: Some(drop.release.flank[0]),
            contact: Some(drop.contact.time),
            lowest_point: drop.lowest_point().map(clock),
            rebound: rebound.map(clock),
            ..Landmarks::default()
        }
    }

    /// What an `acceleration` (m/s²) shows under `gravity` (m/s²) although its reduction failed with this `error`.
    pub fn of_failed(acceleration: &Series, gravity: f64, error: &DropError) -> Landmarks {
        let found = even(acceleration).ok().and_then(|reading| Release::find(&reading, gravity).ok());
        let found = found.map_or_else(Landmarks::default, |release| Landmarks {
            release: Some(release.flank[0]),
            release_end: Some(release.flank[1]),
            impact: Some(release.blow),
            ..Landmarks::default()
        });
        match *error {
            DropError::Release(ReleaseError::NoRelease { blow, .. }) => Landmarks { impact: Some(blow), ..found },
            DropError::Release(ReleaseError::NoRest { release, .. }) => Landmarks { release: Some(release), ..found },
            DropError::Coupling(CouplingError::NoFall { release, contact }) => {
                Landmarks { release_end: Some(release), latest_contact: Some(contact), ..found }
            }
            DropError::Contact(ContactError::NoCrossing { near } | ContactError::NoOnset { near, .. }) => {
                Landmarks { sought_contact: Some(near), ..found }
            }
            _ => found,
        }
    }

    /// The landmarks that are known with their names, in the order of their times.
    pub fn named(&self) -> Vec<(&'static str, f64)> {
        let all = [
            ("release", self.release),
            ("end of release", self.release_end),
            ("contact", self.contact),
            ("latest contact", self.latest_contact),
            ("contact sought", self.sought_contact),
            ("impact (1 g)", self.impact),
            ("lowest point", self.lowest_point),
            ("rebound", self.rebound),
        ];
        let mut known: Vec<(&str, f64)> = all.into_iter().filter_map(|(name, time)| Some((name, time?))).collect();
        known.sort_by(|a, b| a.1.total_cmp(&b.1));
        known
    }
}

impl Drop {
    /// Time from contact (s) and place (m) of the lowest point; none where the impactor still descends at the end, and
    /// where the accelerometer was at the end of its range before.
    pub fn lowest_point(&self) -> Option<[f64; 2]> {
        let displacement = self.signals.series(column::DISPLACEMENT.name)?;
        let is_measured = |time: f64| self.clipped_from.is_none_or(|clipped| time < clipped);
        displacement.smallest().filter(|[time, _]| displacement.time().last() > Some(time) && is_measured(*time))
    }

    /// Time from contact (s) and velocity (m/s, upward) at which the film lets go of the impactor: the largest after the
    /// lowest point. None without a lowest point, without motion upward after it, and where the accelerometer was at the
    /// end of its range before.
    pub fn rebound(&self) -> Option<[f64; 2]> {
        let [lowest, _] = self.lowest_point()?;
        let after = self.signals.series(column::VELOCITY.name)?.window([lowest, f64::INFINITY]);
        let is_measured = |time: f64| self.clipped_from.is_none_or(|clipped| time < clipped);
        after.largest().filter(|[time, velocity]| *velocity > 0.0 && is_measured(*time))
    }
}
