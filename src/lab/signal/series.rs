//! Values over time: one series, and channels over one time axis.

use serde::{Deserialize, Serialize};

use base::budget::Numbers;

/// One quantity over its own time axis; cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    time: Numbers,
    values: Numbers,
}

impl Series {
    /// A series of `values` at `time` (s, strictly increasing); the longer of the two is cut.
    pub fn new(time: impl Into<Numbers>, values: impl Into<Numbers>) -> Series {
        let (time, values) = (time.into(), values.into());
        let count = time.len().min(values.len());
        if time.len() == values.len() {
            return Series { time, values };
        }
        Series { time: time[..count].into(), values: values[..count].into() }
    }

    /// Sample times, s.
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// One value a sample; `NaN` where nothing was measured.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is no sample at all.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Whether every sample was measured.
    pub fn is_complete(&self) -> bool {
        self.values.iter().all(|v| v.is_finite())
    }

    /// Other values on the same time axis.
    pub fn with_values(&self, values: Vec<f64>) -> Series {
        Series::new(self.time.clone(), values)
    }

    /// The samples with `from <= time <= to`.
    pub fn window(&self, [from, to]: [f64; 2]) -> Series {
        let start = self.time.partition_point(|t| *t < from);
        let end = self.time.partition_point(|t| *t <= to).max(start);
        Series::new(&self.time[start..end], &self.values[start..end])
    }

    /// Time and value of the largest measured sample; the first of several.
    pub fn largest(&self) -> Option<[f64; 2]> {
        self.best(|value, best| value > best)
    }

    /// Time and value of the smallest measured sample; the first of several.
    pub fn smallest(&self) -> Option<[f64; 2]> {
        self.best(|value, best| value < best)
    }

    fn best(&self, beats: impl Fn(f64, f64) -> bool) -> Option<[f64; 2]> {
        let measured = self.samples().filter(|[_, value]| value.is_finite());
        measured.reduce(|best, sample| if beats(sample[1], best[1]) { sample } else { best })
    }

    /// Time and value, sample by sample.
    pub fn samples(&self) -> impl Iterator<Item = [f64; 2]> + Clone + '_ {
        self.time.iter().zip(self.values.iter()).map(|(t, v)| [*t, *v])
    }

    /// Value at `time`, linear between samples; `None` outside the samples or beside an unmeasured one.
    pub fn value_at(&self, time: f64) -> Option<f64> {
        interpolated(&self.time, &self.values, time)
    }
}

/// Value at time `t`, linear between samples; `None` outside them or beside an unmeasured one.
pub(crate) fn interpolated(time: &[f64], values: &[f64], t: f64) -> Option<f64> {
    let after = time.partition_point(|sample| *sample < t);
    if after == time.len() {
        return None;
    }
    if time[after] == t {
        return Some(values[after]).filter(|v| v.is_finite());
    }
    let before = after.checked_sub(1)?;
    let share = (t - time[before]) / (time[after] - time[before]);
    Some(values[before] + share * (values[after] - values[before])).filter(|v| v.is_finite())
}

/// Fewest equal samples in a row that are a flat top.
const FEWEST_EQUAL: usize = 5;
/// Share of all that was read below which two values are the same but for the rounding of their units.
const ROUNDING: f64 = 1e-9;

/// First and last place of the longest run of samples at exactly the largest of the `values`; none where it is short.
pub(crate) fn flat_top(values: &[f64]) -> Option<[usize; 2]> {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let runs = values.chunk_by(|a, b| a == b).scan(0, |first, run| {
        *first += run.len();
        Some([*first - run.len(), *first - 1])
    });
    let flat = runs.filter(|[first, last]| values[*first] == most && last - first + 1 >= FEWEST_EQUAL);
    flat.max_by_key(|[first, last]| last - first)
}

/// The smallest distance of two of the `values`, beyond their rounding: one step of the converter.
///
/// The top of a pulse is a parabola whose width grows with the root of the depth below it, so that a step q holds a
/// reading of level L, of width w at L/2, for w √(2q/L).
pub(crate) fn quantum(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rounding = ROUNDING * sorted.last().zip(sorted.first()).map_or(0.0, |(most, least)| most - least);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    steps.filter(|step| *step > rounding).fold(f64::INFINITY, f64::min)
}

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
