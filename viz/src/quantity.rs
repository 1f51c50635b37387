//! The quantities that colour films, their colour bar, the numbers of axes and the colours of lines.

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::archetypes::{LineStrips2D, Points2D};
use re_sdk_types::components::Radius;

use plot::Along;
use plot::viridis::viridis;
use report::geometry::Field;

/// The timeline of what is simulated or measured, in seconds since the start.
pub const TIME: &str = "time";

/// A field that colours films.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// The field.
    pub field: &'static Field,
    /// Values that get the first and the last colour, in its unit.
    pub range: [f32; 2],
}

/// Colours that the bar is drawn with, one above the other.
const BANDS: usize = 96;

/// Width of the bar over its height.
const WIDTH: f32 = 0.07;

impl Quantity {
    /// Entity of the bar.
    pub(crate) fn legend(&self) -> String {
        format!("legends/{}", self.field.key)
    }

    /// Logs the bar: colours from bottom to top.
    pub(crate) fn log_bar(&self, stream: &RecordingStream) -> RecordingStreamResult<()> {
        let middle = |band: usize| (band as f32 + 0.5) / BANDS as f32;
        let [low, high] = self.range;
        let values: Vec<f32> = (0..BANDS).map(|band| low + middle(band) * (high - low)).collect();
        let strips = (0..BANDS).map(|band| [[0.0, 1.0 - middle(band)], [WIDTH, 1.0 - middle(band)]]);
        let bar = LineStrips2D::new(strips)
            .with_colors(colours(&values, self.range))
            .with_radii([Radius::new_scene_units(0.8 / BANDS as f32)]);
        stream.log_static(format!("{}/bar", self.legend()), &bar)
    }

    /// Logs the numbers beside the bar from a time (s) on; earlier snapshots keep the numbers of their range.
    pub(crate) fn log_numbers(&self, stream: &RecordingStream, from: f64) -> RecordingStreamResult<()> {
        stream.set_duration_secs(TIME, from);
        let [low, high] = self.range.map(f64::from);
        let ticks = Along::between(low, high, NUMBERS).ticks().into_iter();
        let numbers = ticks.map(|(share, words)| ([2.6 * WIDTH, 1.0 - share as f32], words));
        let title = ([2.0 * WIDTH, -0.06], format!("{}, {}", self.field.symbol, self.field.unit));
        let (places, words): (Vec<[f32; 2]>, Vec<String>) = numbers.chain([title]).unzip();
        let labels = Points2D::new(places)
            .with_labels(words)
            .with_show_labels(true)
            .with_colors([GREY])
            .with_radii([Radius::new_ui_points(0.0)]);
        stream.log(format!("{}/numbers", self.legend()), &labels)
    }
}

/// Most numbers along an axis or a bar.
pub(crate) const NUMBERS: usize = 7;

/// Colour of text and guide lines.
pub(crate) const GREY: [u8; 3] = [128, 128, 132];

/// Number of distinct colours: equal neighbours compress.
const STEPS: f32 = 64.0;

/// Colours of `values` over `range`; what is not a number gets the first.
pub(crate) fn colours(values: &[f32], [low, high]: [f32; 2]) -> impl Iterator<Item = [u8; 3]> + '_ {
    // One value has no span; all get the first colour instead of a NaN.
    let span = (high - low).max(f32::MIN_POSITIVE);
    let share = move |value: &f32| ((value - low) / span * STEPS).round() / STEPS;
    values.iter().map(move |value| viridis(share(value)).map(|part| part.round() as u8))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle_are_the_maps_own() {
        let colours: Vec<_> = colours(&[-1.0, 0.0, 1.0, 2.0, 3.0, f32::NAN], [0.0, 2.0]).collect();
        let [first, middle, last] = [[68, 1, 84], [33, 145, 140], [253, 231, 37]];
        assert_eq!(colours, [first, first, middle, last, last, first]);
    }

    #[test]
    fn a_range_of_nothing_is_one_colour() {
        assert_eq!(colours(&[0.0], [0.0, 0.0]).collect::<Vec<_>>(), [[68, 1, 84]]);
    }

    #[test]
    fn numbers_of_a_bar_are_round_and_within_it() {
        let words = |low, high| -> Vec<String> {
            Along::between(low, high, NUMBERS).ticks().into_iter().map(|(_, words)| words).collect()
        };
        assert_eq!(words(0.0, 0.1), ["0", "0.02", "0.04", "0.06", "0.08", "0.1"]);
        assert_eq!(words(0.3, 57.0), ["10", "20", "30", "40", "50"]);
    }
}
