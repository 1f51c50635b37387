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

/// What a test is labelled with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Labelled {
    /// Direction of the coupon.
    pub direction: Direction,
    /// Speed of the jaws apart, m/s.
    pub velocity: f64,
    /// Whether that is the speed of time and travel, and what else name or header state, m/s.
    pub measured: Option<Option<f64>>,
}

/// Largest difference of two speeds of jaws that are one, over the speed.
pub const SAME_SPEED: f64 = 0.1;

/// Whether two speeds are one but for errors of time and travel.
pub fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME_SPEED * a.abs().max(b.abs())
}

/// Direction and speed (m/s) of a test: what is `given` counts before what the file states, in the lines of its header
/// (`direction: MD`, `velocity: 0.02 m/s`) or in its name without the ending, which must agree. A name states the
/// direction (`MD_3`, `MD 3`), and a speed in m/s up to [`FASTEST`] where it is `md-0.02` or `md-0.02-3`. The speed that
/// time and travel of the jaws have `measured` counts where none is stated, or another.
pub fn label(name: &str, header: &[String], given: Label, measured: Option<f64>) -> Result<Labelled, Error> {
    let (named, headed) = (named(name), headed(header, given)?);
    let direction = match (given.direction, named.direction, headed.direction) {
        (Some(given), _, _) => given,
        (None, Some(name), Some(header)) if name != header => return Err(differ(name, header)),
        (None, name, header) => {
            header.or(name).ok_or_else(|| not_known("direction of the coupon", "direction", "MD"))?
        }
    };
    if let Some(velocity) = given.velocity {
        return Ok(Labelled { direction, velocity, measured: None });
    }
    let stated = match (named.velocity, headed.velocity) {
        (Some(name), Some(header)) if !is_same_speed(name, header) => {
            let [name, header] = [name, header].map(|speed| format!("{} m/s", significant(speed, 6)));
            return Err(differ(name, header));
        }
        (name, header) => header.or(name),
    };
    let (velocity, measured) = match (stated, measured) {
        (Some(stated), Some(measured)) if !is_near(stated, measured) => (measured, Some(Some(stated))),
        (Some(stated), _) => (stated, None),
        (None, Some(measured)) => (measured, Some(None)),
        (None, None) => return Err(not_known("speed of the jaws", "velocity", "0.02 m/s")),
    };
    Ok(Labelled { direction, velocity, measured })
}

/// Parts of a pull whose speeds are compared, and how many samples each has at least.
const PARTS: usize = 20;

/// Speed of the jaws (m/s) from their travel (m) over time (s); none where it changes, as that of an extensometer does.
pub fn measured_speed(time: &[f64], travel: &[f64]) -> Option<f64> {
    let last = time.len().min(travel.len()).checked_sub(1)?;
    let at = |part: usize| part * last / PARTS;
    let slope = |part: usize| {
        let [from, to] = [at(part), at(part + 1)];
        (travel[to] - travel[from]) / (time[to] - time[from])
    };
    if last < PARTS {
        return None;
    }
    let mut slopes: Vec<f64> = (0..PARTS).map(slope).filter(|slope| slope.is_finite()).collect();
    slopes.sort_by(f64::total_cmp);
    let [low, speed, high] = [1, 2, 3].map(|quarter| slopes.get(quarter * slopes.len() / 4).copied());
    let (low, speed, high) = (low?, speed?, high?);
    (low > 0.0 && is_near(low, speed) && is_near(speed, high)).then_some(speed)
}

/// The refusal of a name and a header that state different values.
fn differ<T: std::fmt::Display>(name: T, header: T) -> Error {
    refusal!("its name states {name}, its header {header}")
        .with_hint("correct one of them, or give it on the command line")
}

/// The refusal of a test of which neither name nor header states a value, and none is given.
fn not_known(what: &str, key: &str, example: &str) -> Error {
    let hint = format!("write `# {key}: {example}` into the header, name the file like md-0.02-1.csv, or give --{key}");
    refusal!("the {what} is not known").with_hint(hint).with_kind(Kind::NoLabel)
}

/// Whether two speeds differ by no more than the digits of their units.
pub fn is_same_speed(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * a.abs().max(b.abs())
}

/// Direction of a name such as `MD 3`, and the speed of one such as `md-0.02` or `md-0.02-3`. A whole number alone may
/// be that of the specimen; a date is no speed.
fn named(name: &str) -> Label {
    let parts: Vec<&str> = name.split(['-', '_', ' ']).collect();
    let (direction, velocity) = match parts[..] {
        [direction] => (direction, None),
        [direction, number] if is_digits(number) => (direction, None),
        [direction, velocity] => (direction, Some(velocity)),
        [direction, velocity, number] if is_digits(number) => (direction, Some(velocity)),
        _ => return Label::default(),
    };
    match (direction.parse(), velocity.map(speed)) {
        (Ok(direction), Some(Some(velocity))) => Label { direction: Some(direction), velocity: Some(velocity) },
        (Ok(direction), None) => Label { direction: Some(direction), velocity: None },
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
        label(name, &header, Label::default(), None).map(|found| (found.direction, found.velocity))
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
            ("md", &[], "the speed of the jaws is not known"),
            ("MD_1", &[], "the speed of the jaws is not known"),
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
        let found = label("md-0.02", &header, given, Some(0.5)).unwrap();
        assert_eq!((found.direction, found.velocity), (Direction::D3, 1.0));
    }

    #[test]
    fn the_speed_of_time_and_travel_counts() {
        let found = |name: &str, measured| {
            let found = label(name, &[], Label::default(), measured).unwrap();
            (found.direction, found.velocity, found.measured)
        };
        for name in ["MD_1", "MD 1", "md-1", "md-2", "md"] {
            assert_eq!(found(name, Some(0.0083)), (Direction::Md, 0.0083, Some(None)), "{name}");
        }
        assert_eq!(found("45deg-0.02-1", Some(0.0199)), (Direction::D3, 0.02, None));
        assert_eq!(found("td-1-3", Some(0.0083)), (Direction::Td, 0.0083, Some(Some(1.0))));
        let time: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
        let even: Vec<f64> = time.iter().map(|t| 0.0083 * t + 1e-7 * (1e3 * t).sin()).collect();
        assert!(is_near(measured_speed(&time, &even).unwrap(), 0.0083));
        let uneven: Vec<f64> = time.iter().map(|t| 0.0083 * t * t).collect();
        assert_eq!([measured_speed(&time, &uneven), measured_speed(&time[..9], &even)], [None; 2]);
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
