//! The quantities that colour films, their colour bar, the scales of axes and the colours of lines.

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::archetypes::{LineStrips2D, Points2D};
use re_sdk_types::components::Radius;

/// The timeline of what is simulated or measured, in seconds since the start.
pub const TIME: &str = "time";

/// A nodal value that colours films.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// One word of letters, e.g. `md`.
    pub key: &'static str,
    /// Title of its tab.
    pub title: String,
    /// Name with its unit, over the bar of colours.
    pub words: String,
    /// Values that get the first and the last colour.
    pub range: [f32; 2],
    /// Colours at equal distances over the range, two or more; sRGB.
    pub colours: &'static [[u8; 3]],
}

/// Colours that the bar is drawn with, one above the other.
const BANDS: usize = 96;

/// Width of the bar over its height.
const WIDTH: f32 = 0.07;

impl Quantity {
    /// Entity of the bar.
    pub(crate) fn legend(&self) -> String {
        format!("legends/{}", self.key)
    }

    /// Logs the bar: colours from bottom to top.
    pub(crate) fn log_bar(&self, stream: &RecordingStream) -> RecordingStreamResult<()> {
        let middle = |band: usize| (band as f32 + 0.5) / BANDS as f32;
        let [low, high] = self.range;
        let values: Vec<f32> = (0..BANDS).map(|band| low + middle(band) * (high - low)).collect();
        let strips = (0..BANDS).map(|band| [[0.0, 1.0 - middle(band)], [WIDTH, 1.0 - middle(band)]]);
        let bar = LineStrips2D::new(strips)
            .with_colors(colours(self.colours, &values, self.range))
            .with_radii([Radius::new_scene_units(0.8 / BANDS as f32)]);
        stream.log_static(format!("{}/bar", self.legend()), &bar)
    }

    /// Logs the numbers beside the bar from a time (s) on; earlier snapshots keep the numbers of their range.
    pub(crate) fn log_numbers(&self, stream: &RecordingStream, from: f64) -> RecordingStreamResult<()> {
        stream.set_duration_secs(TIME, from);
        let scale = Scale::over(self.range.iter().map(|end| f64::from(*end)), false);
        let numbers = scale.ticks().into_iter().map(|(share, words)| ([2.6 * WIDTH, 1.0 - share as f32], words));
        let title = ([2.0 * WIDTH, -0.06], self.words.clone());
        let (places, words): (Vec<[f32; 2]>, Vec<String>) = numbers.chain([title]).unzip();
        let labels = Points2D::new(places)
            .with_labels(words)
            .with_show_labels(true)
            .with_colors([GREY])
            .with_radii([Radius::new_ui_points(0.0)]);
        stream.log(format!("{}/numbers", self.legend()), &labels)
    }
}

/// Colour of text and guide lines.
pub(crate) const GREY: [u8; 3] = [128, 128, 132];

/// Number of distinct colours: equal neighbours compress.
const STEPS: f32 = 64.0;

/// Colours of `values` from those of `map`, at equal distances from the lower to the upper end of `range`; what is not a
/// number gets the first.
pub(crate) fn colours<'v>(
    map: &'v [[u8; 3]],
    values: &'v [f32],
    [low, high]: [f32; 2],
) -> impl Iterator<Item = [u8; 3]> + 'v {
    // One value has no span; all get the first colour instead of a NaN.
    let span = (high - low).max(f32::MIN_POSITIVE);
    values.iter().map(move |value| colour_at(map, (value - low) / span))
}

fn colour_at(map: &[[u8; 3]], share: f32) -> [u8; 3] {
    let last = map.len() - 1;
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    let place = (share * STEPS).round() / STEPS * last as f32;
    // The upper end itself has no colour above it.
    let below = (place as usize).min(last - 1);
    let rest = place - below as f32;
    let mix = |i: usize| {
        let [from, to] = [map[below][i], map[below + 1][i]].map(f32::from);
        (from + (to - from) * rest).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}

/// Colour and width of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// sRGB.
    pub colour: [u8; 3],
    /// Points of the screen.
    pub width: f32,
}

/// Wong's palette (Nature Methods 8, 441, 2011) without its black and yellow, which have no contrast on dark and light
/// backgrounds.
const COLOURS: [[u8; 3]; 6] =
    [[0, 114, 178], [230, 159, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [213, 94, 0]];

impl Stroke {
    /// The line of the `index`-th curve of a chart.
    pub fn nth(index: usize) -> Stroke {
        Stroke { colour: COLOURS[index % COLOURS.len()], width: 1.5 }
    }

    /// The line of a reference, such as a measurement: broad and grey, visible beneath the others.
    pub fn target() -> Stroke {
        Stroke { colour: GREY, width: 5.0 }
    }

    /// The line of the reference of this one, where a chart has several: broad and paler.
    pub fn target_of(self) -> Stroke {
        let paler = |shade: u8| shade.midpoint(GREY[0]);
        Stroke { colour: self.colour.map(paler), ..Stroke::target() }
    }

    /// A thin guide line.
    pub fn faint(self) -> Stroke {
        Stroke { width: 1.0, ..self }
    }
}

/// Intended number of intervals between ticks.
const SPACES: f64 = 5.0;

/// Least span of an axis: the ticks of a smaller one have equal labels.
const LEAST_SPAN: f64 = 1e-300;

/// An axis with its ends and ticks, all as numbers on the page: logarithms where it is by decades.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    logarithmic: bool,
    low: f64,
    high: f64,
}

impl Scale {
    /// An axis that covers all of `values`.
    pub(crate) fn over(values: impl Iterator<Item = f64>, logarithmic: bool) -> Scale {
        let placed = values.filter_map(|value| laid(value, logarithmic));
        let (low, high) = placed.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = match high - low {
            // Ends so close that steps between them are lost in their last digits are one value.
            span if span > LEAST_SPAN && span > 1e-12 * low.abs().max(high.abs()) => (low, high),
            _ if low.is_finite() => (low - 0.5 * low.abs().max(1.0), low + 0.5 * low.abs().max(1.0)),
            _ => (0.0, 1.0),
        };
        Scale { logarithmic, low, high }
    }

    /// This scale with the ends moved out to the next ticks.
    pub(crate) fn rounded(self) -> Scale {
        let step = step(self.high - self.low);
        // An end that is a tick but for round-off stays where it is.
        let out = |value: f64| (value / step - 1e-9).ceil() * step;
        Scale { low: -out(-self.low), high: out(self.high), ..self }
    }

    /// Share of the axis at a value; `None` where it is not drawn.
    pub(crate) fn share(&self, value: f64) -> Option<f64> {
        laid(value, self.logarithmic).map(|value| (value - self.low) / (self.high - self.low))
    }

    /// Share of the axis and words of every tick.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let span = self.high - self.low;
        // On a logarithmic axis, steps of less than a power of ten have no round exponents.
        let step = if self.logarithmic { step(span).max(1.0) } else { step(span) };
        let [first, last] = [(self.low / step - 1e-9).ceil(), (self.high / step + 1e-9).floor()].map(|k| k as i64);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let words = |value: f64| match self.logarithmic {
            true => format!("1e{value:.0}"),
            false if !(1e-5..1e6).contains(&step) => format!("{value:.*e}", digits(value, step)),
            false => format!("{:.decimals$}", value + 0.0),
        };
        (first..=last).map(|k| k as f64 * step).map(|value| ((value - self.low) / span, words(value))).collect()
    }
}

fn laid(value: f64, logarithmic: bool) -> Option<f64> {
    let value = if logarithmic { value.log10() } else { value };
    value.is_finite().then_some(value)
}

/// Digits behind the point of a number in powers of ten that tell it from one a step away.
fn digits(value: f64, step: f64) -> usize {
    let power = |number: f64| number.log10().floor();
    (power(value.abs().max(step)) - power(step)).max(0.0) as usize
}

/// The round step (1, 2 or 5 times a power of ten) that comes closest to the wanted number of spaces.
fn step(span: f64) -> f64 {
    let raw = span / SPACES;
    let power = 10_f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= 0.8 * raw).unwrap_or(10.0);
    factor * power
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    const MAP: [[u8; 3]; 3] = [[68, 1, 84], [33, 145, 140], [253, 231, 37]];

    #[test]
    fn ends_and_middle_are_the_maps_own() {
        let colours: Vec<_> = colours(&MAP, &[-1.0, 0.0, 1.0, 2.0, 3.0, f32::NAN], [0.0, 2.0]).collect();
        let [first, middle, last] = MAP;
        assert_eq!(colours, [first, first, middle, last, last, first]);
    }

    #[test]
    fn a_range_of_nothing_is_one_colour() {
        assert_eq!(colours(&MAP, &[0.0], [0.0, 0.0]).collect::<Vec<_>>(), [MAP[0]]);
    }

    #[test]
    fn ticks_are_round_and_within_the_axis() {
        let words = |scale: &Scale| scale.ticks().into_iter().map(|(_, words)| words).collect::<Vec<_>>();
        let values = [0.3, 57.0, f64::NAN];
        let scale = Scale::over(values.into_iter(), false);
        assert_eq!(words(&scale), ["10", "20", "30", "40", "50"]);
        assert_eq!(words(&scale.rounded()), ["0", "10", "20", "30", "40", "50", "60"]);
        let scale = Scale::over([1e-3, 20.0, -1.0].into_iter(), true);
        assert_eq!(words(&scale), ["1e-3", "1e-2", "1e-1", "1e0", "1e1"]);
        assert_eq!(scale.share(-1.0), None);
        assert_eq!(words(&Scale::over([-0.12, 0.12].into_iter(), false)), ["-0.10", "-0.05", "0.00", "0.05", "0.10"]);
    }

    #[test]
    fn an_axis_of_one_value_or_none_has_a_width() {
        assert_eq!(Scale::over([2.0].into_iter(), false).share(2.0), Some(0.5));
        assert_eq!(Scale::over([f64::NAN].into_iter(), false).share(0.5), Some(0.5));
        let subnormal = Scale::over([0.0, 5e-324].into_iter(), false);
        assert_eq!((subnormal.share(0.0), subnormal.ticks().len()), (Some(0.5), 5));
    }

    #[test]
    fn neighbours_far_from_nothing_have_words_of_their_own() {
        for ends in [[1.0, 1.00001], [1.23e12, 1.23e12 + 4e6], [-2e-9, 3e-9]] {
            let words: Vec<String> =
                Scale::over(ends.into_iter(), false).ticks().into_iter().map(|(_, words)| words).collect();
            let different: BTreeSet<&String> = words.iter().collect();
            assert!(words.len() > 3 && different.len() == words.len(), "{words:?}");
        }
    }
}
