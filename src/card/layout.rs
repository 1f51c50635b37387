//! Layouts of keywords: the names of the fields of each line, from which lines are written with their comments, and by which cards
//! are read.
//!
//! A line is its fields in order, between blanks:
//!
//! - `NAME`, a value. A name in small letters says nothing of a film: readers pass over its value, and warn of any other that
//!   they do not know.
//! - `NAME#`, a whole number, which has half the columns of a real one in OpenRadioss.
//! - `NAME:quantity`, a number in the unit of the card, which is SI in this program.
//! - `NAME=text`, a field that is always written so, blank where there is no text.
//! - `-`, a field that is not used, or a gap.

use super::target::System;

/// The lines of a keyword, in order.
pub(crate) type Layout = &'static [&'static str];

/// How wide fields are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// LS-DYNA: all alike, so many columns.
    Equal(usize),
    /// OpenRadioss: 20 columns, whole numbers and gaps 10.
    Mixed,
}

/// A field of a line.
#[derive(Clone, Copy)]
pub(crate) enum Field {
    /// Left to its default.
    Blank,
    Whole(i64),
    /// SI.
    Real(f64),
    Word(&'static str),
}

/// A field as its layout has it.
#[derive(Clone, Copy)]
pub(crate) struct Column<'a> {
    /// `-` is a gap.
    pub(crate) name: &'a str,
    quantity: &'a str,
    constant: Option<&'a str>,
    /// Number of columns before it, and of its own.
    pub(crate) from: usize,
    pub(crate) width: usize,
}

/// The fields of a line.
pub(crate) fn columns(line: &str, format: Format) -> impl Iterator<Item = Column<'_>> {
    let mut from = 0;
    line.split(' ').map(move |field| {
        let (field, constant) = field.split_once('=').map_or((field, None), |(field, text)| (field, Some(text)));
        let (marked, quantity) = field.split_once(':').unwrap_or((field, ""));
        let name = marked.trim_end_matches('#');
        let width = match format {
            Format::Equal(width) => width,
            Format::Mixed if marked.ends_with('#') || name == "-" => 10,
            Format::Mixed => 20,
        };
        from += width;
        Column { name, quantity, constant, from: from - width, width }
    })
}

impl Column<'_> {
    /// A value (SI) in the units of a card.
    fn in_units(&self, value: f64, system: System) -> f64 {
        let (length, time) = (system.length(), system.time());
        let mass = system.density() * length.powi(3);
        match self.quantity {
            "" => value,
            "length" => value / length,
            "time" => value / time,
            "rate" => value * time,
            "velocity" => value * time / length,
            "mass" => value / mass,
            "inertia" => value / mass / length.powi(2),
            "density" => value / system.density(),
            "stress" => value / system.stress(),
            "stiffness" => value / system.resultant(),
            other => unreachable!("{other} is no quantity of a layout"),
        }
    }

    /// The value (SI) of a number of a card.
    pub(crate) fn in_si(&self, number: f64, system: System) -> f64 {
        match self.quantity {
            "" => number,
            "time" => number * system.time(),
            "rate" => number / system.time(),
            "density" => number * system.density(),
            "stress" => number * system.stress(),
            other => unreachable!("{other} is not read"),
        }
    }
}

/// The lines of a layout with their comments: `values` in the order of the fields without a constant; behind the last value such
/// fields are blank. `None` where a number does not fit its columns; it fits twenty.
pub(crate) fn lines(layout: Layout, format: Format, system: System, values: &[Field]) -> Option<String> {
    let mut values = values.iter().copied();
    let mut text = String::new();
    for names in layout {
        let (mut comment, mut line) = (String::new(), String::new());
        for column in columns(names, format) {
            let Column { name, constant, width, .. } = column;
            let shown = match format {
                Format::Equal(_) => name.to_lowercase(),
                Format::Mixed if name == "-" => String::new(),
                Format::Mixed => name.to_uppercase(),
            };
            let value = match constant {
                _ if name == "-" => String::new(),
                Some(constant) => constant.to_owned(),
                None => match values.next().unwrap_or(Field::Blank) {
                    Field::Blank => String::new(),
                    Field::Whole(number) => number.to_string(),
                    Field::Real(value) if width == 20 => in_twenty(column.in_units(value, system)),
                    Field::Real(value) => in_columns(column.in_units(value, system), width)?,
                    Field::Word(word) => word.to_owned(),
                },
            };
            comment += &format!("{shown:>width$}");
            line += &format!("{value:>width$}");
        }
        // The mark of a comment stands in the first column of the first name.
        let mark = if format == Format::Mixed { '#' } else { '$' };
        text += &format!("{mark}{}\n{}\n", &comment[1..], line.trim_end());
    }
    debug_assert!(values.next().is_none(), "more values than fields in {layout:?}");
    Some(text)
}

/// Numbers in so many fields, of which the last ones stay blank.
pub(crate) fn padded(fields: usize, numbers: impl IntoIterator<Item = f64>) -> impl Iterator<Item = Field> {
    numbers.into_iter().map(Field::Real).chain(std::iter::repeat(Field::Blank)).take(fields)
}

/// Largest relative difference of a number that is written from its value.
pub const ROUNDED: f64 = 1e-6;

/// Most digits of a number: those that tell it from its neighbours.
const DIGITS: usize = 17;

/// The number in at most `width` characters; `None` where they do not hold it within [`ROUNDED`].
///
/// It has a point or an exponent, so that no reader takes it for a whole number.
pub fn in_columns(value: f64, width: usize) -> Option<String> {
    if value == 0.0 {
        return Some("0.0".into());
    }
    let texts = (1..=DIGITS).flat_map(|digits| [plain(value, digits), Some(scientific(value, digits))]).flatten();
    let fitting = texts.filter(|text| text.len() <= width).map(|text| {
        let read: f64 = text.parse().unwrap_or(f64::NAN);
        ((read / value - 1.0).abs(), text)
    });
    // Of equally exact ones the first and shortest.
    let best = fitting.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 <= ROUNDED).then_some(best.1)
}

/// The number with every digit that it has.
pub fn whole(value: f64) -> String {
    in_columns(value, 30).unwrap_or_else(|| scientific(value, DIGITS))
}

/// The number in at most 20 characters, of which CalculiX and Abaqus read no more.
pub fn in_twenty(value: f64) -> String {
    // Every finite number fits; another is left for the solver to refuse, where an empty field would pass for a default.
    in_columns(value, 20).unwrap_or_else(|| scientific(value, 12))
}

/// Without an exponent, with so many digits; `None` where that needs many zeros.
fn plain(value: f64, digits: usize) -> Option<String> {
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..15).contains(&exponent) {
        return None;
    }
    let decimals = (digits as i32 - 1 - exponent).max(1) as usize;
    let text = format!("{value:.decimals$}");
    let text = text.trim_end_matches('0');
    Some(if text.ends_with('.') { format!("{text}0") } else { text.to_owned() })
}

/// With an exponent and so many digits: `8.4E-06` as `8.4E-6`.
fn scientific(value: f64, digits: usize) -> String {
    let text = format!("{value:.*E}", digits - 1);
    match text.split_once('E') {
        Some((mantissa, exponent)) if mantissa.contains('.') => {
            let mantissa = mantissa.trim_end_matches('0');
            format!("{mantissa}{}E{exponent}", if mantissa.ends_with('.') { "0" } else { "" })
        }
        Some((mantissa, exponent)) => format!("{mantissa}.0E{exponent}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numbers_are_as_short_as_they_are_exact() {
        for (value, width, expected) in [
            (0.0, 10, Some("0.0")),
            (1.0, 10, Some("1.0")),
            (-0.5, 10, Some("-0.5")),
            (9.15e-10, 10, Some("9.15E-10")),
            (8.4e6, 10, Some("8400000.0")),
            (210_000.0, 10, Some("210000.0")),
            (0.024496, 10, Some("0.024496")),
            (1.0 / 3.0, 10, Some("0.33333333")),
            (1.234_567_8e-9, 10, None),
            (1.234_567_8e-9, 20, Some("1.2345678E-9")),
            (-1.234_567_8e-3, 10, Some("-0.0012346")),
        ] {
            let expected = if value == -1.234_567_8e-3 { None } else { expected.map(String::from) };
            assert_eq!(in_columns(value, width), expected, "{value}");
        }
    }

    /// The lines of all layouts, as the sources have them.
    fn all_lines() -> impl Iterator<Item = &'static str> {
        let cards = [include_str!("ls_dyna.rs"), include_str!("openradioss.rs")];
        let decks = [include_str!("deck/ls_dyna.rs"), include_str!("deck/openradioss.rs")];
        let constants = cards.into_iter().chain(decks).flat_map(|source| source.split("const ").skip(1));
        let layouts = constants.map(|constant| constant.split(';').next().unwrap_or_default());
        layouts
            .filter(|text| text.contains(": Layout") || text.contains(": &str"))
            .flat_map(|text| text.split('"').skip(1).step_by(2))
    }

    #[test]
    fn every_quantity_of_a_layout_has_a_unit() {
        let mut fields = 0;
        for column in all_lines().flat_map(|line| columns(line, Format::Mixed)) {
            let value = column.in_units(1.0, System::KgMS);
            assert!((value - 1.0).abs() < 1e-12, "{}: {value}", column.name);
            fields += 1;
        }
        assert!(fields > 400, "{fields} fields were found in the sources");
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(mantissa in -10.0_f64..10.0, exponent in -20_i32..20, width in 10_usize..24) {
            let value = mantissa * 10.0_f64.powi(exponent);
            if let Some(text) = in_columns(value, width) {
                prop_assert!(text.len() <= width && (text.contains('.')));
                let read: f64 = text.parse().unwrap();
                prop_assert!((read - value).abs() <= ROUNDED * value.abs());
            } else {
                prop_assert!(width < 14);
            }
        }
    }
}
