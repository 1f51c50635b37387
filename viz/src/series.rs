//! Signals and moments on a timeline.

use re_sdk::RecordingStream;
use re_sdk::log::TimeColumn;

use crate::VizError;
use crate::stroke::Stroke;

/// The timeline of what is simulated or measured, in seconds since the start.
pub const TIME: &str = "time";

/// The timeline of a search, counted in iterations.
pub const ITERATION: &str = "iteration";

/// A place on a timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// On [`TIME`], s.
    Time(f64),
    /// On [`ITERATION`].
    Iteration(u32),
}

/// The places of the values of a signal.
#[derive(Clone, Debug, PartialEq)]
pub enum Places {
    /// On [`TIME`], s.
    Times(Vec<f64>),
    /// On [`ITERATION`].
    Iterations(Vec<u32>),
}

/// A curve over a timeline.
#[derive(Clone, Debug)]
pub struct SignalTrack {
    /// Entity path, e.g. `signals/velocity_m_s`.
    pub path: String,
    /// Label in the legend.
    pub label: String,
    /// Places of its values.
    pub places: Places,
    /// One value a place; `NaN` leaves a gap.
    pub values: Vec<f32>,
    /// Colour and width of its line.
    pub stroke: Stroke,
}

/// A chart of signals over the timeline that the viewer shows.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Quantity and unit.
    pub title: String,
    /// Paths of the signals it shows.
    pub signals: Vec<String>,
}

impl Moment {
    /// Sets the place of what is logged next.
    pub(crate) fn set(self, stream: &RecordingStream) {
        // Else a value on one timeline would also stand at the last place of the other.
        stream.reset_time();
        match self {
            Moment::Time(time) => stream.set_duration_secs(TIME, time),
            Moment::Iteration(number) => stream.set_time_sequence(ITERATION, number),
        }
    }
}

impl Places {
    pub(crate) fn len(&self) -> usize {
        match self {
            Places::Times(times) => times.len(),
            Places::Iterations(numbers) => numbers.len(),
        }
    }

    pub(crate) fn column(&self) -> TimeColumn {
        match self {
            Places::Times(times) => TimeColumn::new_duration_secs(TIME, times.iter().copied()),
            Places::Iterations(numbers) => TimeColumn::new_sequence(ITERATION, numbers.iter().copied()),
        }
    }
}

impl SignalTrack {
    pub(crate) fn check(&self) -> Result<(), VizError> {
        let (found, expected) = (self.values.len(), self.places.len());
        if found == expected {
            return Ok(());
        }
        Err(VizError::Samples { signal: self.path.clone(), found, expected })
    }
}
