//! Signals over time.

use crate::VizError;
use crate::stroke::Stroke;

/// The timeline of what is simulated or measured, in seconds since the start.
pub const TIME: &str = "time";

/// A curve over time.
#[derive(Clone, Debug)]
pub struct SignalTrack {
    /// Entity path, e.g. `signals/velocity_m_s`.
    pub path: String,
    /// Label in the legend.
    pub label: String,
    /// Times of its values, s.
    pub times: Vec<f64>,
    /// One value a time; `NaN` leaves a gap.
    pub values: Vec<f32>,
    /// Colour and width of its line.
    pub stroke: Stroke,
}

/// A chart of signals.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Quantity and unit.
    pub title: String,
    /// Paths of the signals it shows.
    pub signals: Vec<String>,
}

impl SignalTrack {
    pub(crate) fn check(&self) -> Result<(), VizError> {
        let (found, expected) = (self.values.len(), self.times.len());
        if found == expected {
            return Ok(());
        }
        Err(VizError::Samples { signal: self.path.clone(), found, expected })
    }
}
