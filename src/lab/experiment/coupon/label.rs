//! Direction and speed of a coupon test, from the name and the header of its file.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Kind, refusal};
use crate::signal::annotations::stated;
use base::number::significant;
use base::units::{Angle, Velocity};

/// Largest speed of jaws in the name of a file, m/s: tensile machines reach some 20 m/s, larger numbers are years.
pub const FASTEST: f64 = 100.0;

/// Direction and speed of a test, as far as they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Label {
    /// Direction of the coupon.
    pub direction: Option<Direction>,
    /// Speed of the jaws apart, m/s.
    pub velocity: Option<f64>,
}

/// Direction and speed (m/s) of a test: what is `given` counts before what the file states, in the lines of its header
/// (`direction: MD`, `velocity: 0.02 m/s`) or in its name without the ending, which must agree. A name counts where it
/// is direction, speed in m/s up to [`FASTEST`] and, perhaps, a number: `md-0.02-3`.
pub fn label(name: &str, header: &[String], given: Label) -> Result<(Direction, f64), Error> {
    let (named, headed) = (named(name), headed(header, given)?);
    let direction = match (given.direction, named.direction, headed.direction) {
        (Some(given), _, _) => given,
        (None, Some(name), Some(header)) if name != header => return Err(differ(name, header)),
        (None, name, header) => {
            header.or(name).ok_or_else(|| not_known("direction of the coupon", "direction", "MD"))?
        }
    };
    let velocity = match (given.velocity, named.velocity, headed.velocity) {
        (Some(given), _, _) => given,
        (None, Some(name), Some(header)) if !is_same_speed(name, header) => {
            let [name, header] = [name, header].map(|speed| format!("{} m/s", significant(speed, 6)));
            return Err(differ(name, header));
        }
        (None, name, header) => {
            header.or(name).ok_or_else(|| not_known("speed of the jaws", "velocity", "0.02 m/s"))?
        }
    };
    Ok((direction, velocity))
}

/// The refusal of a name and a header that state different values.
fn differ<T: std::fmt::Display>(name: T, header: T) -> Error {
    refusal!("its name states {name}, its header {header}")
        .with_hint("correct one of them, or give it on the command line")
}

/// The refusal of a test of which neither name nor header states a value, and none is given.
fn not_known(what: &str, key: &str, example: &str) -> Error {
    let hint = format!("write `# {key}: {example}` into its header, name it like md-0.02-1.csv, or give --{key}");
    refusal!("the {what} is not known").with_hint(hint).with_kind(Kind::NoLabel)
}

/// Whether two speeds differ by no more than the digits of their units.
pub fn is_same_speed(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * a.abs().max(b.abs())
}

/// Direction and speed of a name of the form `<direction>-<speed>` or `<direction>-<speed>-<number>`; a date is no
/// speed.
fn named(name: &str) -> Label {
    let parts: Vec<&str> = name.split('-').collect();
    let (direction, velocity) = match parts[..] {
        [direction, velocity] => (direction, velocity),
        [direction, velocity, number] if is_digits(number) => (direction, velocity),
        _ => return Label::default(),
    };
    match (direction.parse(), speed(velocity)) {
        (Ok(direction), Some(velocity)) => Label { direction: Some(direction), velocity: Some(velocity) },
        _ => Label::default(),
    }
}

/// A speed in m/s of digits and a point, up to [`FASTEST`].
fn speed(text: &str) -> Option<f64> {
    let (whole, part) = text.split_once('.').unwrap_or((text, "0"));
    let velocity = if is_digits(whole) && is_digits(part) { text.parse().ok() } else { None };
    velocity.filter(|velocity| (f64::MIN_POSITIVE..=FASTEST).contains(velocity))
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// A line whose value is given otherwise is not read.
fn headed(header: &[String], given: Label) -> Result<Label, Error> {
    let wrong = |line: &str, error: &dyn std::fmt::Display| {
        refusal!("its header: {error}").with_hint(format!("write `# {line}`"))
    };
    let direction = stated(header, "direction").filter(|_| given.direction.is_none()).map(str::parse::<Direction>);
    let direction = direction.transpose().map_err(|error| wrong("direction: MD", &error))?;
    let velocity = stated(header, "velocity").filter(|_| given.velocity.is_none());
    let velocity = velocity.map(|text| Velocity::DIMENSION.parse(text)).transpose();
    let velocity = velocity.map_err(|error| wrong("velocity: 0.02 m/s", &error))?;
    Ok(Label { direction, velocity })
}

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

    fn labelled(name: &str, header: &[&str]) -> Result<(Direction, f64), Error> {
        let header: Vec<String> = header.iter().map(|line| (*line).to_owned()).collect();
        label(name, &header, Label::default())
    }

    #[test]
    fn name_and_header_give_direction_and_speed() {
        for (name, header) in [
            ("md-0.0002-3", &[][..]),
            ("sample 7", &["VIRTUAL recording", "direction: md", "velocity: 0.2 mm/s"]),
            ("MD-x", &["# direction: MD", "# Velocity: 0.0002 m/s"]),
        ] {
            let (direction, velocity) = labelled(name, header).unwrap();
            assert_eq!(direction, Direction::Md);
            assert!(is_same_speed(velocity, 2e-4));
        }
    }

    #[test]
    fn a_name_states_any_angle() {
        for (name, expected) in [("15deg-0.02-3", "15deg"), ("22.5deg-0.02", "22.5deg"), ("45deg-0.02-1", "D3")] {
            assert_eq!(labelled(name, &[]).unwrap().0.to_string(), expected);
        }
    }

    #[test]
    fn missing_and_contradictory_labels_are_refused() {
        for (name, header, expected) in [
            ("sample", &[][..], "the direction of the coupon is not known"),
            ("md", &[], "the direction of the coupon is not known"),
            ("md", &["direction: MD"], "the speed of the jaws is not known"),
            ("md-0.02-1", &["direction: TD"], "its name states MD, its header TD"),
            ("md-0.02-1", &["velocity: 0.2 m/s"], "its name states 0.02 m/s, its header 0.2 m/s"),
            (
                "x",
                &["direction: north"],
                "its header: `north` is not a direction of the film: expected MD, TD, D3, D4 or an angle such as 15deg",
            ),
            ("md", &["velocity: 3 kg"], "its header: expected a velocity, found \"3 kg\""),
        ] {
            assert_eq!(labelled(name, header).unwrap_err().to_string(), expected);
        }
    }

    #[test]
    fn dates_and_other_names_are_no_speeds() {
        for name in
            ["md-2024-05-01", "md-2024-05", "md-20240501", "md-0.02-1-2", "md-0.02-a", "md-1e1-1", "md-0-1", "md-inf"]
        {
            assert_eq!(labelled(name, &[]).unwrap_err().kind(), &Kind::NoLabel, "{name}");
        }
        let header = ["direction: TD", "velocity: 0.2 m/s"];
        assert_eq!(labelled("md-2024-05-01", &header), Ok((Direction::Td, 0.2)));
    }

    #[test]
    fn given_values_take_precedence() {
        let given = Label { direction: Some(Direction::D3), velocity: Some(1.0) };
        let header = ["direction: north".to_owned(), "velocity: 3 kg".to_owned()];
        assert_eq!(label("md-0.02", &header, given), Ok((Direction::D3, 1.0)));
    }

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
