//! The second stage: an acceleration with its low frequencies restored, and first contact in it.

use super::time_constant::Coupling;
use crate::experiment::Warning;
use crate::experiment::contact::Contact;
use crate::experiment::ramp::GravityRamp;
use crate::signal::Series;

/// The correction that restored the low frequencies of an acceleration.
#[derive(Clone, Copy, Debug)]
pub(super) enum Restoration {
    /// The inverse of AC coupling.
    Coupling(Coupling),
    /// The mirrored release.
    Ramp(GravityRamp),
}

/// A corrected acceleration whose contact is located.
#[derive(Clone, Debug)]
pub(super) struct Corrected {
    /// Acceleration from the end of the rest on, m/s².
    pub acceleration: Series,
    /// First contact.
    pub contact: Contact,
    /// The correction.
    pub restoration: Restoration,
    /// Reading of the sensor at rest, m/s².
    pub offset: f64,
    /// The report of a known speed that is not reached, or of a zero that is beyond the scatter of the rest.
    pub warning: Option<Warning>,
}
