//! How much of a pixel a curve covers.

/// Colours as red, green and blue from 0 to 255. Pictures are drawn, and their edges mixed, in these values.
type Colour = [f64; 3];

/// The colour of a curve, and that behind it.
#[derive(Clone, Copy, Debug)]
pub struct Ink {
    background: Colour,
    /// From the background to the curve.
    direction: Colour,
    tolerance: f64,
}

impl Ink {
    /// Ink of this colour on this background; `tolerance` is a share of their distance. `None` where they hardly differ.
    pub fn new(colour: [u8; 3], background: [u8; 3], tolerance: f64) -> Option<Ink> {
        let background = background.map(f64::from);
        let colour = colour.map(f64::from);
        let direction = [0, 1, 2].map(|index| colour[index] - background[index]);
        (dot(direction, direction) >= 30.0 * 30.0).then_some(Ink { background, direction, tolerance })
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
        if distance > self.tolerance { 0.0 } else { share.clamp(0.0, 1.0) }
    }
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
        let ink = Ink::new(blue, [255; 3], 0.2).unwrap();
        assert_eq!((ink.coverage(blue), ink.coverage([255; 3])), (1.0, 0.0));
        let half = blue.map(|part| part.midpoint(255));
        assert!((ink.coverage(half) - 0.5).abs() < 0.01);
        for other in [[0, 0, 0], [217, 72, 15], [43, 138, 62], [100, 100, 100]] {
            assert_eq!(ink.coverage(other), 0.0, "{other:?}");
        }
        assert!(Ink::new([250; 3], [255; 3], 0.2).is_none());
        for wrong in ["1f77b4", "#1f77b", "#1f77bg", "blue", "#1f77b4ff", "#éééé"] {
            assert!(Ink::parse(wrong).is_none(), "{wrong}");
        }
    }
}
