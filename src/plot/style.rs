//! Size, letters and lines of a picture for a page of paper or a slide.

/// Points per inch.
const POINTS: f64 = 72.0;

/// Metres per inch.
const INCH: f64 = 0.0254;

/// How a picture is set. Lengths are in points, 1/72 inch, as those of letters are.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// Size of letters.
    pub letters: f64,
    /// Families of letters, as in CSS: the first that a reader has is taken.
    pub family: String,
    /// Width of curves.
    pub line: f64,
    /// Whether the picture has its heading; in a journal the caption below it says what it is.
    pub has_title: bool,
}

impl Style {
    /// The pixels of a length in points at so many pixels per inch.
    pub fn pixels(length: f64, dpi: f64) -> u32 {
        (length / POINTS * dpi).round() as u32
    }

    /// The points of a length in m.
    pub fn points(length: f64) -> f64 {
        length / INCH * POINTS
    }

    /// The points of so many pixels.
    pub fn of_pixels(pixels: u32, dpi: f64) -> f64 {
        f64::from(pixels) / dpi * POINTS
    }

    /// The length in mm as SVG has it, to a micrometre.
    pub fn millimetres(length: f64) -> String {
        format!("{}mm", (length / POINTS * INCH * 1e6).round() / 1e3)
    }
}
