//! The quantities that colour films, and their colour bar.

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::archetypes::{LineStrips2D, Points2D};
use re_sdk_types::components::Radius;

use crate::colour;
use crate::diagram::Scale;
use crate::series::TIME;

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
            .with_colors(colour::colours(self.colours, &values, self.range))
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
            .with_colors([colour::GREY])
            .with_radii([Radius::new_ui_points(0.0)]);
        stream.log(format!("{}/numbers", self.legend()), &labels)
    }
}
