//! Tables as values: named columns of numbers, Booleans or strings with gaps, as CSV.

use std::io;

/// A column, with a value or nothing in every row.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, with its SI unit as suffix.
    pub name: String,
    /// Its values.
    pub values: Values,
}

/// Values of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers, SI.
    Numbers(Vec<Option<f64>>),
    /// Booleans.
    Flags(Vec<Option<bool>>),
    /// Texts.
    Texts(Vec<Option<String>>),
}

impl Column {
    /// A column of numbers; what is not finite is a gap.
    pub fn of_numbers(name: impl Into<String>, numbers: impl IntoIterator<Item = f64>) -> Column {
        let values = numbers.into_iter().map(|number| Some(number).filter(|number| number.is_finite()));
        Column { name: name.into(), values: Values::Numbers(values.collect()) }
    }
}

impl Values {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Values::Numbers(values) => values.len(),
            Values::Flags(values) => values.len(),
            Values::Texts(values) => values.len(),
        }
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a row as text; empty where there is none.
    fn text(&self, row: usize) -> String {
        let text = match self {
            Values::Numbers(values) => values[row].map(|number| number.to_string()),
            Values::Flags(values) => values[row].map(|flag| flag.to_string()),
            Values::Texts(values) => values[row].clone(),
        };
        text.unwrap_or_default()
    }

    /// Gives the values `rows` rows: appends gaps, or drops the last values.
    pub fn resize(&mut self, rows: usize) {
        match self {
            Values::Numbers(values) => values.resize(rows, None),
            Values::Flags(values) => values.resize(rows, None),
            Values::Texts(values) => values.resize_with(rows, || None),
        }
    }

    /// As numbers; a flag is one or zero, a text nothing.
    pub fn numbers(&self) -> Vec<Option<f64>> {
        match self {
            Values::Numbers(values) => values.clone(),
            Values::Flags(values) => values.iter().map(|flag| flag.map(|flag| f64::from(u8::from(flag)))).collect(),
            Values::Texts(values) => vec![None; values.len()],
        }
    }
}

/// Columns of equal length as CSV with a header.
///
/// # Errors
/// Memory is exhausted.
pub fn to_csv(columns: &[Column]) -> io::Result<Vec<u8>> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(columns.iter().map(|column| &column.name))?;
    for row in 0..columns.first().map_or(0, |column| column.values.len()) {
        out.write_record(columns.iter().map(|column| column.values.text(row)))?;
    }
    out.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_is_an_empty_cell() {
        let columns = [
            Column::of_numbers("a", [0.1, f64::NAN]),
            Column { name: "b".to_owned(), values: Values::Texts(vec![Some("x, y".to_owned()), None]) },
        ];
        assert_eq!(String::from_utf8(to_csv(&columns).unwrap()).unwrap(), "a,b\n0.1,\"x, y\"\n,\n");
    }
}
