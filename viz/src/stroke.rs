//! Colours and widths of lines, distinguishable on light and dark backgrounds and by colour-blind readers.

use crate::colour;

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
        Stroke { colour: colour::GREY, width: 5.0 }
    }

    /// The line of the reference of this one, where a chart has several: broad and paler.
    pub fn target_of(self) -> Stroke {
        let paler = |shade: u8| shade.midpoint(colour::GREY[0]);
        Stroke { colour: self.colour.map(paler), ..Stroke::target() }
    }

    /// A thin guide line.
    pub fn faint(self) -> Stroke {
        Stroke { width: 1.0, ..self }
    }
}
