//! What the header of a recording states about the tower.

use thiserror::Error;

use crate::signal::annotations;
use base::units::{Length, Mass, UnitError};

/// Mass of the impactor and height of fall, as far as they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stated {
    /// kg.
    pub mass: Option<f64>,
    /// m.
    pub height: Option<f64>,
}

/// A line of a header that states no mass or no height.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StatedError {
    /// `mass: …` is none.
    #[error("its header: {0}; write `mass: 10.72 kg`")]
    Mass(UnitError),
    /// `height: …` is none.
    #[error("its header: {0}; write `height: 1 m`")]
    Height(UnitError),
}

impl Stated {
    /// What the lines of a `header` state: `mass: 10.72 kg`, `height: 1 m`. A line whose value is `given` otherwise is
    /// not refused.
    pub fn of_header(header: &[String], given: Stated) -> Result<Stated, StatedError> {
        let mass =
            annotations::stated(header, "mass").map(|text| Mass::DIMENSION.parse(text).map_err(StatedError::Mass));
        let height = annotations::stated(header, "height")
            .map(|text| Length::DIMENSION.parse(text).map_err(StatedError::Height));
        Ok(Stated { mass: unless_given(mass, given.mass)?, height: unless_given(height, given.height)? })
    }
}

/// The value of a line, or its fault where nothing takes its place.
fn unless_given(line: Option<Result<f64, StatedError>>, given: Option<f64>) -> Result<Option<f64>, StatedError> {
    match line.transpose() {
        Err(_) if given.is_some() => Ok(None),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_states_mass_and_height() {
        let of = |lines: &[&str], given: Stated| {
            let header: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
            Stated::of_header(&header, given).map_err(|error| error.to_string())
        };
        let none = Stated::default();
        let both = Stated { mass: Some(10.72), height: Some(1.5) };
        assert_eq!(of(&["test 7", "Mass: 10.72 kg", "# height: 150 cm"], none), Ok(both));
        assert_eq!(of(&["massive: 3 kg", "a height of 2 m"], none), Ok(none));
        let wrong = ["mass: heavy", "height: 3 kg"];
        assert!(of(&wrong[..1], none).expect_err("no mass").starts_with("its header: expected a mass"));
        assert_eq!(
            of(&wrong[1..], none).expect_err("no height"),
            "its header: expected a length, found \"3 kg\"; write `height: 1 m`"
        );
        assert_eq!(of(&wrong, both), Ok(none), "what is given takes the place of both");
    }
}
