//! A fitted relaxation.

use super::args::ShiftWord;
use lab::experiment::relaxation::{Master, PronyFit, ShiftFits, ShiftLawFit};

/// A fitted relaxation, with its master curve where it comes from several temperatures.
pub(super) struct Fitted {
    pub(super) source: String,
    pub(super) fit: PronyFit,
    pub(super) master: Option<(Master, ShiftFits)>,
}

impl Fitted {
    /// The law of the shift factors that is written: the one that is asked for, or the closer one.
    pub(super) fn shift(&self, asked: Option<ShiftWord>) -> Option<&ShiftLawFit> {
        let (_, fits) = self.master.as_ref()?;
        match asked {
            Some(ShiftWord::Wlf) => fits.wlf.as_ref(),
            Some(ShiftWord::Arrhenius) => fits.arrhenius.as_ref(),
            None => fits.better(),
        }
    }
}
