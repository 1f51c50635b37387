//! Channels over one time axis.

use serde::{Deserialize, Serialize};

use super::Series;

/// One measured or computed quantity over the common time axis of its [`Recording`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// Name with its SI unit as suffix, e.g. `velocity_m_s`.
    pub name: String,
    /// One value a sample; `NaN` where nothing was measured.
    pub values: Vec<f64>,
}

/// Channels that share one time axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Recording {
    /// Sample times, s, strictly increasing.
    pub time: Vec<f64>,
    /// The channels, each as long as `time`.
    pub channels: Vec<Channel>,
}

impl Recording {
    /// The channel called `name`.
    pub fn channel(&self, name: &str) -> Option<&[f64]> {
        self.channels.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// The channel called `name` together with its time axis.
    pub fn series(&self, name: &str) -> Option<Series> {
        let values = self.channel(name)?;
        Some(Series::new(self.time.as_slice(), values))
    }

    /// Bytes of its numbers.
    pub fn size(&self) -> usize {
        size_of::<f64>() * (self.time.len() + self.channels.iter().map(|channel| channel.values.len()).sum::<usize>())
    }

    /// Puts `channel` behind the one called `before`, or last where there is none.
    pub fn insert_after(&mut self, before: &str, channel: Channel) {
        let place = self.channels.iter().position(|c| c.name == before);
        let place = place.map_or(self.channels.len(), |index| index + 1);
        self.channels.insert(place, channel);
    }
}
