//! How much of a pixel a curve covers.

/// Colours as red, green and blue from 0 to 255. Pictures are drawn, and their edges mixed, in these values.
type Colour = [f64; 3];

/// The colour of a curve, and that behind it.
#[derive(Clone, Copy, Debug)]
pub struct Ink {
    background: Colour,
    /// From the background to the curve.
    direction: Colour,
    /// The part of that without its mean: what makes it no grey.
    chroma: Colour,
    tolerance: f64,
    fidelity: Fidelity,
}

/// What a picture's format leaves of colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fidelity {
    /// Least chroma of a pixel over that of a mix of curve and background that covers as much: what has less is a grey, such
    /// as that of a grid.
    pub least_chroma: f64,
    /// Part of the tolerance that a pixel has which the curve covers not at all: mixes lie between both colours.
    pub faint_tolerance: f64,
}

impl Fidelity {
    /// Of pictures without loss.
    pub const EXACT: Fidelity = Fidelity { least_chroma: 0.5, faint_tolerance: 0.2 };
    /// Of a JPEG, which stores colours coarser than brightness, and neither exactly.
    pub const JPEG: Fidelity = Fidelity { least_chroma: 0.2, faint_tolerance: 1.0 };

    /// The part of the tolerance of a pixel that the curve covers by this share.
    fn tolerance(self, share: f64) -> f64 {
        let full = self.faint_tolerance.max(0.7);
        self.faint_tolerance + (full - self.faint_tolerance) * share
    }
}

/// Part of a curve's chroma from which it is no grey, over its distance from the background.
const CHROMATIC: f64 = 0.25;

impl Ink {
    /// Ink of this colour on this background; `tolerance` is a share of their distance. `None` where they hardly differ.
    pub fn new(colour: [u8; 3], background: [u8; 3], tolerance: f64, fidelity: Fidelity) -> Option<Ink> {
        let background = background.map(f64::from);
        let colour = colour.map(f64::from);
        let direction = [0, 1, 2].map(|index| colour[index] - background[index]);
        let chroma = without_mean(direction);
        let is_distinct = dot(direction, direction) >= 30.0 * 30.0;
        is_distinct.then_some(Ink { background, direction, chroma, tolerance, fidelity })
    }

    /// Reads "#1f77b4".
    pub fn parse(text: &str) -> Option<[u8; 3]> {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
        let part = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).ok();
        Some([part(0)?, part(2)?, part(4)?])
    }

    /// The share of a pixel of this colour that the curve covers, from 0 to 1; 0 where the colour is another one.
    pub fn coverage(&self, pixel: [u8; 3]) -> f64 {
        let square = dot(self.direction, self.direction);
        let from = [0, 1, 2].map(|index| f64::from(pixel[index]) - self.background[index]);
        let share = dot(from, self.direction) / square;
        let beside = [0, 1, 2].map(|index| from[index] - share * self.direction[index]);
        let beyond = (share - 1.0).max(0.0);
        let distance = (dot(beside, beside) / square + beyond * beyond).sqrt();
        let share = share.clamp(0.0, 1.0);
        let tolerance = self.tolerance * self.fidelity.tolerance(share);
        if distance > tolerance || self.is_grey(from, share) { 0.0 } else { share }
    }

    /// Whether a pixel that is `from` the background has too little of the chroma of a curve that covers this share.
    fn is_grey(&self, from: Colour, share: f64) -> bool {
        let square = dot(self.chroma, self.chroma);
        let is_chromatic = square > CHROMATIC * CHROMATIC * dot(self.direction, self.direction);
        is_chromatic && dot(from, self.chroma) < self.fidelity.least_chroma * share * square
    }
}

fn without_mean(colour: Colour) -> Colour {
    let mean = colour.iter().sum::<f64>() / 3.0;
    colour.map(|part| part - mean)
}

fn dot(a: Colour, b: Colour) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixed_pixels_are_covered_in_part_and_other_colours_are_not() {
        let blue = Ink::parse("#1f77b4").unwrap();
        let ink = Ink::new(blue, [255; 3], 0.2, Fidelity::EXACT).unwrap();
        assert_eq!((ink.coverage(blue), ink.coverage([255; 3])), (1.0, 0.0));
        let half = blue.map(|part| part.midpoint(255));
        assert!((ink.coverage(half) - 0.5).abs() < 0.01);
        for other in [[0, 0, 0], [217, 72, 15], [43, 138, 62], [100, 100, 100], [128; 3], [176; 3], [211; 3]] {
            assert_eq!(ink.coverage(other), 0.0, "{other:?}");
        }
        assert!(Ink::new([250; 3], [255; 3], 0.2, Fidelity::EXACT).is_none());
        for wrong in ["1f77b4", "#1f77b", "#1f77bg", "blue", "#1f77b4ff", "#éééé"] {
            assert!(Ink::parse(wrong).is_none(), "{wrong}");
        }
    }
}
