//! How lines are drawn: colours that stay apart on light and on dark ground, also for the colour-blind.

use crate::colour;

/// Colour and width of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// sRGB.
    pub colour: [u8; 3],
    /// Points of the screen.
    pub width: f32,
}

/// Wong's palette (Nature Methods 8, 441, 2011) without its black and yellow, which vanish on dark and on light ground.
const COLOURS: [[u8; 3]; 6] =
    [[0, 114, 178], [230, 159, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [213, 94, 0]];

impl Stroke {
    /// The line of the `index`-th curve of a picture.
    pub fn nth(index: usize) -> Stroke {
        Stroke { colour: COLOURS[index % COLOURS.len()], width: 1.5 }
    }

    /// The line of what others are held against, such as a measurement: broad and grey, so that it shows beneath them.
    pub fn target() -> Stroke {
        Stroke { colour: colour::GREY, width: 5.0 }
    }

    /// The line of what this one is held against, where a picture has several: broad and paler.
    pub fn target_of(self) -> Stroke {
        let paler = |shade: u8| shade.midpoint(colour::GREY[0]);
        Stroke { colour: self.colour.map(paler), ..Stroke::target() }
    }

    /// A line that is there for orientation: thin.
    pub fn faint(self) -> Stroke {
        Stroke { width: 1.0, ..self }
    }
}
