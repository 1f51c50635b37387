//! Directions in the film.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// Direction in the film along which a coupon was cut and tested.
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
}

/// A word that is not a direction of the film.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is not a direction of the film: expected MD, TD, D3 or D4")]
pub struct DirectionError(pub String);

impl Direction {
    /// All directions.
    pub const ALL: [Direction; 4] = [Direction::Md, Direction::Td, Direction::D3, Direction::D4];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Direction::Md => "MD",
            Direction::Td => "TD",
            Direction::D3 => "D3",
            Direction::D4 => "D4",
        }
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Direction {
    type Err = DirectionError;

    fn from_str(text: &str) -> Result<Direction, DirectionError> {
        let named = Direction::ALL.into_iter().find(|direction| direction.name().eq_ignore_ascii_case(text.trim()));
        named.ok_or_else(|| DirectionError(text.into()))
    }
}
