//! The last stage before the result: a drop without the figures that an accelerometer at the end of its range falsifies.

use super::clipping::Clipping;
use super::corrected::Restoration;
use super::evaluated::Evaluated;
use super::plausibility::{self, Impact};
use super::result::{Drop, Intervals};
use crate::experiment::Warning;
use crate::experiment::release::Release;
use crate::signal::{Recording, Series, column};

/// An evaluated drop whose clipping is known.
pub(super) struct Screened {
    evaluated: Evaluated,
    clipping: Option<Clipping>,
    /// The report of a laser that was out of its range.
    laser: Option<Warning>,
}

impl Screened {
    /// Screens a drop by the `reading` (m/s²) that it was reduced from.
    pub(super) fn new(evaluated: Evaluated, reading: &Series, laser: Option<Warning>) -> Screened {
        let clipping = Clipping::find(reading, evaluated.contact().time);
        Screened { evaluated, clipping, laser }
    }

    /// The reduced drop with all reports, among them those of plausibility by the `reading` (m/s²) with this `release`.
    pub(super) fn into_drop(self, reading: &Series, release: Release) -> Drop {
        let Screened { evaluated, clipping, laser } = self;
        let Evaluated { motion, intervals, guide_friction, film_absorption, warnings } = evaluated;
        // A peak that is cut off is missing in every later speed, and so in the energy after the rebound.
        let is_whole = clipping.is_none();
        let energy_absorption = motion.energy_absorption.ok().filter(|_| is_whole);
        let saturated = clipping.map(|clipping| saturated(&clipping, &motion.signals));
        let (contact, ideal_speed, signals) = (motion.contact(), motion.ideal_speed, &motion.signals);
        let impact = Impact { contact, ideal_speed, signals, energy_absorption };
        let implausible = plausibility::warnings(&impact, reading, release.rest_end);
        let reports = [motion.warnings(is_whole), warnings, laser.into_iter().chain(saturated).collect(), implausible];
        let without_absorption = |intervals| Intervals { energy_absorption: None, ..intervals };
        Drop {
            release,
            acceleration: motion.acceleration().clone(),
            contact: *motion.contact(),
            ideal_speed: motion.ideal_speed,
            time_constant: motion.time_constant(),
            intervals: if is_whole { intervals } else { intervals.map(without_absorption) },
            guide_friction,
            ramp: match motion.restoration() {
                Restoration::Coupling(_) => None,
                Restoration::Ramp(ramp) => Some(ramp),
            },
            offset: motion.offset(),
            energy_absorption,
            film_absorption: film_absorption.filter(|_| is_whole),
            total_energy_drift: motion.total_energy_drift,
            clipped_from: clipping.map(|clipping| clipping.start - motion.contact().time),
            signals: motion.signals,
            warnings: reports.concat(),
        }
    }
}

/// The report of a reading at the end of the range, with the extremes that may therefore be exceeded.
fn saturated(clipping: &Clipping, signals: &Recording) -> Warning {
    let extreme = |name: &str, of: fn(&Series) -> Option<[f64; 2]>| of(&signals.series(name)?).map(|[_, value]| value);
    Warning::Saturated {
        reading: clipping.level,
        start: clipping.start,
        duration: clipping.duration,
        peak: extreme(column::ACCELERATION_FILTERED.name, Series::largest).unwrap_or(f64::NAN),
        deepest: extreme(column::DISPLACEMENT.name, Series::smallest).unwrap_or(f64::NAN),
    }
}
