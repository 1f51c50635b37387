//! The channel code of ISO/TS 13499: sixteen characters that say what was measured where.

use std::fmt;

use base::units::{Acceleration, Angle, Dimension, Force, Length, Moment, Pressure, Unit, Velocity};

/// A channel code in its parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelCode(String);

impl ChannelCode {
    /// The code that `text` is, if it has sixteen characters of the code's alphabet.
    pub fn parse(text: &str) -> Option<ChannelCode> {
        let fits = text.len() == 16 && text.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'?');
        fits.then(|| ChannelCode(text.to_ascii_uppercase()))
    }

    /// The code of the channel `number` that has none of its own: the location is not stated (0), and the fine
    /// locations count.
    pub fn counted(number: usize, unit: Option<&Unit>, class: Option<f64>) -> ChannelCode {
        let dimension = unit.and_then(|unit| DIMENSIONS.iter().find(|(_, known)| unit.measures(*known)));
        let dimension = dimension.map_or("00", |(letters, _)| letters);
        let filter = CLASSES.iter().find(|(_, known)| Some(*known) == class).map_or('0', |(letter, _)| *letter);
        ChannelCode(format!("000000{:04}00{dimension}0{filter}", number % 10_000))
    }

    /// The code of the time axis `number`.
    pub fn time_axis(number: usize) -> ChannelCode {
        ChannelCode(format!("000000{:04}00TI00", number % 10_000))
    }

    /// Whether the code only counts: the channel that droptower wrote under it has no code of its own.
    pub fn is_counted(&self) -> bool {
        let number = &self.0[6..10];
        self.0.starts_with("000000") && number != "0000" && number.bytes().all(|digit| digit.is_ascii_digit())
    }

    /// Test object, e.g. 1 for the driver's side.
    pub fn object(&self) -> &str {
        &self.0[..1]
    }

    /// Position of the object.
    pub fn position(&self) -> &str {
        &self.0[1..2]
    }

    /// Physical dimension: AC acceleration, DS displacement, VE velocity, FO force, MO moment, TI time, …
    pub fn dimension(&self) -> &str {
        &self.0[12..14]
    }

    /// Direction: X, Y, Z, R resultant, 0 none.
    pub fn direction(&self) -> &str {
        &self.0[14..15]
    }

    /// Letter of the filter class: A to D for the classes 1000, 600, 180, 60, P for an anti-aliasing filter alone.
    pub fn filter(&self) -> &str {
        &self.0[15..]
    }

    /// The channel frequency class that the letter names.
    pub fn class(&self) -> Option<f64> {
        CLASSES.iter().find(|(letter, _)| self.0.ends_with(*letter)).map(|(_, class)| *class)
    }

    /// Whether it is a time axis.
    pub fn is_time(&self) -> bool {
        self.dimension() == "TI"
    }
}

impl fmt::Display for ChannelCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Letters of the filter classes (SAE J211-1).
const CLASSES: [(char, f64); 4] = [('A', 1000.0), ('B', 600.0), ('C', 180.0), ('D', 60.0)];

/// Letters of the physical dimensions that droptower writes; TI is for time axes alone, which are no channels.
const DIMENSIONS: [(&str, Dimension); 7] = [
    ("AC", Acceleration::DIMENSION),
    ("VE", Velocity::DIMENSION),
    ("DS", Length::DIMENSION),
    ("FO", Force::DIMENSION),
    ("MO", Moment::DIMENSION),
    ("PR", Pressure::DIMENSION),
    ("AN", Angle::DIMENSION),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_has_parts() {
        let code = ChannelCode::parse("24NECKUP00P2MOZP").unwrap();
        assert_eq!((code.object(), code.position()), ("2", "4"));
        assert_eq!((code.dimension(), code.direction(), code.filter()), ("MO", "Z", "P"));
        assert_eq!(code.class(), None);
        assert_eq!(ChannelCode::parse("11HEADCG0000ACXA").unwrap().class(), Some(1000.0));
        assert!(ChannelCode::parse("11TIRS000000TIRP").unwrap().is_time());
    }

    #[test]
    fn other_texts_are_no_codes() {
        for text in ["", "11HEADCG0000ACX", "11HEADCG0000ACXPP", "11HEAD CG000ACXP", "11HEADCG0000AC µ"] {
            assert_eq!(ChannelCode::parse(text), None, "{text}");
        }
    }

    #[test]
    fn channels_without_a_code_are_counted() {
        let g = Unit::parse("g").unwrap();
        assert_eq!(ChannelCode::counted(7, Some(&g), Some(60.0)).to_string(), "000000000700AC0D");
        assert_eq!(ChannelCode::counted(12, None, None).to_string(), "0000000012000000");
    }
}
