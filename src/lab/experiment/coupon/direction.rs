//! Directions in the film.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use crate::error::{Error, refusal};
use base::number::significant;
use base::units::Angle;

/// Direction in the film along which a coupon was cut and tested. It has no sense, so that 165° and −15° are one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Direction {
    /// The machine direction.
    Md,
    /// The transverse direction.
    Td,
    /// At 45° between them.
    D3,
    /// At 45°, across D3.
    D4,
    /// At any other angle from MD towards TD.
    At(Hundredths),
}

/// Hundredths of a degree from MD towards TD, above 0 and below 180°, none of the four directions with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Hundredths(u16);

/// Hundredths of a degree of half a turn, after which a direction comes again.
const HALF_TURN: i64 = 18_000;

impl Direction {
    /// The directions with a name.
    pub const NAMED: [Direction; 4] = [Direction::Md, Direction::Td, Direction::D3, Direction::D4];

    /// Whether a curve of a fabric rests on coupons of this direction.
    pub fn has_curve(self) -> bool {
        matches!(self, Direction::Md | Direction::Td | Direction::D3)
    }

    /// The direction at this angle (rad) from MD towards TD, to a hundredth of a degree.
    pub fn at(angle: f64) -> Direction {
        let hundredths = ((angle.to_degrees() * 100.0).round() as i64).rem_euclid(HALF_TURN);
        let named = Direction::NAMED.into_iter().find(|direction| i64::from(direction.hundredths()) == hundredths);
        named.unwrap_or(Direction::At(Hundredths(hundredths as u16)))
    }

    fn hundredths(self) -> u16 {
        match self {
            Direction::Md => 0,
            Direction::Td => 9_000,
            Direction::D3 => 4_500,
            Direction::D4 => 13_500,
            Direction::At(Hundredths(hundredths)) => hundredths,
        }
    }

    /// Angle from MD towards TD, rad, from 0 to below π.
    pub fn angle(self) -> f64 {
        f64::from(self.hundredths()) / HALF_TURN as f64 * PI
    }

    /// The same in degrees.
    pub fn degrees(self) -> f64 {
        f64::from(self.hundredths()) / 100.0
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Direction::Md => f.write_str("MD"),
            Direction::Td => f.write_str("TD"),
            Direction::D3 => f.write_str("D3"),
            Direction::D4 => f.write_str("D4"),
            Direction::At(Hundredths(hundredths)) => write!(f, "{}deg", significant(f64::from(*hundredths) / 100.0, 5)),
        }
    }
}

impl FromStr for Direction {
    type Err = Error;

    /// A name, or an angle with its unit: a number alone may be anything.
    fn from_str(text: &str) -> Result<Direction, Error> {
        let word = text.trim();
        let named = Direction::NAMED.into_iter().find(|direction| direction.to_string().eq_ignore_ascii_case(word));
        if let Some(named) = named {
            return Ok(named);
        }
        let has_unit = word.ends_with(|end: char| end.is_alphabetic() || end == '°');
        let angle = if has_unit { Angle::DIMENSION.parse(&word.replace('°', "deg")).ok() } else { None };
        // Two turns and more are a slip.
        let angle = angle.filter(|angle| angle.abs() <= 4.0 * PI);
        angle.map(Direction::at).ok_or_else(|| {
            refusal!("`{text}` is not a direction of the film: expected MD, TD, D3, D4 or an angle such as 15deg")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_names_are_directions() {
        for (word, expected, degrees) in [
            ("md", "MD", 0.0),
            ("TD", "TD", 90.0),
            ("15deg", "15deg", 15.0),
            ("15 deg", "15deg", 15.0),
            ("22.5°", "22.5deg", 22.5),
            ("45 deg", "D3", 45.0),
            ("-45deg", "D4", 135.0),
            ("195 deg", "15deg", 15.0),
            ("-30 deg", "150deg", 150.0),
            ("180deg", "MD", 0.0),
            ("0.5 rad", "28.65deg", 28.65),
        ] {
            let direction: Direction = word.parse().unwrap();
            assert_eq!(direction.to_string(), expected);
            assert!((direction.angle().to_degrees() - degrees).abs() < 1e-9, "{word}: {}", direction.angle());
            assert_eq!(direction.to_string().parse(), Ok(direction));
        }
        for word in ["", "45", "15 N", "deg", "1e9 deg", "nan deg", "XD"] {
            let error = word.parse::<Direction>().unwrap_err().to_string();
            assert!(error.starts_with(&format!("`{word}` is not a direction of the film")), "{error}");
        }
    }
}
