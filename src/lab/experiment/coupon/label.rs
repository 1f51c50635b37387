//! Direction and speed of a coupon test, from the name and the header of its file.

use super::direction::Direction;
use crate::error::{Error, Kind, refusal};
use crate::signal::annotations::stated;
use base::number::significant;
use base::units::Velocity;

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
}
