//! Time series as values: what a channel and a recording are.

/// One measured or computed quantity over the common time axis of its [`Recording`].
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name with its SI unit as suffix, e.g. `velocity_m_s`.
    pub name: String,
    /// One value a sample; `NaN` where nothing was measured.
    pub values: Vec<f64>,
}

/// Channels that share one time axis.
#[derive(Clone, Debug, Default, PartialEq)]
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
}
