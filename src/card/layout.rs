//! Layouts of keywords: the names of the fields of each line, from which lines are written with their comments, and by which cards
//! are read.
//!
//! A line is its names in order, between blanks. `-` is a field that is not used, or a gap; a name that ends with `#` is a whole
//! number, which has half the columns of a real one in OpenRadioss. A name in small letters says nothing of a film: readers pass
//! over its value, and warn of any other that they do not know.

use super::number::in_columns;

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
    Real(f64),
    Word(&'static str),
}

/// Name, number of columns before it, and number of its own columns, of each field of a line; a gap has the name `-`.
pub(crate) fn fields(names: &str, format: Format) -> impl Iterator<Item = (&str, usize, usize)> {
    let mut from = 0;
    names.split(' ').map(move |written| {
        let name = written.trim_end_matches('#');
        let width = match format {
            Format::Equal(width) => width,
            Format::Mixed if written.ends_with('#') || name == "-" => 10,
            Format::Mixed => 20,
        };
        from += width;
        (name, from - width, width)
    })
}

/// A line with its comment: values in the order of the names, gaps left out; behind the last value fields are blank.
pub(crate) fn line(names: &str, format: Format, values: &[Field]) -> String {
    let mut values = values.iter().copied();
    let (mut comment, mut text) = (String::new(), String::new());
    for (name, _, width) in fields(names, format) {
        let (shown, value) = match (format, name) {
            (Format::Equal(_), "-") => (name.to_owned(), Field::Blank),
            (Format::Mixed, "-") => (String::new(), Field::Blank),
            (Format::Equal(_), _) => (name.to_lowercase(), values.next().unwrap_or(Field::Blank)),
            (Format::Mixed, _) => (name.to_uppercase(), values.next().unwrap_or(Field::Blank)),
        };
        comment += &format!("{shown:>width$}");
        text += &format!("{:>width$}", written(value, width));
    }
    debug_assert!(values.next().is_none(), "more values than names in {names}");
    // The mark of a comment stands in the first column of the first name.
    let mark = if format == Format::Mixed { '#' } else { '$' };
    format!("{mark}{}\n{}\n", &comment[1..], text.trim_end())
}

/// A value in at most so many columns.
pub(crate) fn written(value: Field, width: usize) -> String {
    match value {
        Field::Blank => String::new(),
        Field::Whole(number) => number.to_string(),
        Field::Real(value) => in_columns(value, width).unwrap_or_default(),
        Field::Word(word) => word.to_owned(),
    }
}
